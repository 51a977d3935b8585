"""The scope: thin strips stacked on one axis, drawn as a Plotly figure of plain dictionaries.

plotly.py is not imported: that takes most of a second, and its figures become such dictionaries in the end.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from thetascope.figures import decimation, style
from thetascope.figures.narrow_screens import narrow

LEFT, RIGHT, TOP, BOTTOM, GAP = 116, 74, 38, 44, 9
MANY = 6
"""Number of strips from which each gets a smaller height."""


@dataclass(frozen=True)
class Line:
    """One trace. name, legend: HTML. final: write its last value at the strip's right edge."""

    y: np.ndarray
    name: str
    colour: str
    legend: str = ""
    dash: str = "solid"
    width: float = 1.1
    final: bool = False
    framing: bool = False
    """Keep the whole line in view (the true value); rare spikes of other lines may leave the strip."""
    layer: int = 0
    """Lines of a higher layer are drawn over the others."""
    curve: str = ""
    """Key of what the line shows in every strip and language: true, measured, or an observer's label."""
    source: str = ""
    """The line's values as an expression of columns of the run."""


@dataclass(frozen=True)
class Abscissa:
    """The horizontal axis of a strip. title: HTML. Strips that hold the same object share one axis."""

    values: np.ndarray
    title: str
    is_time: bool = True


@dataclass(frozen=True)
class Strip:
    """One strip. symbol, caption: escaped HTML; shade: intervals (start, end) of active faults, in s."""

    x: Abscissa
    symbol: str
    caption: str
    lines: Sequence[Line]
    log: bool = False
    shade: Sequence[tuple[float, float]] = ()
    marks: Sequence[float] = ()
    """Times at which another fault begins or ends, drawn as hairlines."""
    limit: float | None = None
    height: int = 104
    """Height in pixels; larger where the numbers beside the strip need it."""
    unit: str = ""
    """The unit of the vertical axis as plain text, if all lines have the same."""


@dataclass(frozen=True)
class Drawing:
    """A figure before it is drawn: its strips, the first on top. title, caption: plain text."""

    title: str
    caption: str
    strips: Sequence[Strip]
    flags: Sequence[tuple[float, str]] = ()
    """Notes on the time of the run: time in s and text, empty for a bookmark."""


def stack(drawing: Drawing, theme: style.Theme) -> dict:
    """Return {"data", "layout"} of a drawing; its title and caption are under layout.meta."""
    strips = drawing.strips
    shared = all(strip.x is strips[0].x for strip in strips)
    heights, gap = [_height(strip, len(strips)) for strip in strips], GAP if shared else GAP + BOTTOM
    total = sum(heights) + gap * (len(heights) - 1)
    margin = {
        "l": LEFT,
        "r": RIGHT if any(line.final for s in strips for line in s.lines) else 22,
        "t": TOP,
        "b": BOTTOM,
    }
    layout = style.base_layout(theme, total + TOP + BOTTOM, margin)
    layout |= {"meta": {"title": drawing.title, "caption": drawing.caption}, "annotations": [], "shapes": []}
    data, seen, top = [], {}, total
    for place, (strip, height) in enumerate(zip(strips, heights, strict=True), start=1):
        y = _numbered("y", place)
        x = "x" if shared else _numbered("x", place)
        domain = ((top - height) / total, top / total)
        points = [_points(strip, line.y) for line in strip.lines]
        layout[y.replace("y", "yaxis")] = _y_axis(strip, [values for _, values in points], theme, domain, x)
        layout[x.replace("x", "xaxis")] = _x_axis(strip.x, theme, y)  # of the lowest strip if shared
        layout["annotations"] += _labels(strip, theme, domain) + _finals(strip, theme, domain)
        layout["shapes"] += _shading(strip, theme, x, y)
        if strip.x.is_time:
            layout["shapes"] += [_flag_line(t, theme, x, y) for t, _ in drawing.flags]
            if place == 1 or not shared:
                layout["annotations"] += [_flag(t, text, theme, x, y) for t, text in drawing.flags]
        first = {line.legend: line for line in reversed(strip.lines) if line.legend not in seen}
        seen |= first
        for rank, (line, (xs, ys)) in sorted(
            enumerate(zip(strip.lines, points, strict=True)), key=lambda e: e[1][0].layer
        ):
            data.append(_trace(line, xs, ys, x, y, line is first.get(line.legend)) | {"legendrank": 100 * place + rank})
        top -= height + gap
    if shared and strips[0].x.is_time:
        layout["hovermode"], layout["hoversubplots"] = "x unified", "axis"
    layout["showlegend"] = any(seen)
    layout["meta"]["narrow"] = narrow(layout, strips, theme, filter(None, seen))
    return {"data": data, "layout": layout}


