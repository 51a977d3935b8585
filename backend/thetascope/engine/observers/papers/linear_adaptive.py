"""Linear adaptive observer: Shen & Hu 2015, eqs. (11)–(12) with ρ = 0, the observer of its reference [5].

    x̂' = A x̂ + γ(x̂, u) + f(x̂, u) θ̂ + K e1        (11)
    θ̂' = λ g(x̂, u) e1                             (12)

for one output y = Cx, C the first state, e1 = y − ŷ. Any plant is A x + γ with γ = f − A x, A the chain of
integrators. The paper's f is the plant's Φ here; g and P come from the matching condition (8), see
matching_condition.py. What the nonsmooth observer (nonsmooth_adaptive.py) shares with it is written here.

States and outputs may have any units, faults too: y = c x1 + c0, and K, λ and g have the units that follow from (11)
and (12), with one λ for each fault. The paper's coordinates, in which its conditions are examined, are z = T x: z1 is y
without its offset, and z_i' = z_(i+1) + …, T being diagonal (`to_chain`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from thetascope.engine.errors import SpecError
from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.model.plant_model import Model
from thetascope.engine.model.result import CANNOT_TELL, FAILS, HOLDS, Check
from thetascope.engine.observers.forms import lipschitz_proof
from thetascope.engine.observers.forms.matching_condition import (
    closed,
    direction,
    find_P,
    lyapunov_margin,
    matched_gains,
    shift,
)
from thetascope.engine.observers.forms.sizes import TooLarge, expanded
from thetascope.engine.observers.support.common_checks import NO_ESTIMATE, stable, verdict
from thetascope.engine.observers.support.declaration import Context, Gain, Observed, Observer
from thetascope.engine.observers.support.dimensions import FAULT_PER_OUTPUT_SQUARED, STATE_PER_OUTPUT_SECOND
from thetascope.engine.observers.support.draft import Draft, Matrix, ModelAt
from thetascope.engine.observers.support.kalman_defaults import output_scales, pace, typical_sizes
from thetascope.engine.observers.support.matrices import column
from thetascope.messages import Message

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Expr, Symbol

SOURCE = "Shen & Hu 2015"


def default_K(context: Context) -> list[float]:
    """Return K such that A − KC has the eigenvalues −ω, …, −nω, ω in proportion to the plant's rate.

    For the paper's plant it is about the paper's (3, 2). Where the matching condition has no P for these eigenvalues,
    they are moved until it has one (`matched_gains`).
    """
    omega = _FAST * pace(context)
    model = Model(context.model)
    values = {s: float(p["value"]) for s, p in zip(model.parameters, model.data["parameters"], strict=True)}
    slopes = [0.0 if e is None else float(e.xreplace(values)) for e in chain_slopes(model)]
    T, wished = to_chain(context, slopes), np.poly(-omega * np.arange(1.0, context.n + 1))[1:]
    d = _direction(context, model, values)
    return [float(k) for k in (wished if d is None else matched_gains(wished, d * T / T[0])) / T]


def _direction(context: Context, model: Model, values: Mapping[Symbol, float]) -> np.ndarray | None:
    """Return the direction d (n,) of the matching condition in the plant's coordinates; None where it has none."""
    if not context.channels:
        return None
    try:
        d, _ = direction(model, context.channels)
    except SpecError:  # a fault that does not enter the first state; the check says so
        return None
    return None if d is None else np.array([float(e.xreplace(values)) for e in d])


def default_lambda(context: Context) -> list[float]:
    """Return λ of each fault, 10 for the paper's plant."""
    return [10 * (size / output_scales(context)[0]) ** 2 for size in typical_sizes(context)]


def chain_slopes(model: Model) -> list[Expr | None]:
    """Return c, and the factor of the next state in each state's rate (n,); None where it is not constant."""
    flat = model.f.xreplace(model.expansion)
    return [output_slope(model), *(_factor(flat[i], model.x[i + 1], model) for i in range(model.n - 1))]


def to_chain(context: Context, slopes: Sequence[float]) -> np.ndarray:
    """Return the diagonal of T (n,) for the numbers of `chain_slopes`, 0 for None.

    A plant without such a factor is not a chain of integrators. Then the median slope along the healthy run takes its
    place, or if that is 0 the scales of both states.
    """
    x, y, omega = context.scales.states, context.scales.outputs[0], _FAST * pace(context)
    along = context.scales.chain or (0.0,) * context.n
    by_scale = [y / x[0], *(omega * x[i] / x[i + 1] for i in range(context.n - 1))]
    return np.cumprod([a or b or c for a, b, c in zip(slopes, along, by_scale, strict=True)])


_FAST = 14.0  # times the plant's slowest rate

K = Gain("K", Message("gain.injection-k"), default_K, None, size="n", symbol="K", unit=STATE_PER_OUTPUT_SECOND)
LAMBDA = Gain(
    "lambda", Message("gain.adaptation-rate"), default_lambda, size="p", symbol="λ", unit=FAULT_PER_OUTPUT_SQUARED
)


def write(d: Draft) -> None:
    """Write the equations of the observer. Raises SpecError for a plant that is not of the form (1)."""
    x, theta, at, e1 = begin(d)
    d.set(x, at.f + at.Phi @ theta + d.gain("K") * e1)  # (11)
    d.set(theta, adaptation(d, at, e1))  # (12)


def adaptation(d: Draft, at: ModelAt, e1: Expr) -> Matrix:
    """Return λ g e1 (p×1) of (12), where g = (CΦ)ᵀ follows from (8) with P d = Cᵀ."""
    g = (at.matrix([output_slope(d.model)])[0] * at.Phi[0, :]).T
    return column([rate * of_channel * e1 for rate, of_channel in zip(d.gain("lambda"), g, strict=True)])


