"""Many runs of one shape at once, in SIMD lanes: the batch entry point of the engine.

A batch is a list of experiments with the same plant and observer programs, step, horizon and record; seeds,
parameters, gains, initial states, signals may differ. Result i has the bits of running experiment i alone.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from backend.engine.draws import BLOCK, normal
from backend.engine.errors import Cancelled
from backend.engine.graph import variables
from backend.engine.grid import Grid, cut
from backend.engine.initial import observer_states
from backend.engine.kernel import Layout, kernel
from backend.engine.partition import Partition, partition
from backend.engine.signals import Signal
from backend.engine.simulation import Experiment, Simulation, Tables, joined
from backend.engine.system import DISCRETE, Program

FEW_STATES = 8  # up to this many states two vectors a value hide latency; beyond, registers run out
CHUNK = 4096  # base steps: what is handed from the shared part to the lanes stays in the cache


@dataclass(frozen=True)
class Batch:
    """Recorded states: ``plant`` (runs × rows × states) and for each observer ``observers[i]`` (runs × rows × states)."""

    index: np.ndarray  # base steps of the rows
    plant: np.ndarray
    observers: tuple[np.ndarray, ...]


def run_batch(experiments: Sequence[Experiment], cancelled: Callable[[], bool] | None = None) -> Batch:
    """Run all experiments. Raises ValueError where their shapes differ, Cancelled when asked to stop.

    Where something cannot go in lanes (faults of the measurement itself, sampled measurement, observers at a sample
    period), the runs are made one after the other.
    """
    first = experiments[0]
    for e in experiments:
        if _shape(e) != _shape(first):
            raise ValueError("the experiments of a batch must have the same programs, step, horizon and record")
    if not first.estimators or not all(Simulation(e).joined and not Simulation(e).sampled for e in experiments):
        return _one_by_one(experiments, cancelled)
    index = np.arange(0, first.steps + 1, first.every)
    plant, observers = None, []
    for i in range(len(first.estimators)):
        lanes = _Lanes(experiments, i)
        states = lanes.run(cancelled)
        n = len(first.plant.states)
        plant = states[:, :, :n] if plant is None else plant
        observers.append(states[:, :, n:])
    return Batch(index, plant, tuple(observers))


def _shape(e: Experiment) -> tuple:
    return (e.plant.digest, tuple(s.program.digest for s in e.estimators), e.step, e.steps, e.every, tuple(e.signals))


def _one_by_one(experiments: Sequence[Experiment], cancelled: Callable[[], bool] | None) -> Batch:
    plants, observers, index = [], [], None
    for e in experiments:
        if cancelled is not None and cancelled():
            raise Cancelled("the batch was cancelled")
        parts = [rows for _, rows in Simulation(e).spans(e.steps + 1)]
        index = np.concatenate([p.index for p in parts])
        plants.append(np.concatenate([p.plant for p in parts]))
        observers.append([np.concatenate(o) for o in zip(*(p.observers for p in parts), strict=True)])
    return Batch(index, np.stack(plants), tuple(np.stack(o) for o in zip(*observers, strict=True)))


class _Lanes:
    """One observer (joined to the plant) over all experiments."""

    def __init__(self, experiments: Sequence[Experiment], i: int):
        self.experiments = list(experiments)
        self.first = first = experiments[0]
        self.i = i
        estimator = first.estimators[i]
        self.program: Program = joined(first.plant, estimator.program)
        self.signals = [self._signals(e) for e in experiments]
        self.values = [e.parameters | e.estimators[i].parameters for e in experiments]
        plants = np.stack([e.x0 for e in experiments], axis=1)
        self.state = np.concatenate([plants, observer_states(experiments, i)])  # states × runs
        self.differing_signals = [
            n for n in self.signals[0] if any(s[n] is not self.signals[0][n] for s in self.signals)
        ]
        differing = set(self.differing_signals)
        self.differing_parameters = {p for p in self.program.parameters if len({v[p] for v in self.values}) > 1}
        differing |= self.differing_parameters
        differing |= {s for s, row in zip(self.program.states, self.state, strict=True) if (row != row[0]).any()}
        staged = frozenset(n for n in self.signals[0] if not all(s[n].held for s in self.signals))
        self.parts: Partition = partition(self.program, frozenset(differing), staged)
        self.width = 16 if len(self.parts.lanes.states) <= FEW_STATES else 8
        self.staged = staged
        self.stages = 1 if self.program.time == DISCRETE else 4

    def _signals(self, e: Experiment) -> dict[str, Signal]:
        return e.signals | dict(zip([f"noise.{n}" for n in e.plant.outputs], e.measurement.noises, strict=True))

    # ---- running -----------------------------------------------------------------------------------------------------

    def run(self, cancelled: Callable[[], bool] | None) -> np.ndarray:
        """All states of all runs at the rows: runs × rows × states."""
        runs, names = len(self.experiments), list(self.program.states)
        mine = [names.index(s) for s in self.parts.lanes.states]
        common = [names.index(s) for s in self.parts.shared.states] if self.parts.shared else []
        rows = self.first.steps // self.first.every + 1
        result = np.empty((runs, rows, len(names)))
        result[:, 0, :] = self.state.T
        padded = -(-runs // self.width) * self.width
        lane_state = np.ascontiguousarray(self.state[mine][:, np.minimum(np.arange(padded), runs - 1)])
        lane_state = np.ascontiguousarray(
            lane_state.reshape(len(mine), -1, self.width).transpose(1, 0, 2)
        )  # block, state, lane
        shared_state = np.ascontiguousarray(self.state[common, 0])
        noise = _Noise(self)
        for begin in range(0, self.first.steps, CHUNK):
            if cancelled is not None and cancelled():
                raise Cancelled("the batch was cancelled")
            grid = self._grid(begin, min(begin + CHUNK, self.first.steps))
            shared_rows, handed = self._shared(grid, shared_state, begin)
            lane_rows = self._lane_rows(grid, lane_state, handed, noise, begin)
            a = begin // self.first.every + 1
            result[:, a : a + lane_rows.shape[1], mine] = lane_rows[:runs]
            result[:, a : a + len(shared_rows), common] = shared_rows[None]
        return result

    def _grid(self, first: int, last: int) -> Grid:
        a, b = (first - 0.5) * self.first.step, (last + 0.5) * self.first.step
        parts = [s.breaks(a, b) for s in self.signals[0].values()]
        parts += [p.edges[(p.edges > a) & (p.edges < b)] for p in self.pieces.values()]
        parts += [s[n].breaks(a, b) for s in self.signals[1:] for n in self.own if n not in self.pieces]
        return cut(first, last, self.first.step, np.concatenate(parts), self.first.every, 1)

    @cached_property
    def own(self) -> list[str]:
        """Differing signals that may switch at other times from run to run; noise of one sample time does not."""
        times = {e.measurement.sample_time for e in self.experiments}
        plain = len(times) == 1 and not any(e.measurement.faults for e in self.experiments)
        return [n for n in self.differing_signals if not (plain and n.startswith("noise."))]

    @cached_property
    def pieces(self) -> dict[str, "_Pieces"]:
        """Levels of the differing held signals over the whole horizon, where they are few enough to keep."""
        end = (self.first.steps + 1) * self.first.step
        made = {n: _Pieces.of([s[n] for s in self.signals], end) for n in self.own if n not in self.staged}
        return {n: p for n, p in made.items() if p is not None}

    def _rows_in(self, grid_first: int, grid_last: int) -> int:
        return grid_last // self.first.every - grid_first // self.first.every

    def _shared(self, grid: Grid, state: np.ndarray, begin: int) -> tuple[np.ndarray, np.ndarray]:
        shared, handed = self.parts.shared, self.parts.handed
        end = begin + len(grid.base) - 1
        out = np.empty((self._rows_in(begin, end), 0 if shared is None else len(shared.states)))
        table = np.empty((len(grid.start), self.stages, max(1, len(handed))))
        if shared is None:
            return out, table
        held, staged = _divide(shared, [*shared.update, *handed], self.signals[0], self.staged)
        layout = Layout(held=held, staged=staged, emitted=handed)
        params = np.array([self.values[0][p] for p in layout.shared_params(shared)] or [0.0])
        kernel(shared, layout)(grid.segments, state, params, self.first.every, out, emitted=table,
                               held=_held(grid, held, self.signals[0]),
                               staged=_staged(grid, staged, self.signals[0], self.stages))  # fmt: skip
        return out, table

    def _lane_rows(self, grid: Grid, state: np.ndarray, handed: np.ndarray, noise: "_Noise", begin: int) -> np.ndarray:
        lanes, one = self.parts.lanes, self.signals[0]
        held, staged = _divide(lanes, list(lanes.update), one, self.staged)
        lane_held = tuple(n for n in held if n in self.differing_signals)
        lane_staged = tuple(n for n in staged if n in self.differing_signals)
        held, staged = (tuple(n for n in g if n not in self.differing_signals) for g in (held, staged))
        differ = tuple(p for p in lanes.parameters if p in self.differing_parameters)
        layout = Layout(held=held, staged=self.parts.names + staged, lane_held=lane_held, lane_staged=lane_staged,
                        lane_params=differ, lanes=self.width)  # fmt: skip
        if staged:
            handed = np.concatenate(
                [handed[:, :, : len(self.parts.names)], _staged(grid, staged, one, self.stages)], axis=2
            )
            handed = np.ascontiguousarray(handed)
        params = np.array([self.values[0][p] for p in layout.shared_params(lanes)] or [0.0])
        held_table = _held(grid, held, one)
        rows = self._rows_in(begin, begin + len(grid.base) - 1)
        result = np.empty((len(state), rows, len(lanes.states), self.width))
        run = kernel(lanes, layout)
        for b in range(len(state)):
            who = [min(b * self.width + lane, len(self.experiments) - 1) for lane in range(self.width)]
            run(grid.segments, state[b], params, self.first.every, result[b], held=held_table, staged=handed,
                lane_held=noise.table(grid, lane_held, b, who), lane_staged=self._lane_staged(grid, lane_staged, who),
                lane_params=np.array([[self.values[r][p] for r in who] for p in differ]) if differ else None)  # fmt: skip
        return result.transpose(0, 3, 1, 2).reshape(-1, rows, len(lanes.states))

    def _lane_staged(self, grid: Grid, names: tuple[str, ...], who: list[int]) -> np.ndarray | None:
        if not names:
            return None
        tables = [_staged(grid, names, self.signals[r], self.stages) for r in who]
        return np.ascontiguousarray(np.stack(tables, axis=3))


@dataclass(frozen=True)
class _Pieces:
    """A held signal in all runs: ``levels[i]`` (one number a run) between edges i−1 and i."""

    edges: np.ndarray
    levels: np.ndarray

    @classmethod
    def of(cls, signals: list[Signal], end: float, most: int = 20_000_000) -> "_Pieces | None":
        edges = np.unique(np.concatenate([s.breaks(0.0, end) for s in signals]))
        if (len(edges) + 1) * len(signals) > most:
            return None
        bounds = np.concatenate([[0.0], edges, [end]])
        inside = 0.5 * (bounds[:-1] + bounds[1:])
        return cls(edges, np.stack([s(inside, inside) for s in signals], axis=1))

    def at(self, times: np.ndarray, runs: list[int]) -> np.ndarray:
        return self.levels[np.searchsorted(self.edges, times)[:, None], runs]


class _Noise:
    """Held inputs that differ from run to run, as tables segments × names × lanes; drawn for many steps at a time."""

    def __init__(self, lanes: _Lanes):
        self.lanes = lanes
        self.kept: dict[tuple[int, int], tuple[int, np.ndarray]] = {}

    def table(self, grid: Grid, names: tuple[str, ...], block: int, who: list[int]) -> np.ndarray | None:
        if not names:
            return None
        at = grid.segment_anchor
        if len(names) == 1 and names[0] not in self.lanes.own:
            return self._drawn(names[0], at, block, who)
        table = np.empty((len(at), len(names), self.lanes.width))
        for j, name in enumerate(names):
            if name not in self.lanes.own:
                table[:, j, :] = self._drawn(name, at, block, who)
            elif name in self.lanes.pieces:
                table[:, j, :] = self.lanes.pieces[name].at(at, who)
            else:
                for lane, r in enumerate(who):
                    table[:, j, lane] = self.lanes.signals[r][name](at, at)
        return table

    def _drawn(self, name: str, at: np.ndarray, block: int, who: list[int]) -> np.ndarray:
        """Noise of one output for a block of runs: what signals[name] would give, gathered for all lanes at once."""
        first = self.lanes.first
        output = [f"noise.{n}" for n in first.plant.outputs].index(name)
        index = np.floor(at / first.measurement.sample_time[output]).astype(np.int64)
        low, high = int(index.min()), int(index.max())
        kept = self.kept.get((block, output))
        if kept is None or not kept[0] <= low <= high < kept[0] + len(kept[1]):
            start = low // BLOCK * BLOCK  # whole blocks: what is drawn is used
            count = (high // BLOCK + 1) * BLOCK - start
            drawn = np.empty((self.lanes.width, count))
            for lane, r in enumerate(who):
                m = self.lanes.experiments[r].measurement
                drawn[lane] = m.std[output] * normal((m.seed, 3, output), start, count)
            kept = self.kept[block, output] = (start, np.ascontiguousarray(drawn.T))
        if high - low + 1 == len(index) and (np.diff(index) == 1).all():
            return kept[1][low - kept[0] : high - kept[0] + 1]
        return kept[1][index - kept[0]]


def _divide(program: Program, roots: list[int], signals: dict[str, Signal], staged: frozenset[str]):
    used = sorted(variables(program.graph, roots) & set(signals))
    return tuple(n for n in used if n not in staged), tuple(n for n in used if n in staged)


def _held(grid: Grid, names: tuple[str, ...], signals: dict[str, Signal]) -> np.ndarray:
    return Tables(grid, signals, 4).held(names)


def _staged(grid: Grid, names: tuple[str, ...], signals: dict[str, Signal], stages: int) -> np.ndarray:
    return Tables(grid, signals, stages).staged(names)


def with_seed(experiment: Experiment, seed: int) -> Experiment:
    """The same experiment with other noise (its random fault shapes keep theirs)."""
    return replace(experiment, measurement=replace(experiment.measurement, seed=seed))
