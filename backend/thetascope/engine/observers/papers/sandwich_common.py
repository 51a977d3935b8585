"""What the observers of sandwich systems share: the gain K, the facts, the checks of Zhou & Tan 2012, Theorem 1."""

from __future__ import annotations

import numpy as np

from thetascope.engine.model.plant_model import Model
from thetascope.engine.model.result import CANNOT_TELL, Check
from thetascope.engine.observers.forms.sandwich_parts import Sandwich, blocks, memory_names, refused, sandwich
from thetascope.engine.observers.support.common_checks import stable, verdict
from thetascope.engine.observers.support.declaration import Context, Gain, Observed
from thetascope.engine.observers.support.dimensions import STATE_PER_OUTPUT
from thetascope.engine.observers.support.draft import Draft, Matrix, ModelAt
from thetascope.engine.observers.support.kalman_defaults import output_scales, state_scales
from thetascope.engine.observers.support.matrices import column
from thetascope.messages import Message

SOURCE = "Zhou & Tan 2012"


def corrected(context: Context) -> int:
    """Return the number of states of L1 and L2, which K corrects."""
    return context.n - len(memory_names(context.model))


def corrected_names(context: Context) -> list[str]:
    """Return the names of the states of L1 and L2, in the plant's order."""
    memory = memory_names(context.model)
    return [s["name"] for s in context.model["states"] if s["name"] not in memory]


def default_K(context: Context) -> list[float]:
    """0 on the states of L1, which Theorem 1 asks for, and 0.1 in scaled variables on those of L2, as in the paper."""
    parts = sandwich(Model(context.model))
    x, y = state_scales(context), output_scales(context)[0]
    return [0.0 if i in parts.front else 0.1 * x[i] / y for i in parts.linear_states]


K = Gain(
    "K",
    Message("gain.injection-sandwich"),
    default_K,
    None,
    size=corrected,
    rows=corrected_names,
    symbol="K",
    unit=STATE_PER_OUTPUT,
)


def begin(d: Draft) -> Sandwich:
    """Find the parts of the plant and note them as facts. Raises SpecError where it is not a sandwich system."""
    if d.m != 1:
        raise refused(d.model, Message("observer.reason.sandwich.outputs", outputs=d.m))
    parts = sandwich(d.model)
    d.facts["L1"], d.facts["L2"], d.facts["memory"] = (
        [d.model.states[i] for i in group] for group in (parts.front, parts.back, parts.memory)
    )
    d.facts["operators"] = len(parts.operators)
    return parts


def injection(d: Draft, parts: Sandwich) -> Matrix:
    """Return K with a 0 for each state of the memory (n×1)."""
    gain = dict(zip(parts.linear_states, d.gain("K"), strict=True))
    return column([gain.get(i, 0) for i in range(d.n)])


def describe(d: Draft, parts: Sandwich, at: ModelAt) -> None:
    """Offer the matrices of (11) for the checks."""
    moving = False
    for name, matrix in blocks(d.model, parts).items():
        moving |= bool(matrix.free_symbols & set(d.model.x))
        d.outputs(name, at.matrix(matrix))
    d.facts["linear"] = not moving
    order = parts.linear_states
    d.facts["K1"] = [order.index(i) for i in parts.front]
    d.facts["K2"] = [order.index(i) for i in parts.back]


# ---- the assumptions of Theorem 1 ------------------------------------------------------------------------------------


def bounds(run: Observed) -> list[Check]:
    """Check conditions 1 and 2 of Theorem 1: x1 is bounded, and so is its error at the start. Along one run both are
    numbers: the largest norm of x1, and that of e1 at the first sample."""
    names = run.facts["L1"]
    states = [state["name"] for state in run.context.model["states"]]
    found = []
    conditions = (
        ("check.sandwich-bounds.state", "check.sandwich-bounds.state.norm", 1),
        ("check.sandwich-bounds.start", "check.sandwich-bounds.start.norm", 2),
    )
    for code, said, condition in conditions:
        source = f"{SOURCE}, Theorem 1, condition {condition}"
        if run.truth is None or not names:
            found.append(Check(Message(code), CANNOT_TELL, Message("check.sandwich-bounds.record"), source=source))
            continue
        true = run.truth.x[:, [states.index(name) for name in names]]
        estimated = np.stack([run.values[f"x.{name}"] for name in names], 1)
        norms = np.linalg.norm(true if condition == 1 else estimated[:1] - true[:1], axis=1)
        norms = norms[np.isfinite(norms)]
        value = float(norms.max()) if len(norms) else np.nan
        text = Message(said, value=value)
        found.append(Check(Message(code), verdict(bool(len(norms))), text, value, None, source))
    return found


