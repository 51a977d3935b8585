"""The constants of Shen & Hu 2015 in numbers, and the inequalities (6), (7) and (10) of its Theorems 1 and 2.

Along the run, and at random points of the plant's physical domain where it declares one, G = ∂γ/∂x is evaluated in the
paper's coordinates. γ(x) − γ(x̂) = G e with a mean G of the segment, so that

    (3)  β1 = max λmax(sym G),    ‖Ge‖² ≤ β2 ‖e‖² + β3 eᵀGe  for  β2 = max λmax(GᵀG − β3 sym G),
    (4)  M ≥ 0 with M ≥ sym(PG) for each G; M = m P with m the largest m of det(sym(PG) − mP) = 0 is one.

A maximum over points is a lower bound of the constant; only where γ is affine in the state is it the constant.

In the proof, the term −2ρ eᵀPF is bounded by 2c2 eᵀPe, where 2ρ c2 is enough: the factor ρ is lost, and (6) and (7)
hold for no K. With c the largest number for which (A − KC)ᵀP + P(A − KC) ≤ −cP, n c ≤ 2 k1 by the trace of A − KC,
while 2 c2 = 2 max|k| √(n λmax(P)/λmin(P)) ≥ 2 k1 √n. Here ρ is kept. Then 2ρ c2 ≥ ρ n√n c, so that ρ < 1/(n√n) is
necessary; c is below twice the rate of the slowest zero of d (`fastest_rate`), and with γ = Gx below that of the
slowest zero of C(sI − A − G)⁻¹d. These tell where no K can meet an inequality; where one can, `gains_by_lmi` seeks it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from thetascope.engine.model.result import CANNOT_TELL, FAILS, Check
from thetascope.engine.observers.forms.gains_by_lmi import Demand, Design, design, excess, proof, rate, usable
from thetascope.engine.observers.forms.matching_condition import fastest_rate, matched_Ps, shift
from thetascope.engine.observers.support.common_checks import NO_ESTIMATE, verdict
from thetascope.engine.observers.support.declaration import Observed
from thetascope.engine.observers.support.kalman_defaults import state_scales, typical_sizes
from thetascope.messages import Message

SOURCE = "Shen & Hu 2015"
_POINTS = 200  # rows, and points of the domain
_DIFFERENCE = 1e-5  # of a state's scale: half the distance of a central difference


@dataclass(frozen=True)
class Constants:
    """Lower bounds of the constants: of γ over `G` (points, n×n), of f (l1) and of θ (l2)."""

    G: np.ndarray
    beta1: float
    beta2: float
    beta3: float
    l1: float
    l2: float
    points: int
    domain: bool  # points of the plant's domain are among them


def constants(run: Observed, T: np.ndarray) -> Constants | None:
    """Return the constants in the paper's coordinates T x; None without a finite estimate."""
    n = run.context.n
    D = run.matrix("Df", n, n)
    finite = np.flatnonzero(np.isfinite(D).all(axis=(1, 2)))
    if not len(finite):
        return None
    rows = finite[np.unique(np.linspace(0, len(finite) - 1, _POINTS).astype(int))]
    inside = _in_domain(run, rows)
    G = np.concatenate([D[rows], inside]) * T[:, None] / T - shift(n)
    beta1 = float(np.linalg.eigvalsh((G + G.transpose(0, 2, 1)) / 2).max())
    beta2, beta3 = _inner_bound(G, beta1)
    theta = [np.asarray(run.values[f"theta.{c}"]) for c in run.channels] if run.truth is None else run.truth.theta.T
    sizes = np.reshape(typical_sizes(run.context), (-1, 1))
    known = np.linalg.norm(np.array(theta) / sizes, axis=0)
    l2 = float(np.max(known, where=np.isfinite(known), initial=0.0))
    return Constants(G, beta1, beta2, beta3, _slope_of_faults(run, rows, T), l2, len(G), bool(len(inside)))


