"""Theorems 1 and 2 of Shen & Hu 2015 in numbers: the P there are, what (6) and (7) ask for, a K that meets (7)."""

import numpy as np
import pytest
import scipy.linalg

from tests.simulate import simulate
from thetascope import library
from thetascope.engine.observers.forms.lipschitz_proof import Constants, designed_gains, quasi_one_sided
from thetascope.engine.observers.forms.matching_condition import closed, fastest_rate, matched_gains, matched_Ps
from thetascope_schemas import Experiment

NOTHING = Constants(np.zeros((1, 2, 2)), 0.0, 0.0, 0.0, 0.0, 0.0, 1, False)


def rate(P, K):
    """Return the largest c with (A − KC)ᵀP + P(A − KC) ≤ −cP."""
    matrix = closed(K).T @ P + P @ closed(K)
    return -np.linalg.eigvals(np.linalg.solve(P, matrix)).real.max()


def test_each_P_is_matched_and_none_is_faster_than_the_zeros_of_d():
    """60 random K and d: P d = Cᵀ, P > 0, and rates up to near the largest that the zeros and the poles allow."""
    rng, fast = np.random.default_rng(3), 0
    for _ in range(60):
        n = int(rng.integers(2, 5))
        d = np.poly(-rng.uniform(0.5, 3, n - 1))
        K = matched_gains(np.poly(-rng.uniform(1, 5, n))[1:], d)
        found = matched_Ps(K, d)
        rates = [rate(P, K) for P in found]
        for P in found:
            assert P @ d == pytest.approx(np.eye(n)[0], abs=1e-7) and np.linalg.eigvalsh(P)[0] > 0
        assert min(rates) > 0 and max(rates) < fastest_rate(d)
        fast += len(found) > 3
    assert fast > 20


def test_the_printed_inequality_holds_for_no_gains():
    """(6) and (7) ask for c > 2 c2 with c2 ≥ k1 √n; n c ≤ 2 k1. With ρ kept, 2ρ c2 ≥ ρ n√n c. Any P, matched or not."""
    rng = np.random.default_rng(5)
    for _ in range(300):
        n = int(rng.integers(2, 6))
        K = np.poly(-(10 ** rng.uniform(-1, 1, n)))[1:]
        P = scipy.linalg.solve_continuous_lyapunov(closed(K).T, -np.diag(10 ** rng.uniform(-2, 2, n)))
        spectrum = np.linalg.eigvalsh(P)
        c, c2 = rate(P, K), np.abs(K).max() * np.sqrt(n * spectrum[-1] / spectrum[0])
        assert n * c <= 2 * K[0] * (1 + 1e-6) and c < 2 * c2
        assert 2 * c2 >= n**1.5 * c * (1 - 1e-6)


def test_M_bounds_the_nonlinearity_in_the_norm_of_P():
    """m is the least with eᵀPGe ≤ m eᵀPe: reached, and exceeded by no e."""
    rng = np.random.default_rng(8)
    root = rng.normal(size=(3, 3))
    P, G = root @ root.T + np.eye(3), rng.normal(size=(20, 3, 3))
    m = quasi_one_sided(P, G)
    e = rng.normal(size=(20000, 3))
    quotient = np.einsum("ki,ij,gjl,kl->gk", e, P, G, e) / np.einsum("ki,ij,kj->k", e, P, e)
    assert quotient.max() <= m and quotient.max() > 0.9 * m
    assert quasi_one_sided(P, -np.eye(3)[None]) == 0.0


def test_gains_for_theorem_2_exist_where_the_zeros_are_fast_enough():
    """Without γ, (7) at ρ = 0 asks for c > 1: a zero faster than 1/2 is enough."""
    for zero, possible in ((0.4, False), (0.6, True), (3.0, True), (-1.0, False)):
        K = designed_gains(np.array([1.0, zero]), NOTHING, 0.0, 2)
        assert (K is not None) == possible
        assert K is None or max(rate(P, K) for P in matched_Ps(K, (1.0, zero))) > 1


