"""Gains designed by linear matrix inequalities: they meet (6) and (7) of Shen & Hu 2015, and none is missed."""

import numpy as np
import pytest

from thetascope.engine.observers.forms.gains_by_lmi import Demand, Design, design, proof
from thetascope.engine.observers.forms.lmi import least
from thetascope.engine.observers.forms.matching_condition import closed

NO_G = np.empty((0, 2, 2))


def excess(one: Design, d, demand: Demand) -> float:
    """Return by how much the inequality is met, in the norm of P, after asserting P > 0, P d = Cᵀ and (4)."""
    P, K, n = one.P, one.K, len(d)
    spectrum = np.linalg.eigvalsh(P)
    assert spectrum[0] > 0 and P @ d == pytest.approx(np.eye(n)[0], abs=1e-7)
    for G in demand.G:
        assert np.linalg.eigvalsh(one.M - (P @ G + G.T @ P) / 2)[0] > -1e-6 * np.abs(P).max()
    condition = spectrum[-1] / spectrum[0]
    asked = demand.fixed + demand.faults * condition**0.5 + demand.shared * condition
    asked += 2 * demand.rho * np.abs(K).max() * (n * condition) ** 0.5
    matrix = P @ closed(K)
    return -np.linalg.eigvals(np.linalg.solve(P, matrix + matrix.T + 2 * one.M)).real.max() - asked


def by_grid(d2: float, demand: Demand) -> float | None:
    """Return the least max|k| of a grid of K and P for n = 2, with M = mP; None where no point of it is enough."""
    ks = np.geomspace(0.1, 300, 40)
    k1, k2, p = (a.ravel() for a in np.meshgrid(ks, np.concatenate([-ks, ks]), np.geomspace(1e-3, 1e3, 60)))
    P = np.moveaxis(np.array([[1 + d2**2 * p, -d2 * p], [-d2 * p, p]]), 2, 0)
    spectrum = np.linalg.eigvalsh(P)
    condition, largest = spectrum[:, 1] / spectrum[:, 0], np.maximum(np.abs(k1), np.abs(k2))
    matrix = P @ np.moveaxis(np.array([[-k1, np.ones_like(k1)], [-k2, np.zeros_like(k1)]]), 2, 0)
    half = np.linalg.inv(np.linalg.cholesky(P))
    m = np.zeros(len(P))
    for G in demand.G:
        of_G = half @ (P @ G + G.T @ P) @ half.transpose(0, 2, 1) / 2
        m = np.maximum(m, np.linalg.eigvalsh(of_G)[:, -1])
    asked = demand.fixed + demand.faults * condition**0.5 + demand.shared * condition + 2 * m
    asked += 2 * demand.rho * largest * (2 * condition) ** 0.5
    enough = np.linalg.eigvalsh(matrix + matrix.transpose(0, 2, 1) + asked[:, None, None] * P)[:, -1] < 0
    return float(largest[enough].min()) if enough.any() else None


def test_a_design_is_found_wherever_a_grid_of_gains_finds_one():
    """12 random d, Jacobians and constants: each design meets its inequality, with a K about as small as the grid's."""
    rng, found = np.random.default_rng(1), 0
    for _ in range(12):
        d2, size = 10 ** rng.uniform(-0.2, 1), rng.choice([0, 0.1, 0.5])
        demand = Demand(1.0, rng.choice([0, 0.5]), rng.choice([0, 0, 0.2]), size * rng.normal(size=(3, 2, 2)), 0.0)
        one, smallest = design(np.array([1.0, d2]), demand), by_grid(d2, demand)
        assert smallest is None or one is not None
        if one is not None:
            assert excess(one, np.array([1.0, d2]), demand) > 0
            assert smallest is None or np.abs(one.K).max() < 1.5 * smallest
            found += 1
    assert found > 3


@pytest.mark.parametrize("d", [(1, 3), (1, 6), (1, 5, 10), (1, 9, 30, 60), (1,)])
def test_the_direction_of_the_fault_is_no_obstacle_while_its_zeros_are_stable(d):
    """(7) of Theorem 2 without γ, for d that the poles of a plain design have no P for."""
    d = np.array(d, dtype=float)
    demand = Demand(1.0, 0.0, 0.0, np.empty((0, len(d), len(d))), 0.0)
    one = design(d, demand)
    assert one is not None and excess(one, d, demand) > 0


def test_no_design_where_a_zero_is_unstable_or_too_slow():
    """C(sI − A)⁻¹d must have zeros faster than half the rate asked for, whatever K is."""
    for d in ((1.0, -1.0), (1.0, 0.4), (1.0, 0.7, 1.6)):
        assert design(np.array(d), Demand(1.0, 0.0, 0.0, np.empty((0, len(d), len(d))), 0.0)) is None


def test_the_nonsmooth_injection_is_part_of_the_design():
    """With 2ρ c2 and ρ below 1/(n√n), for one state and for two: it meets the inequality with its own max|k|."""
    for d, rho in (((1.0,), 0.9), ((1.0, 2.0), 0.03), ((1.0, 5.0), 0.002)):
        demand = Demand(1.0, 0.0, 0.0, np.empty((0, len(d), len(d))), rho)
        one = design(np.array(d), demand)
        assert one is not None and excess(one, np.array(d), demand) > 0


def test_given_gains_are_proven_by_an_M_of_its_own():
    """K = (3, 2) and Jacobians 2.5 times those of the paper's example: M = mP misses (7), an M of its own meets it."""
    x = np.random.default_rng(4).uniform(-1.2, 1.2, (60, 2))
    G = np.zeros((60, 2, 2))
    G[:, 0] = 0.25 * np.cos(x[:, :1] * x[:, 1:]) * x[:, ::-1]
    d, demand = np.array([1.0, 1.0]), Demand(1.0, 0.0, 0.0, G, 0.0)
    assert max(excess(one, d, demand) for one in proof(np.array([3.0, 2.0]), d, demand)) > 0
    assert by_multiples(np.array([3.0, 2.0]), demand) < 0


def by_multiples(K, demand):
    """Return the largest excess of (7) for K with M = mP over P(b) = [[1 + b, −b], [−b, b]]."""
    best = -np.inf
    for b in np.geomspace(1e-3, 1e3, 400):
        P = np.array([[1 + b, -b], [-b, b]])
        half, matrix = np.linalg.inv(np.linalg.cholesky(P)), P @ closed(K)
        m = max(np.linalg.eigvalsh(half @ (P @ G + G.T @ P) @ half.T / 2)[-1] for G in demand.G)
        c = -np.linalg.eigvalsh(half @ (matrix + matrix.T) @ half.T)[-1]
        best = max(best, c - 1 - 2 * max(m, 0))
    return best


def test_the_solver_agrees_with_an_eigenvalue():
    """The least t with tI − S ≥ 0 is λmax(S); without a solution there is no answer."""
    rng = np.random.default_rng(0)
    for n in (1, 3, 6):
        S = rng.normal(size=(n, n))
        S += S.T
        answer = least(np.ones(1), [np.array([-S, np.eye(n)])])
        assert answer is not None and answer[0] == pytest.approx(np.linalg.eigvalsh(S)[-1], abs=1e-6)
    assert least(np.ones(1), [np.array([[[-1.0]], [[0.0]]])]) is None
