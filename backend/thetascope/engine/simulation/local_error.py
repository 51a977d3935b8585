"""The local error of a step: one base step from a state, taken with n substeps and with 2n.

The points at which it is measured are independent; the kernels are those of the run, called once for each point, so
nothing more is compiled. Observers read y with its noise but without other faults of the measurement, which change the
size of the error little.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from thetascope.engine.compiler.codegen_implicit import MOST_STATES
from thetascope.engine.compiler.instructions import implicit_method
from thetascope.engine.compiler.jit import NEVER, Segments
from thetascope.engine.inputs.input_tables import RUNGE_KUTTA, Tables
from thetascope.engine.inputs.signals import Signal
from thetascope.engine.inputs.time_grid import Grid
from thetascope.engine.programs.call_plan import Plan, plan
from thetascope.engine.programs.defect import PLACES, defect_program
from thetascope.engine.programs.evaluate_rows import probe
from thetascope.engine.simulation.experiment import Estimator, Experiment
from thetascope.engine.simulation.loop import LoopRun
from thetascope.engine.simulation.simulation import Simulation, joined, measured_nodes
from thetascope.engine.simulation.step_control import Steps

_COMPRESSION = 32.0  # of the time at which noise is drawn, which its values do not depend on
SHORTEST_EVENT = 2.0**-24  # of a base step: the interval to which the time of an event is narrowed
_TRIED = 256  # times at which an event is looked for
_BEFORE_END = 1e-4  # of a step
_ORDER = {False: 4, True: 5}  # by whether steps are implicit

States = dict[str, np.ndarray]
"""States at points (points, states) by observer's label; "" is the plant, with its controllers after it."""


@dataclass(frozen=True)
class LocalErrors:
    """Errors that one base step adds: ``plant`` (points, n), signed; ``observers`` by label (points, states).

    ``ends``: the states after the base step, by label; the plant's is "". ``fired``: whether an event acted (points,);
    the plant's error is then that without events.
    """

    plant: np.ndarray
    observers: States
    ends: States
    fired: np.ndarray


