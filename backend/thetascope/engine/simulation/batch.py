"""Run many experiments of one shape together in SIMD lanes: the batch entry point of the engine.

A batch is a list of experiments with the same plant and observer programs, step, horizon and recording interval. Seeds,
parameters, gains, initial states and signals may differ. Result i is bit-identical to running experiment i alone.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from thetascope.engine.compiler.graph import variables
from thetascope.engine.compiler.jit import Layout, kernel
from thetascope.engine.compiler.partition import Partition, partition
from thetascope.engine.compiler.system import DISCRETE, Program
from thetascope.engine.errors import Cancelled
from thetascope.engine.inputs.input_tables import RUNGE_KUTTA
from thetascope.engine.inputs.signals import Signal
from thetascope.engine.inputs.time_grid import Grid, cut, sort_out
from thetascope.engine.simulation.experiment import PROCESS_NOISE, Experiment
from thetascope.engine.simulation.initial_states import observer_states
from thetascope.engine.simulation.lanes import Blocks, Column, Levels, Noise, Separate, table
from thetascope.engine.simulation.simulation import Simulation, Tables, joined

FEW_STATES = 8  # up to this many states, two vectors per value hide latency; with more, registers run out
FEWEST, MOST = 1024, 16384  # base steps per kernel call
HANDED = 1 << 22  # bytes of stage values per call of the shared kernel: they stay in cache while lanes read them


@dataclass(frozen=True)
class Batch:
    """Recorded states: ``plant`` (runs × rows × states); ``observers[i]`` for observer i (runs × rows × states)."""

    index: np.ndarray  # base-step index of each row
    plant: np.ndarray
    observers: tuple[np.ndarray, ...]


def run_batch(experiments: Sequence[Experiment], cancelled: Callable[[], bool] | None = None) -> Batch:
    """Run all experiments. Raises ValueError where their shapes differ, and Cancelled when cancelled.

    Experiments that cannot run in lanes (faults of the measurement, sampled measurement, observers at a sample period)
    run one after the other. Runs whose steps are divided at different times form separate groups. Each base step has
    ``substeps`` substeps as the experiment specifies, one by default.
    """
    first = experiments[0]
    groups: dict[tuple, list[int]] = {}
    for i, e in enumerate(experiments):
        if shape(e) != shape(first):
            raise ValueError("the experiments of a batch must have the same programs, step, horizon and record")
        groups.setdefault(_divisions(e, first), []).append(i)
    lanes = all(in_lanes(e) for e in experiments)
    parts = [_group([experiments[i] for i in group], lanes, cancelled) for group in groups.values()]
    if len(parts) == 1:
        return parts[0]
    back = np.argsort(np.concatenate(list(groups.values())))
    observers = zip(*(p.observers for p in parts), strict=True)
    return Batch(
        parts[0].index,
        np.concatenate([p.plant for p in parts])[back],
        tuple(np.concatenate(o)[back] for o in observers),
    )


def _group(experiments: list[Experiment], lanes: bool, cancelled: Callable[[], bool] | None) -> Batch:
    """Run experiments whose steps all end at the same times."""
    if not lanes or len(experiments) == 1:
        return _one_by_one(experiments, cancelled)
    first = experiments[0]
    states = [_Lanes(experiments, i).run(cancelled) for i in range(len(first.estimators))]
    n = len(first.plant.states)
    return Batch(np.arange(0, first.steps + 1, first.every), states[0][:, :, :n], tuple(s[:, :, n:] for s in states))


def shape(e: Experiment) -> tuple:
    """Return what the experiments of a batch must have in common."""
    programs = (e.plant.digest, *(s.program.digest for s in e.estimators))
    return (programs, e.step, e.steps, e.every, e.substeps, tuple(e.signals), tuple(s.every for s in e.estimators))


def _divisions(e: Experiment, first: Experiment) -> tuple:
    """Return all that determines where base steps are divided, leaving out signals that the first experiment shares."""
    end = (e.steps + 1) * e.step
    # process noise changes at the same times in all runs
    signals = [s for n, s in e.signals.items() if s is not first.signals[n] and not n.startswith(PROCESS_NOISE)]
    signals += e.measurement.noises if e.measurement.faults else ()
    breaks = np.concatenate([s.breaks(0.0, end) for s in signals]) if signals else np.empty(0)
    return (e.measurement.sample_time, *sort_out(breaks, e.step)[1])


def in_lanes(e: Experiment) -> bool:
    """Return whether an experiment can run in lanes."""
    simulation = Simulation(e)
    return simulation.joined and not simulation.sampled and not e.plant.after


def _one_by_one(experiments: Sequence[Experiment], cancelled: Callable[[], bool] | None) -> Batch:
    plants, observers, index = [], [], np.empty(0, dtype=np.int64)
    for e in experiments:
        if cancelled is not None and cancelled():
            raise Cancelled("the batch was cancelled")
        parts = [rows for _, rows in Simulation(e, e.substeps or 1).spans(e.steps + 1)]
        index = np.concatenate([p.index for p in parts])
        plants.append(np.concatenate([p.plant for p in parts]))
        observers.append([np.concatenate(o) for o in zip(*(p.observers for p in parts), strict=True)])
    return Batch(index, np.stack(plants), tuple(np.stack(o) for o in zip(*observers, strict=True)))


class _Lanes:
    """One observer (joined to the plant) over all experiments."""

    def __init__(self, experiments: Sequence[Experiment], i: int):
        self.experiments = list(experiments)
        self.first = first = experiments[0]
        estimator = first.estimators[i]
        self.program: Program = joined(first.plant, estimator.program)
        self.places = (0.0,) if self.program.time == DISCRETE else RUNGE_KUTTA
        self.stages = len(self.places)
        self.substeps = first.substeps or 1
        self.signals = [_with_noise(e) for e in experiments]
        self.values = [e.parameters | e.estimators[i].parameters for e in experiments]
        plants = np.stack([e.x0 for e in experiments], axis=1)
        self.state = np.concatenate([plants, observer_states(experiments, i)])  # states × runs
        one = self.signals[0]
        self.differing = [n for n in one if any(s[n] is not one[n] for s in self.signals)]
        self.staged = frozenset(n for n in one if not all(s[n].held for s in self.signals))
        parameters = {p for p in self.program.parameters if len({v[p] for v in self.values}) > 1}
        starts = {s for s, row in zip(self.program.states, self.state, strict=True) if (row != row[0]).any()}
        self.parts: Partition = partition(self.program, frozenset({*self.differing, *parameters, *starts}), self.staged)
        lanes = self.parts.lanes
        self.blocks = Blocks(len(experiments), 16 if len(lanes.states) <= FEW_STATES else 8)
        self.layout = self._layout(parameters)
        self.kernel = kernel(lanes, self.layout)
        self.sources = {n: self._source(n) for n in self.differing if n not in self.staged}

    def _layout(self, parameters: set[str]) -> Layout:
        lanes = self.parts.lanes
        held, staged = _divide(lanes, list(lanes.update), self.signals[0], self.staged)
        mine = set(self.differing)
        return Layout(
            held=tuple(n for n in held if n not in mine),
            staged=self.parts.names + tuple(n for n in staged if n not in mine),
            lane_held=tuple(n for n in held if n in mine),
            lane_staged=tuple(n for n in staged if n in mine),
            lane_params=tuple(p for p in lanes.parameters if p in parameters),
            lanes=self.blocks.width,
        )

    def _source(self, name: str) -> Noise | Levels | Separate:
        """Return the source of a held signal's columns, for a signal that differs between runs."""
        measurements = [e.measurement for e in self.experiments]
        outputs = [f"noise.{n}" for n in self.first.plant.outputs]
        if name in outputs:
            i = outputs.index(name)
            if all(m.std[i] > 0 and not m.faults and not m.correlation for m in measurements):
                stds, seeds = [m.std[i] for m in measurements], [m.seed for m in measurements]
                return Noise(self.blocks, i, stds, seeds, measurements[0].sample_time[i])
        signals = [s[name] for s in self.signals]
        return Levels.of(self.blocks, signals, (self.first.steps + 1) * self.first.step) or Separate(
            self.blocks, signals
        )

    # ---- running -----------------------------------------------------------------------------------------------------

    def run(self, cancelled: Callable[[], bool] | None) -> np.ndarray:
        """Return the states of all runs at the recorded rows (runs × rows × states)."""
        first, runs, names = self.first, len(self.experiments), list(self.program.states)
        mine = _consecutive([names.index(s) for s in self.parts.lanes.states])
        common = _consecutive([names.index(s) for s in self.parts.shared.states] if self.parts.shared else [])
        result = np.empty((runs, first.steps // first.every + 1, len(names)))
        result[:, 0, :] = self.state.T
        lane_state = self._by_block(self.state[mine])
        shared_state = np.ascontiguousarray(self.state[common, 0])
        chunk = min(MOST, max(FEWEST, HANDED // (8 * self.stages * self.substeps * max(1, len(self.parts.handed)))))
        for begin in range(0, first.steps, chunk):
            if cancelled is not None and cancelled():
                raise Cancelled("the batch was cancelled")
            end = min(begin + chunk, first.steps)
            rows = slice(begin // first.every + 1, end // first.every + 1)
            grid = self._grid(begin, end)
            shared_rows, handed = self._shared(grid, shared_state, rows.stop - rows.start)
            lane_rows = self._lane_rows(grid, lane_state, handed, rows.stop - rows.start)
            result[:, rows, mine] = lane_rows[:runs]
            result[:, rows, common] = shared_rows[None]
        return result

    def _by_block(self, values: np.ndarray) -> np.ndarray:
        """Reshape quantities × runs into blocks × quantities × lanes."""
        padded = values[:, self.blocks.padded].reshape(len(values), self.blocks.count, self.blocks.width)
        return np.ascontiguousarray(padded.transpose(1, 0, 2))

    def _grid(self, first: int, last: int) -> Grid:
        a, b = (first - 0.5) * self.first.step, (last + 0.5) * self.first.step
        parts = [s.breaks(a, b) for s in self.signals[0].values()]
        for name in self.differing:
            source = self.sources.get(name)
            if isinstance(source, Levels):
                parts.append(source.edges[(source.edges > a) & (source.edges < b)])
            elif not isinstance(source, Noise):  # noise changes at the same times in all runs
                parts += [s[name].breaks(a, b) for s in self.signals[1:]]
        return cut(first, last, self.first.step, np.concatenate(parts), self.first.every, self.substeps)

    def _shared(self, grid: Grid, state: np.ndarray, rows: int) -> tuple[np.ndarray, np.ndarray]:
        """Advance the part that all runs share; return its rows and the values it passes on at every stage."""
        shared, handed = self.parts.shared, self.parts.handed
        out = np.empty((rows, 0 if shared is None else len(shared.states)))
        emitted = np.empty((grid.count, self.stages, max(1, len(handed))))
        if shared is not None:
            held, staged = _divide(shared, [*shared.update, *handed], self.signals[0], self.staged)
            tables = Tables(grid, self.signals[0], self.places)
            layout = Layout(held=held, staged=staged, emitted=handed)
            kernel(shared, layout)(
                grid.segments,
                state,
                self._parameters(shared, layout),
                self.first.every * self.substeps,
                out,
                emitted=emitted,
                held=tables.held(held),
                staged=tables.staged(staged),
            )
        return out, emitted[:, :, : len(handed)]

    def _parameters(self, program: Program, layout: Layout) -> np.ndarray:
        return np.array([self.values[0][p] for p in layout.shared_params(program)] or [0.0])

    def _lane_rows(self, grid: Grid, state: np.ndarray, handed: np.ndarray, rows: int) -> np.ndarray:
        """Advance the lanes block by block; return their rows (runs × rows × states)."""
        layout, lanes, blocks = self.layout, self.parts.lanes, self.blocks
        tables = Tables(grid, self.signals[0], self.places)
        staged = layout.staged[len(self.parts.names) :]
        if staged or not handed.flags.c_contiguous:
            handed = np.concatenate([handed, tables.staged(staged)[:, :, : len(staged)]], axis=2)
        held, params, every = (
            tables.held(layout.held),
            self._parameters(lanes, layout),
            self.first.every * self.substeps,
        )
        columns: list[Column] = [self.sources[n].over(grid.segment_anchor) for n in layout.lane_held]
        own = self._by_block(
            np.array([[v[p] for v in self.values] for p in layout.lane_params]).reshape(-1, blocks.runs)
        )
        result = np.empty((blocks.count, rows, len(lanes.states), blocks.width))
        for b in range(blocks.count):
            self.kernel(
                grid.segments,
                state[b],
                params,
                every,
                result[b],
                held=held,
                staged=handed,
                lane_held=table(columns, len(grid.segments.steps), b, blocks.width),
                lane_staged=self._lane_staged(grid, layout.lane_staged, b),
                lane_params=own[b],
            )
        return result.transpose(0, 3, 1, 2).reshape(-1, rows, len(lanes.states))

    def _lane_staged(self, grid: Grid, names: tuple[str, ...], block: int) -> np.ndarray | None:
        if not names:
            return None
        runs = self.blocks.padded[self.blocks.slice(block)]
        tables = [Tables(grid, self.signals[r], self.places).staged(names) for r in runs]
        return np.ascontiguousarray(np.stack(tables, axis=3))


def _with_noise(e: Experiment) -> dict[str, Signal]:
    return e.signals | dict(zip([f"noise.{n}" for n in e.plant.outputs], e.measurement.noises, strict=True))


def _divide(program: Program, roots: list[int], signals: dict[str, Signal], staged: frozenset[str]):
    """Divide the signals that a program uses into held and staged ones."""
    used = sorted(variables(program.graph, roots) & set(signals))
    return tuple(n for n in used if n not in staged), tuple(n for n in used if n in staged)


def _consecutive(places: list[int]) -> slice | list[int]:
    """Return consecutive indices as a slice, which is faster to assign to; other indices unchanged."""
    if places and places == list(range(places[0], places[-1] + 1)):
        return slice(places[0], places[-1] + 1)
    return places


def with_seed(experiment: Experiment, seed: int) -> Experiment:
    """Return the same experiment with another seed of noise; random fault shapes keep their own seeds."""
    return experiment.with_seed(seed)
