"""The covariance between two rows, against the matrix exponential, Lyapunov's equation and its own compiled form."""

import numpy as np
import pytest
from scipy.linalg import expm, solve_continuous_lyapunov

from thetascope.engine.estimation import discretisation
from thetascope.engine.estimation.discretisation import propagate, transitions

RNG = np.random.default_rng(3)


def stable(n: int, fastest: float) -> np.ndarray:
    """A random stable matrix with rates between 0.01 and `fastest`, one of them oscillating."""
    rates = np.geomspace(0.01, fastest, n)
    M = RNG.normal(size=(n, n)) + 3 * np.eye(n)
    core = -np.diag(rates)
    core[0, 1], core[1, 0] = 1.0, -1.0
    return M @ core @ np.linalg.inv(M)


@pytest.mark.parametrize("fastest", [1e-2, 1.0, 30.0, 1e3])
@pytest.mark.parametrize("interval", [1e-3, 0.1, 1.0])
def test_transitions_are_van_loans(fastest: float, interval: float):
    """F and Q of 20 random systems are those of the exponential of the block matrix, which holds both."""
    n, m = 5, 2
    A = np.array([stable(n, fastest) for _ in range(20)])
    noise = RNG.normal(size=(20, n, m))
    F, Q = transitions(A, noise, np.full(20, interval))
    for k in range(20):
        parts = max(1, int(2 * np.abs(A[k]).sum(axis=1).max() * interval))  # expm(−A) of a stiff A overflows
        block = np.block([[-A[k], noise[k] @ noise[k].T], [np.zeros((n, n)), A[k].T]]) * (interval / parts)
        E = expm(block)
        f, q = E[n:, n:].T, E[n:, n:].T @ E[:n, n:]
        exact_f, exact_q = np.eye(n), np.zeros((n, n))
        for _ in range(parts):
            exact_f, exact_q = f @ exact_f, f @ exact_q @ f.T + q
        assert F[k] == pytest.approx(exact_f, rel=1e-7, abs=1e-9 * np.abs(exact_f).max())
        assert Q[k] == pytest.approx(exact_q, rel=1e-7, abs=1e-9 * np.abs(exact_q).max())


@pytest.mark.parametrize("fastest", [1e2, 1e8, 1e16, 1e30])
def test_however_stiff_the_covariance_is_that_of_lyapunovs_equation(fastest: float):
    """After many time constants Q is the stationary covariance: symmetric, positive, and F is zero."""
    A = np.diag([-1.0, -3.0, -fastest])
    A[0, 2], A[1, 0], noise = 0.5, 2.0, np.array([[1.0, 0.2], [0.0, 1.0], [0.0, np.sqrt(fastest)]])
    F, Q = transitions(A[None], noise[None], np.array([60.0]))
    exact = solve_continuous_lyapunov(A[:2, :2], -(noise[:2] @ noise[:2].T))
    assert np.abs(F).max() < 1e-20
    assert Q[0, 2, 2] == pytest.approx(0.5, rel=1e-6)
    assert (Q[0] == Q[0].T).all()
    assert np.linalg.eigvalsh(Q[0]).min() > 0
    if fastest > 1e6:  # the fast part moves the others by 1/√fastest only
        assert Q[0, :2, :2] == pytest.approx(exact, rel=1e-3)


def test_a_row_does_not_depend_on_its_neighbours():
    """Live and batch divide the rows differently: F and Q of a row have the same bits in any company."""
    A, noise = RNG.normal(size=(40, 4, 4)) * np.geomspace(1e-4, 1e4, 40)[:, None, None], RNG.normal(size=(40, 4, 2))
    interval = np.full(40, 0.01)
    together = transitions(A, noise, interval)
    for k in range(40):
        alone = transitions(A[k : k + 1], noise[k : k + 1], interval[:1])
        assert all((x[k] == y[0]).all() for x, y in zip(together, alone, strict=True))


def test_the_compiled_recursion_is_that_of_numpy(monkeypatch: pytest.MonkeyPatch):
    """Both forms give the same S, also where rows have no step or several, and where S would overflow."""
    n, p, rows = 4, 2, 60
    A, noise = RNG.normal(size=(rows, n, n)), RNG.normal(size=(rows, n, 1))
    A[20:25] += 40 * np.eye(n)
    A[25:] -= 4 * np.eye(n)
    F, Q = transitions(A, noise, np.full(rows, 0.1))
    first = np.concatenate([np.eye(n)[np.triu_indices(n)], np.zeros(p)])
    steps = np.arange(rows) % 3
    given = (F, Q, np.square(noise[:, n - p :]).sum(axis=2), first, steps, (0.1, 0.5, 0.05, 0.5))
    compiled = propagate(*given)
    monkeypatch.setattr(discretisation, "_COMPILED", 0)
    assert np.isfinite(compiled).all()
    assert compiled == pytest.approx(propagate(*given), rel=1e-6, abs=1e-9)
