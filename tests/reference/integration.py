"""Signals with one-sided limits, the scenario of a run, and two integrators: DOP853 and a textbook RK4.

Every right-hand side is called as rhs(t, z, inside). `inside` is a time strictly within the current step or segment;
piecewise signals choose their branch by it, so a stage at a step's end sees the left limit and one at its start the
right limit, whatever rounding does to t.
"""

from bisect import bisect_left
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp

Rhs = Callable[[float, np.ndarray, float], np.ndarray]
AFTER = 1e-9  # s; `inside` of a right limit, and the distance below which two discontinuities are one


@dataclass(frozen=True)
class Signal:
    """A scalar time function: value(t, inside), and edges(horizon), the times of its discontinuities.

    varies is False when the value stays the same between edges, so that it needs evaluating once per segment only.
    """

    value: Callable[[float, float], float]
    edges: Callable[[float], Iterable[float]] = lambda horizon: ()
    varies: bool = False


def constant(level: float) -> Signal:
    """The same value for all time."""
    return Signal(lambda t, inside: level)


def steps(times: Sequence[float], values: Sequence[float]) -> Signal:
    """values[0] before times[0], values[i + 1] from times[i] on."""
    edges, levels = [float(t) for t in times], [float(v) for v in values]
    return Signal(lambda t, inside: levels[bisect_left(edges, inside)], lambda horizon: times)


def pulse(low: float, high: float, period: float, width: float, start: float = 0.0) -> Signal:
    """`high` on [start + k period, start + k period + width), k = 0, 1, ..., else `low`."""

    def value(t: float, inside: float) -> float:
        return high if inside >= start and (inside - start) % period < width else low

    def edges(horizon: float) -> list[float]:
        count = int(max(horizon - start, 0.0) / period) + 1
        return [start + k * period + shift for k in range(count) for shift in (0.0, width)]

    return Signal(value, edges)


def smooth(function: Callable[[float], float]) -> Signal:
    """A function of time without discontinuities."""
    return Signal(lambda t, inside: function(t), varies=True)


def sine(amplitude: float, frequency: float, phase: float = 0.0, offset: float = 0.0) -> Signal:
    """offset + amplitude sin(2 pi frequency t + phase), frequency in Hz."""
    return smooth(lambda t: offset + amplitude * np.sin(2 * np.pi * frequency * t + phase))


def held(values: Sequence[float], period: float) -> Signal:
    """values[k] on [k period, (k + 1) period): noise with its own sample time. The last value stays."""
    levels = [float(v) for v in values]

    def value(t: float, inside: float) -> float:
        return levels[min(int(inside / period), len(levels) - 1)]

    return Signal(value, lambda horizon: np.arange(min(len(levels), int(horizon / period) + 1)) * period)


