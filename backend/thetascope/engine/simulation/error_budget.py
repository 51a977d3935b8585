"""Errors at points of a run, judged against scales and the tolerance: which points need other substeps.

The rules, for the tolerance TOLERANCE of a state's scale:

- The plant's errors are propagated along the run by its Jacobian, and may reach half of the tolerance, divided by the
  factor by which the plant may amplify them later: 1 for a plant that is linear in its states, else that of the healthy
  run, from 5 to 10⁴. Where they would exceed it, a base step may add no more than PLANT_SHARE of the tolerance.
- An observer follows noisy measurements and forgets its errors: those of the last MEMORY base steps together may reach
  OBSERVER_TOLERANCE. They are measured from a state that is moved by NUDGE of its scales, so that a step at which the
  observer's equations are unstable is noticed before the instability has grown.
"""

from dataclasses import replace

import numpy as np

from thetascope.engine.model.result import OBSERVER_TOLERANCE, TOLERANCE, Accuracy
from thetascope.engine.programs.propagation import accumulate, exponentials, is_linear, jacobians
from thetascope.engine.simulation import step_control
from thetascope.engine.simulation.experiment import Experiment
from thetascope.engine.simulation.local_error import LocalErrors, States, Steppers
from thetascope.engine.simulation.loop import LoopRows
from thetascope.engine.simulation.simulation import row_values
from thetascope.engine.simulation.state_scales import DIVERGED, ObserverScales, grown, plant_scales
from thetascope.engine.simulation.step_control import Control, Steps

PLANT_SHARE = 3e-5
MEMORY = 100.0  # base steps
NUDGE = 1e-6  # of the scales
_LEAST_LEFT = 0.1  # of the tolerance of observers: left for the next steps, whatever has been used
_MOST_PROPAGATED = 12  # plant states up to which errors are propagated
_LEAST_AMPLIFIED = 5.0
_EXCEEDED = 2.0  # times the tolerance of observers: where other steps are chosen
_MOST_AMPLIFIED = 1e4
_JUMP = 30.0  # ratio of errors at neighbouring points above which the error changed suddenly
_STABLE = 2.5  # about the eigenvalue times the step up to which explicit steps are stable
_SLOPES_EVERY = 8  # explicit steps: where the Jacobian of a plant that is not linear is computed
_CHANGING = 1.0  # change of an element of h·∂f/∂x over a base step above which finite differences replace it


