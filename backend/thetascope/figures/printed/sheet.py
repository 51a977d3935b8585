"""From a drawing and its options to a sheet: what is printed, as a value of moderate size."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from thetascope.figures import decimation
from thetascope.figures.printed.looks import LOOKS, Look, apart, assign, coloured
from thetascope.figures.printed.markup import plain, unit_html
from thetascope.figures.strips import Drawing, Line, Strip, view
from thetascope.messages import Message

_POINTS = {"tex": 1000}
"""Most points of a curve where they are fewer than on a screen: TeX's memory is small."""
_HEIGHTS = ((1, 4.6), (2, 3.2), (4, 2.5), (200, 2.0))
"""Height of a panel in cm, by the number of panels up to which it holds."""
_TALLEST = 24.0
_FRAME = 0.5
"""Width of the axes' lines in pt."""


class RefusedChoice(ValueError):
    """Raised for a curve, panel or style that does not exist, or a span without rows."""

    def __init__(self, field: str, value: object, problem: Message, known: Sequence[str] = ()) -> None:
        super().__init__(field, value, problem, known)
        self.field, self.value, self.problem, self.known = field, value, problem, known


@dataclass(frozen=True)
class Curve:
    """One curve of a panel. label: HTML, "" where no legend is needed; source: an expression of columns."""

    key: str
    label: str
    source: str
    x: np.ndarray
    y: np.ndarray
    look: Look
    layer: int


@dataclass(frozen=True)
class SheetPanel:
    """One pair of axes. label, x_title: HTML; limits: of the vertical axis, None if nothing is finite."""

    label: str
    x_title: str
    x_limits: tuple[float, float] | None
    limits: tuple[float, float] | None
    log: bool
    curves: tuple[Curve, ...]
    shade: tuple[tuple[float, float], ...] = ()
    marks: tuple[float, ...] = ()
    limit: float | None = None
    shares_x: bool = True


@dataclass(frozen=True)
class About:
    """Facts about the run that the files contain."""

    title: str
    caption: str
    command: str


@dataclass(frozen=True)
class Sheet:
    """A figure for print. width, height in cm; size in pt."""

    panels: tuple[SheetPanel, ...]
    width: float
    height: float
    font: str
    size: float
    colour: str
    legend: str
    about: About

    @property
    def looks(self) -> dict[str, Look]:
        """Return the line style of every curve that has an entry in the legend."""
        return {curve.key: curve.look for panel in self.panels for curve in panel.curves if curve.label}

    @property
    def thinnest(self) -> float:
        """Return the width of the thinnest line in pt."""
        return min([_FRAME, *(curve.look.width for panel in self.panels for curve in panel.curves)])

    @property
    def apart(self) -> bool:
        """Return whether the curves of the legend differ without colour."""
        return apart(self.looks.values())


def key_of(line: Line) -> str:
    """Return the key of a line's curve, "" for one without a legend."""
    return (line.curve or plain(line.legend)) if line.legend else ""


def curves_of(drawing: Drawing) -> dict[str, Line]:
    """Return the first line of every curve that has a legend, by its key."""
    lines: dict[str, Line] = {}
    for line in (line for strip in drawing.strips for line in strip.lines if line.legend):
        lines.setdefault(key_of(line), line)
    return lines


def panel_label(strip: Strip) -> str:
    """Return the label of a panel as HTML: its symbol with the unit, or else its words."""
    if not strip.symbol:
        return strip.caption
    return strip.symbol + (f" ({unit_html(strip.unit)})" if strip.unit else "")


def styles_of(drawing: Drawing, choices: Sequence[str]) -> dict[str, str]:
    """Return the line style of every curve; choices: curve=style. Raises RefusedChoice."""
    lines, chosen = curves_of(drawing), {}
    for place, choice in enumerate(choices):
        key, _, style = choice.rpartition("=")
        if key not in lines:
            raise RefusedChoice(f"styles[{place}]", choice, Message("print.curve", name=key), list(lines))
        if style not in LOOKS:
            raise RefusedChoice(f"styles[{place}]", choice, Message("print.style", name=style), list(LOOKS))
        chosen[key] = style
    return assign({key: line.dash for key, line in lines.items()}, chosen)


