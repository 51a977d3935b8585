"""Bounds on the size of expressions: never below the size, and what is beyond them is refused before it is made."""

import random

import pytest
import sympy

from benchmarks import attacks
from thetascope.engine.errors import SpecError
from thetascope.engine.model.plant_model import Model
from thetascope.engine.observers.forms import sizes
from thetascope.engine.observers.forms.normal_form import normal_form
from thetascope.engine.observers.forms.observable_form import canonical_form
from thetascope_schemas import Plant

X = sympy.symbols("a b c d", real=True)


def expression(draw: random.Random, depth: int, rational: bool) -> sympy.Expr:
    """Return a random polynomial, or a rational function, of a few symbols; with functions if it is not rational."""
    if depth == 0:
        return draw.choice([*X, sympy.Integer(draw.randint(1, 3))])
    kind = draw.choice(["sum", "sum", "product", "power", "function"])
    inner = [expression(draw, depth - 1, rational) for _ in range(draw.randint(2, 3))]
    if kind == "sum":
        return sympy.Add(*inner)
    if kind == "product":
        return sympy.Mul(*inner)
    if kind == "power":
        return inner[0] ** draw.choice([2, 3, -1] if rational else [2, 3])
    return inner[0] + inner[1] if rational else draw.choice([sympy.sin, sympy.tanh, sympy.cos])(inner[0])


@pytest.mark.parametrize("seed", range(30))
def test_the_bounds_hold(seed: int):
    """An expanded sum has no more terms, a fraction no longer polynomials, and a derivative no more nodes."""
    draw = random.Random(seed)
    e = expression(draw, 3, rational=False)
    assert len(sympy.Add.make_args(sympy.expand(e))) <= sizes.terms(e)
    known: dict = {}
    assert sizes.nodes(e) == sum(1 for _ in sympy.preorder_traversal(e))
    for x in X:
        assert sizes.nodes(e.diff(x)) <= max(1, sizes.derivative_nodes(e, x, known))
    fraction = expression(draw, 3, rational=True)
    polynomials = sympy.fraction(sympy.together(fraction))
    for bound, polynomial in zip(sizes.fraction_terms(fraction), polynomials, strict=True):
        assert len(sympy.Add.make_args(sympy.expand(polynomial))) <= bound


def test_what_is_too_large_is_not_begun():
    """A power of a sum is counted by its monomials, also under a function and below the fraction line."""
    huge = sum(X) ** 200
    assert sizes.terms(huge) == sympy.binomial(203, 3)
    for e in (huge, X[0] * huge + 1, sympy.sin(huge)):
        with pytest.raises(sizes.TooLarge):
            sizes.expanded(e)
    assert not sizes.cancels(1 / huge) and not sizes.cancels(1 / (1 + 1 / huge))
    assert sizes.simpler(huge) is huge
    small = (X[0] + X[1]) ** 2
    assert sizes.expanded(small) == sympy.expand(small) and sizes.cancels(small)


@pytest.mark.parametrize(
    ("attack", "form", "reason"),
    [
        (attacks.chain, canonical_form, "observer.reason.too-many-terms"),
        (attacks.ring, canonical_form, "observer.reason.too-long"),
        (attacks.ring, normal_form, "observer.reason.too-long"),
    ],
)
def test_a_plant_whose_form_would_be_too_large_is_refused(attack, form, reason: str):
    """The refusal of the observer says why."""
    model = Model(Plant.model_validate(attack()).model_dump(mode="json"))
    with pytest.raises(SpecError) as refusal:
        form(model)
    assert refusal.value.problem.args["why"].code == reason