class Budget:
    """Measures errors of an experiment's base steps."""

    def __init__(self, experiment: Experiment, remember: bool = False):
        self.experiment, loop = experiment, experiment.loop
        program = experiment.plant if loop is None else loop.program
        self.propagated = len(program.states) <= _MOST_PROPAGATED
        self.linear = is_linear(program) and not program.after
        self.at_points = self.linear or loop is not None  # where the Jacobian is computed
        # controllers are judged by their effect on the plant
        controllers = np.full(0 if loop is None else len(loop.start), np.inf)
        self.least = np.concatenate([plant_scales(experiment), controllers])
        healthy = experiment.context.healthy
        known = 1.0 if healthy is None else healthy.scales.amplification
        self.amplified = 1.0 if self.linear else min(max(_LEAST_AMPLIFIED, known), _MOST_AMPLIFIED)
        self.observers = {s.label: ObserverScales(s) for s in experiment.estimators if s.every is None}
        self._steppers = Steppers(experiment, remember)

    def scales(self, control: Control, states: States, ends: States) -> tuple[States, States]:
        """Return the largest sizes so far at each point, and the scales there, by label."""
        with np.errstate(invalid="ignore"):
            sizes = {n: grown(control.sizes[n], np.fmax(np.abs(v), np.abs(ends[n]))) for n, v in states.items()}
        plant = np.maximum(sizes[""], 1e-300)
        return sizes, {n: self.observers[n](s, plant) if n else plant for n, s in sizes.items()}

    def errors(
        self, control: Control, points: np.ndarray, states: States, steps: Steps, part: tuple[float, float] = (0.0, 1.0)
    ) -> LocalErrors:
        """Return the errors of base steps from states whose observers are moved by NUDGE."""
        _, scales = self.scales(control, states, states)
        moved = {n: v + NUDGE * scales[n] * _signs(v.shape[1]) if n else v for n, v in states.items()}
        return self._steppers.local_errors(points, moved, steps, part)

    def ends(self, k: int, states: States, steps: Steps, part: tuple[float, float] = (0.0, 1.0)) -> States:
        """Return the states after base step k, or after a part of it."""
        return self._steppers.ends(np.array([k]), states, steps, part)

    def excess(
        self, control: Control, k: int, states: States, steps: Steps, part: tuple[float, float] = (0.0, 1.0)
    ) -> tuple[float, LocalErrors]:
        """Return the error of base step k relative to the share that it may add, and the errors."""
        at = np.array([k])
        errors = self.errors(control, at, states, steps, part)
        gap = np.array([step_control.interval(self.experiment.every)])
        whole = steps if part == (0.0, 1.0) else None
        return float(Judged(self, control, at, gap, states, errors, whole).strict[0]), errors

    def event_between(self, k: int, states: States, steps: Steps, part: tuple[float, float]) -> tuple[float, float]:
        """Return a short interval of a part of base step k in which an event of the plant acts."""
        return self._steppers.event_between(k, states[""], steps[1], part)

    def slopes(self, index: np.ndarray, plant: np.ndarray) -> np.ndarray:
        """Return h·∂f/∂x at base steps, with the plant's states there: shape (base steps, n, n)."""
        e = self.experiment
        with np.errstate(all="ignore"):
            if e.loop is None:
                return e.step * jacobians(e.plant, row_values(e, index, plant), len(index))
            n, none = len(e.plant.states), np.zeros((len(index), len(e.applied)))
            rows = LoopRows(plant[:, n:], none, none)
            values = e.loop.values(rows, row_values(e, index, plant[:, :n], rows))
            return e.step * jacobians(e.loop.program, values, len(index))

    def without_points(self, control: Control, index: np.ndarray, plant: np.ndarray) -> Control:
        """Return the control after a span without points; ``plant``: the states at its base steps and its end."""
        if self.at_points or not self.propagated:
            return control
        factors, index = self.factors(control, index, plant)
        return replace(control, growth=_products(factors, np.array([0, len(index)]), control.growth)[0])

    def factors(self, control: Control, index: np.ndarray, plant: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return how deviations grow over some of the base steps of a span, or from each to the next, and which.

        ``plant``: the states at the base steps ``index`` and at the end (steps + 1, n).
        """
        if control.implicit or control.substeps >= _SLOPES_EVERY:
            slopes = self.slopes(np.append(index, index[-1:] + 1), plant)
            factors = exponentials(0.5 * (slopes[:-1] + slopes[1:]))
            changing = np.flatnonzero(np.abs(np.diff(slopes, axis=0)).max(axis=(1, 2), initial=0.0) > _CHANGING)
            factors[changing] = self._differences(control, index[changing], plant[changing], plant[changing + 1])
            return factors, index
        every = max(1, _SLOPES_EVERY // control.substeps)
        wanted = index[index % every == 0]
        return exponentials(every * self.slopes(wanted, plant[wanted - index[0]])), wanted

    def _differences(self, control: Control, points: np.ndarray, begin: np.ndarray, end: np.ndarray) -> np.ndarray:
        """Return how deviations grow over base steps, by finite differences (points, n, n)."""
        n = begin.shape[1]
        if not len(points):
            return np.empty((0, n, n))
        moves = NUDGE * np.maximum(np.abs(begin), np.maximum(1e-4 * control.largest, 1e-300))
        moved = (begin[:, None, :] + moves[:, None, :] * np.eye(n)).reshape(-1, n)
        ends = self._steppers.ends(np.repeat(points, n), {"": moved}, control.steps, (0.0, 1.0))[""]
        with np.errstate(all="ignore"):
            return np.swapaxes((ends.reshape(-1, n, n) - end[:, None, :]) / moves[:, :, None], 1, 2)


class Judged:
    """Errors at the points of a span, relative to scales.

    Attributes:
        sizes: largest sizes so far (points, states), by label.
        strict: errors of the next base step, relative to the share that any step may add (points,).
        fired: whether an event acts in the next base step, which is not divided there (points,).
    """

    def __init__(
        self,
        budget: Budget,
        control: Control,
        points: np.ndarray,
        ahead: np.ndarray,
        states: States,
        errors: LocalErrors,
        steps: Steps | None,
    ):
        """Judge errors of base steps taken with ``steps``, or of a part of them (None).

        ``ahead``: base steps from each point to the next (points,).
        """
        self.points, self._ahead, self._budget, self._before = points, ahead, budget, control
        self.sizes, scales = budget.scales(control, states, errors.ends)
        self.scale = scales[""]
        parts = []
        with np.errstate(all="ignore"):
            lost = ~(np.abs(states[""]) < DIVERGED * self.scale).all(axis=1)
            plant = _largest(np.abs(errors.plant) / self.scale, states[""], DIVERGED * self.scale)
            for label, known in budget.observers.items():
                if label in states:
                    relative = known.errors(errors.observers[label], scales[label])
                    parts.append(_largest(relative, states[label], known.limits(self.scale[-1])))
        observers = np.max(parts, axis=0) if parts else np.zeros(len(points))
        keep = (1 - 1 / MEMORY) ** ahead
        left = np.maximum(OBSERVER_TOLERANCE - control.observers * keep, _LEAST_LEFT * OBSERVER_TOLERANCE)
        with np.errstate(over="ignore"):
            self.shares = observers * MEMORY * (1 - keep) / left, plant / (PLANT_SHARE * TOLERANCE)
        if budget.at_points and steps is not None:
            self._slopes = budget.slopes(points, states[""])
            # a plant at rest shows no error of unstable steps, until something moves it between points
            self.shares = (
                self.shares[0],
                np.maximum(self.shares[1], np.where(lost, 0.0, instability(self._slopes, steps))),
            )
        known = np.array([k == control.chosen and bool(control.inner) for k in points], dtype=bool)
        self.fired = errors.fired & (steps is not None) & ~known
        self.strict = np.maximum(*self.shares)
        self.plant_step = np.where(np.isfinite(errors.plant), errors.plant, 0.0)
        self.observers_step = np.where(np.isfinite(observers), observers, 0.0)

    def accumulate(self, index: np.ndarray, plant: np.ndarray) -> np.ndarray:
        """Set the errors at every point; return `strict`, but 0 where errors may stay as they are (points,).

        ``index``: the points, or all base steps of the span where the plant is not linear; ``plant``: the states there,
        and then also those at its end.
        """
        control, budget = self._before, self._budget
        gaps = np.diff(self.points, prepend=control.at).astype(float)
        self._allowed = PLANT_SHARE * TOLERANCE * self.scale, OBSERVER_TOLERANCE / MEMORY
        steps = _between(np.vstack([control.plant_step[None], self.plant_step]), gaps[:, None], self._allowed[0])
        recent = _between(np.concatenate([[control.observers_step], self.observers_step]), gaps, self._allowed[1])
        growth = self._growth(index, plant, gaps)
        keep = (1 - 1 / MEMORY) ** gaps
        self.plant, self.observers = accumulate((control.plant, control.observers), growth, steps, keep, recent)
        gap, keep = self._ahead, (1 - 1 / MEMORY) ** self._ahead
        after = self.observers * keep + self.observers_step * MEMORY * (1 - keep)
        enough = (after <= _EXCEEDED * OBSERVER_TOLERANCE) & np.isfinite(self.shares[0])
        need = np.where(enough, 0.0, np.maximum(self.shares[0], 1.0 + 1e-9))
        loose = self.shares[1]
        if budget.propagated:
            after = np.abs(self.plant + self.plant_step * gap[:, None]) / self.scale
            small = (after.max(axis=1, initial=0.0) * budget.amplified <= 0.5 * TOLERANCE) & np.isfinite(loose)
            loose = np.where(small, 0.0, loose)
        need = np.maximum(need, loose)
        return np.where(np.isnan(need), np.inf, need)

    def _growth(self, index: np.ndarray, plant: np.ndarray, gaps: np.ndarray) -> np.ndarray:
        """Return how deviations of the plant's states grow up to each point (points, n, n)."""
        budget, n = self._budget, plant.shape[1]
        self._grown = np.eye(n)
        if not budget.propagated:
            return np.broadcast_to(self._grown, (len(gaps), n, n))
        if budget.at_points:
            return np.nan_to_num(exponentials(self._slopes * gaps[:, None, None]))
        factors, index = budget.factors(self._before, index, plant)
        bounds = np.concatenate([[0], np.searchsorted(index, self.points), [len(index)]])
        products = np.nan_to_num(_products(factors, bounds, self._before.growth))
        self._grown = products[-1]
        return products[:-1]

    def control_at(self, i: int, control: Control) -> Control:
        """Return the control with errors at point i and the sizes before it; after the last point, those there.

        Where the steps are changed at the point, the errors of those that are taken instead are within the tolerance.
        """
        last = min(i, len(self.points) - 1)
        plant_step, observers_step = self.plant_step[last], float(self.observers_step[last])
        if control.steps != self._before.steps:
            plant_step = np.clip(plant_step, -self._allowed[0][last], self._allowed[0][last])
            observers_step = min(observers_step, self._allowed[1])
        sizes = dict(self._before.sizes) | ({n: s[i - 1] for n, s in self.sizes.items()} if i else {})
        return replace(
            control,
            at=int(self.points[last]),
            plant=self.plant[last],
            observers=float(self.observers[last]),
            plant_step=plant_step,
            observers_step=observers_step,
            sizes=sizes,
            growth=self._grown if i > last else np.eye(len(plant_step)),
        )

    def reached(self, i: int) -> Accuracy:
        """Return the accuracy at the points before point i."""
        steps = taken(self._before)
        if i == 0:
            return steps
        plant = (np.abs(self.plant[:i]) / self.scale[:i]).max(initial=0.0)
        observers = self.observers[:i].max(initial=0.0)
        return replace(steps, plant=min(1.0, float(plant)), observers=min(1.0, float(observers)))


def taken(control: Control) -> Accuracy:
    """Return the accuracy of a span without points: only its steps are known."""
    if control.implicit:
        return Accuracy(substeps=1, implicit=control.substeps)
    return Accuracy(substeps=control.substeps)


def _between(errors: np.ndarray, gaps: np.ndarray, allowed: np.ndarray | float) -> np.ndarray:
    """Return the error that the base steps between neighbouring points add together, as if it changed exponentially.

    A far larger error at the second point than at the first one began there, with a discontinuity or an event.

    Args:
        errors: of the base steps at the points (points + 1, …).
        gaps: base steps between them (points, …).
        allowed: error that any base step may add (points, …).
    """
    first, last = errors[:-1], np.abs(errors[1:])
    last = np.minimum(last, np.maximum(_JUMP * np.abs(first), allowed))
    with np.errstate(all="ignore"):
        ratio = last / np.abs(first)
        mean = np.where(np.abs(ratio - 1) < 1e-3, 1.0, (ratio - 1) / np.log(ratio))
        mean = np.where(np.isfinite(mean), mean, 0.0)
    return first * np.where(gaps > 0, 1 + np.maximum(gaps - 1, 0) * mean, 0.0)


def _products(factors: np.ndarray, bounds: np.ndarray, before: np.ndarray) -> np.ndarray:
    """Return the products of matrices (steps, n, n) between neighbouring bounds, the later ones on the left.

    The first one begins with ``before``. They are multiplied one after another, so that a product does not depend on
    where spans begin and end.
    """
    starts, counts = bounds[:-1], np.diff(bounds)
    products = np.repeat(np.eye(factors.shape[1])[None], len(starts), axis=0)
    if before.size:
        products[0] = before
    with np.errstate(all="ignore"):
        for offset in range(int(counts.max(initial=0))):
            longer = np.flatnonzero(counts > offset)
            products[longer] = factors[starts[longer] + offset] @ products[longer]
    return products


def instability(slopes: np.ndarray, steps: Steps) -> np.ndarray:
    """Return by how much unstable steps exceed what is stable, as an error of order 4; 0 for stable ones (points,).

    ``slopes``: h·∂f/∂x of base steps (points, n, n).
    """
    substeps, implicit, inner = steps
    if implicit or inner or not slopes.shape[1]:
        return np.zeros(len(slopes))
    changed = np.concatenate([[True], (slopes[1:] != slopes[:-1]).any(axis=(1, 2))])
    z = np.linalg.eigvals(slopes[changed]) / substeps
    with np.errstate(over="ignore", invalid="ignore"):
        grown_by = np.abs(1 + z * (1 + z / 2 * (1 + z / 3 * (1 + z / 4))))
        unstable = ~(grown_by <= 1.001 * np.maximum(1.0, np.abs(np.exp(z))))
        need = np.where(unstable, np.maximum(2.0, (np.abs(z) / _STABLE) ** 4), 0.0).max(axis=1)
    return need[np.cumsum(changed) - 1]


def _largest(relative: np.ndarray, states: np.ndarray, limits: np.ndarray) -> np.ndarray:
    """Return the largest relative error at each point.

    It is infinite where a step from finite states is not finite, and 0 where the states are lost.
    """
    relative = np.where(np.isfinite(relative), relative, np.inf)
    lost = ~(np.abs(states) < limits).all(axis=1)
    return np.where(lost, 0.0, relative.max(axis=1, initial=0.0))


def _signs(count: int) -> np.ndarray:
    """Return signs that do not repeat in short patterns (count,)."""
    return np.where((np.arange(count) * 2654435761 >> 7) & 1, 1.0, -1.0)
