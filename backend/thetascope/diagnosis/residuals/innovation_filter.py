"""The filter of engine/estimation/kalman_innovations.py run along rows: what goes in, and what is kept."""

from dataclasses import dataclass

import numpy as np

from thetascope.engine.compiler.graph import variables
from thetascope.engine.compiler.jit import NEVER, Layout, Segments, kernel
from thetascope.engine.estimation.covariance import holds, noise_stds
from thetascope.engine.estimation.kalman_innovations import innovations
from thetascope.engine.observers.support.declaration import Context
from thetascope.engine.observers.support.kalman_defaults import DOUBT, process_noise, state_scales
from thetascope.engine.simulation.experiment import Experiment as Engine

MOST_STATES = 12
LARGEST = 1e60  # standard deviations: an innovation as large is a filter that is lost
REPEATS = 10  # noisy values in a row that are the very same number: the output stands still
_USUAL = 3.0  # times as long as nearly all repetitions in a record
_EDGE = 1e-3  # of a state's size: how far inside the domain derivatives are taken (√x has none at 0)


@dataclass(frozen=True)
class Innovations:
    """White innovations along rows: ``nu`` (rows, m) = ``omega`` (rows, m, p) (θ − θ₀) + noise of variance one.

    ``states`` (rows, states): the filter after each row.
    """

    omega: np.ndarray
    nu: np.ndarray
    states: np.ndarray


