"""Curves of several runs on the same axes: each run has a colour, the true values are those of the first."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from thetascope.figures import style
from thetascope.figures.figure_data import FigureData
from thetascope.figures.html_symbols import HAT, escape, symbol
from thetascope.figures.strips import Abscissa, Drawing, Line, Strip


class NothingInCommon(Exception):
    """Raised for runs that have no estimate of the same fault or state."""


@dataclass(frozen=True)
class OverlaidRun:
    """A run with the name of its curves and the observer whose estimates are drawn."""

    data: FigureData
    name: str
    label: str | None


def overlaid(runs: Sequence[OverlaidRun], less: bool = False) -> Drawing:
    """Return the faults and states that at least two runs have, before they are drawn. Raises NothingInCommon.

    A quantity is the same where its name and its unit are. Curves are read at the times of the run that lasts longest.
    A run that shares nothing with the others has a strip of its own: its first fault. With `less` curves are the
    differences from the first run, whose own curves and true values, and what it does not have, are left out.
    """
    strips = [
        strip for kind, name, unit in _quantities(runs) if (strip := _strip(runs, kind, name, unit, less)) is not None
    ]
    if not less:
        shown = {line.curve for strip in strips for line in strip.lines}
        strips += [own for place, run in enumerate(runs) if run.name not in shown and (own := _own_strip(run, place))]
    if not strips:
        raise NothingInCommon
    first = runs[0].data
    code = "figure.less-the-first" if less else "figure.overlaid"
    caption = first.say(f"{code}.caption", name=runs[0].name) if less else first.say(f"{code}.caption")
    return Drawing(first.say(code), caption, tuple(strips))


def _quantities(runs: Sequence[OverlaidRun]) -> list[tuple[str, str, str]]:
    """Return kind, name and unit of the faults of all plants, then of the states, each once."""
    found = [
        (kind, item.name, run.data.unit(kind, item.name))
        for kind, field in (("theta", "channels"), ("x", "states"))
        for run in runs
        for item in getattr(run.data.plant, field)
    ]
    return list(dict.fromkeys(found))


def _has(run: OverlaidRun, kind: str, name: str) -> bool:
    return f"{run.label}.{kind}.{name}" in run.data.columns


def _strip(runs: Sequence[OverlaidRun], kind: str, name: str, unit: str, less: bool) -> Strip | None:
    """Return the strip of a channel or state; None if fewer than two runs, or not the first of `less`, estimate it."""
    members = [
        (place, run) for place, run in enumerate(runs) if _has(run, kind, name) and run.data.unit(kind, name) == unit
    ]
    if len(members) < 2 or (less and members[0][0] != 0):
        return None
    time = max((run.data for _, run in members), key=lambda data: float(data.t[-1])).time
    return _drawn(members, kind, name, time, less)


def _own_strip(run: OverlaidRun, place: int) -> Strip | None:
    """Return the strip of a run alone: the first of its faults that acts, else of its channels, else of its states."""
    data = run.data
    channels = [item.name for item in data.plant.channels if _has(run, "theta", item.name)]
    channels.sort(key=lambda name: not data.intervals("theta", name))
    states = [item.name for item in data.plant.states if _has(run, "x", item.name)]
    found = [("theta", name) for name in channels] + [("x", name) for name in states]
    return _drawn([(place, run)], *found[0], data.time, False) if found else None


def _drawn(members: Sequence[tuple[int, OverlaidRun]], kind: str, name: str, time: Abscissa, less: bool) -> Strip:
    """Return the strip of runs with their places among all; the true values are those of the first of them."""
    first = members[0][1]
    source = f"{first.label}.{kind}.{name}"
    reference = _read(time, first.data, first.data.values(source)) if less else 0.0
    lines = []
    for place, run in members[1:] if less else members:
        column = f"{run.label}.{kind}.{name}"
        lines.append(
            Line(
                _read(time, run.data, run.data.values(column)) - reference,
                f"{symbol(name, HAT)} {escape(run.name)}",
                style.observer_colour(run.data.theme, place),
                escape(run.name),
                final=True,
                layer=-place,
                curve=run.name,
                source=f"{column} - {source}" if less else column,
            )
        )
    data = first.data
    if f"{kind}.{name}" in data.columns and not less:
        truth = data.truth(kind, name)
        lines.append(replace(truth, y=_read(time, data, truth.y)))
    shade = data.intervals(kind, name) if kind == "theta" else []
    edges = {at for interval in shade for at in interval}
    marks = [at for at in data.changes() if at not in edges]
    shown = f"Δ {symbol(name, HAT)}" if less else symbol(name)
    return Strip(time, shown, data.caption(kind, name), lines, shade=shade, marks=marks, unit=data.unit(kind, name))


def _read(time: Abscissa, data: FigureData, values: np.ndarray) -> np.ndarray:
    """Return values of a run at other times; beyond its end they are missing."""
    return values if time is data.time else np.interp(time.values, data.t, values, left=np.nan, right=np.nan)
