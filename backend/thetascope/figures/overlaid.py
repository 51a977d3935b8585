"""Curves of several runs on the same axes: each run has a colour, the true values are those of the first."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from thetascope.figures import style
from thetascope.figures.figure_data import FigureData
from thetascope.figures.html_symbols import HAT, escape, symbol
from thetascope.figures.strips import Drawing, Line, Strip


class NothingInCommon(Exception):
    """Raised for runs that have no estimate of the same fault or state."""


@dataclass(frozen=True)
class OverlaidRun:
    """A run with the name of its curves and the observer whose estimates are drawn."""

    data: FigureData
    name: str
    label: str | None


def overlaid(runs: Sequence[OverlaidRun], less: bool = False) -> Drawing:
    """Return the faults and states that all plants have, before they are drawn. Raises NothingInCommon.

    Curves of other runs are read at the times of the first; beyond their end they are missing. With `less` they are
    the differences from the first run, whose own curves and true values are left out.
    """
    first = runs[0].data
    strips = [
        strip
        for kind, items in (("theta", first.plant.channels), ("x", first.plant.states))
        for item in items
        if (strip := _strip(runs, kind, item.name, less)) is not None
    ]
    if not strips:
        raise NothingInCommon
    code = "figure.less-the-first" if less else "figure.overlaid"
    caption = first.say(f"{code}.caption", name=runs[0].name) if less else first.say(f"{code}.caption")
    return Drawing(first.say(code), caption, tuple(strips))


def _strip(runs: Sequence[OverlaidRun], kind: str, name: str, less: bool) -> Strip | None:
    """Return the strip of a channel or state, or None if a run has no estimate of it."""
    columns = [f"{run.label}.{kind}.{name}" for run in runs]
    if not all(column in run.data.columns for column, run in zip(columns, runs, strict=True)):
        return None
    first = runs[0].data
    reference = first.values(columns[0])
    lines = [
        Line(
            np.interp(first.t, run.data.t, run.data.values(column), right=np.nan) - (reference if less else 0.0),
            f"{symbol(name, HAT)} {escape(run.name)}",
            style.observer_colour(first.theme, place),
            escape(run.name),
            final=True,
            layer=-place,
            curve=run.name,
            source=f"{column} - {columns[0]}" if less else column,
        )
        for place, (run, column) in enumerate(zip(runs, columns, strict=True))
        if place or not less
    ]
    truth = [first.truth(kind, name)] if f"{kind}.{name}" in first.columns and not less else []
    shade = first.intervals(kind, name) if kind == "theta" else []
    edges = {at for interval in shade for at in interval}
    marks = [at for at in first.changes() if at not in edges]
    shown = f"Δ {symbol(name, HAT)}" if less else symbol(name)
    unit = first.unit(kind, name)
    return Strip(first.time, shown, first.caption(kind, name), [*lines, *truth], shade=shade, marks=marks, unit=unit)