class Steppers:
    """Takes single base steps of an experiment from given states, with any steps."""

    def __init__(self, experiment: Experiment, remember: bool = False):
        self.experiment = e = experiment
        recorded = e.measurement.readings is not None
        noises = (s if recorded else replace(s, value=_compressed(s)) for s in e.measurement.noises)
        self.signals = e.signals | {f"noise.{n}": s for n, s in zip(e.plant.outputs, noises, strict=True)}
        self.remember = remember
        self._quiet: Steppers | None = None  # the same plant without events
        if e.plant.after and e.loop is None:
            self._quiet = Steppers(replace(e, plant=replace(e.plant, after=()), estimators=()))
        self._loop = None if e.loop is None else LoopRun(e.loop, e.measurement, e.signals, e.parameters, 1)

    def local_errors(
        self, points: np.ndarray, states: States, steps: Steps, part: tuple[float, float] = (0.0, 1.0)
    ) -> LocalErrors:
        """Return the errors of base steps that begin at ``points`` (their numbers).

        ``states``: the states there. Labels that it lacks are not measured. ``part``: of the base step, if not all of
        it; the states are those at its beginning.
        """
        substeps, implicit, inner = steps
        ends = (part[0], *inner, part[1])
        coarse, fine = (self._advance(points, states, n, implicit, ends) for n in (substeps, 2 * substeps))
        scale = 2.0 ** _ORDER[implicit] / (2.0 ** _ORDER[implicit] - 1)
        with np.errstate(all="ignore"):
            errors = {label: scale * (coarse[label] - fine[label]) for label in coarse}
        plant, fired = errors.pop(""), np.zeros(len(points), dtype=bool)
        if self._quiet is not None:  # two numbers of substeps say nothing of an event: both may take one across it
            alone = {"": states[""]}
            one, two = (self._quiet._advance(points, alone, n, implicit, ends)[""] for n in (substeps, 2 * substeps))
            fired = _differ(coarse[""], one)
            with np.errstate(all="ignore"):
                plant[fired] = scale * (one - two)[fired]
        return LocalErrors(plant, errors, coarse, fired)

    def ends(self, points: np.ndarray, states: States, steps: Steps, part: tuple[float, float]) -> States:
        """Return the states after base steps that begin at ``points``, or after a part of them."""
        substeps, implicit, inner = steps
        return self._advance(points, states, substeps, implicit, (part[0], *inner, part[1]))

    def event_between(
        self, k: int, plant: np.ndarray, implicit: bool, part: tuple[float, float]
    ) -> tuple[float, float]:
        """Return a short interval of a part of base step k in which the first event acts, if one acts in the part.

        Its length is SHORTEST_EVENT of the base step, or less. ``plant``: the states at the beginning of the part.
        """
        assert self._quiet is not None, "a plant without events has none to find"
        low, high = part
        while high - low > SHORTEST_EVENT:
            tried = np.linspace(low, high, _TRIED + 1)[1:]
            states = np.repeat(plant, len(tried), axis=0)
            after, quiet = (s._stretched(k, states, implicit, part[0], tried) for s in (self, self._quiet))
            fired = _differ(after, quiet)
            first = int(np.argmax(fired)) if fired.any() else len(tried) - 1
            low, high = (float(tried[first - 1]) if first else low), float(tried[first])
        return low, high

    def _stretched(self, k: int, plant: np.ndarray, implicit: bool, begin: float, ends: np.ndarray) -> np.ndarray:
        """Return the plant's states after one step from ``begin`` to each of ``ends``, as parts of base step k."""
        count, h = len(ends), self.experiment.step
        ones = np.ones(count, dtype=np.int64)
        start = np.full(count, (k + begin) * h)
        segments = Segments(ones, NEVER * ones, start, np.zeros(count), (ends - begin) * h)
        tables = Tables(_PointGrid(segments, k, k + 1, h, 1, False, 1, 0), self.signals, _places(implicit))
        states: States = {}
        self._plant(tables, {"": plant}, states, implicit)
        return states[""]

    def _advance(
        self, points: np.ndarray, states: States, substeps: int, implicit: bool, ends: tuple[float, ...]
    ) -> States:
        """Return the states after the parts between ``ends`` of each base step."""
        places = _places(implicit)
        for a, b in pairwise(ends):
            grid = _grid(points, self.experiment.step, substeps, a, b)
            states = self._part(Tables(grid, self.signals, places), states, implicit)
        return states

    def _part(self, tables: Tables, states: States, implicit: bool) -> States:
        """Return the states after one segment for each point."""
        e = self.experiment
        simulation = Simulation(e, 1, self.remember, implicit)
        measured = [s for s in e.estimators if s.every is None and s.label in states]
        after: States = {}
        lead = e.estimators[simulation.lockstep[0]] if simulation.joined else None
        if self._loop is not None:
            noises = {n: s for n, s in self.signals.items() if n.startswith("noise.")}
            after[""], *seen = self._loop.each(tables.grid, states[""], noises)
            y = np.concatenate(seen, axis=2)
        elif lead is not None and lead in measured:
            y = self._joint(lead, tables, states, after)
            measured.remove(lead)
        else:
            y = self._plant(tables, states, after, implicit)
        for estimator in measured:
            assert y is not None, "it was emitted for further observers"
            after[estimator.label] = self._observer(estimator, tables, states[estimator.label], y, implicit)
        return after

    def _joint(self, lead: Estimator, tables: Tables, states: States, after: States) -> np.ndarray | None:
        """Advance plant and first observer with the run's joined kernel; return y where the run emits it."""
        e, n = self.experiment, len(self.experiment.plant.states)
        program = joined(e.plant, lead.program)
        roots = measured_nodes(e, program) if len(e.estimators) > 1 or self.remember else ()
        both = np.concatenate([states[""], states[lead.label]], axis=1)
        both, y = _call(plan(program, roots, tables.kinds), tables, e.parameters | lead.parameters, both)
        after[""], after[lead.label] = both[:, :n], both[:, n:]
        return y if roots else None

    def _plant(self, tables: Tables, states: States, after: States, implicit: bool) -> np.ndarray:
        """Advance the plant alone; return y with noise at every stage of every step."""
        e = self.experiment
        own = Tables(tables.grid, e.signals, tables.places)
        call = plan(e.plant, tuple(e.plant.outputs.values()), own.kinds, implicit=implicit)
        after[""], clean = _call(call, own, e.parameters, states[""])
        at = tables.grid.segment_anchor
        noise = np.stack([self.signals[f"noise.{n}"](at, at) for n in e.plant.outputs], axis=1)
        return clean + np.repeat(noise, tables.grid.segments.steps, axis=0)[:, None, :]

    def _observer(
        self, estimator: Estimator, tables: Tables, start: np.ndarray, y: np.ndarray, implicit: bool
    ) -> np.ndarray:
        """Return the states of an observer that reads y, and in a closed loop the applied inputs after y."""
        e, program = self.experiment, estimator.program
        names = [*e.plant.outputs, *e.applied]
        given = tuple(n for n in names if n in program.used_inputs)
        own = Tables(tables.grid, e.signals, tables.places)
        picked = y[:, :, [names.index(n) for n in given]]
        call = plan(program, (), own.kinds, given, implicit=implicit)
        return _call(call, own, estimator.parameters, start, picked)[0]


