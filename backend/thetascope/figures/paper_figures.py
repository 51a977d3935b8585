"""Figures that an experiment declares as data, such as those of the paper.

A trace of an observer's diagnostic that this run does not have is left out, and so is a panel without a trace.
"""

from collections.abc import Sequence

import numpy as np

from thetascope.figures.figure_data import Scene
from thetascope.figures.html_symbols import TILDE, escape, mathematical, symbol, wrap
from thetascope.figures.strips import Abscissa, Line, Strip, stack
from thetascope.figures.style import mix

_MATH_LENGTH = 12
"""Longest title of a vertical axis that is set as mathematics beside the strip; longer ones are set as words."""


def drawable(declared, columns: Sequence[str]) -> bool:
    """Return whether a run with these columns has anything to draw in that figure."""
    return any(_traces(panel, columns) for panel in declared.panels)


def build(scene: Scene, declared) -> dict:
    """Return one figure of the experiment's `figures`: its panels below one another, those over time on one axis."""
    panels = [panel for panel in declared.panels if _traces(panel, scene.columns)]
    if not panels:
        raise KeyError(declared.name)
    axes: dict[tuple[str, str], Abscissa] = {}
    strips = [
        _strip(scene, panel, axes.setdefault((panel.x, panel.x_title), _abscissa(scene, panel)), len(panels))
        for panel in panels
    ]
    return stack(scene.text(declared.title) or declared.name, scene.text(declared.caption), strips, scene.theme)


def _traces(panel, columns) -> list:
    """Return the traces of the panel whose columns exist; none if its abscissa does not exist."""
    if panel.x not in columns:
        return []
    return [trace for trace in panel.traces if trace.column in columns and (trace.minus or "t") in columns]


def _abscissa(scene: Scene, panel) -> Abscissa:
    if panel.x == "t":
        return (
            Abscissa(scene.t, mathematical(escape(scene.text(panel.x_title))) or scene.time.title)
            if panel.x_title
            else scene.time
        )
    unit = scene.unit(*scene.split(panel.x)[1:])
    return Abscissa(
        scene.values(panel.x),
        mathematical(escape(scene.text(panel.x_title)))
        or scene.symbol(panel.x) + (f" ({escape(unit)})" if unit else ""),
        is_time=False,
    )


def _strip(scene: Scene, panel, x: Abscissa, count: int) -> Strip:
    traces = _traces(panel, scene.columns)
    lines = [_line(scene, panel.log, traces, place) for place in range(len(traces))]
    shown = {scene.split(column)[1:] for trace in traces for column in (trace.column, trace.minus) if column}
    faults = [interval for kind, name in shown if kind in ("theta", "y") for interval in scene.intervals(kind, name)]
    shade = sorted(set(faults)) if x.is_time else []
    edges = {at for interval in shade for at in interval}
    marks = [at for at in scene.changes() if at not in edges] if x.is_time else []
    heading, caption = _heading(scene, panel, traces)
    height = 380 if not x.is_time else 340 if count == 1 else 170 if count < 4 else 124
    return Strip(x, heading, caption, lines, log=panel.log, shade=shade, marks=marks, height=height)


def _default_label(scene: Scene, trace, truth: bool, kind: str) -> str:
    """Return the legend of a line of the plant that the experiment does not name."""
    if truth or kind == "y":
        return scene.say("figure.truth" if truth else "figure.measured")
    return _name(scene, trace)


def _heading(scene: Scene, panel, traces: Sequence) -> tuple[str, str]:
    """Return the label left of the panel (the title of its vertical axis, or its symbols), and its words and unit."""
    quantities = list(dict.fromkeys(scene.split(trace.column)[1:] for trace in traces))
    title, words = scene.text(panel.y_title), [scene.text(panel.title)]
    if title and len(title) <= _MATH_LENGTH:
        heading = f"<i>{mathematical(escape(title))}</i>"
    elif title:
        heading, words = "", [title, scene.text(panel.title)]
    else:
        accent = TILDE if all(trace.minus for trace in traces) else ""
        heading = ", ".join(symbol(name, accent) for _, name in quantities[:3]) + (" …" if len(quantities) > 3 else "")
    if not (title or panel.title) and len(quantities) == 1:
        return heading, scene.caption(*quantities[0])
    units = {scene.unit(kind, name) for kind, name in quantities}
    unit = units.pop() if len(units) == 1 else ""
    rows = [mathematical(wrap(text)) for text in words if text] + ([escape(unit)] if unit and unit not in title else [])
    return heading, "<br>".join(rows)


def _values(scene: Scene, trace) -> np.ndarray:
    y = scene.values(trace.column)
    if trace.minus:
        with np.errstate(over="ignore", invalid="ignore"):
            y = y - scene.values(trace.minus)
    return np.abs(y) if trace.absolute else y


def _line(scene: Scene, log: bool, traces: Sequence, place: int) -> Line:
    """Return the trace at `place`: observers in their colours, the plant in ink, dashed beside an estimate."""
    trace = traces[place]
    y, plain = _values(scene, trace), not (trace.minus or log)
    label, kind, _ = scene.split(trace.column)
    label = label or (scene.split(trace.minus)[0] if trace.minus else None)
    if label is None:
        truth = kind in ("x", "theta") and any(scene.split(other.column)[0] for other in traces)
        dash = "dash" if truth and trace.style == "solid" else trace.style
        text = mathematical(escape(scene.text(trace.label))) or _default_label(scene, trace, truth, kind)
        colour = scene.theme.soft if kind == "y" else scene.theme.ink
        return Line(
            y,
            _name(scene, trace) + f" {text}" * truth,
            colour,
            text,
            dash,
            final=plain,
            framing=kind != "y",
            layer=1 if truth else -99 if kind == "y" else 0,
        )
    dashed = any(
        scene.split(other.column)[0] is None and not other.minus for other in traces
    )  # the true value is drawn beside it
    dash = "solid" if dashed and trace.style == "dash" else trace.style
    same = [other for other in traces if label in (scene.split(other.column)[0], scene.split(other.minus or "t")[0])]
    colour = mix(scene.colour(label), scene.theme.ink, min(0.35 * same.index(trace), 0.7))
    legend = scene.legend(label) if len(same) == 1 else f"{_name(scene, trace)} {scene.legend(label)}"
    return Line(
        y,
        f"{_name(scene, trace)} {escape(label)}",
        colour,
        mathematical(escape(trace.label)) or legend,
        dash,
        final=plain,
        layer=-scene.labels.index(label),
    )


def _name(scene: Scene, trace) -> str:
    """Return the quantity of a trace as mathematics."""
    text = scene.symbol(trace.column) + (f" − {scene.symbol(trace.minus)}" if trace.minus else "")
    return f"|{text}|" if trace.absolute else text
