"""The suitability of a step: eigenvalues, and the substeps that follow from them."""

import numpy as np
import pytest
import sympy

from thetascope.engine.compiler.system import Program, System
from thetascope.engine.simulation.step_stability import LIMIT, fastest, sample_rows, substeps_needed


def linear(A: np.ndarray) -> Program:
    x = sympy.symbols(f"x0:{len(A)}", real=True)
    update = tuple(sum(sympy.Float(a) * s for a, s in zip(row, x, strict=True) if a) for row in A)
    return System("linear", "continuous", x, (), (), update).lower()


def values(n: int, rows: int = 3) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(0)
    return {f"x{i}": rng.normal(size=rows) for i in range(n)} | {"t": np.zeros(rows)}


@pytest.mark.parametrize("n", [1, 3, 12, 60])
def test_the_fastest_eigenvalue_of_a_linear_system_is_found(n: int):
    """Among all decaying ones, in small systems and large."""
    rng = np.random.default_rng(n)
    A = np.triu(np.tril(rng.normal(size=(n, n)), 2), -2) - np.diag(np.linspace(5, 5 + n, n))
    eigenvalues = np.linalg.eigvals(A)
    expected = np.abs(eigenvalues)[eigenvalues.real < 0].max()
    assert fastest(linear(A), values(n), np.arange(3)) == pytest.approx(expected, rel=0.02 if n > 40 else 1e-5)


def test_growing_modes_do_not_count():
    """No step makes a growing mode decay: only decaying ones limit it."""
    assert fastest(linear(np.diag([50.0, -2.0])), values(2), np.arange(3)) == pytest.approx(2.0, rel=1e-6)


def test_the_jacobian_is_evaluated_along_the_run():
    """x' = −x³: the rate is 3x², largest at the row with the largest |x|."""
    x = sympy.Symbol("x", real=True)
    cubic = System("cubic", "continuous", (x,), (), (), (-(x**3),)).lower()
    along = {"x": np.array([1.0, 4.0, 2.0, np.nan])}
    assert fastest(cubic, along, np.array([0, 2])) == pytest.approx(12.0, rel=1e-6)
    assert fastest(cubic, along, np.arange(4)) == pytest.approx(48.0, rel=1e-6)
    assert fastest(cubic, along, np.array([3])) == 0.0 and fastest(cubic, along, np.array([], dtype=int)) == 0.0


@pytest.mark.parametrize("angle", np.linspace(np.pi / 2 + 0.05, np.pi, 7))
def test_the_limit_is_within_the_stability_region_of_runge_kutta(angle: float):
    """At |h·λ| = LIMIT the amplification 1 + z + z²/2 + z³/6 + z⁴/24 does not exceed 1 in any decaying direction."""
    z = LIMIT * np.exp(1j * angle)
    assert abs(1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24) <= 1


@pytest.mark.parametrize(("rate", "count"), [(0, 1), (100, 1), (259, 1), (261, 2), (1000, 5), (6000, 30)])
def test_substeps_follow_from_the_rate(rate: float, count: int):
    """At a step of 10 ms: one if it is stable, otherwise enough to reduce h·λ to 2."""
    assert substeps_needed(0.01, rate) == count


@pytest.mark.parametrize("opening", [True, False])
@pytest.mark.parametrize("count", [0, 1, 2, 7, 1000])
@pytest.mark.parametrize("size", [1, 30, 500])
def test_rows_to_check_are_few_and_within_the_run(count: int, size: int, opening: bool):
    """The first and the last are among them; the larger the system, the fewer."""
    rows = sample_rows(count, size, opening)
    assert len(rows) <= 18 and (len(rows) == 0) == (count == 0)
    if count:
        assert rows[0] == 0 and rows[-1] == count - 1 and (np.diff(rows) >= 0).all()
    if count == 1000 and opening and size == 1:
        assert (rows < 60).sum() >= 5
