"""The filter of engine/innovations.py run along rows: what goes in, what is kept, and from what onset a fault is looked at."""

from dataclasses import dataclass

import numpy as np

from backend.engine.graph import variables
from backend.engine.innovations import innovations
from backend.engine.kernel import Layout, Segments, kernel
from backend.engine.observers.base import Context
from backend.engine.observers.weights import DOUBT, process_noise, state_scales
from backend.engine.simulation import Experiment as Engine
from backend.engine.spread import holds, noise_stds

MOST_STATES = 12
_EDGE = 1e-3  # of a state's size: how far inside the domain derivatives are taken (√x has none at 0)


@dataclass(frozen=True)
class Innovations:
    """White innovations along rows: ``nu`` (rows, m) = ``omega`` (rows, m, p) (θ − θ₀) + noise of variance one.

    ``states`` (rows, states): the filter after each row.
    """

    omega: np.ndarray
    nu: np.ndarray
    states: np.ndarray


class Filter:
    """The filter of one plant with one noise: values that do not change along a stretch of rows.

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
        outputs = tuple(self.program.outputs.values())
        used = variables(self.program.graph, [*self.program.update, *outputs])
        self.names = tuple(sorted(used & set(self.program.inputs)))
        self.layout = Layout(held=self.names, emitted=outputs)
        self.interval = experiment.every * experiment.step
        values = experiment.parameters | {"interval": self.interval}
        values |= {f"q.{i}": v * (doubt / DOUBT) ** 2 for i, v in enumerate(process_noise(context))}
        values |= {f"R.{k}": float(v) for k, v in enumerate(self._variance())}
        values |= {f"known.{j}": 0.0 for j in range(self.p)}
        for i, (state, scale) in enumerate(zip(context.model["states"], state_scales(context), strict=True)):
            low, high = state.get("domain") or (None, None)
            edge = _EDGE * scale
            values |= {f"low.{i}": -np.inf if low is None else low + edge, f"high.{i}": np.inf if high is None else high - edge}
        order = self.layout.shared_params(self.program)
        self._params = np.array([values[p] for p in order] or [0.0])
        self._known = [(order.index(f"known.{j}"), j) for j in range(self.p) if f"known.{j}" in order]

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

    def run(self, state: np.ndarray, known: np.ndarray, table: np.ndarray, t: np.ndarray) -> Innovations:
        """Along rows with inputs ``table`` at times ``t``, θ₀ = ``known``."""
        rows = len(t)
        params = self._params.copy()
        for place, j in self._known:
            params[place] = self.base[j] + known[j]
        ones, zeros = np.ones(rows, dtype=np.int64), np.zeros(rows)
        emitted = np.empty((rows, 1, len(self.layout.emitted)))
        out = np.empty((rows, len(state)))
        kernel(self.program, self.layout)(Segments(ones, ones, t.copy(), zeros, zeros), state.copy(), params, 1, out,
                                          held=np.ascontiguousarray(table), emitted=emitted)  # fmt: skip
        shown = emitted[:, 0, :].reshape(rows, self.m, self.p + 1)  # of each output its Ω, then its ν
        return Innovations(shown[:, :, : self.p], shown[:, :, self.p], out)

    def unanswered(self, state: np.ndarray) -> np.ndarray:
        """The filter's state with V = 0: as if faults began here."""
        fresh = state.copy()
        fresh[self.n : self.n * (1 + self.p)] = 0.0
        return fresh

    def answers(self, state: np.ndarray) -> np.ndarray:
        """V (n × p) of the filter's state."""
        return state[self.n : self.n * (1 + self.p)].reshape(self.n, self.p)

    def knowing(self, state: np.ndarray, V: np.ndarray, change: np.ndarray) -> np.ndarray:
        """The filter's state had it known a change of θ whose answer is V."""
        told = state.copy()
        told[: self.n] += V @ change
        return told