def example(K):
    """Return a run of the paper's plant with the linear observer, without noise."""
    spec = library.experiment("shen-hu-2015-noise-free")
    observer = next(o for o in spec.observers if o.label == "linear")
    observer = observer.model_copy(update={"gains": observer.gains | {"K": K}})
    return simulate(library.resolve(spec.model_copy(update={"observers": [observer], "figures": (), "horizon": 20.0})))


def shown(run, name):
    return next(c for c in run.observers[0].checks if str(c.name).startswith(name))


def test_the_proposed_gains_meet_theorem_2_and_V_falls():
    """The paper's K meets (7) with ρ = 0, (1.2, 1) misses it; the K proposed then meets it, and eᵀPe + θ̃²/λ falls."""
    paper = shown(example([3, 2]), "Theorem 2")
    assert paper.verdict == "cannot tell" and paper.value > paper.threshold and paper.gains is None
    check = shown(example([1.2, 1]), "Theorem 2")
    assert check.verdict == "fails" and check.value < check.threshold and "meets it" in str(check.text)
    assert check.gains is not None
    proposed = shown(example(check.gains["K"]), "Theorem 2")
    assert proposed.verdict == "cannot tell" and proposed.value > proposed.threshold and proposed.gains is None
    run = example([5, 4])
    check = shown(run, "Theorem 2")
    assert check.verdict == "cannot tell" and check.value > check.threshold and "met" in str(check.text)
    e = np.array([run.column(f"x.{s}") - run.column(f"linear.x.{s}") for s in ("x1", "x2")])
    theta = run.column("theta.theta") - run.column("linear.theta.theta")
    K, G = np.array([5.0, 4.0]), 0.14 * np.eye(2)
    P = max(matched_Ps(K, (1.0, 1.0)), key=lambda P: rate(P, K) - 2 * quasi_one_sided(P, G[None]))
    V = np.einsum("it,ij,jt->t", e, P, e) + theta**2 / 10
    assert (np.diff(V) <= 1e-9 * V[0]).all() and V[-1] < 1e-5 * V[0]


def test_no_gains_help_where_rho_or_the_zeros_forbid():
    """ρ = 0.8 is above 1/(n√n); (6) asks for more than the zeros of d allow, whatever K is."""
    spec = library.experiment("shen-hu-2015-noise-free").model_copy(update={"horizon": 1.0})
    found = {o.label: o.checks for o in simulate(library.resolve(spec)).observers}
    of = {label: {str(c.name)[:9]: c for c in checks} for label, checks in found.items()}
    assert "ρ < 1/(n√n) = 0.354" in str(of["nonsmooth"]["Theorem 2"].text)
    assert "no K helps" in str(of["linear"]["Theorem 1"].text) and of["linear"]["Theorem 1"].verdict == "fails"


def test_constants_over_the_domain_of_a_plant_with_moving_faults():
    """γ = (0, −½ x2²) and f = (1 + 0.1 x1)(1, 2) on |x| ≤ 2: β1 = 2 and l1 = 0.1 √5 to the density of the points."""
    plant = {
        "id": "drag",
        "states": [{"name": n, "initial": 0.1, "domain": [-2.0, 2.0]} for n in ("x1", "x2")],
        "outputs": [{"name": "y", "expression": "x1"}],
        "dynamics": {"x1": "x2", "x2": "-0.5*x2^2"},
        "channels": [{"name": "f", "kind": "process", "enters": {"x1": "1 + 0.1*x1", "x2": "2 + 0.2*x1"}}],
    }
    observers = [{"label": "o", "kind": "linear-adaptive", "gains": {"K": [6, 8]}}]
    data = {"plant": plant, "horizon": 0.5, "step": 0.01, "observers": observers}
    run = simulate(library.resolve(Experiment.model_validate(data)))
    args = shown(run, "γ quadratically").text.args
    assert 1.9 < args["beta1"] <= 2.0 and "domain" in str(shown(run, "γ quadratically").text)
    assert args["beta2"] + args["beta1"] * args["beta3"] == pytest.approx(args["beta1"] ** 2, rel=0.02)
    assert shown(run, "Theorem 2").text.args["taken"] >= 0
