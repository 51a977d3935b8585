"""The expression language a second time, for the tests: drawn, written as text, and computed without the parser.

Expressions are drawn as nested tuples, written as text by `render`, and computed by `compute`, which drops what has
no sharp value at the point: near kinks and poles, and outside of domains. `value` computes SymPy's forms.
"""

import math
from collections.abc import Callable, Mapping

import sympy
from hypothesis import strategies as st
from sympy import Symbol

NAMES = ("x", "y", "z", "t", "x1", "phi")
SYMBOLS = {name: Symbol(name, real=True) for name in NAMES}
# irregular values, so that random expressions do not hit a kink by chance
POINT = {"x": 0.7312, "y": -1.3167, "z": 2.1743, "t": 0.4129, "x1": 1.6291, "phi": -0.5477}


literals = st.sampled_from(["0.5", "2", "3", "1.25", ".75", "4e-1", "1", "10", "1.5e0", "pi"])
atoms = st.tuples(st.just("number"), literals) | st.tuples(st.just("name"), st.sampled_from(NAMES))
UNARY = ["sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "abs", "sign"]
UNARY += ["heaviside", "step", "floor"]


def grow(inner: st.SearchStrategy) -> st.SearchStrategy:
    condition = st.tuples(st.sampled_from(["<", "<=", ">", ">="]), inner, inner)
    joined = condition | st.tuples(st.sampled_from(["and", "or"]), condition, condition)
    return st.one_of(
        st.tuples(st.sampled_from(["+", "-", "*", "/"]), inner, inner),
        st.tuples(st.sampled_from(["neg", "pos"]), inner),
        st.tuples(st.just("power"), inner, st.sampled_from(["2", "3", "-1", "0.5", "1.5", "-2", "y"])),
        st.tuples(st.sampled_from(UNARY), inner),
        st.tuples(st.sampled_from(["atan2", "min", "max"]), inner, inner),
        st.tuples(st.just("max"), inner, inner, inner),
        st.tuples(st.just("clip"), inner, st.just(("number", "0.5")), st.just(("number", "2"))),
        st.tuples(st.just("spow"), inner, st.just(("number", "0.85"))),
        st.tuples(st.just("where"), joined, inner, inner),
        st.tuples(st.just("backlash"), inner, inner, inner, *[st.just(("number", d)) for d in ("1", "2", "0.5", "3")]),
    )


trees = st.recursive(atoms, grow, max_leaves=12)
INFIX = {"+": 1, "-": 1, "*": 2, "/": 2}


def render(tree: tuple, level: int = 0) -> str:
    """Return the text of a tree with the fewest parentheses that Python's precedence requires."""
    kind, *args = tree
    if kind in ("number", "name"):
        return args[0]
    if kind in INFIX:
        own = INFIX[kind]
        text, need = f"{render(args[0], own)} {kind} {render(args[1], own + 1)}", own
    elif kind in ("neg", "pos"):
        text, need = ("-" if kind == "neg" else "+") + render(args[0], 3), 3
    elif kind == "power":
        text, need = f"{render(args[0], 5)}^{args[1]}", 4
    elif kind in ("<", "<=", ">", ">="):
        text, need = f"{render(args[0])}{kind}{render(args[1])}", 0
    elif kind in ("and", "or"):
        text, need = f"{render(args[0])} {kind} {render(args[1])}", 0
    else:
        text, need = f"{kind}({', '.join(render(arg) for arg in args)})", 9
    return f"({text})" if need < level else text


class Vague(Exception):
    """The value is not sharp at this point."""


def sharp(good: bool) -> None:
    if not good:
        raise Vague


def compute(tree: tuple, env: Mapping[str, float]) -> float:
    kind, *args = tree
    if kind == "number":
        return math.pi if args[0] == "pi" else float(args[0])
    if kind == "name":
        return env[args[0]]
    if kind == "power":
        base, exponent = compute(args[0], env), env[args[1]] if args[1] in env else float(args[1])
        sharp(abs(base) > 1e-2 and (base > 0 or exponent in (2, 3, -1, -2)))
        return bounded(base**exponent)
    return bounded(OPERATIONS[kind](*(compute(arg, env) for arg in args)))


def bounded(value: float) -> float:
    sharp(abs(value) < 1e6)
    return value


def off_zero(x: float) -> bool:
    return abs(x) > 1e-3


def away(condition: Callable[[float], bool], function: Callable[[float], float]) -> Callable[[float], float]:
    def guarded(x: float) -> float:
        sharp(condition(x))
        return function(x)

    return guarded


def compare(sign: int) -> Callable[[float, float], float]:
    def less(a: float, b: float) -> float:
        sharp(abs(a - b) > 1e-3)
        return float(sign * (b - a) > 0)

    return less


def divide(a: float, b: float) -> float:
    sharp(abs(b) > 1e-2)
    return a / b


def play(x: float, dx: float, z: float, m1: float, m2: float, d1: float, d2: float) -> float:
    rising, falling = compare(1)(z / m1 + d1, x) * compare(1)(0, dx), compare(1)(x, z / m2 - d2) * compare(1)(dx, 0)
    return m1 * (x - d1) if rising else m2 * (x + d2) if falling else z


def signed_power(x: float, a: float) -> float:
    sharp(abs(x) > 1e-3)
    return math.copysign(abs(x) ** a, x)


def angle(y: float, x: float) -> float:
    sharp(abs(x) > 1e-2 and abs(y) > 1e-2)
    return math.atan2(y, x)


OPERATIONS: dict[str, Callable[..., float]] = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": divide,
    "neg": lambda a: -a,
    "pos": lambda a: a,
    "<": compare(1),
    "<=": compare(1),
    ">": compare(-1),
    ">=": compare(-1),
    "and": lambda a, b: a * b,
    "or": max,
    "sin": math.sin,
    "cos": math.cos,
    "tan": away(lambda x: abs(math.cos(x)) > 1e-2, math.tan),
    "asin": away(lambda x: abs(x) < 0.99, lambda x: math.asin(x)),
    "acos": away(lambda x: abs(x) < 0.99, lambda x: math.acos(x)),
    "atan": math.atan,
    "sinh": away(lambda x: abs(x) < 10, math.sinh),
    "cosh": away(lambda x: abs(x) < 10, math.cosh),
    "tanh": math.tanh,
    "exp": away(lambda x: abs(x) < 10, math.exp),
    "log": away(lambda x: x > 1e-2, lambda x: math.log(x)),
    "sqrt": away(lambda x: x > 1e-2, lambda x: math.sqrt(x)),
    "abs": abs,
    "sign": away(off_zero, lambda x: math.copysign(1, x)),
    "heaviside": away(off_zero, lambda x: float(x > 0)),
    "step": away(off_zero, lambda x: float(x > 0)),
    "floor": away(lambda x: off_zero(x - round(x)), math.floor),
    "atan2": angle,
    "min": min,
    "max": max,
    "clip": lambda x, low, high: min(max(x, low), high),
    "spow": signed_power,
    "where": lambda condition, a, b: a if condition else b,
    "backlash": play,
}