def _flag_line(t: float, theme: style.Theme, x: str, y: str) -> dict:
    line = {"color": theme.ink, "width": 1, "dash": "1px,2px"}
    return {"type": "line", "xref": x, "x0": t, "x1": t, "yref": f"{y} domain", "y0": 0, "y1": 1, "line": line}


def _flag(t: float, text: str, theme: style.Theme, x: str, y: str) -> dict:
    """Return the flag of a note above a strip; the note is read under the pointer."""
    return {
        "name": "flag",
        "xref": x,
        "x": t,
        "yref": f"{y} domain",
        "y": 1,
        "yanchor": "bottom",
        "xanchor": "left",
        "xshift": -3,
        "showarrow": False,
        "text": "⚑",
        "hovertext": escape(text) or f"{t:g} s",
        "captureevents": True,
        "font": {"size": 13, "color": theme.ink},
    }


def _numbered(axis: str, place: int) -> str:
    """Return Plotly's name of an axis: y, y2, y3, …"""
    return axis if place == 1 else f"{axis}{place}"


def _height(strip: Strip, count: int) -> int:
    base = strip.height * (0.8 if count > MANY else 1)
    return max(round(base), 15 * sum(line.final for line in strip.lines) + 12)


def _points(strip: Strip, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the points to draw: all, or a reduced set that looks the same."""
    x = strip.x.values
    if not strip.x.is_time:
        rows = decimation.curve_extremes(x, y)
    else:
        rows = decimation.peaks(y) if strip.log else decimation.extremes(y)
    return (x, y) if rows is None else (x[rows], y[rows])


def _trace(line: Line, x: np.ndarray, y: np.ndarray, x_axis: str, y_axis: str, first: bool) -> dict:
    return {
        "type": "scatter",
        "mode": "lines",
        "x": decimation.typed(x),
        "y": decimation.typed(y),
        "xaxis": x_axis,
        "yaxis": y_axis,
        "name": line.legend or line.name,
        "legendgroup": line.legend,
        "showlegend": bool(line.legend) and first,
        "line": {"color": line.colour, "width": line.width, "dash": style.DASHES[line.dash]},
        "hovertemplate": line.name.replace("%{", "%&#123;") + "  %{y:.4~g}<extra></extra>",
    }


def view(drawn: Sequence[tuple[np.ndarray, bool]], log: bool) -> list[float] | None:
    """Return the range of a strip's axis; None when nothing is finite.

    The range shows everything, unless rare spikes would flatten the rest. drawn: (values, framing) of each line.
    Framing lines are always shown in full. Of the others the middle 95 % of the points counts if the full range is over
    three times as high; at least a twentieth of the value is shown, and a double click in the browser shows all. On a
    logarithmic axis the range is in decades, at most twelve below the highest. On a linear one, a line that ends in NaN
    (an observer that diverged) is ignored if there are others.
    """
    full, core = [], []
    for y, framing in [entry for entry in drawn if log or np.isfinite(entry[0][-1])] or drawn:
        y = y[np.isfinite(y) & (y > 0)] if log else y[np.isfinite(y)]
        if y.size == 0:
            continue
        y = np.sort(np.log10(y) if log else y)
        cut = 0 if framing else y.size // 40
        full += [y[0], y[-1]]
        core += [y[cut], y[-1 - cut]]
    if not full:
        return None
    low, high = min(full), max(full)
    spread = max(max(core) - min(core), 0.05 * max(map(abs, core)))
    if log:
        low = max(min(core), high - 12)
    elif high - low > 3 * spread > 0:
        middle = (max(core) + min(core)) / 2
        low, high = middle - 0.85 * spread, middle + 0.85 * spread
    pad = 0.07 * (high - low) or 0.1 * abs(high) or (0.5 if log else 1e-3)
    return [float(low - pad), float(high + pad)]


def _y_axis(strip: Strip, drawn: Sequence[np.ndarray], theme: style.Theme, domain: tuple[float, float], x: str) -> dict:
    shown = [(y, line.framing or not strip.x.is_time) for line, y in zip(strip.lines, drawn, strict=True)]
    if strip.limit is not None:
        shown.append((np.array([strip.limit]), True))
    limits = view(shown, strip.log)
    more = {"domain": list(domain), "nticks": 4, "anchor": x, "showgrid": False}
    if limits is not None:
        more["range"] = limits
        if strip.log and limits[1] - limits[0] > 1.5:
            more["dtick"] = max(1, round((limits[1] - limits[0]) / 3))
        elif limits[0] < 0 < limits[1]:
            more |= {"zeroline": True, "zerolinecolor": theme.line, "zerolinewidth": 1}
    return style.axis(theme, type="log" if strip.log else "linear", **more)


def _x_axis(x: Abscissa, theme: style.Theme, anchor: str) -> dict:
    title = {"text": x.title, "font": {"size": 12, "color": theme.soft}, "standoff": 6}
    axis = style.axis(theme, anchor=anchor, title=title, nticks=11, hoverformat=".6~g")
    axis["mirror"] = "all"
    if x.is_time:
        axis |= {
            "range": [float(x.values[0]), float(x.values[-1])],
            "unifiedhovertitle": {"text": "%{x:.6~g} s"},
            "showspikes": True,
            "spikemode": "across",
            "spikethickness": 1,
            "spikedash": "solid",
            "spikecolor": theme.soft,
            "spikesnap": "cursor",
        }
    return axis


def _labels(strip: Strip, theme: style.Theme, domain: tuple[float, float]) -> list[dict]:
    """Return the symbol and, below it, the caption, left of the strip; a narrow page moves them by their names."""
    middle = (domain[0] + domain[1]) / 2
    place = {
        "xref": "paper",
        "yref": "paper",
        "x": 0,
        "y": middle,
        "xanchor": "left",
        "xshift": 6 - LEFT,
        "align": "left",
        "showarrow": False,
    }
    symbol = place | {
        "name": "symbol",
        "text": strip.symbol,
        "yanchor": "bottom",
        "yshift": -3,
        "font": {"family": style.MATH, "size": 17, "color": theme.ink},
    }
    caption = place | {
        "name": "caption",
        "text": strip.caption,
        "yanchor": "top",
        "yshift": -4,
        "font": {"family": style.UI, "size": 10.5, "color": theme.soft},
    }
    return [symbol, caption] if strip.caption else [symbol]


def _finals(strip: Strip, theme: style.Theme, domain: tuple[float, float]) -> list[dict]:
    """Return the last value of each line with `final`, in its colour, right of the strip."""
    lines = [line for line in strip.lines if line.final]
    lines.sort(key=lambda line: not line.framing)  # the true value first
    values = [float(line.y[-1]) for line in lines]
    form, middle = style.decimals(values), (domain[0] + domain[1]) / 2
    return [
        {
            "name": "final",
            "xref": "paper",
            "yref": "paper",
            "x": 1,
            "y": middle,
            "xanchor": "left",
            "yanchor": "middle",
            "xshift": 7,
            "yshift": 7.5 * (len(lines) - 1) - 15 * place,
            "showarrow": False,
            "text": style.aligned(value, form),
            "font": {"family": style.NUMBERS, "size": 11, "color": line.colour},
        }
        for place, (line, value) in enumerate(zip(lines, values, strict=True))
    ]


def _shading(strip: Strip, theme: style.Theme, x: str, y: str) -> list[dict]:
    """Return the shapes of a strip: amber while its fault acts, hairlines at changes of other faults, and the limit."""
    whole = {"yref": f"{y} domain", "y0": 0, "y1": 1, "xref": x, "layer": "below"}
    shapes = [
        whole | {"type": "rect", "x0": start, "x1": end, "fillcolor": theme.fault, "line": {"width": 0}}
        for start, end in strip.shade
    ]
    shapes += [
        whole | {"type": "line", "x0": at, "x1": at, "line": {"color": theme.fault_line, "width": 1, "dash": "1px,3px"}}
        for at in strip.marks
    ]
    if strip.limit is not None:
        line = {"color": theme.alarm, "width": 1, "dash": "3px,4px"}
        shapes.append(
            {
                "type": "line",
                "layer": "below",
                "xref": f"{x} domain",
                "x0": 0,
                "x1": 1,
                "yref": y,
                "y0": strip.limit,
                "y1": strip.limit,
                "line": line,
            }
        )
    return shapes
