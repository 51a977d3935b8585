"""Drafts: named matrices, second definitions refused, symmetric matrices symmetric."""

import numpy as np
import pytest
import sympy

from thetascope import library
from thetascope.engine.compiler.lowering import numbers
from thetascope.engine.model.plant_model import Model
from thetascope.engine.observers.registry import kinds, observer
from thetascope.engine.observers.support.draft import Draft
from thetascope.engine.observers.support.linearisation import linearise
from thetascope.engine.observers.support.matrices import Matrix, block, column, diag, eye, matrix, zeros


def model(name: str = "dc-motor") -> Model:
    return Model(library.plant(name).model_dump(mode="json"))


def draft(name: str = "dc-motor", **gains) -> Draft:
    return Draft(model(name), (), gains)


def dense(d: Draft, name: str, rows: int, columns: int) -> Matrix:
    return d.states(name, rows, columns)


def test_a_chain_of_products_is_the_product():
    """K @ C @ P, in any order of evaluation, equals the product of NumPy."""
    d, random = draft(), np.random.default_rng(1)
    K, C, P = dense(d, "K", 4, 2), dense(d, "C", 2, 4), dense(d, "P", 4, 4)
    values = {name: random.normal(size=shape) for name, shape in (("K", (4, 2)), ("C", (2, 4)), ("P", (4, 4)))}
    point = {f"{n}.{i}.{j}": v for n, M in values.items() for (i, j), v in np.ndenumerate(M)}
    found = numbers((K @ C @ P).entries, point, d.definitions).reshape(4, 4)
    assert found == pytest.approx(values["K"] @ values["C"] @ values["P"])
    transposed = numbers((K @ C @ P).T.entries, point, d.definitions).reshape(4, 4)
    assert transposed == pytest.approx(found.T)


def test_a_named_product_is_used_wherever_its_matrices_meet():
    """After C P is named, P Cᵀ is its transpose and K C P is K (CP), without a further definition."""
    d = draft()
    P = d.symmetric("P", 3, eye(3))
    K, C = dense(d, "K", 3, 2), dense(d, "C", 2, 3)
    CP = d.let("CP", C @ P)
    count = len(d.definitions)
    assert P @ C.T == CP.T
    assert K @ C @ P == K @ CP
    assert len(d.definitions) == count


def test_intermediate_products_are_named():
    """F P Fᵀ names F P, and the sum that contains it stays flat."""
    d = draft()
    F, P = dense(d, "F", 3, 3), dense(d, "P", 3, 3)
    product = (F @ P @ F.T).entries
    assert [s.name for s, _ in d.definitions] == [f"let.FP.{i}.{j}" for i in range(3) for j in range(3)]
    assert product[0, 1].func is sympy.Add and len(product[0, 1].args) == 3


def test_shapes_that_do_not_fit_are_refused():
    """A product or a value of the wrong shape raises ValueError with both shapes."""
    d = draft()
    A, B = dense(d, "A", 2, 3), dense(d, "B", 2, 3)
    with pytest.raises(ValueError, match=r"A \(2, 3\) @ B \(2, 3\)"):
        A @ B
    with pytest.raises(ValueError, match=r"A \(2, 3\) is set to \(3, 2\)"):
        d.set(A, B.T)
    with pytest.raises(TypeError, match="use @"):
        A * B.T


def test_a_second_definition_is_refused():
    """let, set, states and output refuse a name that is taken."""
    d = draft()
    x = d.estimate_of_state()
    d.let("r", x[0] + x[1])
    with pytest.raises(ValueError, match="r is defined twice"):
        d.let("r", x[0] * x[1])
    d.set(x, zeros(d.n))
    with pytest.raises(ValueError, match="is set twice"):
        d.set(x, eye(d.n)[:, 0])
    with pytest.raises(ValueError, match="is declared twice"):
        d.estimate_of_state()
    d.output("e", x[0])
    with pytest.raises(ValueError, match="e is offered twice"):
        d.output("e", x[1])


def test_a_value_of_a_symmetric_matrix_must_be_symmetric():
    """A lower triangle that differs from the upper one is refused, not dropped."""
    d = draft()
    P = d.symmetric("P", 2, eye(2))
    d.set(P, matrix(2, 2, lambda i, j: P[0, 0] * (i + 2 * j)))
    with pytest.raises(ValueError, match=r"P\[0, 1\] should be symmetric"):
        d.system("o")
    d = draft()
    P, A = d.symmetric("P", 2, eye(2)), dense(d, "A", 2, 2)
    d.set(P, A @ P + P @ A.T)
    d.set(A, zeros(2, 2))
    assert len(d.system("o").states) == 7


def test_a_state_without_an_update_is_refused():
    """system() names the states without an equation."""
    d = draft()
    d.estimate_of_state()
    with pytest.raises(ValueError, match="no update for xh.current"):
        d.system("o")


def test_a_matrix_gain_has_one_parameter_per_entry():
    """A gain of 2 × 3 is a matrix of the parameters g.L.i.j, row by row."""
    d = draft(L=(2, 3), k=2, rate=None)
    assert d.gain("L").shape == (2, 3) and d.gain("L")[1, 2].name == "g.L.1.2"
    assert d.gain("k")[1].name == "g.k.1" and d.gain("rate").name == "g.rate"


def test_blocks_and_diagonals():
    """block, diag, column, eye and zeros return the matrices of their names."""
    made = block([[diag([1, 2]), zeros(2)], [zeros(1, 2), column([3])]])
    assert made == diag([1, 2, 3]) and eye(2) == diag([1, 1])


def test_the_linearisation_is_that_of_finite_differences():
    """A, C and Φ at a point equal central differences of f + Φθ and h + Ψθ."""
    plant = model("zhao-contois")
    channels = ("theta1", "theta2", "theta3")
    point = {"x1": 0.07, "x2": 0.011, "theta1": 0.2, "phi1": 0.3, "phi2": 0.1, "phi3": 0.5}
    point = {k: v for k, v in point.items() if k in (*plant.states, *channels, *plant.signal_names)}

    def rate(**changes: float) -> tuple[np.ndarray, np.ndarray]:
        at = linearise(plant, channels, point | changes)
        theta = np.array([(point | changes).get(c, 0.0) for c in channels])
        return at.f + at.Phi @ theta, at.h + at.Psi @ theta

    at = linearise(plant, channels, point)
    for j, name in enumerate(plant.states):
        (f1, h1), (f0, h0) = (rate(**{name: point[name] + side * 1e-6}) for side in (1, -1))
        assert at.A[:, j] == pytest.approx((f1 - f0) / 2e-6, rel=1e-5, abs=1e-7)
        assert at.C[:, j] == pytest.approx((h1 - h0) / 2e-6, rel=1e-5, abs=1e-7)
    assert at.Phi.shape == (2, 3) and at.Psi.shape == (1, 3)
    with pytest.raises(KeyError, match="nothing"):
        linearise(plant, channels, {"nothing": 1.0})


@pytest.mark.parametrize("kind", kinds())
def test_every_observer_has_docstrings(kind):
    """The module and the equations of every registered observer have a docstring."""
    assert observer(kind).write.__doc__