def value(expr: sympy.Expr, env: Mapping[str, float]) -> float:
    """Return the value of the SymPy forms that the parser may emit; any other form is an error."""
    if expr.is_Symbol:
        return env[expr.name]
    if expr.is_Number or expr.is_NumberSymbol:
        return float(expr)
    args = [value(arg, env) for arg in expr.args]
    if expr.is_Add:
        return math.fsum(args)
    if expr.is_Mul:
        return math.prod(args)
    if expr.is_Pow:
        return args[0] ** args[1]
    return EMITTED[expr.func.__name__](*args)


MATH = ["sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log"]
EMITTED: dict[str, Callable[..., float]] = {name: getattr(math, name) for name in [*MATH, "floor", "atan2"]} | {
    "Abs": abs,
    "sign": lambda x: math.copysign(1, x) if x else 0,
    "Min": min,
    "Max": max,
    "Less": lambda a, b: a < b,
    "LessEqual": lambda a, b: a <= b,
    "And_": lambda a, b: a and b,
    "Or_": lambda a, b: a or b,
    "Divisor": lambda x: x or math.inf,
    "Where": lambda condition, a, b: a if condition else b,
    "SignedPower": lambda x, a: math.copysign(abs(x) ** a, x),
    "Backlash": lambda x, dx, z, m1, m2, d1, d2: (
        m1 * (x - d1) if x > z / m1 + d1 and dx > 0 else m2 * (x + d2) if x < z / m2 - d2 and dx < 0 else z
    ),
}
