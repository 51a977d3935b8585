"""Tables of signal values for kernels: one per segment for held signals, one per stage of each step for others."""

import numpy as np

from thetascope.engine.inputs.signals import Signal
from thetascope.engine.inputs.time_grid import Grid


class Tables:
    """Tables of signals over one time grid; ``stages`` is the number of stages per step (4, or 1 in discrete time)."""

    def __init__(self, grid: Grid, signals: dict[str, Signal], stages: int):
        self.grid, self.signals, self.stages = grid, signals, stages

    def extended(self, more: dict[str, Signal]) -> "Tables":
        """Return tables that have further signals."""
        return Tables(self.grid, self.signals | more, self.stages)

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
            table[:, 0, j] = signal(g.start, g.anchor)
            if self.stages == 4:
                table[:, 1, j] = table[:, 2, j] = signal(0.5 * (g.start + g.end), g.anchor)
                table[:, 3, j] = signal(g.end, g.anchor)
        return table
