"""Scores, and how the declared measurement noise enters them: engine/estimation/noise_response.py along rows."""

from dataclasses import dataclass

import numpy as np

from thetascope.diagnosis.residuals.backward_pass import BackwardPass
from thetascope.diagnosis.residuals.innovation_filter import bounded, rowwise
from thetascope.diagnosis.yield_points import Steps
from thetascope.engine.compiler.graph import variables
from thetascope.engine.compiler.jit import Layout, kernel
from thetascope.engine.estimation.covariance import holds
from thetascope.engine.estimation.noise_response import noise_response

_EARLIER = 300  # rows before the first one whose noise counts
_ROUNDING = 1e-6  # of a sample of the noise: a row this close before its beginning belongs to it


@dataclass(frozen=True)
class Scores:
    """Scores Σ Ωᵀν of a hypothesis: derivatives of its likelihood with respect to sizes of courses.

    Attributes:
        innovations: (numbers,), ν along the rows.
        response: (scores, numbers), Ω along the rows.
        noise: (scores, numbers), the weights with which independent noise of variance one enters the scores.
    """

    innovations: np.ndarray
    response: np.ndarray
    noise: np.ndarray

    def joined(self, other: "Scores") -> "Scores":
        """Return these scores, then the others."""
        return Scores(
            self.innovations, np.concatenate([self.response, other.response]), np.concatenate([self.noise, other.noise])
        )

    def of(self, places: np.ndarray) -> "Scores":
        """Return some of the scores, in the order of their places."""
        return Scores(self.innovations, self.response[places], self.noise[places])


class ScoreNoise:
    """The noise response of one filter."""

    def __init__(self, backward_pass: BackwardPass):
        filter_ = self.filter = backward_pass.filter
        self.program = noise_response(filter_.program, filter_.n, filter_.m)
        outputs = tuple(self.program.outputs[f"response.{k}"] for k in range(filter_.m))
        used = variables(self.program.graph, [*self.program.update, *outputs])
        names = [name for name in self.program.inputs if name in used]
        self.layout = Layout(held=tuple(names), emitted=outputs)
        parts = {name: place for place, name in enumerate(backward_pass.program.inputs)}
        self._parts = [(c, parts[name]) for c, name in enumerate(names) if name in parts]
        self._weights = [(c, int(name.removeprefix("w."))) for c, name in enumerate(names) if name not in parts]
        experiment = filter_.experiment
        self._hold = np.maximum(holds(experiment.measurement, experiment.step), filter_.interval)

    def prepare(self) -> None:
        """Compile the kernel in advance."""
        kernel(self.program, self.layout)

    def weights(self, backward_inputs: np.ndarray, t: np.ndarray, weights: np.ndarray) -> Steps[np.ndarray]:
        """Return the weights (scores, numbers) with which independent noise of variance one enters Σ w ν.

        The filter's estimate before the first row has errors due to earlier noise. Its covariance is that of a filter
        along the first rows, which are repeated for this purpose.

        Args:
            backward_inputs: see `BackwardPass.backward_inputs`.
            t: (rows,), times in s.
            weights: (scores, rows, m), w of each innovation; zero for outputs that are not trusted.
        """
        count, (rows, m) = len(weights), weights.shape[1:]
        earlier = min(rows, _EARLIER)
        held = np.zeros((rows + earlier, max(1, len(self.layout.held))))
        for c, place in self._parts:
            held[:rows, c] = backward_inputs[:, place]
            held[rows:, c] = backward_inputs[rows - earlier :, place]
        t = np.concatenate([t[0] - self.filter.interval * np.arange(earlier, 0, -1), t])
        responses, n = np.empty((count, rows + earlier, m)), self.filter.n
        emitted, out = np.empty((rows + earlier, 1, m)), np.empty((rows + earlier, n))
        for i in range(count):
            yield
            for c, k in self._weights:
                held[:rows, c] = weights[i, ::-1, k]
            kernel(self.program, self.layout)(
                rowwise(np.zeros(rows + earlier)), np.zeros(n), np.zeros(1), 1, out, held=held, emitted=emitted
            )
            responses[i] = bounded(emitted[::-1, 0])
        parts = []
        for k in range(m):  # a value of the noise is held for one row or more
            sample = np.floor(t / self._hold[k] + _ROUNDING)
            first = np.flatnonzero(np.diff(sample, prepend=np.nan) != 0)
            parts.append(np.add.reduceat(responses[:, :, k], first, axis=1) * self.filter.stds[k])
        return np.concatenate(parts, axis=1)
