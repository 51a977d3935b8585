"""The healthy run of a plant: a simulation with the experiment's inputs and without faults, and the scales found in it.

A state or output has its declared scale, where the plant gives one. Otherwise the scale is the range that it covers in
the healthy run or, if that is larger, the change that a typical fault causes within one time constant. Offsets do not
count, so that °C and K give the same scales. The rate is the median, along the run, of the slowest eigenvalue of ∂f/∂x.
All scales are homogeneous: a plant in other units, or at another speed, has the same scales in its own units.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from thetascope.engine.compiler.autodiff import derivatives
from thetascope.engine.compiler.graph import Graph, evaluate
from thetascope.engine.compiler.system import DISCRETE, Program
from thetascope.engine.inputs.sensors import Measurement
from thetascope.engine.inputs.signals import Signal, constant
from thetascope.engine.observers.support.declaration import Context
from thetascope.engine.observers.support.scales import Rows, Scales, Slopes
from thetascope.engine.programs.propagation import exponentials, jacobians
from thetascope.engine.simulation.controlled import Repeated
from thetascope.engine.simulation.experiment import Experiment, leading_rows
from thetascope.engine.simulation.loop import Loop, LoopRows
from thetascope.engine.simulation.simulation import row_values

_ROWS = 2000  # approximate number of recorded rows of the healthy run
_LONGEST = 200_000  # base steps of the healthy run, at most
_FAULT_STEPS = 400_000  # base steps of all runs with a typical fault together, at most
#: Fraction of a typical fault that is simulated; its effect is multiplied, since a large fault may leave the domain.
_SMALL = 1e-3
_INFINITE = 1e150  # the square of a larger number is not finite
_POINTS = 24  # of the run at which eigenvalues are computed
_GROWTH_POINTS = 200  # of the run between which the growth of a small change is computed
_LARGEST = 40  # states and fault channels together up to which a linearisation is kept
_INTEGRATOR = 1e-3  # eigenvalues below this fraction of the largest at a point count as integrators, unless they
_DECAYS = 5.0  # time constants that slow parts of a stiff plant make in the run; below
_NEGLIGIBLE = 1e-9  # of the largest, an eigenvalue may be rounding
_ROUNDING = 1e-9  # changes below this fraction of the size of a quantity count as none
_ESCAPES = 1e8  # a state that grows to this multiple of its early size belongs to an unstable plant
_NOISES = 100.0  # standard deviations of the noise that make the scale of an output that does not move


def healthy_run(
    program: Program,
    data: Mapping,
    parameters: Mapping[str, float],
    x0: np.ndarray,
    signals: Mapping[str, Signal],
    noise: np.ndarray,
    step: float,
    steps: int,
    loop: Loop | None = None,
) -> Scales:
    """Simulate a plant without faults and return its scales.

    Args:
        program, data: the plant's program, and the plant as JSON.
        parameters, x0, signals: of the experiment (`Experiment`); faults among the signals are not used.
        noise: standard deviation (m,) of the noise of each output, 0 where none is declared.
        step, steps: base step in s, and the number of base steps that the run has.
        loop: the controllers, for continuous measurement; None: an open loop.
    """
    return _Healthy(program, data, dict(parameters), x0, dict(signals), step, steps, loop).scales(noise)


class _Healthy:
    def __init__(
        self,
        program: Program,
        data: Mapping,
        parameters: dict[str, float],
        x0: np.ndarray,
        signals: dict[str, Signal],
        step: float,
        steps: int,
        loop: Loop | None,
    ):
        self.data, self.span = data, step * steps
        steps = min(steps, _LONGEST)
        outputs = tuple(program.outputs)
        healthy = {n: constant(0.0) if n.startswith("theta.") else s for n, s in signals.items()}
        quiet = Measurement(outputs, (0.0,) * len(outputs), (step,) * len(outputs), 0)
        size = Context(len(program.states), len(outputs), 0, (0.0,) * len(outputs), step, step, data)
        every = max(1, steps // _ROWS)
        self.experiment = Experiment(program, parameters, x0, healthy, quiet, (), step, steps, every, size, loop=loop)
        self.repeated = Repeated()
        self.index, self.x, self.y, self.loop = self._simulate(self.experiment)
        self.early = leading_rows(self.x, _INFINITE)
        self.first_rate = self._rate(np.arange(min(1, self.early)))
        self.base, self.stable = self._base()

    # ---- simulations -------------------------------------------------------------------------------------------------

    def _simulate(self, experiment: Experiment) -> tuple[np.ndarray, np.ndarray, np.ndarray, LoopRows | None]:
        """Return base steps (rows,), states (rows, n), outputs (rows, m) and controllers, up to the first row that is
        not finite."""
        parts = []
        for rows in self.repeated.spans(experiment):
            parts.append(rows)
            if leading_rows(rows.plant, _INFINITE) < len(rows.plant):
                break
        index, x, y = (np.concatenate([getattr(r, n) for r in parts]) for n in ("index", "plant", "y"))
        rows = leading_rows(x, _INFINITE)
        loops = [r.loop for r in parts if r.loop is not None]
        loop = LoopRows.concatenated(loops).part(0, rows) if loops else None
        return index[:rows], x[:rows], y[:rows], loop

    def _values(self, rows: np.ndarray) -> dict:
        """Return inputs, parameters and states at rows of the run."""
        loop = None
        if self.loop is not None:
            loop = self.loop.where(rows)
        return row_values(self.experiment, self.index[rows], self.x[rows], loop)

    # ---- rates -------------------------------------------------------------------------------------------------------

    def _rate(self, rows: np.ndarray) -> float:
        """Return the median over rows of the slowest rate without integrators, in 1/s; 0 without one."""
        e, n = self.experiment, len(self.experiment.plant.states)
        if not len(rows) or not n:
            return 0.0
        A = self._finite_jacobians(rows)
        if not len(A):
            return 0.0
        with np.errstate(all="ignore"):
            rates = np.abs(np.linalg.eigvals(_balanced(A)))
            if e.plant.time == DISCRETE:
                rates = np.abs(np.log(np.linalg.eigvals(_balanced(A)).astype(complex))) / e.step
        rates = np.where(np.isfinite(rates), rates, 0.0)
        fast = rates.max(axis=1, keepdims=True)
        slow_part = (rates * self.span > _DECAYS) & (rates > _NEGLIGIBLE * fast)
        matters = (rates > 0) & ((rates > _INTEGRATOR * fast) | slow_part)
        slowest = np.where(matters, rates, np.inf).min(axis=1)
        slowest = slowest[np.isfinite(slowest)]
        return float(np.median(slowest)) if len(slowest) else 0.0

    def _fastest(self) -> float:
        """Return `Scales.fastest`."""
        points = self._points(len(self.x))
        if self.experiment.plant.time == DISCRETE or not len(points) or not self.experiment.plant.states:
            return 0.0
        A = self._finite_jacobians(points)
        return float(np.abs(np.linalg.eigvals(_balanced(A))).max()) if len(A) else 0.0

    def _finite_jacobians(self, rows: np.ndarray) -> np.ndarray:
        """Return ∂f/∂x (points, n, n) at those of some rows where it is finite."""
        A = _jacobians(self.experiment.plant, self._values(rows), len(rows))
        return A[np.isfinite(A).all(axis=(1, 2))]

    def _points(self, rows: int) -> np.ndarray:
        """Return the rows at which derivatives are computed."""
        return np.unique(np.linspace(0, rows - 1, _POINTS).astype(int)) if rows else np.zeros(0, dtype=int)

    def _chain(self) -> tuple[float, ...]:
        """Return `Scales.chain`."""
        e, points = self.experiment, self._points(len(self.x))
        A = self._finite_jacobians(points) if len(points) else np.zeros((0, 0, 0))
        if len(e.plant.outputs) != 1 or not len(A):
            return ()
        C = _slopes(e.plant, tuple(e.plant.outputs.values()), self._values(points), len(points))[:, 0, 0]
        first = float(np.median(C[np.isfinite(C)])) if np.isfinite(C).any() else 0.0
        return (first, *(float(a) for a in np.median(np.diagonal(A, 1, axis1=1, axis2=2), axis=0)))

    def _linear(self) -> Slopes | None:
        """Return `Scales.slopes`; None without a row at which all derivatives are finite."""
        e, points = self.experiment, self._points(len(self.x))
        faults = tuple(f"theta.{channel['name']}" for channel in self.data["channels"])
        n, m = len(e.plant.states), len(e.plant.outputs)
        if e.plant.time == DISCRETE or n + len(faults) > _LARGEST or not len(points):
            return None
        roots, by = (*e.plant.update, *e.plant.outputs.values()), (*e.plant.states, *faults)
        slopes = _slopes(e.plant, roots, self._values(points), len(points), by)
        slopes = slopes[np.isfinite(slopes).all(axis=(1, 2))]
        if not len(slopes):
            return None
        middle = np.median(slopes, axis=0)
        parts = middle[:n, :n], middle[n : n + m, :n], middle[:n, n:], middle[n : n + m, n:]
        return Slopes(*(_rows(part) for part in parts))

    def _pace(self, rows: int) -> float:
        """Return the rate of the plant; without eigenvalues that of its motion, without motion ten times 1/span."""
        rate = self._rate(self._points(rows)) if rows else 0.0
        if rate > 0:
            return rate
        x, t = self.x[:rows], self.index[:rows] * self.experiment.step
        spread = np.std(x, axis=0) if rows else np.zeros(0)
        moving = spread > _ROUNDING * np.abs(x).max(axis=0, initial=0.0)
        if rows > 2 and moving.any():
            speeds = np.sqrt(np.mean((np.diff(x[:, moving], axis=0) / np.diff(t)[:, None]) ** 2, axis=0))
            return float(np.median(speeds / spread[moving]))
        return 10.0 / self.span

    # ---- scales ------------------------------------------------------------------------------------------------------

    def _base(self) -> tuple[np.ndarray, bool]:
        """Return the early size (n,) of each state, and whether no state grows far beyond it."""
        row_time = self.experiment.every * self.experiment.step
        early = self.x[: 2 + (int(1 / (self.first_rate * row_time)) if self.first_rate * row_time > 0 else 0)]
        if not len(early):
            early = self.experiment.x0[None]
        first = np.abs(early).max(axis=0)
        width = np.array([_width(s.get("domain")) for s in self.data["states"]])
        base = np.maximum(first, width)
        whole = len(self.x) == self.experiment.steps // self.experiment.every + 1
        grown = (np.abs(self.x) > _ESCAPES * base) & (base > 0)
        if grown.any() or not whole:
            rows = int(np.argmax(grown.any(axis=1))) if grown.any() else len(self.x)
            self.index, self.x, self.y = self.index[:rows], self.x[:rows], self.y[:rows]
            return base, False
        return base, True

    def scales(self, noise: np.ndarray) -> Scales:
        """Return the scales; ``noise``: standard deviations (m,) of the outputs, 0 where none is declared."""
        states, outputs = ([item.get("scale") for item in self.data[part]] for part in ("states", "outputs"))
        rate = self._pace(len(self.x))
        dx, dy = np.zeros(len(states)), np.zeros(len(outputs))
        if None in states or None in outputs:
            dx, dy = self._effects(rate)
            if self.stable:
                dx, dy = np.maximum(dx, np.ptp(self.x, axis=0)), np.maximum(dy, np.ptp(self.y, axis=0))
        x = self._of_states(states, dx)
        y = self._of_outputs(outputs, dy, noise, x)
        largest = np.abs(self.x).max(axis=0, initial=0.0) if self.stable else self.base
        extents = np.maximum(np.maximum(x, largest), self.base)
        of_x, of_y, of_extents = (tuple(map(float, values)) for values in (x, y, extents))
        growth, fastest = self._amplification(extents), self._fastest()
        return Scales(of_x, of_y, of_extents, rate, self.span, growth, self._chain(), self._linear(), fastest)

    def _amplification(self, extents: np.ndarray) -> float:
        """Return the largest growth of a small change between two rows, relative to ``extents``; at least 1."""
        e, n = self.experiment, len(extents)
        if e.plant.time == DISCRETE or not n or len(self.x) < 2:
            return 1.0
        rows = np.unique(np.linspace(0, len(self.x) - 1, _GROWTH_POINTS).astype(int))
        slopes = jacobians(e.plant, self._values(rows), len(rows))
        scaled = slopes * extents[None, None, :] / extents[None, :, None]
        growth = exponentials(scaled[:-1] * (np.diff(self.index[rows]) * e.step)[:, None, None])
        starts, largest = np.zeros((0, n, n)), 1.0
        with np.errstate(all="ignore"):
            for matrix in growth:
                starts = matrix @ np.concatenate([starts, np.eye(n)[None]])
                size = float(np.abs(starts).sum(axis=2).max())
                if not np.isfinite(size):
                    return np.inf
                largest = max(largest, size)
        return largest

    def _effects(self, rate: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the largest change of states (n,) and outputs (m,) that any fault of typical size causes."""
        e, channels = self.experiment, self.data["channels"]
        dx, dy = np.zeros(len(e.plant.states)), np.zeros(len(e.plant.outputs))
        if not channels:
            return dx, dy
        most = max(1, _FAULT_STEPS // len(channels))
        steps = int(min(e.steps, most, max(10.0, np.ceil(1 / (rate * e.step)))))
        for channel in channels:
            name, size = f"theta.{channel['name']}", _SMALL * float(channel.get("typical", 1.0))
            faulty = replace(e, signals={**e.signals, name: constant(size)}, steps=steps)
            _, x, y, _ = self._simulate(faulty)
            rows = min(len(x), len(self.x))
            for change, with_fault, without in ((dx, x, self.x), (dy, y, self.y)):
                apart = np.abs(with_fault[:rows] - without[:rows]) / _SMALL
                np.maximum(change, apart[np.isfinite(apart).all(axis=1)].max(axis=0, initial=0.0), out=change)
        return dx, dy

    def _of_states(self, declared: list[float | None], moved: np.ndarray) -> np.ndarray:
        size = np.maximum(np.abs(self.x).max(axis=0, initial=0.0), np.abs(self.experiment.x0))
        moved = np.where(moved > _ROUNDING * size, moved, 0.0)
        width = np.array([_width(s.get("domain")) / 4 for s in self.data["states"]])
        start = np.abs(self.experiment.x0)
        still = np.where(width > 0, width, np.where(start > 0, start, 1.0))  # neither an input nor a fault moves it
        found = np.where(moved > 0, moved, still)
        return np.array([f if d is None else float(d) for d, f in zip(declared, found, strict=True)], dtype=float)

    def _of_outputs(
        self, declared: list[float | None], moved: np.ndarray, noise: np.ndarray, x: np.ndarray
    ) -> np.ndarray:
        moved = np.where(moved > _ROUNDING * np.abs(self.y).max(axis=0, initial=0.0), moved, 0.0)
        still = np.where(noise > 0, _NOISES * noise, self._through_states(x))
        found = np.where(moved > 0, moved, np.where(still > 0, still, 1.0))
        return np.array([f if d is None else float(d) for d, f in zip(declared, found, strict=True)], dtype=float)

    def _through_states(self, x: np.ndarray) -> np.ndarray:
        """Return the change (m,) of each output when all states change by their scales, at the beginning."""
        e = self.experiment
        values = row_values(e, np.zeros(1, dtype=np.int64), e.x0[None], self.loop and self.loop.part(0, 1))
        C = _slopes(e.plant, tuple(e.plant.outputs.values()), values, 1)[0]
        return np.where(np.isfinite(C), np.abs(C), 0.0) @ x


def _width(domain: tuple[float | None, float | None] | None) -> float:
    """Return the width of a domain; 0 where it has no two ends."""
    low, high = domain or (None, None)
    return 0.0 if low is None or high is None else float(high - low)


def _jacobians(plant: Program, values: dict, count: int) -> np.ndarray:
    """Return ∂(update)/∂(states) at ``count`` rows (count, n, n), exactly."""
    return _slopes(plant, plant.update, values, count)


def _slopes(
    plant: Program, roots: tuple[int, ...], values: dict, count: int, by: tuple[str, ...] | None = None
) -> np.ndarray:
    """Return the derivatives of nodes by the states, or by other variables, at rows (count, roots, variables)."""
    graph, by = Graph(plant.graph.nodes), by or plant.states
    rows = derivatives(graph, list(roots), by)
    nodes = [row[s] for row in rows for s in by if s in row]
    numbers = iter(evaluate(graph, nodes, values))
    slopes = np.zeros((count, len(rows), len(by)))
    for i, row in enumerate(rows):
        for j, s in enumerate(by):
            if s in row:
                slopes[:, i, j] = next(numbers)
    return slopes


def _rows(matrix: np.ndarray) -> Rows:
    return tuple(tuple(float(entry) for entry in row) for row in matrix)


def _balanced(A: np.ndarray) -> np.ndarray:
    """Return similar matrices D⁻¹AD with rows and columns of like size, so that rounding does not depend on units."""
    from scipy.linalg import matrix_balance

    return np.stack([np.asarray(matrix_balance(a, permute=False)[0]) for a in A])
