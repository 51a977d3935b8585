"""Curves of several runs on the same axes: each run has a colour, the true values are those of the first."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from thetascope.figures import style
from thetascope.figures.figure_data import FigureData
from thetascope.figures.html_symbols import HAT, escape, symbol
from thetascope.figures.strips import Drawing, Line, Strip, stack


class NothingInCommon(Exception):
    """Raised for runs that have no estimate of the same fault or state."""


@dataclass(frozen=True)
class OverlaidRun:
    """A run with the name of its curves and the observer whose estimates are drawn."""

    data: FigureData
    name: str
    label: str | None


def overlay(runs: Sequence[OverlaidRun], theme: str = "light") -> dict:
    """Return the figure of the faults and states that all plants have, as plain dictionaries. Raises NothingInCommon.

    Curves of other runs are read at the times of the first; beyond their end they are missing.
    """
    first = runs[0].data
    strips = [
        strip
        for kind, items in (("theta", first.plant.channels), ("x", first.plant.states))
        for item in items
        if (strip := _strip(runs, kind, item.name)) is not None
    ]
    if not strips:
        raise NothingInCommon
    title, caption = first.say("figure.overlaid"), first.say("figure.overlaid.caption")
    return stack(Drawing(title, caption, tuple(strips)), style.theme_named(theme))


def _strip(runs: Sequence[OverlaidRun], kind: str, name: str) -> Strip | None:
    """Return the strip of a channel or state, or None if a run has no estimate of it."""
    columns = [f"{run.label}.{kind}.{name}" for run in runs]
    if not all(column in run.data.columns for column, run in zip(columns, runs, strict=True)):
        return None
    first = runs[0].data
    lines = [
        Line(
            np.interp(first.t, run.data.t, run.data.values(column), right=np.nan),
            f"{symbol(name, HAT)} {escape(run.name)}",
            style.observer_colour(first.theme, place),
            escape(run.name),
            final=True,
            layer=-place,
        )
        for place, (run, column) in enumerate(zip(runs, columns, strict=True))
    ]
    truth = [first.truth(kind, name)] if f"{kind}.{name}" in first.columns else []
    shade = first.intervals(kind, name) if kind == "theta" else []
    edges = {at for interval in shade for at in interval}
    marks = [at for at in first.changes() if at not in edges]
    return Strip(first.time, symbol(name), first.caption(kind, name), [*lines, *truth], shade=shade, marks=marks)
