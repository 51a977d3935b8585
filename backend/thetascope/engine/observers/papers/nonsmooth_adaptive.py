"""Continuous nonsmooth adaptive observer: Shen & Hu 2015, eqs. (11)–(12).

    x̂' = A x̂ + γ(x̂, u) + f(x̂, u) θ̂ + K e1 + ρ F(e1),   F_i = k_i ⌊e1⌉^{α_i},   α_i = iα − (i − 1)    (11)
    θ̂' = λ g(x̂, u) e1                                                                              (12)

for the plants of linear_adaptive.py, its baseline ρ = 0. ⌊e⌉^α = |e|^α sign e. A power of an output has another unit
than the output, so F is taken of e1/e0 and multiplied by e0, an error of the output's size; e0 = 1 in the paper.

In print "k = KC" means k = K, and "0 < α < 1 − 1/(n−1)", which is empty for n = 2, is read 1 − 1/n < α < 1: then all
exponents are positive. The option form "paper-example" writes the observer of the paper's section 3 as printed
there: without γ, with the exponent 2α − 1 in both lines and ρ² for ρ k2. It is not a case of (11), and its numbers
belong to the paper's units.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from thetascope.engine.language.lazy_sympy import functions
from thetascope.engine.model.result import FAILS, Check
from thetascope.engine.observers.forms.matching_condition import closed
from thetascope.engine.observers.papers.linear_adaptive import (
    LAMBDA,
    SOURCE,
    K,
    adaptation,
    begin,
    chain_gains,
    matched,
    require,
)
from thetascope.engine.observers.papers.linear_adaptive import checks as shared_checks
from thetascope.engine.observers.support.common_checks import verdict
from thetascope.engine.observers.support.declaration import Context, Gain, Observed, Observer, Option
from thetascope.engine.observers.support.dimensions import OUTPUT
from thetascope.engine.observers.support.draft import Draft
from thetascope.engine.observers.support.kalman_defaults import output_scales
from thetascope.engine.observers.support.matrices import Matrix, column
from thetascope.messages import Message

if TYPE_CHECKING:
    from sympy import Expr

GENERAL, PAPER_EXAMPLE = "general", "paper-example"


def default_alpha(context: Context) -> float:
    """Return an exponent inside 1 − 1/n < α < 1."""
    return 1 - 0.3 / context.n


GAINS = (
    K,
    LAMBDA,
    Gain("rho", Message("gain.nonsmooth-share"), 0.8, symbol="ρ"),
    Gain(
        "alpha",
        Message("gain.nonsmooth-exponent"),
        default_alpha,
        0.0,
        1.0,
        symbol="α",
    ),
    Gain(
        "e0",
        Message("gain.nonsmooth-error"),
        lambda context: output_scales(context)[0],
        positive=True,
        symbol="e₀",
        unit=OUTPUT,
    ),
)
FORM = Option("form", Message("option.form"), "choice", GENERAL, (GENERAL, PAPER_EXAMPLE))


def F(k: Matrix, alpha: Expr, e0: Expr, e1: Expr) -> Matrix:
    """Return the homogeneous injection F (n×1), defined below (12), in units of e0."""
    powers = [functions.SignedPower(e1 / e0, i * alpha - (i - 1)) for i in range(1, len(k) + 1)]
    return column([k[i] * e0 * power for i, power in enumerate(powers)])


def write(d: Draft) -> None:
    """Write the equations of the observer. Raises SpecError for a plant that is not of the form (1)."""
    x, theta, at, e1 = begin(d)
    K, rho, alpha = d.gain("K"), d.gain("rho"), d.gain("alpha")
    form = d.facts["form"] = d.options.get("form", GENERAL)

    if form == PAPER_EXAMPLE:
        dx = paper_example(d, x, at.Phi @ theta, e1)
    else:
        dx = at.f + at.Phi @ theta + K * e1 + rho * F(K, alpha, d.gain("e0"), e1)  # (11)
    d.set(x, dx)
    d.set(theta, adaptation(d, at, e1))  # (12)


def paper_example(d: Draft, x: Matrix, w_theta: Matrix, e1: Expr) -> Matrix:
    """Return x̂' of section 3 as printed (2×1). Its wθ̂, printed twice with a comma between, is taken once."""
    require(d.n == 2, d.model, Message("observer.reason.two-states", states=d.n, form=GENERAL))
    K, rho = d.gain("K"), d.gain("rho")
    power = functions.SignedPower(e1, 2 * d.gain("alpha") - 1)
    dx1 = x[1] + K[0] * e1 + K[0] * rho * power + w_theta[0]
    dx2 = w_theta[1] + K[1] * e1 + rho**2 * power
    return column([dx1, dx2])


# ---- the assumptions of Theorem 1 ------------------------------------------------------------------------------------


def checks(run: Observed) -> list[Check]:
    """Check the assumptions of Theorems 1 and 2."""
    return [*shared_checks(run, run.gain("rho")), exponent_check(run), as_printed(run)]


def exponent_check(run: Observed) -> Check:
    """Check 1 − 1/n < α < 1, the reading of the print in which all exponents are positive."""
    n, alpha = run.context.n, run.gain("alpha")
    exponents = [f"{i * alpha - (i - 1):.4g}" for i in range(1, n + 1)]
    code = "check.alpha.exponents" if run.facts["form"] == GENERAL else "check.alpha.exponents-printed"
    text = Message(code, alpha=alpha, count=n, exponents=exponents)
    low, source = 1 - 1 / n, f"{SOURCE}, below (12), read so that all exponents are positive"
    return Check(Message("check.alpha"), verdict(low < alpha < 1), text, alpha, low, source)


def as_printed(run: Observed) -> Check:
    """Check (6) with the constants that the proof prints (l1 = 0, γ = 0: its most favourable case)."""
    name, source = Message("check.as-printed"), f"{SOURCE}, eq. (6) and the proof of Theorem 1"
    P, k = matched(run), chain_gains(run)
    if P is None:
        return Check(name, FAILS, Message("check.lyapunov.no-matching"), source=source)
    spectrum = np.linalg.eigvalsh(P)
    c2 = float(k.max() * np.sqrt(len(k) * spectrum[-1] / spectrum[0]))
    rate = -float(np.max(np.linalg.eigvals(np.linalg.solve(P, closed(k).T @ P + P @ closed(k))).real))
    required = 2 * c2 + 1
    text = Message("check.as-printed.rate", rate=rate, required=required)
    return Check(name, verdict(rate > required), text, rate, required, source)


OBSERVER = Observer(
    id="nonsmooth-adaptive",
    source="Shen & Hu 2015, eqs. (11)–(12)",
    gains=GAINS,
    write=write,
    checks=checks,
    options=(FORM,),
    equations=(
        ("(11)", "ẋ̂ = Ax̂ + γ(x̂, u) + Φθ̂ + Ke₁ + ρF(e₁)"),
        ("(12)", "θ̇̂ = λ g e₁"),
        ("", "Fᵢ(e₁) = kᵢ|e₁|^{αᵢ} sgn(e₁)"),
        ("", "αᵢ = iα − (i − 1)"),
        ("", "e₁ = y − ŷ"),
        ("(8)", "PΦ = Cᵀgᵀ"),
    ),
    where=(
        ("F", Message("symbol.nonsmooth-injection")),
        ("A", Message("symbol.integrator-chain")),
        ("g", Message("symbol.matching-g")),
    ),
)