def _inner_bound(G: np.ndarray, beta1: float) -> tuple[float, float]:
    """Return β2 and β3 ≥ 0 with the least β1 β3 + β2, the sum that (6) has; it is convex in β3."""
    squares, symmetric = G.transpose(0, 2, 1) @ G, (G + G.transpose(0, 2, 1)) / 2

    def beta2(beta3: float) -> float:
        return float(np.linalg.eigvalsh(squares - beta3 * symmetric)[:, -1].max())

    most = 2 * float(np.linalg.norm(G, 2, axis=(1, 2)).max())
    if most == 0:
        return 0.0, 0.0
    found = minimize_scalar(
        lambda b: beta1 * b + beta2(b), bounds=(0.0, most), method="bounded", options={"maxiter": 25}
    )
    best = float(found.x) if found.fun < beta2(0.0) else 0.0
    return beta2(best), best


def _in_domain(run: Observed, rows: np.ndarray) -> np.ndarray:
    """Return ∂f/∂x at random points of the domain, with the inputs of these rows; none without a bounded domain."""
    n, states = run.context.n, run.context.model["states"]
    ends = [state.get("domain") or (None, None) for state in states]
    if run.probe is None or not all(isinstance(end, int | float) for pair in ends for end in pair):
        return np.empty((0, n, n))
    low, high = np.array(ends, dtype=float).T
    points = low + (high - low) * np.random.default_rng(1).random((len(rows), n))
    values = run.at(rows).values | {f"xh.{s['name']}": points[:, i] for i, s in enumerate(states)}
    names = [f"Df.{i}.{j}" for i in range(n) for j in range(n)]
    found = np.asarray(run.probe(names, values)).T.reshape(-1, n, n)
    return found[np.isfinite(found).all(axis=(1, 2))]


def _slope_of_faults(run: Observed, rows: np.ndarray, T: np.ndarray) -> float:
    """Return l1, the norm of ∂f/∂x of the paper's f, Φ here, for faults of typical size."""
    n, p = run.context.n, len(run.channels)
    if run.probe is None:
        return 0.0
    some, sizes = run.at(rows), np.array(typical_sizes(run.context))
    names = [f"Phi.{i}.{j}" for i in range(n) for j in range(p)]
    slopes = []
    for i, (state, scale) in enumerate(zip(run.context.model["states"], state_scales(run.context), strict=True)):
        name, step = f"xh.{state['name']}", _DIFFERENCE * scale
        sides = (run.probe(names, some.values | {name: some.values[name] + side}) for side in (step, -step))
        above, below = (np.asarray(side) for side in sides)
        slope = ((above - below) / (2 * step * T[i])).reshape(n, p, -1) * T[:, None, None] * sizes[:, None]
        slopes.append(slope.reshape(n * p, -1))
    table = np.moveaxis(np.array(slopes), 2, 0)  # (rows, n, n·p)
    table = table[np.isfinite(table).all(axis=(1, 2))]
    return float(np.linalg.norm(table, 2, axis=(1, 2)).max(initial=0.0))


# ---- the checks ------------------------------------------------------------------------------------------------------


def checks(run: Observed, T: np.ndarray, k: np.ndarray, d: np.ndarray | None, rho: float) -> list[Check]:
    """Check the inner bound of γ, (6) of Theorem 1, and (7) and (10) of Theorem 2, for gains k and the direction d."""
    found = constants(run, T)
    return [_inner_check(run, found), _theorem1(run, found, T, k, d, rho), _theorem2(run, found, T, k, d, rho)]


def _inner_check(run: Observed, found: Constants | None) -> Check:
    name, source = Message("check.inner-bound"), f"{SOURCE}, Theorem 1"
    if found is None:
        return Check(name, CANNOT_TELL, NO_ESTIMATE, source=source)
    affine = run.facts["affine"]
    code = "check.inner-bound.affine" if affine else "check.inner-bound.sampled"
    args = {"beta1": found.beta1, "beta2": found.beta2, "beta3": found.beta3, "points": found.points}
    where = Message("check.inner-bound.domain" if found.domain else "check.inner-bound.run")
    text = Message(code, **args, where=where)
    return Check(name, verdict(True if affine else None), text, found.beta2, None, source)


@dataclass(frozen=True)
class _Trial:
    """One P with its rate c, what an inequality asks c to exceed, and the parts of that."""

    one: Design
    rate: float
    parts: tuple[float, float, float]  # of the faults, of the injection, of γ

    @property
    def needed(self) -> float:
        return sum(self.parts) + 1

    @property
    def excess(self) -> float:
        return self.rate - self.needed