def linear_checks(run: Observed) -> list[Check]:
    """Check the structure of the plant and conditions 3 and 4 of Theorem 1."""
    A11, A22, C11, C22, _, _ = linear_parts(run)
    K = run.gains("K")
    K1, K2 = K[run.facts["K1"]], K[run.facts["K2"]]
    third, largest = f"{SOURCE}, Theorem 1, condition 3", float(np.abs(K1).max(initial=0.0))
    found = [structure(run, not C11.any())]
    if len(A11):
        found.append(stable("A11", A11, third, discrete=True))
    text = Message("check.k1.largest", value=largest)
    found.append(Check(Message("check.k1"), verdict(largest == 0.0), text, largest, 0.0, third))
    if len(A22):
        closed, fourth = A22 - np.outer(K2, C22), f"{SOURCE}, Theorem 1, condition 4"
        found.append(stable("A22 − K2 C22", closed, fourth, discrete=True))
    return found


def structure(run: Observed, only_back: bool) -> Check:
    """Check that the plant is two linear parts with the hysteresis between,
    and that the output depends on the second alone."""
    linear, front, back = run.facts["linear"], run.facts["L1"], run.facts["L2"]
    text = Message(
        "check.sandwich.parts" if linear else "check.sandwich.parts-nonlinear",
        L1=front or ["–"],
        L2=back if back else Message("check.sandwich.feeds-back"),
        output=Message("check.sandwich.output-l2" if only_back else "check.sandwich.output-l1"),
    )
    found = verdict(bool(back) and only_back and (True if linear else None))
    return Check(Message("check.sandwich"), found, text, source=f"{SOURCE}, eq. (11)")


def rank_check(run: Observed) -> Check:
    """Frozen-time observability of (C, A(k)), below (12): with each operator active alone, and with none."""
    A11, A22, C11, C22, W, X = linear_parts(run)
    n1, n = len(A11), len(A11) + len(A22)
    C = np.hstack([C11, C22])

    def rank(active: list[int]) -> int:
        A = np.zeros((n, n))
        A[:n1, :n1], A[n1:, n1:], A[n1:, :n1] = A11, A22, W[:, active] @ X[active, :]
        rows = [C]
        for _ in range(n - 1):
            rows.append(rows[-1] @ A)
        N = np.vstack([r / (np.linalg.norm(r) or 1.0) for r in rows])
        return int(np.linalg.matrix_rank(N, tol=1e-10)) if np.isfinite(N).all() else 0

    operators = range(run.facts["operators"])
    least, none = min(rank([i]) for i in operators), rank([])
    code = "check.operator-rank.found" if none == n else "check.operator-rank.blind"
    text = Message(code, rank=least, states=n, without=none)
    name, source = Message("check.operator-rank"), f"{SOURCE}, section 3"
    return Check(name, verdict(least == n), text, float(least), float(n), source)


def linear_parts(run: Observed) -> tuple[np.ndarray, ...]:
    """A11, A22, C11, C22, W, X as numbers."""
    n1, n2, q = len(run.facts["L1"]), len(run.facts["L2"]), run.facts["operators"]
    sizes = {"A11": (n1, n1), "A22": (n2, n2), "C11": (1, n1), "C22": (1, n2), "W": (n2, q), "X": (q, n1)}
    return tuple(part(run, name, *size) for name, size in sizes.items())


def part(run: Observed, name: str, rows: int, cols: int) -> np.ndarray:
    """A block of (11) at the last finite estimate."""
    values = run.matrix(name, rows, cols)
    finite = np.flatnonzero(np.isfinite(values).all(axis=(1, 2)))
    return values[finite[-1]] if len(finite) else np.full((rows, cols), np.nan)
