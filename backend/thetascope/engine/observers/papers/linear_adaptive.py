"""Linear adaptive observer: Shen & Hu 2015, eqs. (11)–(12) with ρ = 0, the observer of its reference [5].

    x̂' = A x̂ + γ(x̂, u) + f(x̂, u) θ̂ + K e1        (11)
    θ̂' = λ g(x̂, u) e1                             (12)

for one output y = Cx, C the first state, e1 = y − ŷ. Any plant is A x + γ with γ = f − A x, A the chain of
integrators. The paper's f is the plant's Φ here; g and P come from the matching condition (8), see
matching_condition.py. What the nonsmooth observer (nonsmooth_adaptive.py) shares with it is written here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from thetascope.engine.errors import SpecError
from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.model.plant_model import Model
from thetascope.engine.model.result import CANNOT_TELL, FAILS, HOLDS, Check
from thetascope.engine.observers.forms.matching_condition import closed, direction, find_P, lyapunov_margin
from thetascope.engine.observers.forms.sizes import TooLarge, expanded
from thetascope.engine.observers.support.common_checks import NO_ESTIMATE, stable, verdict
from thetascope.engine.observers.support.declaration import Context, Gain, Observed, Observer
from thetascope.engine.observers.support.draft import Draft, Matrix, ModelAt
from thetascope.engine.observers.support.kalman_defaults import output_scales, pace, typical_sizes
from thetascope.messages import Message

if TYPE_CHECKING:
    from sympy import Expr, Symbol

SOURCE = "Shen & Hu 2015"


def default_K(context: Context) -> list[float]:
    """Return K such that A − KC has the eigenvalues −ω, …, −nω, ω in proportion to the plant's rate.

    For the paper's plant it is about the paper's (3, 2).
    """
    omega = _FAST * pace(context)
    return [float(k) for k in np.poly(-omega * np.arange(1.0, context.n + 1))[1:]]


def default_lambda(context: Context) -> float:
    """Return λ in the units of fault²/output², 10 for the paper's plant. Faults of unlike size share it."""
    sizes = typical_sizes(context) or [1.0]
    return float(10 * np.exp(2 * np.mean(np.log(sizes))) / output_scales(context)[0] ** 2)


_FAST = 14.0  # times the plant's slowest rate

K = Gain("K", Message("gain.injection-k"), default_K, None, size="n", symbol="K")
LAMBDA = Gain(
    "lambda", Message("gain.adaptation-rate"), default_lambda, symbol="λ", unit=Message("unit.fault-per-output-squared")
)


def write(d: Draft) -> None:
    """Write the equations of the observer. Raises SpecError for a plant that is not of the form (1)."""
    x, theta, at, e1 = begin(d)
    d.set(x, at.f + at.Phi @ theta + d.gain("K") * e1)  # (11)
    d.set(theta, d.gain("lambda") * g(at) * e1)  # (12)


def g(at: ModelAt) -> Matrix:
    """Return g = (CΦ)ᵀ (p×1), from (8) with P d = Cᵀ."""
    return at.Phi[0, :].T


def begin(d: Draft) -> tuple[Matrix, Matrix, ModelAt, Expr]:
    """Return x̂, θ̂, the model at them and e1 = y − ŷ. Raises SpecError for a plant that is not of the form (1)."""
    model = d.model
    require(model.time == "continuous", model, Message("observer.reason.discrete"))
    first_state = Message("observer.reason.not-first-state", state=model.states[0])
    require(model.m == 1 and model.h[0] == model.x[0], model, first_state)
    require(d.p > 0, model, Message("observer.reason.no-channel"))
    sensors = [c for c, psi in zip(d.channels, model.Psi(d.channels), strict=True) if psi != 0]
    require(not sensors, model, Message("observer.reason.sensor-fault", names=sensors))
    x, theta = d.estimate_of_state(), d.estimate_of_theta()
    at = d.at(x, theta)
    e1 = d.let("e1", d.measured()[0] - x[0])
    d.estimates(x, theta, [x[0]])
    describe(d, at)
    return x, theta, at, e1


def require(condition: bool, model: Model, why: Message) -> None:
    """Raise SpecError with the reason where the plant is not of the form (1)."""
    if not condition:
        raise SpecError("observers.kind", model.id, Message("observer.matching.form", why=why))


def describe(d: Draft, at: ModelAt) -> None:
    """Add the outputs that the checks need: the direction d, Φ and the Jacobian of γ at x̂."""
    model = d.model
    vector, reason = direction(model, d.channels)
    d.facts["matching"] = reason.as_data() if reason else None
    if vector is not None:
        d.facts["direction"] = [str(e) for e in vector]
        d.outputs("direction", at.matrix(vector))
    d.outputs("Phi", at.Phi)
    gamma = sympy.Matrix(model.f) - sympy.Matrix([*model.x[1:], 0])
    d.outputs("Dgamma", at.matrix(model.jacobian(gamma)))
    d.facts["affine"] = all(model.is_affine)
    flat = model.f.xreplace(model.expansion)
    d.facts["chain"] = all(_adds(flat[i], model.x[i + 1]) for i in range(model.n - 1))


