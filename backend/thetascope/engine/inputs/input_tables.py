"""Tables of signal values for kernels: one per segment for held signals, one per stage of each step for others."""

from collections.abc import Mapping

import numpy as np

from thetascope.engine.compiler.graph import variables
from thetascope.engine.compiler.system import Program
from thetascope.engine.inputs.signals import Signal
from thetascope.engine.inputs.time_grid import Grid

RUNGE_KUTTA = (0.0, 0.5, 0.5, 1.0)  # where the stages of the classical method are, in steps


class Tables:
    """Tables of signals over one time grid.

    ``places``: where the stages of a step are, in steps; (0,) in discrete time.
    """

    def __init__(self, grid: Grid, signals: dict[str, Signal], places: tuple[float, ...]):
        self.grid, self.signals, self.places, self.stages = grid, signals, places, len(places)

    def extended(self, more: dict[str, Signal]) -> "Tables":
        """Return tables that have further signals."""
        return Tables(self.grid, self.signals | more, self.places)

    @property
    def kinds(self) -> tuple[tuple[str, bool], ...]:
        """Return the names of the signals, each with whether it is held."""
        return tuple((n, s.held) for n, s in self.signals.items())

    def held(self, names: tuple[str, ...]) -> np.ndarray:
        """Return the values of held signals: shape (segments, max(1, names))."""
        at = self.grid.segment_anchor
        table = np.empty((len(at), max(1, len(names))))
        for j, name in enumerate(names):
            signal = self.signals[name]
            table[:, j] = signal(at, at) if signal.level is None else signal.level
        return table

    def staged(self, names: tuple[str, ...]) -> np.ndarray:
        """Return the values of signals at every stage of every step: shape (steps, stages, max(1, names))."""
        g = self.grid
        if not names:
            return np.empty((g.count, self.stages, 1))
        table = np.empty((g.count, self.stages, len(names)))
        for j, name in enumerate(names):
            signal = self.signals[name]
            values: dict[float, np.ndarray] = {}
            for stage, place in enumerate(self.places):
                if place not in values:
                    values[place] = signal(_times(g, place), g.anchor)
                table[:, stage, j] = values[place]
        return table


def sample_table(
    program: Program,
    signals: Mapping[str, Signal],
    intervals: tuple[np.ndarray, np.ndarray, float],
    known: Mapping[str, np.ndarray],
) -> tuple[tuple[str, ...], np.ndarray]:
    """Return the inputs of an observer over each sample interval, as names and a table (intervals, 1, names).

    Inputs are those at the start, in the middle and at the end (left limit), and at the sample instant (right limit).

    Args:
        program: of the observer.
        signals: by name.
        intervals: their begins and ends in s, and the base step in s.
        known: values at the ends by name, which are taken in place of signals: y; in a closed loop the applied u, as
            means over the intervals; the length of the intervals.
    """
    (begin, end, step), tiny = intervals, 1e-4
    middle = 0.5 * (begin + end)
    places = {
        "": (begin, begin + tiny * step),
        "mid.": (middle, middle + tiny * step),
        "end.": (end, end - tiny * step),
        "now.": (end, end + tiny * step),
    }
    names = tuple(sorted(variables(program.graph, program.update) & set(program.inputs)))
    table = np.empty((len(begin), 1, max(1, len(names))))
    for c, name in enumerate(names):
        when, bare = next((w, name[len(w) :]) for w in ("mid.", "end.", "now.", "") if name.startswith(w))
        given = name if name in known else bare if bare.startswith("y.") else None
        table[:, 0, c] = signals[bare](*places[when]) if given is None else known[given]
    return names, table


def _times(grid: Grid, place: float) -> np.ndarray:
    """Return the times in s at one place within every step: 0 at its start, 1 at its end."""
    if place in (0.0, 1.0):
        return grid.end if place else grid.start
    if place == 0.5:
        return 0.5 * (grid.start + grid.end)
    return grid.start + place * (grid.end - grid.start)
