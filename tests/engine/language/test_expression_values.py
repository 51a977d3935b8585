"""The values of expressions: accepted text has its usual meaning, and so have its derivatives."""

import math
import sys

import pytest
import sympy
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from sympy import Float, Symbol

from tests.engine.language.expression_language import NAMES, POINT, SYMBOLS, Vague, compute, render, trees, value
from thetascope.engine.errors import ExpressionError
from thetascope.engine.language.derivatives import derivative
from thetascope.engine.language.parser import FUNCTIONS, parse
from thetascope.engine.language.sympy_functions import Backlash, SignedPower, Where


@settings(max_examples=300)
@given(trees)
@example(("-", ("neg", ("power", ("name", "x"), "2")), ("/", ("name", "y"), ("*", ("name", "z"), ("name", "t")))))
@example(("/", ("/", ("name", "x"), ("name", "y")), ("/", ("name", "z"), ("name", "t"))))
@example(("backlash", *[("name", n) for n in ("z", "t", "x")], *[("number", n) for n in ("1", "2", "0.5", "3")]))
@example(("backlash", *[("name", n) for n in ("y", "phi", "z")], *[("number", n) for n in ("2", "4", "0.5", "0.75")]))
def test_accepted_text_has_its_usual_value(tree: tuple) -> None:
    """The SymPy expression has the value of the drawn tree, and consists of known forms only."""
    try:
        expected = compute(tree, POINT)
    except Vague:
        assume(False)
    try:
        found = parse(render(tree), NAMES).sympy(SYMBOLS)
    except ExpressionError as error:
        assume("powers of powers" not in str(error.problem))
        raise
    assert value(found, POINT) == pytest.approx(expected, rel=1e-7, abs=1e-7)


@given(st.floats(min_value=1e-300, max_value=1e300) | st.floats(min_value=0, max_value=100))
def test_decimals_are_bit_equal_to_pythons(number: float) -> None:
    """A decimal becomes the double that Python reads, a whole number the integer."""
    text = repr(number)
    assume(float(text) == 0 or float(text) >= sys.float_info.min)
    result = parse(text, ()).sympy({})
    assert isinstance(result, Float)
    assert float(result) == number


def test_small_constants_stay_exact() -> None:
    """Whole numbers and their fractions are exact, so that they cancel exactly; all others are doubles."""

    def read(text: str):
        return parse(text, NAMES).sympy(SYMBOLS)

    assert read("x/3 + x/3 + x/3") == SYMBOLS["x"]
    assert read("2**10") == 1024
    assert read("x**0.5") == sympy.sqrt(SYMBOLS["x"]) == read("sqrt(x)") == read("x^(1/2)")
    assert read("sqrt(2)") == Float(math.sqrt(2))
    assert read("x^2^3") == SYMBOLS["x"] ** 8
    assert read("-x^2") == -(SYMBOLS["x"] ** 2)
    assert read("where(1 < 2 and 3 >= 3, x, y)") == SYMBOLS["x"]
    assert read("exp(-x)*exp(x)") == 1


def test_the_names_of_a_text_are_listed() -> None:
    """In order of appearance, without pi and functions."""
    assert parse("pi*z + sin(x)*z - t", NAMES).names == ("z", "x", "t")


def test_symbols_must_be_real() -> None:
    """A complex symbol would change the meaning of |x|; it is an error of the program."""
    with pytest.raises(TypeError, match="real=True"):
        parse("abs(x)", NAMES).sympy({"x": Symbol("x")})


# ---- derivatives ---------------------------------------------------------------------------------------------------

DIFFERENTIABLE = [
    "abs(x*y)",
    "abs(sqrt(x))",
    "sign(x)*x + floor(z)*x + step(x)*x^2",
    "min(x*y, z, t)",
    "max(x^2, x^3, y)",
    "clip(x*z, 0, 2)",
    "clip(x*z, 0, 1)",
    "where(x < y or x > t, x^3, x^2)",
    "where(x < y and x > t, x^3, x^2)",
    "spow(x - y, 0.85)",
    "spow(y - x, 0.7)",
    "x^y + x^2.5 + 2^x",
    "atan2(x*y, z - x)",
    "backlash(z*x, t, x, 1, 2, 0.1, 0.2)",
    "backlash(y*x, y, x, 1 + x, 2 + x, 0.1, 0.2 + x)",
    "backlash(x1 + x, t, x, 1 + x, 2, 0.1 + x, 0.2)",
    "backlash(x, y, x + z, 1, 1, 5, 5)",
]


