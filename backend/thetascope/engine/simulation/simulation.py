"""Advance plant, measurement and observers together: state in, state out.

The plant's kernel emits y at the four stages of each Runge–Kutta step, the measurement turns it into sensor values, and
the observers' kernels read those. Where the measurement only adds noise, plant and first observer are joined into one
kernel, which gives the same numbers faster. An observer with a sample period gets the samples at its own instants.

Advancing over base steps [k, k+n) returns the recorded rows in that half-open span: all values at t_k, including the
measured y, are known when the step from t_k begins.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache
from time import thread_time

import numpy as np

from thetascope.engine.compiler.instructions import implicit_method
from thetascope.engine.compiler.jit import Layout, Segments, kernel
from thetascope.engine.compiler.system import DISCRETE, Program, join
from thetascope.engine.inputs.input_tables import RUNGE_KUTTA, Tables, sample_table
from thetascope.engine.inputs.signals import Signal
from thetascope.engine.inputs.time_grid import Grid, cut
from thetascope.engine.programs.call_plan import Plan, plan
from thetascope.engine.programs.evaluate_rows import probe
from thetascope.engine.programs.kernel_cost import PLANT, divided
from thetascope.engine.programs.recorded_programs import PERIOD
from thetascope.engine.simulation.experiment import PRESENCE, Estimator, Experiment, Rows, State
from thetascope.engine.simulation.initial_states import observer_states
from thetascope.engine.simulation.loop import ClosedSpan, Loop, LoopRows, LoopRun

CHUNK = 1 << 15  # base steps per chunk, which keeps the tables of stages small


@lru_cache(maxsize=128)
def joined(plant: Program, observer: Program) -> Program:
    """Return plant and observer as one program; ``noise.y`` is added to each output y before the observer reads it."""
    return join(plant, observer, {name: (name, f"noise.{name}") for name in plant.outputs})


def measured_nodes(experiment: Experiment, program: Program) -> tuple[int, ...]:
    """Return the nodes of a joined program that hold the outputs with their noise."""
    outputs, index = experiment.plant.outputs, program.graph.index
    return tuple(index[("add", program.outputs[n], index[("var", f"noise.{n}")])] for n in outputs)


class Simulation:
    """Advances an experiment with steps of one length. ``substeps`` divides every base step.

    ``remember``: keep the last measurement even where nothing needs it yet, because a fault that needs it (freeze,
    dropout) may be added later. ``implicit``: take the implicit steps of implicit_method.py, in continuous time.
    ``inner``: where every base step is divided into parts, between 0 and 1; each part has ``substeps``.
    ``spacing``: base steps between rows, a divisor of the experiment's ``every``, which it is by default.
    """

    def __init__(
        self,
        experiment: Experiment,
        substeps: int = 1,
        remember: bool = False,
        implicit: bool = False,
        inner: tuple[float, ...] = (),
        spacing: int | None = None,
    ):
        self.inner, self.spacing = inner, spacing or experiment.every
        self.experiment, self.substeps, self.remember, self.implicit = experiment, substeps, remember, implicit
        plant = experiment.plant
        self.places = (0.0,) if plant.time == DISCRETE else implicit_method.C if implicit else RUNGE_KUTTA
        self.stages = len(self.places)
        self.lockstep = [i for i, e in enumerate(experiment.estimators) if e.every is None]
        self.sampled = [i for i, e in enumerate(experiment.estimators) if e.every is not None]
        # only an observer that runs in the plant's time can be joined to the plant; implicit steps solve for each alone
        direct = experiment.measurement.direct and experiment.loop is None
        self.joined = bool(self.lockstep) and direct and not implicit
        self.kept = max((experiment.estimators[i].every or 0 for i in self.sampled), default=0)  # means of u
        self.spent: dict[str, float] = {}  # processor seconds of the kernels in one span

    # ---- states ------------------------------------------------------------------------------------------------------

    def initial(self) -> State:
        """Return the state at t = 0; observers may start from the first measurement."""
        e = self.experiment
        state = State(0, e.x0.astype(float).copy(), (), e.measurement.start(), *self._first_loop())
        seen = None if e.loop is None else self.known_at(state)
        observers = tuple(observer_states([e], i, known=seen)[:, 0].copy() for i in range(len(e.estimators)))
        return replace(state, observers=observers)

    def _first_loop(self) -> tuple[np.ndarray | None, np.ndarray | None]:
        loop = self.experiment.loop
        return (None, None) if loop is None else (loop.start.copy(), np.empty((0, len(loop.applied))))

    def known_at(self, state: State) -> dict[str, float]:
        """Return the applied u and the noisy outputs of a closed loop at the instant of a state."""
        e = self.experiment
        assert e.loop is not None and state.loop is not None, "only a closed loop computes its inputs"
        grid = cut(state.k, state.k + 1, e.step, self.breaks(state.k, state.k + 1), self.spacing, self.substeps)
        span = self._loop_run(e.loop).peek(grid, np.concatenate([state.plant, state.loop]), state.memory)
        return dict(zip((*e.plant.outputs, *e.applied), (*span.y[0, 0], *span.u[0, 0]), strict=True))

    # ---- advancing ---------------------------------------------------------------------------------------------------

    def advance(self, state: State, count: int, points: np.ndarray | None = None) -> tuple[State, Rows]:
        """Advance by ``count`` base steps; return the new state and the rows of [k, k + count).

        ``points``: further base steps to return as rows, ascending; y is measured at recorded rows only.
        """
        e, first, last, every, stops = self.experiment, state.k, state.k + count, self.spacing, None
        index = np.arange(-(-first // every) * every, last, every)
        if points is not None and len(points) == count:
            every, index = 1, points
        elif points is not None and (points % every).any():
            stops = np.union1d(points, np.arange(-(-first // every) * every, last + 1, every))
            index = stops[stops < last]
        grid = cut(first, last, e.step, self.breaks(first, last), every, self.substeps, stops)
        tables = Tables(grid, e.signals, self.places)
        observers, self.spent = list(state.observers), {}
        recorded: dict[int, np.ndarray] = {}  # by the observer's index
        closed = None
        if e.loop is not None:
            closed = self._closed(e.loop, state, grid, index)
            plant, plant_rows, y, memory = closed.plant, closed.plant_rows, closed.span.y, closed.span.memory
        elif self.joined:
            plant, plant_rows, y, memory = self._joint(state, tables, index, observers, recorded)
        else:
            plant, plant_rows, clean = self._plant(state, tables, index)
            y, memory = e.measurement.measure(grid, first, clean, state.memory)
        for i in self.lockstep:
            if i not in recorded:
                assert y is not None, "a second observer takes y from the first's kernel"
                observers[i], recorded[i] = self._observer(i, state, tables, index, y, closed)
        for i in self.sampled:
            assert y is not None, "the joined kernel emits y for further observers"
            observers[i], recorded[i] = self._sampling(i, state, grid, index, y, closed)
        y_rows = self.measured_rows(grid, first, index, plant_rows, y)
        loop, past = (None, None) if closed is None else (closed.loop, closed.past[len(closed.past) - self.kept :])
        after = State(last, plant, tuple(observers), memory, loop, past)
        earlier = np.maximum(grid.base[index - first] - 1, 0)
        known = self.remember and e.measurement.direct
        passed = None
        if known:
            assert y is not None, "a program that remembers y emits it"
            left = y[:, -1] if closed is None else closed.span.left
            passed = np.where((index > first)[:, None], left[earlier], state.memory.passed)
        spent = {s.label: (self.spent.get(s.label, 0.0), count * e.step) for s in e.estimators}
        recorded_states = tuple(recorded[i] for i in range(len(e.estimators)))
        loop_rows = None if closed is None else closed.rows
        return after, Rows(index, plant_rows, y_rows, recorded_states, spent, passed, loop_rows)

    def state_at(self, start: State, rows: Rows, r: int) -> State | None:
        """Return the state at recorded row r of the span that began at ``start``; None if the rows lack it."""
        if rows.passed is None or self.sampled:
            return None
        memory = replace(start.memory, passed=rows.passed[r].copy())
        loop = None if rows.loop is None else rows.loop.states[r].copy()
        observers = tuple(o[r].copy() for o in rows.observers)
        return State(int(rows.index[r]), rows.plant[r].copy(), observers, memory, loop, start.past)

    def spans(self, count: int, state: State | None = None) -> Iterator[tuple[State, Rows]]:
        """Advance by ``count`` base steps in chunks."""
        state, most = state or self.initial(), CHUNK
        if self.experiment.loop is not None:  # whole rows, over which the applied u is averaged
            most = max(1, CHUNK // self.experiment.every) * self.experiment.every
        while count > 0:
            state, rows = self.advance(state, min(count, most))
            count -= min(count, most)
            yield state, rows

    def _loop_run(self, loop: Loop) -> LoopRun:
        e = self.experiment
        return LoopRun(loop, e.measurement, e.signals, e.parameters, self.spacing * self.substeps)

    def _closed(self, loop: Loop, state: State, grid: Grid, index: np.ndarray) -> ClosedSpan:
        """Advance plant and controllers."""
        assert state.loop is not None and state.past is not None, "the state of a closed loop holds its controllers"
        begin, clock = np.concatenate([state.plant, state.loop]), thread_time()
        span = self._loop_run(loop).advance(grid, begin, state.memory)
        self.spent |= divided(thread_time() - clock, {PLANT: loop.program})
        rows = self._rows(begin, span.rows, state.k, index)
        return ClosedSpan.of(span, len(state.plant), rows, grid, (index, self.experiment.every), state.past)

    def breaks(self, first: int, last: int) -> np.ndarray:
        """Return the times at which steps in [first, last) are divided."""
        a, b = (first - 0.5) * self.experiment.step, (last + 0.5) * self.experiment.step
        parts = [s.breaks(a, b) for s in self.experiment.signals.values() if s.level is None]
        parts.append(self.experiment.measurement.breaks(a, b, self.experiment.signals.values()))
        if self.experiment.loop is not None:
            samplings = self.experiment.measurement.sampled_by
            parts.append(self.experiment.loop.instants(a, b, self.experiment.step, samplings))
        if self.inner:
            parts.append(((np.arange(first, last)[:, None] + np.array(self.inner)) * self.experiment.step).ravel())
        return np.concatenate(parts)

    def _rows(self, start: np.ndarray, out: np.ndarray, first: int, index: np.ndarray) -> np.ndarray:
        """Return the states at the rows of the span: kernels record at ends of steps.

        The first row may be the start.
        """
        rows = np.vstack([start[None, :], out]) if len(index) and index[0] == first else out
        return rows[: len(index)]

    def _call(
        self,
        plan: Plan,
        parts: dict[str, Program],
        tables: Tables,
        values: dict,
        start: np.ndarray,
        staged: np.ndarray | None = None,
        emitted: np.ndarray | None = None,
    ):
        """Call a kernel and divide its processor time among ``parts``, the programs that it contains."""
        state, grid = start.copy(), tables.grid
        params = np.array([values[p] for p in plan.params] or [0.0])
        out = np.empty((grid.records + 1, len(plan.program.states)))
        staged = tables.staged(plan.staged) if staged is None else staged
        held = tables.held(plan.held)
        clock = thread_time()
        plan.kernel(grid.segments, state, params, grid.spacing, out, held=held, staged=staged, emitted=emitted)
        self.spent |= divided(thread_time() - clock, parts)
        return state, out

    def _plant(self, state: State, tables: "Tables", index: np.ndarray):
        plant = self.experiment.plant
        roots = tuple(plant.outputs.values())
        emitted = np.empty((tables.grid.count, self.stages, max(1, len(roots))))
        new, out = self._call(
            plan(plant, roots, tables.kinds, implicit=self.implicit),
            {PLANT: plant},
            tables,
            self.experiment.parameters,
            state.plant,
            emitted=emitted,
        )
        return new, self._rows(state.plant, out, state.k, index), emitted[:, :, : len(roots)]

    def _joint(self, state: State, tables: "Tables", index: np.ndarray, observers: list, recorded: dict):
        """Advance plant and first lockstep observer in one kernel; y is emitted only if another observer needs it."""
        e, i = self.experiment, self.lockstep[0]
        estimator = e.estimators[i]
        program = joined(e.plant, estimator.program)
        emits = len(e.estimators) > 1 or self.remember
        roots = measured_nodes(e, program) if emits else ()
        noise = dict(zip([f"noise.{n}" for n in e.plant.outputs], e.measurement.noises, strict=True))
        tables = tables.extended(noise)
        emitted = np.empty((tables.grid.count, self.stages, max(1, len(roots))))
        new, out = self._call(
            plan(program, roots, tables.kinds),
            {PLANT: e.plant, estimator.label: estimator.program},
            tables,
            e.parameters | estimator.parameters,
            np.concatenate([state.plant, state.observers[i]]),
            emitted=emitted,
        )
        memory = replace(state.memory, passed=emitted[-1, -1].copy()) if emits else state.memory
        n = len(e.plant.states)
        observers[i] = new[n:]
        recorded[i] = self._rows(state.observers[i], out[:, n:], state.k, index)
        return new[:n], self._rows(state.plant, out[:, :n], state.k, index), emitted if emits else None, memory

    def _observer(
        self, i: int, state: State, tables: "Tables", index: np.ndarray, y: np.ndarray, closed: ClosedSpan | None
    ):
        estimator = self.experiment.estimators[i]
        program = estimator.program
        seen = y if closed is None else np.concatenate([y, closed.span.u], axis=2)
        names = [*self.experiment.plant.outputs, *self.experiment.applied]
        given = tuple(n for n in names if n in program.used_inputs)
        call = plan(program, (), tables.kinds, given, implicit=self.implicit)
        picked = [names.index(n) for n in given]
        parts = [p for p in (tables.staged(call.staged) if call.staged else None, seen[:, :, picked]) if p is not None]
        together = np.ascontiguousarray(np.concatenate(parts, axis=2))
        new, out = self._call(
            call, {estimator.label: program}, tables, estimator.parameters, state.observers[i], staged=together
        )
        return new, self._rows(state.observers[i], out, state.k, index)

    def _sampling(self, i: int, state: State, grid: Grid, index: np.ndarray, y: np.ndarray, closed: ClosedSpan | None):
        """Advance an observer with a sample period: one step for each sample instant t_j = j·period in [t_k, t_k+n)."""
        e, estimator = self.experiment, self.experiment.estimators[i]
        if estimator.instants is not None:
            return self._at_instants(i, state, grid, index, estimator.instants)
        program, q, first = estimator.program, estimator.every, state.k
        assert q is not None, "the observer works at a sample period"
        last = grid.last
        j = np.arange(max(estimator.since // q + 1, -(-first // q)), -(-last // q))
        start = state.observers[i]
        if not len(j):
            return start, np.repeat(start[None, :], len(index), axis=0)
        at = grid.base[j * q - first]
        known = {} if closed is None else closed.known_at(grid, j * q, q, e.applied)
        known |= dict(zip(e.plant.outputs, y[at, 0].T, strict=True))
        staged, table = sample_table(program, e.signals, ((j * q - q) * e.step, j * q * e.step, e.step), known)
        segments = ((j - 1.0) * q, e.step)
        after = self._at_samples(estimator, start, staged, table, np.zeros(len(j)), segments)
        return after[-1].copy(), after[np.searchsorted(j * q, index, side="right")]

    def _at_instants(self, i: int, state: State, grid: Grid, index: np.ndarray, instants: np.ndarray):
        """Advance an observer that works at given times over the intervals that end in [t_k, t_k+n)."""
        e, estimator = self.experiment, self.experiment.estimators[i]
        on, start = instants / e.step + 1e-6, state.observers[i]
        low = max(int(np.searchsorted(on, max(state.k, estimator.since + 1e-3))), 1)
        j = np.arange(low, max(low, int(np.searchsorted(on, grid.last))))
        if not len(j):
            return start, np.repeat(start[None, :], len(index), axis=0)
        begin, end = instants[j - 1], instants[j]
        after_it = end + 1e-4 * e.step
        noises = zip(e.plant.outputs, e.measurement.noises, strict=True)
        known = {name: signal(end, after_it) for name, signal in noises} | {PERIOD: end - begin}
        staged, table = sample_table(estimator.program, e.signals, (begin, end, e.step), known)
        after = self._at_samples(estimator, start, staged, table, begin, (np.zeros(len(j)), e.step))
        return after[-1].copy(), after[np.searchsorted(on[j], index + 2e-6, side="right")]

    def _at_samples(
        self,
        estimator: Estimator,
        start: np.ndarray,
        staged: tuple[str, ...],
        table: np.ndarray,
        t: np.ndarray,
        index_and_step: tuple[np.ndarray, float],
    ) -> np.ndarray:
        """Return the states at the beginning and after each sample (samples + 1, states).

        ``t``, ``index_and_step``: the intervals begin at t + index·step.
        """
        program, (index, step), ones = estimator.program, index_and_step, np.ones(len(t), dtype=np.int64)
        segments = Segments(ones, ones, t, index, np.full(len(t), step))
        params = np.array([estimator.parameters[p] for p in program.parameters] or [0.0])
        new, out = start.copy(), np.empty((len(t), len(start)))
        run = kernel(program, Layout(staged=staged))
        clock = thread_time()
        run(segments, new, params, 1, out, staged=table)
        self.spent[estimator.label] = thread_time() - clock
        return np.vstack([start[None, :], out])

    def measured_rows(self, grid: Grid, first: int, index: np.ndarray, plant_rows: np.ndarray, y: np.ndarray | None):
        """Return the measured outputs at rows, from ``y`` at all steps if that is known."""
        e = self.experiment
        recorded = index % self.spacing == 0
        if not recorded.all():
            measured = np.full((len(index), len(e.plant.outputs)), np.nan)
            measured[recorded] = self.measured_rows(grid, first, index[recorded], plant_rows[recorded], y)
            return measured
        at = grid.base[index - first]
        if y is not None:
            return y[at, 0, :]
        values = row_values(e, index, plant_rows)
        clean = probe(e.plant, list(e.plant.outputs), values)
        return clean.T + e.measurement.noise_at(grid.anchor[at])


def row_values(
    e: Experiment, index: np.ndarray, plant_rows: np.ndarray, loop: LoopRows | None = None
) -> dict[str, np.ndarray | float]:
    """Return time, signals (right limits), parameters and plant states at recorded rows.

    In a closed loop, also the applied inputs, their means until the next row (``ahead.*``), and controllers' states.
    """
    t = index * e.step
    values: dict[str, np.ndarray | float] = {n: at_rows(s, t, e.step) for n, s in e.signals.items()}
    values |= row_numbers(e) | {"t": t}
    if e.loop is not None:
        assert loop is not None, "rows of a closed loop hold the applied inputs"
        values |= loop_values(e.loop, loop)
    return values | {s: plant_rows[:, j] for j, s in enumerate(e.plant.states)}


def loop_values(loop: Loop, rows: LoopRows) -> dict[str, np.ndarray]:
    """Return the applied inputs, their means until the next row and the controllers' states at recorded rows."""
    values = {n: rows.u[:, j] for j, n in enumerate(loop.applied)}
    values |= {f"ahead.{n}": rows.ahead[:, j] for j, n in enumerate(loop.applied)}
    return values | {n: rows.states[:, j] for j, n in enumerate(loop.states) if n.startswith("c.")}


def at_rows(signal: Signal, t: np.ndarray, step: float) -> np.ndarray:
    """Return a signal at recorded rows, as right limits."""
    return signal(t, t + 1e-4 * step)


def row_numbers(e: Experiment) -> dict[str, float]:
    """Return the values that hold at every row: the plant's parameters and the intensity of the noise."""
    m = e.measurement
    noise = zip(m.outputs, m.std, m.sample_time, strict=True)
    return e.parameters | {f"intensity.{n}": std * std * hold for n, std, hold in noise}


def observed_values(e: Experiment, parameters: dict, values: dict, y: np.ndarray) -> dict:
    """Return the values that an observer may use along the rows: its parameters, t, u.*, signal.*, y.*; no x or θ."""
    observed = {n: v for n, v in values.items() if n == "t" or n.startswith(("u.", "signal.", *PRESENCE))}
    known = list(observed)
    observed |= {n: v for n, v in values.items() if n.startswith("intensity.")}
    observed |= {name: y[:, i] for i, name in enumerate(e.plant.outputs)}
    observed |= {
        f"{when}{n}": observed[n] for when in ("mid.", "end.", "now.") for n in (*known, *e.plant.outputs) if n != "t"
    }
    return observed | dict(parameters)
