"""Advance an experiment with substeps that follow the local error: state in, state out, as in simulation.py.

A span is simulated with the present substeps, then the error is measured at its points. Where a point needs other
substeps, the span ends there, and the next one continues from that point with them.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from thetascope.engine.compiler.system import CONTINUOUS
from thetascope.engine.model.result import TOLERANCE, Accuracy
from thetascope.engine.simulation import step_control
from thetascope.engine.simulation.error_budget import PLANT_SHARE, Budget, Judged, taken
from thetascope.engine.simulation.experiment import Experiment, Rows, State
from thetascope.engine.simulation.local_error import SHORTEST_EVENT, States, defects, roughness, solvable
from thetascope.engine.simulation.simulation import CHUNK, Simulation
from thetascope.engine.simulation.state_scales import grown
from thetascope.engine.simulation.step_control import Control, Steps

_FIRST_SPAN = 2048  # base steps simulated at first
_SHORT_SPAN = 2048  # substeps simulated after a change of substeps, at least 16 base steps
_SUSPECT = 0.3  # of the error that a base step may add: a larger defect makes it a point
_ROUGH = 12.0  # times that: the roughness, about h⁵·x⁗′, above which the defect is evaluated; the error is about 1/120
_TOLERABLE = 100.0  # times the error that a base step may add: tolerated, where no steps reach it
_OF_PART = 0.25  # of the error that a base step may add: what one part of it may


def simulation_of(
    experiment: Experiment, remember: bool = False, spacing: int | None = None, locates: bool = True
) -> "Simulation | Controlled":
    """Return the simulation of an experiment: with the substeps that it gives, else with those that accuracy needs.

    Args:
        experiment: what to simulate.
        remember: as for `Simulation`.
        spacing: base steps between rows, a divisor of the experiment's ``every``, which it is by default.
        locates: whether base steps are divided around events, where steps follow the accuracy.
    """
    if experiment.substeps is not None or experiment.plant.time != CONTINUOUS:
        return Simulation(experiment, experiment.substeps or 1, remember, spacing=spacing)
    return Controlled(experiment, remember, spacing, locates)


class Controlled:
    """Advances an experiment as `Simulation` does, with substeps chosen by `step_control`.

    ``courses``: the base steps from which other steps are taken, with those steps, as far as it has advanced; they do
    not depend on ``spacing``.
    """

    def __init__(
        self, experiment: Experiment, remember: bool = False, spacing: int | None = None, locates: bool = True
    ):
        """Begin; the arguments are those of `simulation_of`."""
        self.experiment, self.remember, self.spacing = experiment, remember, spacing or experiment.every
        self.locates = locates
        self.courses: list[tuple[int, Steps]] = []
        self._span = _FIRST_SPAN  # of the next span; results do not depend on it
        self._measured = [s for s in experiment.estimators if s.every is None]
        self._budget = Budget(experiment, remember)

    def initial(self) -> State:
        """Return the state at t = 0."""
        return Simulation(self.experiment).initial()

    def advance(self, state: State, count: int) -> tuple[State, Rows]:
        """Advance by ``count`` base steps; return the new state and the rows of [k, k + count)."""
        last, parts = state.k + count, []
        control = state.control or Control(origin=state.k, at=state.k)
        state = replace(state, control=self._complete(control, state))
        while state.k < last:
            state, rows = self._advance(state, min(last - state.k, self._whole(self._span)))
            if rows is not None:
                parts.append(rows)
        if not parts:
            return Simulation(self.experiment, 1, self.remember, spacing=self.spacing).advance(state, 0)
        return state, Rows.joined(parts) if len(parts) > 1 else parts[0]

    def _whole(self, span: int) -> int:
        """Return the base steps of a span: in a closed loop whole rows, over which the applied u is averaged."""
        every = 1 if self.experiment.loop is None else self.experiment.every
        return max(1, span // every) * every

    def state_at(self, start: State, rows: Rows, r: int) -> State | None:
        """Return None: the rows do not hold the control of the step."""
        return None

    def spans(self, count: int, state: State | None = None) -> Iterator[tuple[State, Rows]]:
        """Advance by ``count`` base steps in chunks."""
        state = state or self.initial()
        last = state.k + count
        while count > 0:
            state, rows = self.advance(state, min(count, self._whole(CHUNK)))
            count = last - state.k
            yield state, rows

    # ---- one span ----------------------------------------------------------------------------------------------------

    def _complete(self, control: Control, state: State) -> Control:
        """Return the control with sizes and errors for all states."""
        sizes = {"": self._budget.least} | {s.label: np.zeros(len(s.program.states)) for s in self._measured}
        known = {n: v for n, v in control.sizes.items() if n in sizes and len(v) == len(sizes[n])}
        if len(control.plant) != len(self._budget.least):
            control = replace(control, plant=np.zeros(len(sizes[""])), plant_step=np.zeros(len(sizes[""])))
        if control.largest.shape != self._budget.least.shape:
            control = replace(control, largest=self._budget.least, recent=np.zeros((0, len(self._budget.least))))
        return replace(control, sizes=sizes | known)

    def _advance(self, state: State, count: int) -> tuple[State, Rows | None]:
        """Advance by up to ``count`` base steps, to the first point that needs other substeps."""
        control = state.control
        assert control is not None, "advance completes the control"
        first, last, linear = state.k, state.k + count, self._budget.linear
        closed = self.experiment.loop is not None
        points, ahead = self._points(first, last, control)
        inner = Simulation(
            self.experiment, control.substeps, self.remember, control.implicit, control.inner, self.spacing
        )
        every_step = np.arange(first, last)
        dense = points if (linear or closed) and not control.implicit else every_step
        after, rows = inner.advance(state, count, dense if len(dense) else None)
        if control.implicit:
            points, ahead = every_step, np.ones(count, dtype=np.int64)
        elif not linear and not closed:
            points, ahead = self._seen(control, points, ahead, rows.index, np.vstack([rows.plant, after.plant]))
        if not len(points) or "" in control.lost:
            self._note(first, control)
            ends = np.vstack([rows.plant, after.plant])
            control = self._budget.without_points(control, rows.index, ends).after(rows.plant)
            return replace(after, control=control), replace(self._recorded(rows), accuracy=taken(control))
        at = np.searchsorted(rows.index, points)
        plant = rows.plant if rows.loop is None else np.concatenate([rows.plant, rows.loop.states], axis=1)
        states = {"": plant[at]} | {
            s.label: o[at]
            for s, o in zip(self.experiment.estimators, rows.observers, strict=True)
            if s.every is None and s.label not in control.lost
        }
        along = (points, states[""]) if self._budget.at_points else (rows.index, np.vstack([rows.plant, after.plant]))
        changed, control, reached = self._choose(control, points, ahead, states, along)
        if changed is None:
            self._note(first, control)
            self._span = min(4 * self._span, CHUNK)
            return replace(after, control=control.after(rows.plant)), replace(self._recorded(rows), accuracy=reached)
        work = control.substeps * (len(control.inner) + 1) * (8 if control.implicit else 1)
        self._span = max(16, _SHORT_SPAN // work)
        if points[changed] == first:
            return replace(state, control=control), None
        before = state.control
        assert before is not None
        self._note(first, before)
        control = control.after(rows.plant[: int(at[changed])])
        after, rows = inner.advance(state, int(points[changed]) - first)
        return replace(after, control=control), replace(rows, accuracy=reached)

    def _note(self, k: int, control: Control) -> None:
        if not self.courses or self.courses[-1][1] != control.steps:
            self.courses.append((k, control.steps))

    def _seen(
        self, control: Control, points: np.ndarray, ahead: np.ndarray, index: np.ndarray, states: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Add the base steps whose defect is large for their substeps to points and base steps to the next point.

        ``states``: the plant's states at the base steps ``index`` and at the end (steps + 1, n).
        """
        sizes = np.maximum(grown(control.largest, states), 1e-300)[1:] * control.substeps**4
        limits = _SUSPECT * PLANT_SHARE * TOLERANCE * sizes
        rough = np.flatnonzero(~(roughness(control.recent, states) <= _ROUGH * limits).all(axis=1))
        large = ~(defects(self.experiment, index[rough], states[rough], states[rough + 1]) <= limits[rough])
        every = np.union1d(points, index[rough[large.any(axis=1)]])
        gaps = np.ones(len(every), dtype=np.int64)
        gaps[np.searchsorted(every, points)] = ahead
        return every, gaps

    def _recorded(self, rows: Rows) -> Rows:
        """Return the rows without those that were only points."""
        wanted = rows.index % self.spacing == 0
        return rows if wanted.all() else rows.where(wanted)

    def _points(self, first: int, last: int, control: Control) -> tuple[np.ndarray, np.ndarray]:
        h, before = self.experiment.step, step_control.LOOK_BACK
        signals = [s for s in self.experiment.signals.values() if s.level is None]
        a, b = (first - before - 0.5) * h, (last + 0.5) * h
        breaks = np.sort(np.concatenate([s.breaks(a, b) for s in signals])) / h if signals else np.empty(0)
        return step_control.points(
            first, last, control, breaks, self.experiment.every, rows_only=self.experiment.loop is not None
        )

    # ---- the choice --------------------------------------------------------------------------------------------------

    def _choose(
        self,
        control: Control,
        points: np.ndarray,
        ahead: np.ndarray,
        states: States,
        along: tuple[np.ndarray, np.ndarray],
    ) -> tuple[int | None, Control, Accuracy]:
        """Return the first point that needs other substeps (None: none does), the control from there, and the accuracy.

        The accuracy is that of the points up to there. ``along``: the arguments of `Judged.accumulate`.
        """
        errors = self._budget.errors(control, points, states, control.steps)
        judged = Judged(self._budget, control, points, ahead, states, errors, control.steps)
        need, started = judged.accumulate(*along), control
        several = control.substeps > 1 or control.implicit
        events = judged.fired & self.locates
        for i in range(len(points)) if several else np.flatnonzero((need > 1) | events).tolist():
            k = int(points[i])
            if k < control.waits or (control.inner and k == control.chosen):  # divided as well as it can be
                continue
            here, located = {n: v[i : i + 1] for n, v in states.items()}, events[i] and control.credit_at(k) >= 1
            if located or need[i] > 1:
                control = self._more(judged.control_at(i, control), k, here, bool(located))
            else:
                control, fewer = step_control.calmed(control, k, float(judged.strict[i]))
                if fewer:
                    control = self._fewer(judged.control_at(i, control), k, here)
            if control.steps != started.steps or control.lost != started.lost:
                return i, judged.control_at(i, control), judged.reached(i)
        return None, judged.control_at(len(points), control), judged.reached(len(points))

    def _more(self, control: Control, k: int, states: States, fired: bool) -> Control:
        """Return the control with substeps that suffice at a point, or with the best ones, kept for a while."""
        steps, possible = control.steps, solvable(self.experiment)
        if fired:
            many = control.inner and k - control.chosen < step_control.FAR
            inner = () if many else self._divided(control, k, {"": states[""]})
            control = control.with_steps(k, step_control.PART_SUBSTEPS, possible, inner or ())
            control = replace(control, credit=control.credit_at(k) - 1, credited=k)
            return control if inner else step_control.waiting(control, k)
        tried = {steps: self._strict(control, k, states, steps)}
        need = tried[steps]
        for steps in step_control.candidates(control, need, possible):
            tried[steps] = need = self._strict(control, k, states, steps)
            if need <= 1:
                return control.with_steps(k, *steps)
        # An observer settles from its initial state. Where it is that stiff later, dividing its steps takes too long,
        # and what it takes for an event has the error of its estimate, which no division removes.
        part = {"": states[""]} if self._strict(control, k, {"": states[""]}, control.steps) > 1 else states
        late = part is states and (k > control.origin or bool(self.experiment.plant.after))
        inner = None if late else self._divided(control, k, part)
        if inner is not None:
            return control.with_steps(k, step_control.PART_SUBSTEPS, possible, inner)
        if not np.isfinite(need):
            gone = self._gone(k, states, steps)
            if "" in gone:
                control = control.with_steps(k, 1, False, ())
            return replace(control, lost=control.lost | gone) if gone else step_control.waiting(control, k)
        tolerable = [steps for steps, need in tried.items() if need <= _TOLERABLE]
        steps = tolerable[0] if tolerable else min(tried, key=lambda s: tried[s])
        return step_control.waiting(control.with_steps(k, *steps), k)

    def _gone(self, k: int, states: States, steps: Steps) -> frozenset[str]:
        """Return the labels of the states, finite so far, that a base step makes infinite; all if the plant's are."""
        ends = self._budget.ends(k, {"": states[""]}, steps)
        if not np.isfinite(ends[""]).all():
            return frozenset(states)
        ends = self._budget.ends(k, states, steps)
        return frozenset(label for label, end in ends.items() if label and not np.isfinite(end).all())

    def _divided(self, control: Control, k: int, states: States) -> tuple[float, ...] | None:
        """Return where to divide a base step so that every part is accurate: around events, else by halving.

        None: it takes too many parts, or too many events act in it.
        A part that is as short as possible is taken as it is: it contains a jump or a kink.
        """
        steps: Steps = (step_control.PART_SUBSTEPS, solvable(self.experiment), ())
        ends, waiting, events = [], [(0.0, 1.0)], 0
        while waiting:
            a, b = waiting.pop()
            if len(ends) + len(waiting) >= step_control.MOST_PARTS or events > step_control.MOST_EVENTS:
                return None
            if b - a <= SHORTEST_EVENT:
                events += 1
                ends.append(b)
                states = self._budget.ends(k, states, steps, (a, b))
                continue
            need, errors = self._budget.excess(control, k, states, steps, (a, b))
            if errors.fired[0]:
                low, high = self._budget.event_between(k, states, steps, (a, b))
                if (low, high) != (a, b):
                    waiting += [(c, d) for c, d in ((high, b), (low, high), (a, low)) if d > c]
                    continue
            if need <= _OF_PART or b - a <= step_control.SHORTEST_PART:
                if not np.isfinite(need):
                    return None
                ends.append(b)
                states = errors.ends
            else:
                middle = 0.5 * (a + b)
                waiting += [(middle, b), (a, middle)]
        return tuple(ends[:-1])

    def _fewer(self, control: Control, k: int, states: States) -> Control:
        """Return the control with the cheapest steps that suffice at a point, else with the present ones."""
        for steps in step_control.fewer(control):
            if self._strict(control, k, states, steps) <= 1:
                return control.with_steps(k, *steps)
        return control

    def _strict(self, control: Control, k: int, states: States, steps: Steps) -> float:
        """Return by how much the error of one base step exceeds its share of the tolerance."""
        return self._budget.excess(control, k, states, steps)[0]


class Repeated:
    """Simulates an experiment again and again, with other seeds or signals; the first run chooses the steps."""

    def __init__(self) -> None:
        self.courses: list[tuple[int, Steps]] = []

    def spans(self, experiment: Experiment) -> Iterator[Rows]:
        """Return the rows from t = 0 to the horizon, in chunks; the first run is to be drained or to be lost."""
        count, first = experiment.steps + 1, simulation_of(experiment, locates=False)
        if isinstance(first, Simulation) or not self.courses:
            for _, rows in first.spans(count):
                yield rows
                self.courses = first.courses if isinstance(first, Controlled) else []
            return
        state = first.initial()
        ends = [*(min(k, count) for k, _ in self.courses[1:]), count]
        parts: list[Rows] = []
        for end, (substeps, implicit, inner) in zip(ends, (steps for _, steps in self.courses), strict=True):
            if end > state.k:
                simulation = Simulation(experiment, substeps, implicit=implicit, inner=inner)
                for after, rows in simulation.spans(end - state.k, state):
                    state = after
                    parts.append(rows)
                    if sum(len(p.index) for p in parts) * experiment.every >= CHUNK or state.k >= count:
                        yield Rows.joined(parts)
                        parts = []