@pytest.mark.parametrize("text", DIFFERENTIABLE)
def test_derivatives_agree_with_differences(text: str) -> None:
    """d/dx in SymPy equals the central difference of the value, and consists of known forms only."""
    expression = parse(text, NAMES).sympy(SYMBOLS)
    slope = derivative(expression, SYMBOLS["x"])
    step = 1e-6
    above, below = (value(expression, POINT | {"x": POINT["x"] + d}) for d in (step, -step))
    assert value(slope, POINT) == pytest.approx((above - below) / (2 * step), rel=1e-6, abs=1e-8)


def test_a_branch_that_is_not_taken_does_not_affect_the_derivative() -> None:
    """At x = 0 the derivative of where(x > 0, sqrt(x), 0) is that of the branch taken, not 0·∞."""
    x = SYMBOLS["x"]
    slope = parse("where(x > 0, sqrt(x), 0)", NAMES).sympy(SYMBOLS).diff(x)
    assert slope.subs(x, 0) == 0


def test_the_backlash_is_the_play_operator() -> None:
    """Zhou & Tan (6)–(9): rising and falling in the linear zone, memory in between; slope m or 0, and 1 in z."""
    x, dx, z = (SYMBOLS[name] for name in ("x", "y", "z"))
    play = parse("backlash(x, y, z, 1, 2, 0.1, 0.2)", NAMES).sympy(SYMBOLS)
    assert isinstance(play, Backlash)
    cases = [  # x, Δx, z → value, slope in x, slope in z
        ((1.0, 0.5, 0.5), (0.9, 1, 0)),
        ((1.0, -0.5, 0.5), (0.5, 0, 1)),
        ((1.0, 0.0, 0.5), (0.5, 0, 1)),
        ((1.0, 1e-16, 0.5), (0.5, 0, 1)),  # a difference of rounding is no motion
        ((-1.0, -0.5, 0.5), (-1.6, 2, 0)),
        ((0.55, 0.5, 0.5), (0.5, 0, 1)),
        ((0.6, 0.5, 0.5), (0.5, 0, 1)),
    ]
    for at, (result, in_x, in_z) in cases:
        point = dict(zip((x, dx, z), at, strict=True))
        assert float(play.subs(point)) == pytest.approx(result)
        assert float(play.diff(x).subs(point)) == in_x
        assert float(play.diff(z).subs(point)) == in_z


def test_opaque_functions_stay_opaque() -> None:
    """Kinked functions print like SymPy's own but are not rewritten as roots, Heaviside or Dirac terms."""
    x, y = SYMBOLS["x"], SYMBOLS["y"]
    expression = parse("abs(x) + min(x, y) + max(x, y) + atan2(x, y) + sign(x)", NAMES).sympy(SYMBOLS)
    second = derivative(derivative(expression, x), x)
    names = {f.func.__name__ for f in (expression + second).atoms(sympy.Function)}
    assert names <= {"Abs", "Min", "Max", "atan2", "sign", "Where", "Less", "LessEqual", "Divisor"}
    assert sympy.latex(parse("abs(x)", NAMES).sympy(SYMBOLS)) == r"\left|{x}\right|"
    assert isinstance(parse("spow(x, 0.5)", NAMES).sympy(SYMBOLS), SignedPower)
    assert isinstance(parse("heaviside(x)", NAMES).sympy(SYMBOLS), Where)
    assert parse("spow(x, 1.0)", NAMES).sympy(SYMBOLS) == x
    assert y not in parse("where(1 < 0, y, x)", NAMES).sympy(SYMBOLS).free_symbols


@pytest.mark.parametrize("name", sorted(FUNCTIONS.keys() - {"interp"}))  # tables: test_tables.py
def test_every_function_folds_its_constants(name: str) -> None:
    """At constants a function is the number that SymPy's form has there."""
    function = FUNCTIONS[name]
    arguments = ["0.3", "0.9", "1.7", "0.8", "0.6", "0.4", "0.2"][: function.least]
    if name == "where":
        arguments[0] = "0.3 < 0.9"
    constant = parse(f"{name}({', '.join(arguments)})", ()).sympy({})
    names = [f"a{index}" for index in range(len(arguments))]
    text = f"{name}({', '.join(names)})" if name != "where" else "where(a0 < 0.9, a1, a2)"
    symbols = {n: Symbol(n, real=True) for n in names}
    env = dict(zip(names, (float(a.split()[0]) for a in arguments), strict=True))
    assert constant.is_Number
    assert float(constant) == pytest.approx(value(parse(text, names).sympy(symbols), env), rel=1e-15)