def output_slope(model: Model) -> Expr | None:
    """Return c of y = c x1 + c0, both free of states, inputs, signals and t; None where y is not of this form."""
    h = model.h.xreplace(model.expansion)[0]
    slope = sympy.diff(h, model.x[0])
    constant = slope.free_symbols <= set(model.parameters)
    return slope if constant and slope != 0 and h.free_symbols <= {model.x[0], *model.parameters} else None


def begin(d: Draft) -> tuple[Matrix, Matrix, ModelAt, Expr]:
    """Return x̂, θ̂, the model at them and e1 = y − ŷ. Raises SpecError for a plant that is not of the form (1)."""
    model = d.model
    require(model.time == "continuous", model, Message("observer.reason.discrete"))
    first_state = Message("observer.reason.not-first-state", state=model.states[0])
    require(model.m == 1 and output_slope(model) is not None, model, first_state)
    require(d.p > 0, model, Message("observer.reason.no-channel"))
    sensors = [c for c, psi in zip(d.channels, model.Psi(d.channels), strict=True) if psi != 0]
    require(not sensors, model, Message("observer.reason.sensor-fault", names=sensors))
    x, theta = d.estimate_of_state(), d.estimate_of_theta()
    at = d.at(x, theta)
    e1 = d.let("e1", d.measured()[0] - at.h[0])
    d.estimates(x, theta, at.h)
    describe(d, at)
    return x, theta, at, e1


def require(condition: bool, model: Model, why: Message) -> None:
    """Raise SpecError with the reason where the plant is not of the form (1)."""
    if not condition:
        raise SpecError("observers.kind", model.id, Message("observer.matching.form", why=why))


def describe(d: Draft, at: ModelAt) -> None:
    """Add the outputs that the checks need: the direction d, Φ and the Jacobian of f at x̂."""
    model = d.model
    vector, reason = direction(model, d.channels)
    d.facts["matching"] = reason.as_data() if reason else None
    if vector is not None:
        d.facts["direction"] = [str(e) for e in vector]
        d.outputs("direction", at.matrix(vector))
    d.outputs("Phi", at.Phi)
    d.outputs("Df", at.matrix(model.jacobian(sympy.Matrix(model.f))))
    d.facts["affine"] = all(model.is_affine)
    slopes = chain_slopes(model)
    d.facts["chain"] = None not in slopes
    d.outputs("chain", at.matrix([sympy.S.Zero if e is None else e for e in slopes]))


def _factor(e: Expr, x: Symbol, model: Model) -> Expr | None:
    """Return the constant factor of a term x; None without one, or with too many terms to tell."""
    try:
        factor = expanded(e).coeff(x)
    except TooLarge:
        return None
    return factor if factor != 0 and factor.free_symbols <= set(model.parameters) else None


# ---- the assumptions of Theorem 1 ------------------------------------------------------------------------------------


def checks(run: Observed, rho: float = 0.0) -> list[Check]:
    """Check the assumptions on this plant, these gains and this run; ρ is the share of the nonsmooth injection."""
    k = chain_gains(run)
    P = matched(run)
    d = vector(run) if "direction.0.0" in run.values else None
    return [
        chain_check(run),
        stable("A − KC", closed(k), f"{SOURCE}, eq. (6)"),
        matching_check(run, P),
        lyapunov_check(run, P, k),
        one_sided_lipschitz(run),
        *lipschitz_proof.checks(run, coordinates(run), k, d, rho),
    ]


def chain_check(run: Observed) -> Check:
    """(1): A the chain of integrators. Another plant fits too, with the difference in γ."""
    chain = run.facts["chain"]
    text = Message("check.chain.complete" if chain else "check.chain.broken")
    return Check(Message("check.chain"), verdict(True if chain else None), text, source=f"{SOURCE}, eq. (1)")


def chain_gains(run: Observed) -> np.ndarray:
    """Return K (n,) in the paper's coordinates."""
    return run.gains("K") * coordinates(run)


def coordinates(run: Observed) -> np.ndarray:
    """Return the diagonal of T (n,)."""
    return to_chain(run.context, [_constant(run, f"chain.{i}.0") for i in range(run.context.n)])


def _constant(run: Observed, name: str) -> float:
    return float(np.ravel(run.values[name])[0])


def matched(run: Observed) -> np.ndarray | None:
    """Return P (n×n) for the gains of this run, in the paper's coordinates."""
    if "direction.0.0" not in run.values:
        return None
    return find_P(chain_gains(run), vector(run))


def vector(run: Observed) -> np.ndarray:
    """Return the direction d (n,) of the matching condition, in the paper's coordinates."""
    own, T = np.array([_constant(run, f"direction.{i}.0") for i in range(run.context.n)]), coordinates(run)
    return own * T / T[0]


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
    Phi = Phi[np.isfinite(Phi).all(axis=(1, 2))] * coordinates(run)[:, None] * typical_sizes(run.context)
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
        gains = None
        if code == "check.lyapunov.another-k":
            gains = {"K": [float(g) for g in matched_gains(k, vector(run)) / coordinates(run)]}
        return Check(name, FAILS, Message(code, zeros=listed), source=source, gains=gains)
    value, least = lyapunov_margin(P, k), np.linalg.eigvalsh(P)[0]
    text = Message("check.lyapunov.margin", value=value, least=least)
    return Check(name, HOLDS, text, value, 0.0, source)


def one_sided_lipschitz(run: Observed) -> Check:
    """(3): β1 as the largest eigenvalue of the symmetric part of ∂γ/∂x, along the estimates of this run."""
    n = run.context.n
    D, T = run.matrix("Df", n, n), coordinates(run)
    D = D[np.isfinite(D).all(axis=(1, 2))] * T[:, None] / T - shift(n)
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
