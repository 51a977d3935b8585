"""Figures that an experiment declares as data, such as those of the paper.

A trace of an observer's diagnostic that this run does not have is left out, and so is a panel without a trace.
"""

from collections.abc import Sequence

import numpy as np

from thetascope.figures.figure_data import FigureData
from thetascope.figures.html_symbols import TILDE, escape, mathematical, symbol, wrap
from thetascope.figures.strips import Abscissa, Drawing, Line, Strip
from thetascope.figures.style import mix

_MATH_LENGTH = 12
"""Longest title of a vertical axis that is set as mathematics beside the strip; longer ones are set as words."""


def drawable(declared, columns: Sequence[str]) -> bool:
    """Return whether a run with these columns has anything to draw in that figure."""
    return any(_traces(panel, columns) for panel in declared.panels)


def build(run: FigureData, declared) -> Drawing:
    """Return one figure of the experiment's `figures`: its panels below one another, those over time on one axis."""
    panels = [panel for panel in declared.panels if _traces(panel, run.columns)]
    if not panels:
        raise KeyError(declared.name)
    axes: dict[tuple[str, str], Abscissa] = {}
    strips = [
        _strip(run, panel, axes.setdefault((panel.x, panel.x_title), _abscissa(run, panel)), len(panels))
        for panel in panels
    ]
    return Drawing(run.text(declared.title) or declared.name, run.text(declared.caption), strips)


def _traces(panel, columns) -> list:
    """Return the traces of the panel whose columns exist; none if its abscissa does not exist."""
    if panel.x not in columns:
        return []
    return [trace for trace in panel.traces if trace.column in columns and (trace.minus or "t") in columns]


def _abscissa(run: FigureData, panel) -> Abscissa:
    if panel.x == "t":
        return (
            Abscissa(run.t, mathematical(escape(run.text(panel.x_title))) or run.time.title)
            if panel.x_title
            else run.time
        )
    unit = run.unit(*run.split(panel.x)[1:])
    return Abscissa(
        run.values(panel.x),
        mathematical(escape(run.text(panel.x_title))) or run.symbol(panel.x) + (f" ({escape(unit)})" if unit else ""),
        is_time=False,
    )


def _strip(run: FigureData, panel, x: Abscissa, count: int) -> Strip:
    traces = _traces(panel, run.columns)
    lines = [_line(run, panel.log, traces, place) for place in range(len(traces))]
    shown = {run.split(column)[1:] for trace in traces for column in (trace.column, trace.minus) if column}
    faults = [interval for kind, name in shown if kind in ("theta", "y") for interval in run.intervals(kind, name)]
    shade = sorted(set(faults)) if x.is_time else []
    edges = {at for interval in shade for at in interval}
    marks = [at for at in run.changes() if at not in edges] if x.is_time else []
    heading, caption = _heading(run, panel, traces)
    unit = _unit(run, traces)
    height = 380 if not x.is_time else 340 if count == 1 else 170 if count < 4 else 124
    return Strip(x, heading, caption, lines, log=panel.log, shade=shade, marks=marks, height=height, unit=unit)


def _default_label(run: FigureData, trace, truth: bool, kind: str) -> str:
    """Return the legend of a line of the plant that the experiment does not name."""
    if truth or kind == "y":
        return run.say("figure.truth" if truth else "figure.measured")
    return _name(run, trace)


def _heading(run: FigureData, panel, traces: Sequence) -> tuple[str, str]:
    """Return the label left of the panel (the title of its vertical axis, or its symbols), and its words and unit."""
    quantities = list(dict.fromkeys(run.split(trace.column)[1:] for trace in traces))
    title, words = run.text(panel.y_title), [run.text(panel.title)]
    if title and len(title) <= _MATH_LENGTH:
        heading = f"<i>{mathematical(escape(title))}</i>"
    elif title:
        heading, words = "", [title, run.text(panel.title)]
    else:
        accent = TILDE if all(trace.minus for trace in traces) else ""
        heading = ", ".join(symbol(name, accent) for _, name in quantities[:3]) + (" …" if len(quantities) > 3 else "")
    if not (title or panel.title) and len(quantities) == 1:
        return heading, run.caption(*quantities[0])
    unit = _unit(run, traces)
    rows = [mathematical(wrap(text)) for text in words if text] + ([escape(unit)] if unit and unit not in title else [])
    return heading, "<br>".join(rows)


def _unit(run: FigureData, traces: Sequence) -> str:
    """Return the unit of the traces' quantities, "" if they differ."""
    units = {run.unit(*run.split(trace.column)[1:]) for trace in traces}
    return units.pop() if len(units) == 1 else ""


def _source(trace) -> str:
    """Return a trace's values as an expression of columns."""
    text = trace.column + (f" - {trace.minus}" if trace.minus else "")
    return f"|{text}|" if trace.absolute else text


def _values(run: FigureData, trace) -> np.ndarray:
    y = run.values(trace.column)
    if trace.minus:
        with np.errstate(over="ignore", invalid="ignore"):
            y = y - run.values(trace.minus)
    return np.abs(y) if trace.absolute else y


def _line(run: FigureData, log: bool, traces: Sequence, place: int) -> Line:
    """Return the trace at `place`: observers in their colours, the plant in ink, dashed beside an estimate."""
    trace = traces[place]
    y, plain = _values(run, trace), not (trace.minus or log)
    label, kind, _ = run.split(trace.column)
    label = label or (run.split(trace.minus)[0] if trace.minus else None)
    if label is None:
        truth = kind in ("x", "theta") and any(run.split(other.column)[0] for other in traces)
        dash = "dash" if truth and trace.style == "solid" else trace.style
        text = mathematical(escape(run.text(trace.label))) or _default_label(run, trace, truth, kind)
        colour = run.theme.soft if kind == "y" else run.theme.ink
        return Line(
            y,
            _name(run, trace) + f" {text}" * truth,
            colour,
            text,
            dash,
            final=plain,
            framing=kind != "y",
            layer=1 if truth else -99 if kind == "y" else 0,
            curve="" if trace.label else "true" if truth else "measured" if kind == "y" else trace.column,
            source=_source(trace),
        )
    dashed = any(
        run.split(other.column)[0] is None and not other.minus for other in traces
    )  # the true value is drawn beside it
    dash = "solid" if dashed and trace.style == "dash" else trace.style
    same = [other for other in traces if label in (run.split(other.column)[0], run.split(other.minus or "t")[0])]
    colour = mix(run.colour(label), run.theme.ink, min(0.35 * same.index(trace), 0.7))
    legend = run.legend(label) if len(same) == 1 else f"{_name(run, trace)} {run.legend(label)}"
    return Line(
        y,
        f"{_name(run, trace)} {escape(label)}",
        colour,
        mathematical(escape(run.text(trace.label))) or legend,
        dash,
        final=plain,
        layer=-run.labels.index(label),
        curve=label if len(same) == 1 and not trace.label else "",
        source=_source(trace),
    )


def _name(run: FigureData, trace) -> str:
    """Return the quantity of a trace as mathematics."""
    text = run.symbol(trace.column) + (f" − {run.symbol(trace.minus)}" if trace.minus else "")
    return f"|{text}|" if trace.absolute else text
