"""Scores, and how the declared measurement noise enters them: engine/estimation/course_response.py and
engine/estimation/noise_response.py along rows, for several scores side by side in the lanes of a vector."""

from dataclasses import dataclass

import numpy as np

from thetascope.diagnosis.residuals.backward_pass import BackwardPass
from thetascope.diagnosis.residuals.filter_bank import WIDTH
from thetascope.diagnosis.residuals.innovation_filter import bounded, rowwise
from thetascope.diagnosis.yield_points import Steps
from thetascope.engine.compiler.graph import variables
from thetascope.engine.compiler.jit import Layout, kernel
from thetascope.engine.compiler.system import Program
from thetascope.engine.estimation.course_response import course_response
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


class ScorePrograms:
    """The programs of one filter from which scores are made."""

    def __init__(self, backward_pass: BackwardPass):
        filter_ = self.filter = backward_pass.filter
        n, m = filter_.n, filter_.m
        self.places = {name: place for place, name in enumerate(backward_pass.program.inputs)}
        response, noise = course_response(filter_.program, n, m), noise_response(filter_.program, n, m)
        self._response = _Lanes(response, [f"omega.{k}" for k in range(m)], ("w",))
        self._noise = _Lanes(noise, [f"response.{k}" for k in range(m)], tuple(f"w.{k}" for k in range(m)))
        self._hold = np.maximum(holds(filter_.experiment.measurement, filter_.experiment.step), filter_.interval)

    def prepare(self) -> None:
        """Compile the kernels in advance."""
        self._response.prepare()
        self._noise.prepare()

    def responses(self, backward_inputs: np.ndarray, channel: int, courses: np.ndarray) -> Steps[np.ndarray]:
        """Return Ω (courses, rows, m) for courses of one channel's θ (courses, rows); see `BackwardPass` for the
        inputs.
        """
        shown = np.flatnonzero(courses.any(axis=0))
        first = int(shown[0]) if len(shown) else 0  # Ω is zero before
        inputs, rows = backward_inputs[::-1], courses.shape[1]
        held = np.stack([self._column(inputs, name, channel) for name in self._response.layout.held], axis=1)[first:]
        omega = np.zeros((len(courses), rows, self.filter.m))
        yield from self._response.run(held, courses[:, first:, None], omega[:, first:])
        return omega

    def _column(self, inputs: np.ndarray, name: str, channel: int) -> np.ndarray:
        """Return one output of the filter along rows; ``G.i`` and ``D.k`` are those of a channel."""
        name = f"{name}.{channel}" if name.startswith(("G.", "D.")) else name
        if name in self.places:
            return inputs[:, self.places[name]]
        return np.full(len(inputs), self.filter.program.graph.value(self.filter.program.outputs[name]))

    def innovations(self, backward_inputs: np.ndarray) -> np.ndarray:
        """Return ν (rows, m)."""
        return np.stack([self._column(backward_inputs[::-1], f"nu.{k}", 0) for k in range(self.filter.m)], axis=1)

    def noise_weights(self, backward_inputs: np.ndarray, t: np.ndarray, weights: np.ndarray) -> Steps[np.ndarray]:
        """Return the weights (scores, numbers) with which independent noise of variance one enters Σ w ν.

        The filter's estimate before the first row has errors due to earlier noise. Its covariance is that of a filter
        along the first rows, which are repeated for this purpose.

        Args:
            backward_inputs: see `BackwardPass.backward_inputs`.
            t: (rows,), times in s.
            weights: (scores, rows, m), w of each innovation; zero for outputs that are not trusted.
        """
        count, rows, m = weights.shape
        earlier = min(rows, _EARLIER)
        inputs = backward_inputs[:, [self.places[name] for name in self._noise.layout.held]]
        held = np.concatenate([inputs, inputs[rows - earlier :]])
        backwards = np.concatenate([weights[:, ::-1], np.zeros((count, earlier, m))], axis=1)
        responses = np.empty((count, rows + earlier, m))
        yield from self._noise.run(held, backwards, responses)
        responses = bounded(responses)[:, ::-1]
        t = np.concatenate([t[0] - self.filter.interval * np.arange(earlier, 0, -1), t])
        parts = []
        for k in range(m):  # a value of the noise is held for one row or more
            sample = np.floor(t / self._hold[k] + _ROUNDING)
            first = np.flatnonzero(np.diff(sample, prepend=np.nan) != 0)
            parts.append(np.add.reduceat(responses[:, :, k], first, axis=1) * self.filter.stds[k])
        return np.concatenate(parts, axis=1)


class _Lanes:
    """A program without parameters that runs once a row from zero, with inputs of its own in each lane."""

    def __init__(self, program: Program, outputs: list[str], own: tuple[str, ...]):
        nodes = tuple(program.outputs[name] for name in outputs)
        used = variables(program.graph, [*program.update, *nodes])
        held = tuple(name for name in program.inputs if name in used and name not in own)
        self.program = program
        self.layout = Layout(held=held, lane_held=own, emitted=nodes, lanes=WIDTH)

    def prepare(self) -> None:
        """Compile the kernel in advance."""
        kernel(self.program, self.layout)

    def run(self, held: np.ndarray, own: np.ndarray, results: np.ndarray) -> Steps[None]:
        """Fill `results` (scores, rows, outputs); `held`: (rows, inputs), `own`: (scores, rows, own inputs)."""
        rows, segments = len(held), rowwise(np.zeros(len(held)), np.array([len(held)]))
        held = np.ascontiguousarray(held) if held.shape[1] else np.zeros((rows, 1))
        lane_held, states = np.zeros((rows, own.shape[2], WIDTH)), len(self.program.states)
        for first in range(0, len(own), WIDTH):
            yield
            batch = own[first : first + WIDTH]
            lane_held[:, :, : len(batch)] = batch.transpose(1, 2, 0)
            emitted, out = np.empty((rows, results.shape[2], WIDTH)), np.empty((1, states, WIDTH))
            kernel(self.program, self.layout)(
                segments,
                np.zeros((states, WIDTH)),
                np.zeros(1),
                1,
                out,
                held=held,
                lane_held=lane_held,
                emitted=emitted,
            )
            results[first : first + WIDTH] = emitted[:, :, : len(batch)].transpose(2, 0, 1)


class LinearisedFilter:
    """The filter along rows under a hypothesis, to first order in further courses of θ.

    Args:
        programs: those of the filter.
        backward_inputs: see `BackwardPass.backward_inputs`.
        t: (rows,), times in s.
        trusted_outputs: (m,), the outputs that the filter uses.
    """

    def __init__(
        self, programs: ScorePrograms, backward_inputs: np.ndarray, t: np.ndarray, trusted_outputs: np.ndarray
    ):
        self._programs, self._backward_inputs, self._t, self._trusted = programs, backward_inputs, t, trusted_outputs
        self._innovations = (bounded(programs.innovations(backward_inputs)) * trusted_outputs).ravel()

    def scores(self, channels: list[int], courses: np.ndarray) -> Steps[Scores]:
        """Return the scores of the hypothesis with respect to courses (scores, rows) of θ, one channel each."""
        omega = np.empty((*courses.shape, len(self._trusted)))
        for channel in sorted(set(channels)):
            own = np.flatnonzero(np.array(channels) == channel)
            omega[own] = yield from self._programs.responses(self._backward_inputs, channel, courses[own])
        omega = bounded(omega) * self._trusted
        noise = yield from self._programs.noise_weights(self._backward_inputs, self._t, omega)
        return Scores(self._innovations, omega.reshape(len(omega), -1), noise)