def _demand(found: Constants, rho: float, theorem: int) -> Demand:
    """Return what (6), or (7), asks for, with 2ρ c2 in the place of 2 c2."""
    of_gamma, none = found.beta1 * found.beta3 + found.beta2 + 1, found.G[:0]
    faults = 2 * found.l1 * found.l2
    return Demand(1.0, faults, of_gamma, none, rho) if theorem == 1 else Demand(1.0, faults, 0.0, found.G, rho)


def _trial(one: Design, demand: Demand) -> _Trial:
    """Return the trial of K, P and M; what 2M takes from c stands for 2M."""
    K, P = one.K, one.P
    spectrum = np.linalg.eigvalsh(P)
    condition = float(spectrum[-1] / spectrum[0])
    injection = demand.rate(condition, float(np.abs(K).max()), len(K)) - demand.rate(condition, 0.0, len(K))
    plain = rate(K, P)
    of_gamma = demand.shared * condition + (plain - rate(K, P, one.M) if len(demand.G) else 0.0)
    return _Trial(one, plain, (demand.faults * float(np.sqrt(condition)), injection, of_gamma))


def _best(k: np.ndarray, d: np.ndarray, demand: Demand) -> _Trial:
    """Return the P and M with the largest excess: those of the Riccati equations with M = mP, or of the LMI."""
    known = [Design(k, P, quasi_one_sided(P, demand.G) * P) for P in _usable(k, d)]
    best = max((_trial(one, demand) for one in known), key=lambda trial: trial.excess)
    if best.excess > 0:
        return best
    further = (_trial(one, demand) for one in proof(k, d, demand))
    return max((best, *further), key=lambda trial: trial.excess)


def designed_gains(d: np.ndarray, found: Constants, rho: float, theorem: int) -> np.ndarray | None:
    """Return a K (n,) in the paper's coordinates that meets (6) or (7) with these constants; None if none was found."""
    demand = _demand(found, rho, theorem)
    one = design(d, demand)
    if one is None:
        return None
    K = np.array([float(f"{k:.4g}") for k in one.K])  # as it is shown; the design's margin covers the digits left out
    return K if excess(Design(K, one.P, one.M), demand) > 0 else one.K


def _theorem1(
    run: Observed, found: Constants | None, T: np.ndarray, k: np.ndarray, d: np.ndarray | None, rho: float
) -> Check:
    """(6) with 2ρ c2 in the place of 2 c2."""
    name, source = Message("check.shen-theorem1"), f"{SOURCE}, Theorem 1, eq. (6) with the factor ρ"
    refused = _refused(name, source, found, T, k, d, rho, 1)
    if refused is not None or found is None or d is None:
        return refused or Check(name, CANNOT_TELL, NO_ESTIMATE, source=source)
    demand = _demand(found, rho, 1)
    best = _best(k, d, demand)
    change, gains = _change(best, demand.fixed + demand.faults + demand.shared, found, T, d, rho, 1)
    args = {"faults": best.parts[0], "injection": best.parts[1], "gamma": best.parts[2]}
    text = Message("check.shen-theorem1.numbers", **_shown(best, change), **args)
    return Check(name, _met(run, found, best), text, best.rate, best.needed, source, gains)


def _theorem2(
    run: Observed, found: Constants | None, T: np.ndarray, k: np.ndarray, d: np.ndarray | None, rho: float
) -> Check:
    """(4) with the M that takes least of the rate, (7) with 2ρ c2, and (10), which has (1 + ρ)K."""
    name, source = Message("check.shen-theorem2"), f"{SOURCE}, Theorem 2, eqs. (4), (7) with the factor ρ, and (10)"
    refused = _refused(name, source, found, T, k, d, rho, 2)
    if refused is not None or found is None or d is None:
        return refused or Check(name, CANNOT_TELL, NO_ESTIMATE, source=source)
    demand = _demand(found, rho, 2)
    best = _best(k, d, demand)
    ten = rate((1 + rho) * k, best.one.P, best.one.M) + best.parts[2] - best.needed
    change, gains = _change(best, demand.fixed + demand.faults, found, T, d, rho, 2)
    args = {"faults": best.parts[0], "injection": best.parts[1], "taken": best.parts[2], "ten": ten}
    text = Message("check.shen-theorem2.numbers", **_shown(best, change), **args)
    return Check(name, _met(run, found, best), text, best.rate, best.needed, source, gains)