@dataclass(frozen=True)
class Scenario:
    """What happens in a run: inputs u, known signals s, faults theta, noise per output; all lists of `Signal`.

    record: spacing of the recorded rows, s. sample: None for continuous measurement, else the period in s at which
    y is taken (a right limit) and then held.
    """

    horizon: float
    record: float
    inputs: Sequence[Signal] = ()
    signals: Sequence[Signal] = ()
    theta: Sequence[Signal] = ()
    noise: Sequence[Signal] = ()
    sample: float | None = None

    @cached_property
    def grid(self) -> np.ndarray:
        """Recorded times, 0, record, ..., horizon."""
        return np.arange(round(self.horizon / self.record) + 1) * self.record

    @cached_property
    def edges(self) -> np.ndarray:
        """All discontinuities in [0, horizon], with both ends, none closer than AFTER."""
        times = [0.0, self.horizon]
        for signal in (*self.inputs, *self.signals, *self.theta, *self.noise):
            times.extend(signal.edges(self.horizon))
        if self.sample is not None:
            times.extend(np.arange(int(self.horizon / self.sample + 1e-9) + 1) * self.sample)
        return merge(t for t in times if -AFTER < t < self.horizon + AFTER)

    @cached_property
    def _last(self) -> dict:
        return {}

    @cached_property
    def _varies(self) -> bool:
        return any(signal.varies for signal in (*self.inputs, *self.signals, *self.theta))

    def at(self, t: float, inside: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """u, s, theta at t on the branch that holds at `inside`. The last answer is kept: RK stages ask again."""
        key = (t if self._varies else None, inside)
        if key not in self._last:
            self._last.clear()
            self._last[key] = tuple(values(group, t, inside) for group in (self.inputs, self.signals, self.theta))
        return self._last[key]

    def noise_at(self, t: float, inside: float) -> np.ndarray | float:
        """Measurement noise per output; 0 without noise."""
        return values(self.noise, t, inside) if self.noise else 0.0


def values(group: Sequence[Signal], t: float, inside: float) -> np.ndarray:
    """The values of several signals, shape (len(group),)."""
    return np.array([signal.value(t, inside) for signal in group])


def merge(times: Iterable[float]) -> np.ndarray:
    """Sorted times without those closer than AFTER to the one before."""
    ordered = np.sort(np.fromiter(times, float))
    return ordered[np.r_[True, np.diff(ordered) > AFTER]]


def dop853(
    rhs: Rhs,
    z0: np.ndarray,
    scenario: Scenario,
    rtol: float = 1e-11,
    atol: float = 1e-13,
    at_edge: Callable | None = None,
) -> np.ndarray:
    """Integrate over the scenario with DOP853, restarted at every edge; rows on scenario.grid, shape (rows, len(z0)).

    at_edge(t, z, inside) is called at the start of each segment (to sample y). Raises RuntimeError when SciPy gives up.
    """
    grid, edges = scenario.grid, scenario.edges
    rows, z = np.empty((len(grid), len(z0))), np.asarray(z0, float)
    rows[0] = z
    for a, b in pairwise(edges):
        inside = 0.5 * (a + b)
        if at_edge:
            at_edge(a, z, inside)
        wanted = np.flatnonzero((grid > a + AFTER) & (grid <= b + AFTER))
        stops = np.append(grid[wanted][grid[wanted] < b - AFTER], b)
        solution = solve_ivp(
            lambda t, z, inside=inside: rhs(t, z, inside), (a, b), z, "DOP853", t_eval=stops, rtol=rtol, atol=atol
        )
        if not solution.success:
            raise RuntimeError(f"DOP853 stopped at t = {solution.t[-1]:g} s: {solution.message}")
        rows[wanted] = solution.y[:, : len(wanted)].T
        z = solution.y[:, -1]
    return rows


def rk4(rhs: Rhs, z0: np.ndarray, scenario: Scenario, h: float = 1e-3, at_edge: Callable | None = None) -> np.ndarray:
    """The classical Runge-Kutta method at step h; steps end on every edge too. Rows on scenario.grid."""
    edges = scenario.edges
    times = merge(np.concatenate([edges, np.arange(round(scenario.horizon / h) + 1) * h]))
    row_of = {int(i): row for row, i in enumerate(np.searchsorted(times, scenario.grid - AFTER))}
    starts = set(np.searchsorted(times, edges - AFTER).tolist())
    rows, z = np.empty((len(scenario.grid), len(z0))), np.asarray(z0, float)
    rows[0] = z
    for i, (a, b) in enumerate(pairwise(times)):
        step, mid = b - a, 0.5 * (a + b)
        if at_edge and i in starts:
            at_edge(a, z, mid)
        k1 = rhs(a, z, mid)
        k2 = rhs(mid, z + 0.5 * step * k1, mid)
        k3 = rhs(mid, z + 0.5 * step * k2, mid)
        k4 = rhs(b, z + step * k3, mid)
        z = z + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        if i + 1 in row_of:
            rows[row_of[i + 1]] = z
    return rows


def simulate(
    plant: Callable,
    output: Callable,
    x0: np.ndarray,
    scenario: Scenario,
    observer: Callable | None = None,
    o0: Sequence[float] = (),
    solver: Callable = dop853,
    **options,
) -> dict[str, np.ndarray]:
    """Plant and, if given, observer integrated jointly.

    plant(t, x, u, s, theta) -> x'; output(t, x, u, s, theta) -> y, shape (m,); observer(t, o, u, s, y) -> o', which
    sees neither x nor theta. Returns t (rows,), u, signal, theta, x, y (rows, ...) and o (rows, len(o0)).
    """
    n, held_y = len(x0), [np.zeros(0)]

    def measured(t: float, z: np.ndarray, inside: float) -> np.ndarray:
        return output(t, z[:n], *scenario.at(t, inside)) + scenario.noise_at(t, inside)

    def sample(t: float, z: np.ndarray, inside: float) -> None:
        if abs(t - round(t / scenario.sample) * scenario.sample) < AFTER:
            held_y[0] = measured(t, z, inside)

    def rhs(t: float, z: np.ndarray, inside: float) -> np.ndarray:
        u, s, theta = scenario.at(t, inside)
        dx = plant(t, z[:n], u, s, theta)
        if observer is None:
            return dx
        continuous = scenario.sample is None
        y = output(t, z[:n], u, s, theta) + scenario.noise_at(t, inside) if continuous else held_y[0]
        return np.concatenate([dx, observer(t, z[n:], u, s, y)])

    z0 = np.concatenate([np.asarray(x0, float), np.asarray(o0, float)])
    z = solver(rhs, z0, scenario, at_edge=None if scenario.sample is None else sample, **options)
    t = scenario.grid
    u, s, theta = (np.array(part) for part in zip(*(scenario.at(at, at + AFTER) for at in t), strict=True))
    y = np.array([measured(at, row, at + AFTER) for at, row in zip(t, z, strict=True)])
    return {"t": t, "u": u, "signal": s, "theta": theta, "x": z[:, :n], "y": y, "o": z[:, n:]}


def derivative(function: Callable, x: np.ndarray, h: float = 1e-6) -> np.ndarray:
    """Central differences, one column per component of x."""
    return np.array([(function(x + h * e) - function(x - h * e)) / (2 * h) for e in np.eye(len(x))]).T
