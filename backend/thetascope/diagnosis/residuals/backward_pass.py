"""The evidence that is still to come from every decision on: the backward pass of engine/estimation/backward_information.py along rows."""

from dataclasses import dataclass

import numpy as np

from thetascope.diagnosis.residuals.innovation_filter import InnovationFilter, rowwise
from thetascope.engine.compiler.jit import Layout, kernel
from thetascope.engine.estimation.backward_information import SYMMETRIC, forms, onsets, parts


@dataclass(frozen=True)
class FutureInformation:
    """The evidence still to come at each decision (the first axis): the blocks of M and μ of engine/estimation/backward_information.py.

    J and s of a step that begins there are ``ww`` (p × p) and ``w`` (p), of a rise ``rr`` and ``r`` (p, each channel alone).
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
        """D (the diagonal of J) and s of what follows decisions ``k`` if V (k × n × p) and course w (k × p) are there, and w stays."""
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
        """Have the kernels at hand: compiling one takes up to a second."""
        kernel(self.filter.program, self.input_layout)
        kernel(self.program, self.layout)

    def backward_inputs(
        self, state: np.ndarray, held: np.ndarray, t: np.ndarray, trusted_outputs: np.ndarray
    ) -> np.ndarray:
        """What `future_information` takes, along rows of which the filter is given ``held`` (`Filter.held`)."""
        backward_inputs, out = np.empty((len(t), 1, len(self.program.inputs))), np.empty((len(t), len(state)))
        kernel(self.filter.program, self.input_layout)(
            rowwise(t), state.copy(), self.filter.params(trusted_outputs), 1, out, held=held, emitted=backward_inputs
        )
        return backward_inputs[::-1, 0].copy()

    def future_information(
        self, backward_inputs: np.ndarray, trusted_outputs: np.ndarray, stride: int
    ) -> FutureInformation:
        """What is still to come at every ``stride``-th row, the first and the end of the last included."""
        found, place, blocks = self._pass(backward_inputs, trusted_outputs, stride, 1.0 / stride, 1.0), 0, {}
        for name, (shape, kept) in forms(self.filter.n, self.filter.p).items():
            entries = tuple(np.array(kept).T)
            block = blocks[name] = np.zeros((len(found), *shape))
            block[(slice(None), *entries)] = found[:, place : place + len(kept)]
            if name in SYMMETRIC:
                block[(slice(None), *entries[::-1])] = found[:, place : place + len(kept)]
            place += len(kept)
        return FutureInformation(**blocks)

    def exponential_rises(
        self, backward_inputs: np.ndarray, trusted_outputs: np.ndarray, stride: int, tau: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """D and s (each times × p) of rises that bend to their end within ``tau`` decisions, from the same rows on."""
        found = self._pass(
            backward_inputs,
            trusted_outputs,
            stride,
            -float(np.expm1(-1 / (tau * stride))),
            float(np.exp(-1 / (tau * stride))),
        )
        places = {name: len(kept) for name, (_, kept) in forms(self.filter.n, self.filter.p).items()}
        before = sum(count for name, count in places.items() if name not in ("rr", "v", "w", "r"))
        return found[:, before : before + self.filter.p], found[:, -self.filter.p :]

    def _pass(
        self, backward_inputs: np.ndarray, trusted_outputs: np.ndarray, stride: int, delta: float, rho: float
    ) -> np.ndarray:
        rows, values = (
            len(backward_inputs),
            {f"heed.{k}": h for k, h in enumerate(trusted_outputs)} | {"delta": delta, "rho": rho},
        )
        params = np.array([values[name] for name in self.layout.shared_params(self.program)])
        found = np.zeros((rows // stride + 1, len(self.program.states)))
        segments, state = (
            rowwise(np.zeros(rows), np.arange(stride, rows + 1, stride)),
            np.zeros(len(self.program.states)),
        )
        kernel(self.program, self.layout)(segments, state, params, 1, found[1:], held=backward_inputs)
        return found[::-1] if np.isfinite(found.sum()) else np.nan_to_num(found[::-1], posinf=0.0, neginf=0.0)