def _adds(e: Expr, x: Symbol) -> bool:
    """Return whether the coefficient of x in an expression is 1; False where it has too many terms to tell."""
    try:
        return expanded(e).coeff(x) == 1
    except TooLarge:
        return False


# ---- the assumptions of Theorem 1 ------------------------------------------------------------------------------------


def checks(run: Observed) -> list[Check]:
    """Check the assumptions on this plant, these gains and this run."""
    k = run.gains("K")
    P = matched(run)
    return [
        chain_check(run),
        stable("A − KC", closed(k), f"{SOURCE}, eq. (6)"),
        matching_check(run, P),
        lyapunov_check(run, P, k),
        one_sided_lipschitz(run),
    ]


def chain_check(run: Observed) -> Check:
    """(1): A the chain of integrators. Another plant fits too, with the difference in γ."""
    chain = run.facts["chain"]
    text = Message("check.chain.complete" if chain else "check.chain.broken")
    return Check(Message("check.chain"), verdict(True if chain else None), text, source=f"{SOURCE}, eq. (1)")


def matched(run: Observed) -> np.ndarray | None:
    """P for the gains of this run."""
    if "direction.0.0" not in run.values:
        return None
    return find_P(run.gains("K"), vector(run))


def vector(run: Observed) -> np.ndarray:
    """Return the direction d of the matching condition, shape (n,)."""
    return np.array([float(np.ravel(run.values[f"direction.{i}.0"])[0]) for i in range(run.context.n)])


def matching_check(run: Observed, P: np.ndarray | None) -> Check:
    """(8), with the residual max |PΦ − Cᵀgᵀ| over the run."""
    name, source = Message("check.matching"), f"{SOURCE}, eq. (8)"
    if "direction.0.0" not in run.values:
        return Check(
            name, FAILS, Message("check.matching.none", why=Message.from_data(run.facts["matching"])), source=source
        )
    if P is None:
        return Check(name, CANNOT_TELL, Message("check.matching.no-p"), source=source)
    Phi = run.matrix("Phi", run.context.n, len(run.channels))
    Phi = Phi[np.isfinite(Phi).all(axis=(1, 2))]
    residual = P @ Phi
    residual[:, 0, :] -= Phi[:, 0, :]
    value = float(np.abs(residual).max(initial=0.0))
    scale = float(np.abs(Phi).max(initial=0.0)) * float(np.abs(P).max())
    text = Message("check.matching.residual", P=str([[float(f"{e:.4g}") for e in row] for row in P]), value=value)
    return Check(name, verdict(value <= 1e-9 * scale), text, value, 1e-9 * scale, source)


def lyapunov_check(run: Observed, P: np.ndarray | None, k: np.ndarray) -> Check:
    """Check (A − KC)ᵀP + P(A − KC) < 0, (6) without its Lipschitz terms."""
    name, source = Message("check.lyapunov"), f"{SOURCE}, eq. (6) without its Lipschitz terms"
    if "direction.0.0" not in run.values:
        return Check(name, FAILS, Message("check.lyapunov.no-matching"), source=source)
    if P is None:
        zeros = np.roots(vector(run)) if run.context.n > 1 else np.array([])
        listed = [f"{z:.4g}" for z in zeros] or ["–"]
        code = "check.lyapunov.no-k" if (np.real(zeros) >= 0).any() else "check.lyapunov.another-k"
        return Check(name, FAILS, Message(code, zeros=listed), source=source)
    value, least = lyapunov_margin(P, k), np.linalg.eigvalsh(P)[0]
    text = Message("check.lyapunov.margin", value=value, least=least)
    return Check(name, HOLDS, text, value, 0.0, source)


def one_sided_lipschitz(run: Observed) -> Check:
    """(3): β1 as the largest eigenvalue of the symmetric part of ∂γ/∂x, along the estimates of this run."""
    n = run.context.n
    D = run.matrix("Dgamma", n, n)
    D = D[np.isfinite(D).all(axis=(1, 2))]
    name, source, affine = Message("check.one-sided-lipschitz"), f"{SOURCE}, eq. (3)", run.facts["affine"]
    if not len(D):
        return Check(name, CANNOT_TELL, NO_ESTIMATE, source=source)
    value = float(np.linalg.eigvalsh((D + D.transpose(0, 2, 1)) / 2).max())
    code = "check.one-sided-lipschitz.affine" if affine else "check.one-sided-lipschitz.undecided"
    return Check(name, verdict(True if affine else None), Message(code, value=value), value, None, source)


OBSERVER = Observer(
    id="linear-adaptive",
    source="Shen & Hu 2015, eqs. (11)–(12) with ρ = 0 (its ref. [5], Gao & Xu 2012)",
    gains=(K, LAMBDA),
    write=write,
    checks=checks,
    equations=(
        ("(11)", "ẋ̂ = Ax̂ + γ(x̂, u) + Φθ̂ + Ke₁"),
        ("(12)", "θ̇̂ = λ g e₁"),
        ("", "e₁ = y − ŷ"),
        ("(8)", "PΦ = Cᵀgᵀ"),
    ),
    where=(
        ("A", Message("symbol.integrator-chain")),
        ("g", Message("symbol.matching-g")),
    ),
)
