"""Advance a closed loop: the plant, its measurement and its controllers in one kernel.

Controllers read the measured outputs. Noise and quantisation are computed in the kernel. Stuck readings, lost samples
and delays replace a reading by one that is known before a span begins; a span ends where a reading begins to depend on
another one within it (the onset of a freeze, a delay after its first period).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from thetascope.engine.compiler.system import DISCRETE, Program
from thetascope.engine.inputs.input_tables import RUNGE_KUTTA, Tables
from thetascope.engine.inputs.sampling import Sampling
from thetascope.engine.inputs.sensors import Measurement, Memory
from thetascope.engine.inputs.signals import Signal, constant
from thetascope.engine.inputs.time_grid import Grid
from thetascope.engine.model.loop_names import JUMP, SAMPLE
from thetascope.engine.programs.call_plan import Plan, plan

_LONGEST = 4096  # steps of a span with faults that replace readings
_TRIALS = 2  # repetitions of a step in which a reading depends on itself
_ON_GRID = 1e-6  # of a base step: the distance of a segment's start from an instant
_WEIGHTS = {4: np.array([1.0, 2.0, 2.0, 1.0]) / 6.0, 1: np.ones(1)}  # of the stages, by their number


@dataclass(frozen=True)
class Loop:
    """The controllers of a closed loop.

    Attributes:
        program: the closed loop (`engine.model.closed_loop`); its first states are the plant's.
        start: (c,), initial values of the other states.
        applied: the inputs ``u.*`` that controllers set.
        every: base steps between the instants of each sampled controller, by its input ``due.*``.
        quantisers: faults of quantisation per output that the program provides for.
    """

    program: Program
    start: np.ndarray
    applied: tuple[str, ...]
    every: Mapping[str, int]
    quantisers: int = 1

    @property
    def states(self) -> tuple[str, ...]:
        """Return the names of the controllers' and held states."""
        return self.program.states[-len(self.start) :] if len(self.start) else ()

    @property
    def controller_states(self) -> tuple[str, ...]:
        """Return the names of the controllers' own states."""
        return tuple(s for s in self.states if s.startswith("c."))

    def values(self, rows: "LoopRows", values: Mapping) -> dict:
        """Return the values of the closed loop's program at recorded rows, without faults of the sensors; ``values``:
        those of the plant (`row_values`)."""
        states = {n: rows.states[:, j] for j, n in enumerate(self.states)}
        return {**dict.fromkeys(self.program.inputs, 0.0), **values, **states}

    def instants(self, a: float, b: float, step: float, samplings: Sequence[Sampling | None]) -> np.ndarray:
        """Return all instants of controllers and of sensors that take samples in (a, b), in s."""
        first, last = max(0, int(np.floor(a / step))), int(np.ceil(b / step)) + 1
        each = [Sampling(q) for q in self.every.values()] + [s for s in samplings if s is not None]
        times = np.concatenate([np.empty(0), *(s.taken(first, last) for s in each)]) * step
        return times[(times > a) & (times < b)]


@dataclass(frozen=True)
class LoopRows:
    """The controllers at recorded rows.

    Attributes:
        states: (rows, c), the controllers' and held states before the instant of the row.
        u: (rows, applied inputs), the inputs that controllers set, from the row on.
        ahead: (rows, applied inputs), their means until the next row that is examined; NaN between such rows.
    """

    states: np.ndarray
    u: np.ndarray
    ahead: np.ndarray

    def part(self, first: int, last: int | None = None) -> "LoopRows":
        """Return the rows from ``first`` up to ``last`` (exclusive)."""
        return self.where(slice(first, last))

    def where(self, wanted: np.ndarray | slice) -> "LoopRows":
        """Return the wanted rows: a mask, indices or a slice."""
        return LoopRows(self.states[wanted], self.u[wanted], self.ahead[wanted])

    @classmethod
    def concatenated(cls, parts: "list[LoopRows]") -> "LoopRows":
        """Return consecutive rows as one."""
        return cls(*(np.concatenate([getattr(p, n) for p in parts]) for n in ("states", "u", "ahead")))


