"""The information still to come at every decision: the backward pass of engine/estimation/backward_information.py along
rows."""

from dataclasses import dataclass

import numpy as np

from thetascope.diagnosis.residuals.innovation_filter import InnovationFilter, rowwise
from thetascope.engine.compiler.jit import Layout, kernel
from thetascope.engine.estimation.backward_information import SYMMETRIC, forms, onsets, parts


@dataclass(frozen=True)
class FutureInformation:
    """The information of all rows after each decision (the first axis, including the last).

    The blocks of M and μ of engine/estimation/backward_information.py: `vv` (n × n), `vw` (n × p), `ww` (p × p) … J and
    s of a step that begins at a decision are `ww` (p × p) and `w` (p); of a drift `rr` and `r` (p each, every channel
    alone).
    """

    vv: np.ndarray
    vw: np.ndarray
    ww: np.ndarray
    vr: np.ndarray
    wr: np.ndarray
    rr: np.ndarray
    v: np.ndarray
    w: np.ndarray
    r: np.ndarray

    def after(self, k: np.ndarray, V: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return D (the diagonal of J) and s, (k, p) each, of the rows after decisions.

        Args:
            k: (k,), the decisions, counted from the first.
            V: (k, n, p), the sensitivity there.
            w: (k, p), the value of the course there, which stays constant afterwards.
        """
        D = np.einsum("kip,kij,kjp->kp", V, self.vv[k], V) + 2 * w * (V * self.vw[k]).sum(axis=1)
        D += w**2 * np.einsum("kpp->kp", self.ww[k])
        return D, (V * self.v[k][:, :, None]).sum(axis=1) + w * self.w[k]


class BackwardPass:
    """The backward pass of one filter."""

    def __init__(self, filter_: InnovationFilter):
        self.filter = filter_
        self.program = onsets(filter_.program, filter_.n, filter_.p, filter_.m)
        row_parts = parts(filter_.program)
        self.input_layout = Layout(held=filter_.layout.held, emitted=tuple(row_parts[i] for i in self.program.inputs))
        self.layout = Layout(held=self.program.inputs)

    def prepare(self) -> None:
        """Compile the kernels in advance: one takes up to a second."""
        kernel(self.filter.program, self.input_layout)
        kernel(self.program, self.layout)

    def backward_inputs(
        self, state: np.ndarray, held: np.ndarray, t: np.ndarray, trusted_outputs: np.ndarray
    ) -> np.ndarray:
        """Return the inputs of the pass (rows, inputs), last row first.

        Args:
            state: the filter's state before the first row.
            held: see `InnovationFilter.held`.
            t: (rows,), times in s.
            trusted_outputs: (m,), 1 or 0.
        """
        emitted, out = np.empty((len(t), 1, len(self.program.inputs))), np.empty((len(t), len(state)))
        kernel(self.filter.program, self.input_layout)(
            rowwise(t), state.copy(), self.filter.params(trusted_outputs), 1, out, held=held, emitted=emitted
        )
        return emitted[::-1, 0].copy()

    def future_information(
        self, backward_inputs: np.ndarray, trusted_outputs: np.ndarray, stride: int
    ) -> FutureInformation:
        """Return the information after every `stride`-th row, the beginning and the end included."""
        states = self._pass(backward_inputs, trusted_outputs, stride, 1.0 / stride, 1.0)
        place, blocks = 0, {}
        for name, (shape, kept) in forms(self.filter.n, self.filter.p).items():
            entries = tuple(np.array(kept).T)
            block = blocks[name] = np.zeros((len(states), *shape))
            block[(slice(None), *entries)] = states[:, place : place + len(kept)]
            if name in SYMMETRIC:
                block[(slice(None), *entries[::-1])] = states[:, place : place + len(kept)]
            place += len(kept)
        return FutureInformation(**blocks)

    def exponential_rises(
        self, backward_inputs: np.ndarray, trusted_outputs: np.ndarray, stride: int, tau: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return D and s (decisions, p) of exponentials with time constant `tau` (decisions) that begin at each
        decision."""
        states = self._pass(
            backward_inputs,
            trusted_outputs,
            stride,
            -float(np.expm1(-1 / (tau * stride))),
            float(np.exp(-1 / (tau * stride))),
        )
        places = {name: len(kept) for name, (_, kept) in forms(self.filter.n, self.filter.p).items()}
        before = sum(count for name, count in places.items() if name not in ("rr", "v", "w", "r"))
        return states[:, before : before + self.filter.p], states[:, -self.filter.p :]

    def _pass(
        self, backward_inputs: np.ndarray, trusted_outputs: np.ndarray, stride: int, delta: float, rho: float
    ) -> np.ndarray:
        """Run the program and return its states (decisions, states), first decision first; `delta`, `rho`: see its
        module."""
        rows, values = (
            len(backward_inputs),
            {f"trusted.{k}": h for k, h in enumerate(trusted_outputs)} | {"delta": delta, "rho": rho},
        )
        params = np.array([values[name] for name in self.layout.shared_params(self.program)])
        states = np.zeros((rows // stride + 1, len(self.program.states)))
        segments, state = (
            rowwise(np.zeros(rows), np.arange(stride, rows + 1, stride)),
            np.zeros(len(self.program.states)),
        )
        kernel(self.program, self.layout)(segments, state, params, 1, states[1:], held=backward_inputs)
        states = states[::-1]
        return states if np.isfinite(states.sum()) else np.nan_to_num(states, posinf=0.0, neginf=0.0)