def quasi_one_sided(P: np.ndarray, G: np.ndarray) -> float:
    """Return the least m ≥ 0 with eᵀPGe ≤ m eᵀPe for all G (points, n×n): M = m P of (4)."""
    half = np.linalg.inv(np.linalg.cholesky(P))
    of_P = half @ (P @ G + (P @ G).transpose(0, 2, 1)) @ half.T / 2
    return float(np.linalg.eigvalsh(of_P)[:, -1].max(initial=0.0))


def _refused(
    name: Message,
    source: str,
    found: Constants | None,
    T: np.ndarray,
    k: np.ndarray,
    d: np.ndarray | None,
    rho: float,
    theorem: int,
) -> Check | None:
    """Return the check's result where there is no P or no estimate, with gains that meet it where there are some."""
    if found is None:
        return Check(name, CANNOT_TELL, NO_ESTIMATE, source=source)
    if d is None:
        return Check(name, FAILS, Message("check.lyapunov.no-matching"), source=source)
    if not matched_Ps(k, d):
        text, gains = _proposed(found, T, d, rho, theorem) or (Message("check.lyapunov.no-matching"), None)
        return Check(name, FAILS, text, source=source, gains=gains)
    if not _usable(k, d):
        return Check(name, CANNOT_TELL, Message("check.shen-theorem.rounding"), source=source)
    return None


def _proposed(
    found: Constants, T: np.ndarray, d: np.ndarray, rho: float, theorem: int, short: float | None = None
) -> tuple[Message, dict[str, list[float]]] | None:
    """Return gains that meet (6) or (7), in the plant's coordinates, and the sentence on them; None without any."""
    K = designed_gains(d, found, rho, theorem)
    if K is None:
        return None
    own = [float(k) for k in K / T]
    shown = [f"{k:.5g}" for k in own]
    if short is None:
        return Message("check.shen-theorem.no-p", K=shown), {"K": own}
    return Message("check.shen-theorem.this-k", short=short, K=shown), {"K": own}


def _usable(k: np.ndarray, d: np.ndarray) -> list[np.ndarray]:
    """Return the P whose eigenvalues are not lost in rounding."""
    return [P for P in matched_Ps(k, d) if usable(P)]


def _shown(best: _Trial, change: Message) -> dict:
    return {"rate": best.rate, "needed": best.needed, "change": change}


def _change(
    best: _Trial, floor: float, found: Constants, T: np.ndarray, d: np.ndarray, rho: float, theorem: int
) -> tuple[Message, dict[str, list[float]] | None]:
    """Return what to change where the best P is not enough, and gains that are.

    c (1 − ρ n√n) > floor is necessary for every K and P.
    """
    ceiling, share = _ceiling(found, d, theorem), 1 - rho * len(d) ** 1.5
    if best.excess > 0:
        return Message("check.shen-theorem.met"), None
    if share <= 0:
        return Message("check.shen-theorem.rho", rho=rho, most=len(d) ** -1.5), None
    if share * ceiling <= floor:
        return Message("check.shen-theorem.no-k", floor=floor / share, ceiling=ceiling), None
    other = _proposed(found, T, d, rho, theorem, -best.excess)
    return other or (Message("check.shen-theorem.another-k", short=-best.excess), None)


def _ceiling(found: Constants, d: np.ndarray, theorem: int) -> float:
    """Return the rate that no K and P reach: that of the zeros of d, and for (7) those of A + G, for each G."""
    if theorem == 1 or len(d) == 1:
        return fastest_rate(d)
    N = np.eye(len(d))
    N[1:, 0] = -d[1:]
    inverse = 2 * np.eye(len(d)) - N
    zeros = np.linalg.eigvals((N @ (shift(len(d)) + found.G) @ inverse)[:, 1:, 1:])
    return min(fastest_rate(d), max(-2 * float(zeros.real.max()), 0.0))


def _met(run: Observed, found: Constants, best: _Trial):
    """Constants along a run are lower bounds: enough for them is not enough everywhere, unless γ is affine."""
    if best.excess <= 0:
        return verdict(False)
    return verdict(True if run.facts["affine"] and found.l1 == 0 else None)