def sheet(drawing: Drawing, settings, about: About) -> Sheet:
    """Return the sheet of a drawing.

    drawing: in the light theme; settings: `PrintSettings`. Raises RefusedChoice for a curve, panel or style that the
    drawing does not have, and for a span without rows.
    """
    names = styles_of(drawing, settings.styles)
    known = list(names)
    for place, key in enumerate(settings.curves):
        if key not in known:
            raise RefusedChoice(f"curves[{place}]", key, Message("print.curve", name=key), known)
    for place, number in enumerate(settings.panels):
        if number > len(drawing.strips):
            raise RefusedChoice(
                f"panels[{place}]", number, Message("print.panel", number=number, n=len(drawing.strips))
            )
    keys = set(settings.curves or known) | {""}
    strips = [drawing.strips[n - 1] for n in dict.fromkeys(settings.panels)] or list(drawing.strips)
    strips = [replace(strip, lines=[line for line in strip.lines if key_of(line) in keys]) for strip in strips]
    strips = [strip for strip in strips if strip.lines]
    if not strips:
        raise RefusedChoice("curves", None, Message("print.empty"))
    shared = all(strip.x is strips[0].x for strip in strips)
    panels = tuple(_panel(strip, settings, names, shared) for strip in strips)
    return Sheet(
        panels,
        settings.width,
        settings.height or _height(strips, settings.width, shared),
        settings.font,
        settings.size,
        settings.colour,
        settings.legend,
        about,
    )


def _height(strips: Sequence[Strip], width: float, shared: bool) -> float:
    """Return a height in cm for the panels, which are a little higher in a wide figure."""
    each = next(height for most, height in _HEIGHTS if len(strips) <= most)
    each *= 1.0 if width < 12 else 1.15
    heights = [each if strip.x.is_time else 0.6 * width for strip in strips]
    return round(min(sum(heights) + (1.2 if shared else 1.0 * len(strips)), _TALLEST), 1)


def _panel(strip: Strip, settings, names: Mapping[str, str], shared: bool) -> SheetPanel:
    rows = _rows(strip, settings)
    x = strip.x.values[rows]
    curves = tuple(_curve(strip, line, x, line.y[rows], settings, names) for line in strip.lines)
    shown = [(line.y[rows], line.framing or not strip.x.is_time) for line in strip.lines]
    if strip.limit is not None:
        shown.append((np.array([strip.limit]), True))
    limits = view(shown, strip.log)
    if limits is not None and strip.log:
        limits = [10.0**limit for limit in limits]
    low, high = (float(x[0]), float(x[-1])) if strip.x.is_time else (-np.inf, np.inf)
    return SheetPanel(
        panel_label(strip),
        strip.x.title,
        (low, high) if strip.x.is_time else None,
        None if limits is None else (limits[0], limits[1]),
        strip.log,
        curves,
        tuple((max(a, low), min(b, high)) for a, b in strip.shade if a < high and b > low),
        tuple(at for at in strip.marks if low < at < high),
        strip.limit,
        shared,
    )


def _rows(strip: Strip, settings) -> slice:
    """Return the rows of the chosen span; all rows where the horizontal axis is not time."""
    x = strip.x.values
    if not strip.x.is_time:
        return slice(None)
    first = 0 if settings.start is None else int(np.searchsorted(x, settings.start))
    last = x.size if settings.end is None else int(np.searchsorted(x, settings.end, side="right"))
    if last - first < 2:
        value, field = (settings.start, "start") if settings.start is not None else (settings.end, "end")
        raise RefusedChoice(field, value, Message("print.no-rows", first=float(x[0]), last=float(x[-1])))
    return slice(first, last)


def _curve(strip: Strip, line: Line, x: np.ndarray, y: np.ndarray, settings, names: Mapping[str, str]) -> Curve:
    points = _POINTS.get(settings.format, decimation.LIMIT)
    if not strip.x.is_time:
        rows = decimation.curve_extremes(x, y, points)
    elif strip.log:
        rows = decimation.peaks(y, points // 2)
    else:
        rows = decimation.extremes(y, points)
    key = key_of(line)
    look = coloured(LOOKS[names.get(key, "line")], settings.colour, line.colour)
    x, y = (x, y) if rows is None else (x[rows], y[rows])
    return Curve(key, line.legend, line.source, x.copy(), y.copy(), look, line.layer)