def _differ(states: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Return in which rows states differ (rows,)."""
    return ((states != others) & ~(np.isnan(states) & np.isnan(others))).any(axis=1)


def _places(implicit: bool) -> tuple[float, ...]:
    """Return the times of the stages, in steps."""
    return implicit_method.C if implicit else RUNGE_KUTTA


def _call(
    call: Plan, tables: Tables, values: dict[str, float], start: np.ndarray, y: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Return the states after one segment from each row of ``start``, and the emitted nodes (steps, stages, nodes).

    ``y``: measured outputs that follow the staged signals.
    """
    grid, nodes = tables.grid, len(call.kernel.layout.emitted)
    parts = [tables.staged(call.staged)] if call.staged or y is None else []
    staged = np.ascontiguousarray(np.concatenate([*parts, *([] if y is None else [y])], axis=2))
    emitted = np.empty((grid.count, tables.stages, max(1, nodes)))
    params = np.array([values[p] for p in call.params] or [0.0])
    states = np.array(start, order="C")
    call.kernel.advance_each(grid.segments, states, params, tables.held(call.held), staged, emitted)
    return states, emitted[:, :, :nodes]


def _compressed(noise: Signal) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Return the values of a noise in quicker succession: those at points that are far apart are drawn together."""
    return lambda t, anchor: noise.value(t / _COMPRESSION, anchor / _COMPRESSION)


def defects(e: Experiment, k: np.ndarray, begin: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Return roughly the local error of base steps ``k`` from the plant's states at both ends, in size (steps, n)."""
    varying = tuple(sorted(n for n, s in e.signals.items() if not s.held))
    program = defect_program(e.plant, varying)
    start, anchor = k * e.step, (k + 0.5) * e.step
    values: dict[str, np.ndarray | float] = {**e.parameters, "t": start, "h": e.step}
    for name, signal in e.signals.items():
        if signal.held:
            values[name] = signal(anchor, anchor) if signal.level is None else signal.level
            continue
        values |= {f"{prefix}{name}": signal(start + place * e.step, anchor) for prefix, place in PLACES.items()}
    values |= {f"from.{s}": begin[:, j] for j, s in enumerate(e.plant.states)}
    values |= {f"to.{s}": end[:, j] for j, s in enumerate(e.plant.states)}
    return np.abs(probe(program, list(program.outputs), values).T)


def roughness(before: np.ndarray, states: np.ndarray) -> np.ndarray:
    """Return the size of the fifth differences of states, which end with each base step (steps, n): about h⁵·d⁵x/dt⁵.

    They are infinite where fewer than four states are known before the base step.

    Args:
        before: states at the last base steps before the first one (at most four, n).
        states: at the ends of all base steps (steps + 1, n).
    """
    known = np.vstack([before, states]) if len(before) else states
    differences = np.full((len(states) - 1, states.shape[1]), np.inf)
    with np.errstate(invalid="ignore", over="ignore"):
        fifth = np.abs(np.diff(known, 5, axis=0))
    count = min(len(fifth), len(differences))
    if count:
        differences[-count:] = fifth[-count:]
    return differences


def solvable(e: Experiment) -> bool:
    """Return whether implicit steps can be taken: the equations are small enough, and no controller makes them jump."""
    if e.loop is not None:
        return False
    sizes = [len(s.program.states) for s in e.estimators if s.every is None]
    return max([len(e.plant.states), *sizes]) <= MOST_STATES


def _grid(points: np.ndarray, h: float, substeps: int, a: float, b: float) -> Grid:
    """Return one segment for every point: part a … b of its base step in ``substeps`` steps, none of them recorded."""
    count = len(points)
    counts, starts = np.full(count, substeps, dtype=np.int64), points.astype(np.int64)
    if b - a == 1:
        t, index, widths = np.zeros(count), (starts * substeps).astype(float), np.full(count, h / substeps)
    else:
        t, index, widths = (starts + a) * h, np.zeros(count), np.full(count, (b - a) * h / substeps)
    segments = Segments(counts, np.full(count, NEVER), t, index, widths)
    return _PointGrid(segments, int(points[0]), int(points[-1]) + 1, h, substeps, False, 1, 0)


class _PointGrid(Grid):
    """A grid whose every segment continues the piece of a signal that is active at its end: no jump is within it."""

    @cached_property
    def segment_anchor(self) -> np.ndarray:
        """Return a time in s just before the end of every segment (segments,)."""
        segments = self.segments
        return segments.t + (segments.index + segments.steps - _BEFORE_END) * segments.h

    @cached_property
    def anchor(self) -> np.ndarray:
        """Return the same for every step (steps,)."""
        return np.repeat(self.segment_anchor, self.segments.steps)