class InnovationFilter:
    """The filter of one plant with one noise: values that do not change along a stretch of rows.

    ``stuck_after`` (m): rows after which an output that shows the same number stands still, ∞ where no noise is declared.
    ``doubt``: share of a state's size by which its equation may be off within the plant's time constant.
    """

    def __init__(self, experiment: Engine, context: Context, doubt: float = DOUBT):
        self.experiment, self.context = experiment, context
        self.program = innovations(experiment.plant)
        self.channels = tuple(i for i in experiment.plant.inputs if i.startswith("theta."))
        self.n, self.p, self.m = len(experiment.plant.states), len(self.channels), len(experiment.plant.outputs)
        self.base = np.zeros(self.p)  # θ that belongs to the plant as it is; what is known comes on top
        self.outputs = tuple(experiment.plant.outputs)
        self.stds = noise_stds(experiment.measurement, context)
        outputs = tuple(node for name, node in self.program.outputs.items() if name.startswith(("omega.", "nu.")))
        used = variables(self.program.graph, [*self.program.update, *outputs])
        given = used & set(self.program.inputs)
        self._courses = [
            (name, int(j)) for name, j in (i.split(".") for i in sorted(given) if i.startswith(("known.", "profile.")))
        ]
        courses = tuple(f"{name}.{j}" for name, j in self._courses)
        self.names = tuple(sorted(given - set(courses)))
        self.layout = Layout(held=(*self.names, *courses), emitted=outputs)
        self.interval = experiment.every * experiment.step
        self._measured = [self.names.index(f"measured.{o}") for o in self.outputs]
        hold = np.maximum(1.0, holds(experiment.measurement, experiment.step) / self.interval)
        self.stuck_after = np.where(np.array(experiment.measurement.std) > 0, REPEATS * hold, np.inf)
        values = experiment.parameters | {"interval": self.interval}
        values |= {f"q.{i}": v * (doubt / DOUBT) ** 2 for i, v in enumerate(process_noise(context))}
        values |= {f"R.{k}": float(v) for k, v in enumerate(self._variance())}
        values |= {f"heed.{k}": 1.0 for k in range(self.m)}
        for i, (state, scale) in enumerate(zip(context.model["states"], state_scales(context), strict=True)):
            low, high = state.get("domain") or (None, None)
            edge = _EDGE * scale
            values |= {
                f"low.{i}": -np.inf if low is None else low + edge,
                f"high.{i}": np.inf if high is None else high - edge,
            }
        order = self.layout.shared_params(self.program)
        self._params = np.array([values[p] for p in order] or [0.0])
        self._trust_places = [order.index(f"heed.{k}") for k in range(self.m)]

    def _variance(self) -> np.ndarray:
        """Of one row's y, so that rows count as independent: noise that holds for several rows counts once."""
        variance = self.stds**2
        if self.experiment.measurement.sample_every is not None:
            return variance  # one sample is one value, and enters in one row only
        return variance * np.maximum(1.0, holds(self.experiment.measurement, self.experiment.step) / self.interval)

    def start(self) -> np.ndarray:
        """The plant's initial state as observers take it, V = 0, P from the states' scales."""
        first = np.array([s.get("initial", 0.0) for s in self.context.model["states"]])
        P = np.diag(np.array(state_scales(self.context)) ** 2)
        return np.concatenate([first, np.zeros(self.n * self.p), P[np.triu_indices(self.n)]])

    def table(self, index: np.ndarray, y: np.ndarray, values: dict) -> np.ndarray:
        """What goes in at each row (rows × names): y (rows, m), inputs and signals from ``values``."""
        e = self.experiment
        given = values | {f"measured.{o}": y[:, k] for k, o in enumerate(e.plant.outputs)}
        every = e.measurement.sample_every
        given["fresh"] = 1.0 if every is None else (index // every != (index - e.every) // every) * 1.0
        table = np.empty((len(index), max(1, len(self.names))))
        for c, name in enumerate(self.names):
            table[:, c] = given[name]
        return table

    def run(
        self,
        state: np.ndarray,
        known: np.ndarray,
        table: np.ndarray,
        t: np.ndarray,
        profile: np.ndarray | None = None,
        trusted_outputs: np.ndarray | None = None,
    ) -> Innovations:
        """Along rows with inputs ``table`` at times ``t``, θ₀ = ``known`` (p, or rows × p).

        ``profile`` (rows × p): the course of the θ − θ₀ that Ω answers, constant by default; ``trusted_outputs`` (m): outputs that the
        filter follows, all by default.
        """
        return self.run_held(state, self.held(known, table, profile), t, trusted_outputs)

    def run_held(
        self, state: np.ndarray, held: np.ndarray, t: np.ndarray, trusted_outputs: np.ndarray | None = None
    ) -> Innovations:
        """Along rows with what is `held` at each."""
        rows, emitted, out = len(t), np.empty((len(t), 1, len(self.layout.emitted))), np.empty((len(t), len(state)))
        kernel(self.program, self.layout)(
            rowwise(t), state.copy(), self.params(trusted_outputs), 1, out, held=held, emitted=emitted
        )
        shown = emitted[:, 0, :].reshape(rows, self.m, self.p + 1)  # of each output its Ω, then its ν
        return Innovations(shown[:, :, : self.p], shown[:, :, self.p], out)

    def params(self, trusted_outputs: np.ndarray | None = None) -> np.ndarray:
        """The program's parameters, with the outputs that are heeded."""
        params = self._params.copy()
        if trusted_outputs is not None:
            params[self._trust_places] = trusted_outputs
        return params

    def held(self, known: np.ndarray, table: np.ndarray, profile: np.ndarray | None = None) -> np.ndarray:
        """What `layout` has at each row."""
        courses = {"known": np.broadcast_to(self.base + known, (len(table), self.p)), "profile": profile}
        held = np.empty((len(table), max(1, len(self.layout.held))))
        held[:, : len(self.names)] = table[:, : len(self.names)]
        for c, (name, j) in enumerate(self._courses, start=len(self.names)):
            held[:, c] = 1.0 if courses[name] is None else courses[name][:, j]
        return held

    def measured(self, table: np.ndarray) -> np.ndarray:
        """What the outputs showed (rows × m), from a table."""
        return table[:, self._measured]

    def without_sensitivity(self, state: np.ndarray) -> np.ndarray:
        """The filter's state with V = 0: as if faults began here."""
        fresh = state.copy()
        fresh[self.n : self.n * (1 + self.p)] = 0.0
        return fresh

    def sensitivity(self, state: np.ndarray) -> np.ndarray:
        """V (n × p) of the filter's state, or states (the last axis)."""
        return state[..., self.n : self.n * (1 + self.p)].reshape(*state.shape[:-1], self.n, self.p)

    def variances(self, states: np.ndarray) -> np.ndarray:
        """The diagonal of P (n) in the filter's states (the last axis)."""
        i, j = np.triu_indices(self.n)
        return states[..., self.n * (1 + self.p) :][..., i == j]

    def shifted(self, state: np.ndarray, change: np.ndarray) -> np.ndarray:
        """The filter's state (or states, the last axis) had it known of a change of θ (p), to which its V is the answer."""
        told = state.copy()
        told[..., : self.n] += (self.sensitivity(state) @ change[..., None])[..., 0]
        return told

    def learn_repeats(self, y: np.ndarray) -> None:
        """Take it as usual that outputs repeat numbers as often as in a record (rows, m): coarse sensors do."""
        for k, column in enumerate(y.T):
            ends = np.flatnonzero(np.diff(column) != 0)
            if len(ends) > 1:
                self.stuck_after[k] = max(self.stuck_after[k], _USUAL * np.quantile(np.diff(ends), 0.99))


def rowwise(t: np.ndarray, stops: np.ndarray | None = None) -> Segments:
    """Segments of one row each, of which all are recorded, or those that complete so many rows."""
    first = np.full(len(t), 1 if stops is None else NEVER)
    if stops is not None:
        first[stops - 1] = 1
    return Segments(np.ones(len(t), dtype=np.int64), first, t.copy(), np.zeros(len(t)), np.zeros(len(t)))


def bounded(values: np.ndarray) -> np.ndarray:
    """With numbers that can be squared and summed."""
    if np.abs(values).max(initial=0.0) < LARGEST:
        return values
    return np.clip(np.nan_to_num(values, nan=LARGEST), -LARGEST, LARGEST)
