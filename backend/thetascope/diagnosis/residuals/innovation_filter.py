"""The extended Kalman filter of engine/estimation/kalman_innovations.py along rows: its inputs, and what is kept of
it."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from thetascope.engine.compiler.graph import variables
from thetascope.engine.compiler.jit import NEVER, Layout, Segments, kernel
from thetascope.engine.compiler.system import DISCRETE
from thetascope.engine.estimation.covariance import holds, noise_stds
from thetascope.engine.estimation.kalman_innovations import AHEAD, halvings, innovations
from thetascope.engine.inputs.sensors import Measurement
from thetascope.engine.inputs.signals import Signal
from thetascope.engine.observers.support.declaration import Context
from thetascope.engine.observers.support.kalman_defaults import DOUBT, process_noise, state_scales, uncertain_scales
from thetascope.engine.simulation.experiment import Experiment
from thetascope.engine.simulation.simulation import at_rows

MOST_STATES = 12
LARGEST = 1e60  # standard deviations: at larger innovations the filter has diverged
REPEATS = 10  # equal noisy values in succession: the output is stuck
_EDGE = (
    1e-3  # of a state's scale: distance from the edge of the domain at which derivatives are taken (√x has none at 0)
)


@dataclass(frozen=True)
class Innovations:
    """White innovations along rows: ν = Ω (θ − θ₀) + noise of variance one.

    Attributes:
        omega: (rows, m, p), the response Ω of the innovations to faults.
        nu: (rows, m), the innovations ν.
        states: (rows, filter states), the filter after each row: x̂ (n), V (n × p), the upper triangle of P.
    """

    omega: np.ndarray
    nu: np.ndarray
    states: np.ndarray


class InnovationFilter:
    """The filter of one plant with one noise.

    Args:
        experiment: the plant, its parameters and its measurement; of a true plant, its model.
        context: that of the plant.
        doubt: share of a state's scale by which its equation may be wrong within the plant's time constant.

    Attributes:
        n, p, m: numbers of states, fault channels and outputs.
        base: (p,), θ that belongs to the plant itself; known faults are added.
        stds: (m,), standard deviations of the noise.
        stuck_after: (m,), rows of equal values after which an output is stuck; ∞ where no noise is declared.
        interval: time between rows, s.
        acts_directly: (p,), whether a channel's fault shows in whole rows: it acts on an output, or in discrete time.
    """

    def __init__(self, experiment: Experiment, context: Context, doubt: float = DOUBT):
        experiment = experiment.modelled
        self.experiment, self.context = experiment, context
        self.interval = experiment.every * experiment.step
        self.program = innovations(experiment.plant, halvings(context.scales.fastest, self.interval))
        self.channels = tuple(i for i in experiment.plant.inputs if i.startswith("theta."))
        self.n, self.p, self.m = len(experiment.plant.states), len(self.channels), len(experiment.plant.outputs)
        self.base = np.zeros(self.p)
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
        self.acts_directly = np.full(self.p, experiment.plant.time == DISCRETE)
        for k in range(self.m):
            direct = (self.program.outputs[f"D.{k}.{j}"] for j in range(self.p))
            self.acts_directly |= np.array([self.program.graph.value(node) != 0.0 for node in direct], dtype=bool)
        self.layout = Layout(held=(*self.names, *courses), emitted=outputs)
        self._fresh = [self.names.index(f"fresh.{k}") for k in range(self.m)]
        self._measured = [self.names.index(f"measured.{o}") for o in self.outputs]
        hold = np.maximum(1.0, holds(experiment.measurement, experiment.step) / self.interval)
        self.stuck_after = np.where(np.array(experiment.measurement.std) > 0, REPEATS * hold, np.inf)
        own = experiment.measurement.samplings or (None,) * self.m
        self._rows_per_sample = np.array([0.0 if s is None else max(1.0, s.every / experiment.every) for s in own])
        values = experiment.parameters | {"interval": self.interval}
        values |= {f"q.{i}": v * (doubt / DOUBT) ** 2 for i, v in enumerate(process_noise(context))}
        values |= {f"R.{k}": float(v) for k, v in enumerate(self._variance())}
        values |= {f"trusted.{k}": 1.0 for k in range(self.m)}
        for i, (state, scale) in enumerate(zip(context.model["states"], state_scales(context), strict=True)):
            low, high = state.get("domain") or (None, None)
            edge = _EDGE * scale
            values |= {
                f"low.{i}": -np.inf if low is None else low + edge,
                f"high.{i}": np.inf if high is None else high - edge,
            }
        order = self.layout.shared_params(self.program)
        self._params = np.array([values[p] for p in order] or [0.0])
        self._trust_places = [order.index(f"trusted.{k}") for k in range(self.m)]

    def _variance(self) -> np.ndarray:
        """Return the variance (m,) of one row of y such that rows count as independent: noise held for several rows
        counts once."""
        measurement = self.experiment.measurement
        held = np.maximum(1.0, holds(measurement, self.experiment.step) / self.interval)
        sampled = np.array([sampling is not None for sampling in measurement.sampled_by])
        return self.stds**2 * np.where(sampled, 1.0, held)  # a sample enters in one row only

    def start(self) -> np.ndarray:
        """Return the initial state: x̂ as observers assume it, V = 0, P from the scales of the states."""
        first = np.array([s.get("initial", 0.0) for s in self.context.model["states"]])
        P = np.diag(np.array(uncertain_scales(self.context)) ** 2)
        return np.concatenate([first, np.zeros(self.n * self.p), P[np.triu_indices(self.n)]])

    def table(
        self,
        index: np.ndarray,
        y: np.ndarray,
        values: Mapping,
        signals: Mapping[str, Signal],
        measurement: Measurement | None = None,
    ) -> np.ndarray:
        """Return the filter's inputs (rows, inputs).

        Args:
            index: (rows,), base steps.
            y: (rows, m), measurements.
            values: inputs and known signals by name, (rows,) each; those that controllers set also as ``ahead.*``,
                their means until the next row.
            signals: the other ones as functions of time, from which their values between rows are taken.
            measurement: the measurement of y, which says in which rows outputs are new; None: that of the filter.
        """
        e = self.experiment
        given = {**values, **{f"measured.{o}": y[:, k] for k, o in enumerate(e.plant.outputs)}}
        middle = (index + 0.5 * e.every) * e.step
        for name in self.names:
            if name.startswith(AHEAD) and name not in values:
                given[name] = at_rows(signals[name.removeprefix(AHEAD)], middle, e.step)
        fresh = (measurement or e.measurement).fresh(index, e.every)
        given |= {f"fresh.{k}": fresh[:, k] for k in range(self.m)}
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
        """Run the filter along rows.

        Args:
            state: the filter's state before the first row.
            known: θ₀, (p,) or (rows, p).
            table: (rows, inputs), see `table`.
            t: (rows,), times in s.
            profile: (rows, p), the course of θ − θ₀ that Ω responds to; None: constant.
            trusted_outputs: (m,), 1 for outputs that the filter uses, else 0; None: all.
        """
        return self.run_held(state, self.held(known, table, profile), t, trusted_outputs)

    def run_held(
        self, state: np.ndarray, held: np.ndarray, t: np.ndarray, trusted_outputs: np.ndarray | None = None
    ) -> Innovations:
        """Run the filter along rows with inputs from `held`; the rest as in `run`."""
        rows, emitted, out = len(t), np.empty((len(t), 1, len(self.layout.emitted))), np.empty((len(t), len(state)))
        kernel(self.program, self.layout)(
            rowwise(t), state.copy(), self.params(trusted_outputs), 1, out, held=held, emitted=emitted
        )
        shown = emitted[:, 0, :].reshape(rows, self.m, self.p + 1)  # for each output Ω, then ν
        return Innovations(shown[:, :, : self.p], shown[:, :, self.p], out)

    def params(self, trusted_outputs: np.ndarray | None = None) -> np.ndarray:
        """Return the parameters of the program for some trusted outputs (m,)."""
        params = self._params.copy()
        if trusted_outputs is not None:
            params[self._trust_places] = trusted_outputs
        return params

    def held(self, known: np.ndarray, table: np.ndarray, profile: np.ndarray | None = None) -> np.ndarray:
        """Return everything that the program needs at each row (rows, inputs and courses); arguments as in `run`."""
        courses = {"known": np.broadcast_to(self.base + known, (len(table), self.p)), "profile": profile}
        held = np.empty((len(table), max(1, len(self.layout.held))))
        held[:, : len(self.names)] = table[:, : len(self.names)]
        for c, (name, j) in enumerate(self._courses, start=len(self.names)):
            held[:, c] = 1.0 if courses[name] is None else courses[name][:, j]
        return held

    def measured(self, table: np.ndarray) -> np.ndarray:
        """Return the measurements (rows, m) in a table."""
        return table[:, self._measured]

    def repeatable(self, table: np.ndarray) -> np.ndarray:
        """Return the number of rows (rows, m) for which a value in a table counts if it equals the one before.

        A sample of a sensor whose samples may be lost counts for the rows of its period, other rows do not count: the
        value that is held in place of a lost sample does not tell that the sensor is stuck.
        """
        own = self._rows_per_sample
        return np.where(own > 0, table[:, self._fresh] * own, 1.0)

    def without_sensitivity(self, state: np.ndarray) -> np.ndarray:
        """Return the filter's state with V = 0, as if faults began here."""
        fresh = state.copy()
        fresh[self.n : self.n * (1 + self.p)] = 0.0
        return fresh

    def sensitivity(self, state: np.ndarray) -> np.ndarray:
        """Return V = ∂x̂/∂θ (…, n, p) of filter states (…, filter states)."""
        return state[..., self.n : self.n * (1 + self.p)].reshape(*state.shape[:-1], self.n, self.p)

    def variances(self, states: np.ndarray) -> np.ndarray:
        """Return the diagonal of P (…, n) of filter states (…, filter states)."""
        i, j = np.triu_indices(self.n)
        return states[..., self.n * (1 + self.p) :][..., i == j]

    def shifted(self, state: np.ndarray, change: np.ndarray) -> np.ndarray:
        """Return filter states (…, filter states) as if a constant change of θ (p,) had been known all along: x̂ +
        V·change."""
        shifted = state.copy()
        shifted[..., : self.n] += (self.sensitivity(state) @ change[..., None])[..., 0]
        return shifted


def rowwise(t: np.ndarray, stops: np.ndarray | None = None) -> Segments:
    """Return segments of one row each; all are recorded, or only those that complete the numbers of rows `stops`."""
    first = np.full(len(t), 1 if stops is None else NEVER)
    if stops is not None:
        first[stops - 1] = 1
    return Segments(np.ones(len(t), dtype=np.int64), first, t.copy(), np.zeros(len(t)), np.zeros(len(t)))


def bounded(values: np.ndarray) -> np.ndarray:
    """Return values clipped so that they can be squared and summed."""
    if np.abs(values).max(initial=0.0) < LARGEST:
        return values
    return np.clip(np.nan_to_num(values, nan=LARGEST), -LARGEST, LARGEST)