@dataclass(frozen=True)
class LoopSpan:
    """A span of a closed loop: all states after it and at its rows, readings y and applied u at all stages."""

    state: np.ndarray
    rows: np.ndarray
    y: np.ndarray  # steps × stages × m
    u: np.ndarray  # steps × stages × applied inputs
    memory: Memory
    left: np.ndarray  # (steps, m): noisy outputs at the end of each step


@dataclass
class LoopRun:
    """Advances one closed loop over the steps of a grid; ``every``: steps between recorded rows in a segment."""

    loop: Loop
    measurement: Measurement
    signals: dict[str, Signal]
    parameters: Mapping[str, float]
    every: int
    _memo: dict = field(default_factory=dict)

    @property
    def stages(self) -> int:
        """Return the number of stages of a step."""
        return len(self.places)

    @property
    def places(self) -> tuple[float, ...]:
        """Return where the stages of a step are, in steps."""
        return (0.0,) if self.loop.program.time == DISCRETE else RUNGE_KUTTA

    @property
    def names(self) -> list[str]:
        """Return the names of the outputs, without prefix."""
        return [n.partition(".")[2] for n in self.measurement.outputs]

    def advance(self, grid: Grid, state: np.ndarray, memory: Memory) -> LoopSpan:
        """Return the span over a grid from a state (plant and loop) and the measurement's memory."""
        if self.measurement.direct or not self.measurement.replaced(grid).any():
            return self._piece(grid, state, memory, None)
        spans: list[LoopSpan] = []
        ahead = _LONGEST  # steps that are tried, about twice those that were known last
        for begin in range(0, grid.count, _LONGEST):
            block, first = grid.part(begin, min(grid.count, begin + _LONGEST), self.every), 0
            while first < block.count:
                steps = block.part(first, min(block.count, first + ahead), self.every)
                known, given = self._known(steps, memory)
                ahead = min(_LONGEST, max(8, 2 * known))
                if known:
                    steps = steps if known == steps.count else steps.part(0, known, self.every)
                    spans.append(self._piece(steps, state, memory, given[:known]))
                else:
                    steps = steps.part(0, 1, self.every)
                    spans.append(self._trials(steps, state, memory))
                state, memory, first = spans[-1].state, spans[-1].memory, first + steps.count
        joined = {n: np.concatenate([getattr(s, n) for s in spans]) for n in ("rows", "y", "u", "left")}
        return LoopSpan(state=state, memory=memory, **joined)

    def peek(self, grid: Grid, state: np.ndarray, memory: Memory) -> LoopSpan:
        """Return the first step of a grid, with the noisy outputs as y."""
        first = grid.part(0, 1, self.every)
        known, given = self._known(first, memory)
        return self._piece(first, state, memory, given if known else None, measured=False)

    # ---- faults that replace readings --------------------------------------------------------------------------------

    def _known(self, grid: Grid, memory: Memory) -> tuple[int, np.ndarray]:
        """Return the number of first steps whose replaced readings do not depend on these very steps, and the readings
        (steps, stages, m); NaN where the output is read."""
        m = len(self.measurement.outputs)
        unknown = np.full((grid.count, self.stages, m), np.nan)
        readings, _ = self.measurement.after_faults(grid, unknown, memory)
        open_ = self.measurement.replaced(grid) & ~np.isfinite(readings).all(axis=1)
        waiting = open_.any(axis=1)
        return int(np.argmax(waiting)) if waiting.any() else grid.count, readings

    def _trials(self, grid: Grid, state: np.ndarray, memory: Memory) -> LoopSpan:
        """Return one step in which a reading depends on the output in that step: it is repeated with the result."""
        on = self.measurement.replaced(grid)[:, None, :]
        readings = np.full((1, self.stages, len(self.measurement.outputs)), np.nan)
        for _ in range(_TRIALS):
            noisy = self._piece(grid, state, memory, readings, measured=False).y
            readings, _ = self.measurement.after_faults(grid, noisy, memory)
            readings = np.where(on, readings, np.nan)
        return self._piece(grid, state, memory, readings)

    # ---- one call of the kernel --------------------------------------------------------------------------------------

    def _piece(
        self, grid: Grid, state: np.ndarray, memory: Memory, given: np.ndarray | None, measured: bool = True
    ) -> LoopSpan:
        """Return a span in which replaced readings are ``given`` (NaN: read the output). With ``measured`` False, y are
        the noisy outputs without faults."""
        program, m = self.loop.program, len(self.names)
        signals = self._signals()
        replacing = () if given is None else tuple(f"{k}.{n}" for k in ("take", "given") for n in self.names)
        for name in replacing:
            signals.pop(name)
        tables = Tables(grid, signals, self.places)
        call = self._plan(tables, replacing)
        staged = tables.staged(call.staged) if call.staged or not replacing else None
        if given is not None:
            take = np.isfinite(given)
            parts = [p for p in (staged, take.astype(float), np.where(take, given, 0.0)) if p is not None]
            staged = np.ascontiguousarray(np.concatenate(parts, axis=2))
        held = self._held(grid, tables, call.held)
        params = np.array([self.parameters[p] for p in call.params] or [0.0])
        rows = np.empty((grid.recorded(self.every), len(program.states)))
        emitted, new = np.empty((grid.count, self.stages, len(call.kernel.layout.emitted))), state.copy()
        call.kernel(grid.segments, new, params, self.every, rows, held=held, staged=staged, emitted=emitted)
        noisy = emitted[:, :, :m]
        left = noisy[:, -1].copy()
        if measured:
            _, memory = self.measurement.after_faults(grid, noisy.copy(), memory)
        return LoopSpan(
            new, rows, emitted[:, :, m : 2 * m] if measured else noisy, emitted[:, :, 2 * m :], memory, left
        )

    def each(
        self, grid: Grid, states: np.ndarray, noises: Mapping[str, Signal]
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Advance each row of states (segments, n + c) through one segment, without replaced readings.

        Return the states, and the readings and applied inputs at all stages. ``noises``: in place of the measurement's.
        """
        m, tables = len(self.names), Tables(grid, self._signals() | dict(noises), self.places)
        call = self._plan(tables, ())
        params = np.array([self.parameters[p] for p in call.params] or [0.0])
        emitted, new = np.empty((grid.count, self.stages, len(call.kernel.layout.emitted))), np.array(states, order="C")
        held, staged = self._held(grid, tables, call.held), tables.staged(call.staged)
        call.kernel.advance_each(grid.segments, new, params, held, staged, emitted)
        return new, emitted[:, :, m : 2 * m], emitted[:, :, 2 * m :]

    def _plan(self, tables: Tables, replacing: tuple[str, ...]) -> Plan:
        """Return the plan of the closed loop's kernel, which emits noisy outputs, readings and applied inputs."""
        program = self.loop.program
        outputs = [f"{k}.{n}" for k in ("noisy", "y") for n in self.names]
        roots = tuple(program.outputs[n] for n in (*outputs, *self.loop.applied))
        sampled = bool(self.loop.every) or any(self.measurement.sampled_by)
        jump = tuple(program.outputs[f"{JUMP}{s}"] for s in program.states) if sampled else ()
        return plan(program, roots, tables.kinds, replacing, jump)

    def _signals(self) -> dict[str, Signal]:
        """Return all inputs of the closed loop as functions of time; those of instants and replaced readings are 0."""
        if not self._memo:
            zero = constant(0.0)
            self._memo |= self.signals | dict.fromkeys(self.loop.every, zero)
            self._memo |= {f"{SAMPLE}{name}": zero for name in self.names}
            for i, name in enumerate(self.names):
                self._memo |= {f"noise.{name}": self.measurement.noises[i], f"take.{name}": zero, f"given.{name}": zero}
            for name, steps in zip(self.names, self.measurement.resolutions(self.loop.quantisers), strict=True):
                self._memo |= {f"resolution.{name}.{q}": step for q, step in enumerate(steps)}
        return dict(self._memo)

    def _held(self, grid: Grid, tables: Tables, names: tuple[str, ...]) -> np.ndarray:
        """Return the held inputs of every segment, with 1 where an instant is due at its start."""
        held = tables.held(names)
        s = grid.segments
        start = (s.t + s.index * s.h) / grid.h
        nearest = np.rint(start)
        on_grid = np.abs(start - nearest) < _ON_GRID
        samplings = zip((f"{SAMPLE}{n}" for n in self.names), self.measurement.sampled_by, strict=True)
        taken = {n: s.taken(grid.first, grid.last) for n, s in samplings if s is not None and n in names}
        for j, name in enumerate(names):
            if name in self.loop.every:
                held[:, j] = on_grid & (nearest % self.loop.every[name] == 0)
            elif name in taken:
                held[:, j] = on_grid & np.isin(nearest, taken[name])
        return held


@dataclass(frozen=True)
class ClosedSpan:
    """A span of a closed loop, with the plant and the controllers apart.

    Attributes:
        span: readings and applied u at all stages.
        plant, plant_rows: the plant's state after the span, and at its rows.
        loop, rows: the same of the controllers.
        means: (base steps, applied inputs), means of the applied u.
        past: the same, preceded by those before the span that are remembered.
        first: base step with which the span begins.
    """

    span: LoopSpan
    plant: np.ndarray
    plant_rows: np.ndarray
    loop: np.ndarray
    rows: LoopRows
    means: np.ndarray
    past: np.ndarray
    first: int

    @classmethod
    def of(
        cls, span: LoopSpan, n: int, rows: np.ndarray, grid: Grid, at: tuple[np.ndarray, int], past: np.ndarray
    ) -> "ClosedSpan":
        """Return a span over a grid; ``rows``: all states at the base steps ``at[0]``; n: states of the plant.

        Means of u are taken from every ``at[1]``-th base step to the next of these; other rows have none (NaN).
        """
        index, every = at
        means, places, examined = _base_means(grid, span.u), index - grid.first, index % every == 0
        ahead = np.full((len(places), means.shape[1]), np.nan)
        if examined.any():
            begins = places[examined]
            lengths = np.diff(np.append(begins, len(means)))[:, None]
            ahead[examined] = np.add.reduceat(means, begins, axis=0) / lengths
        loop_rows = LoopRows(rows[:, n:], span.u[grid.base[places], 0], ahead)
        remembered = np.concatenate([past, means])
        return cls(span, span.state[:n], rows[:, :n], span.state[n:], loop_rows, means, remembered, grid.first)

    def known_at(self, grid: Grid, instants: np.ndarray, q: int, applied: tuple[str, ...]) -> dict[str, np.ndarray]:
        """Return the applied inputs as observers of period q know them at instants (base steps): ``now.*`` from the
        instant on; otherwise the mean over the q base steps before it."""
        ends = len(self.past) - len(self.means) + instants - self.first
        # an observer that was added within an interval knows u from there on
        mean = self.past[np.maximum(ends[:, None] + np.arange(-q, 0), 0)].sum(axis=1) / q
        present = self.span.u[grid.base[instants - self.first], 0]
        known = {f"now.{n}": present[:, c] for c, n in enumerate(applied)}
        return known | {f"{w}{n}": mean[:, c] for c, n in enumerate(applied) for w in ("", "mid.", "end.")}


def _base_means(grid: Grid, u: np.ndarray) -> np.ndarray:
    """Return the mean of u (steps × stages × inputs) over every base step: shape (base steps, inputs)."""
    weights = _WEIGHTS[u.shape[1]]
    integral = np.einsum("ksi,s->ki", u, weights) * (grid.end - grid.start)[:, None]
    if not len(integral):
        return integral
    return np.add.reduceat(integral, grid.base[:-1], axis=0) / grid.h
