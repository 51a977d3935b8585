"""Solving z = T(x, t) for x, one state at a time: slow general solvers are never let loose on a user's text."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from thetascope.engine.language.lazy_sympy import functions, sympy
from thetascope.engine.model.plant_model import Model
from thetascope.messages import Message

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    Rest = list[tuple[Symbol, Expr]]  # equations not used yet
    Known = dict[Symbol, Expr]  # states solved for already
    Solved = tuple[set[Symbol], dict[Symbol, Expr]]  # the equations used, and the states they give

MAX_JOINT = 4  # states that are solved for together, where no equation has a single unknown left


class NoInverse(Exception):
    """States could not be solved for; ``message`` says which, and why."""

    def __init__(self, message: Message) -> None:
        super().__init__(message)
        self.message = message


def invert(equations: Sequence[tuple[Symbol, Expr]], model: Model) -> dict[Symbol, Expr]:
    """Each state of the model as a function of the left-hand sides z_k, t and parameters.

    Takes, again and again, an equation in which a single unknown state is left and isolates it; where there is none,
    a few equations that are jointly affine in as many unknowns. Raises NoInverse.
    """
    rest, known = list(equations), {}
    unknown = set(model.x)
    while unknown:
        why: list[Message] = []
        found = _single(rest, known, unknown, model, why) or _joint(rest, known, unknown)
        if not found:
            names = [s.name for s in model.x if s in unknown]
            none = Message("observer.inverse.none", names=names)
            raise NoInverse(Message("observer.inverse.none-because", names=names, why=why) if why else none)
        used, solved = found
        known |= solved
        unknown -= set(solved)
        rest = [equation for equation in rest if equation[0] not in used]
    return known


def _single(rest: Rest, known: Known, unknown: set[Symbol], model: Model, why: list[Message]) -> Solved | None:
    """An equation with one unknown state, solved; what stood in the way of others goes to ``why``."""
    for z, expression in rest:
        left = expression.free_symbols & unknown
        if len(left) != 1:
            continue
        (x,) = left
        try:
            solution = isolate(expression, x, z, model)
        except NoInverse as reason:
            why.append(reason.message)
            continue
        return {z}, {x: solution.xreplace(known)}
    return None


def _joint(rest: Rest, known: Known, unknown: set[Symbol]) -> Solved | None:
    """Equations that are affine in the unknowns together: the smallest square set that determines them."""
    for start in rest:
        members, states = [start], start[1].free_symbols & unknown
        while len(members) < len(states) <= MAX_JOINT:
            fitting = [e for e in rest if e not in members and e[1].free_symbols & states]
            if not fitting:
                break
            members.append(min(fitting, key=lambda e: len((e[1].free_symbols & unknown) - states)))
            states = states | (members[-1][1].free_symbols & unknown)
        if len(members) != len(states) or not states or len(states) > MAX_JOINT:
            continue
        ordered = sorted(states, key=lambda s: s.name)
        M = sympy.Matrix([[e.diff(s) for s in ordered] for _, e in members]).applyfunc(sympy.simplify)
        if M.free_symbols & unknown or sympy.simplify(M.det()) == 0:
            continue
        offset = sympy.Matrix([z - e.xreplace(dict.fromkeys(ordered, sympy.S.Zero)) for z, e in members])
        solved = M.LUsolve(offset)
        return {z for z, _ in members}, {
            s: sympy.simplify(e).xreplace(known) for s, e in zip(ordered, solved, strict=True)
        }
    return None


def isolate(expression: Expr, x: Symbol, z: Expr, model: Model) -> Expr:
    """The x for which ``expression`` equals z. Raises NoInverse where that is not one value.

    Affine expressions, or x in one place under functions that have an inverse; an even power or a root of several
    branches takes the branch in the physical domain of x.
    """
    slope = expression.diff(x)
    if x in slope.free_symbols:
        slope = sympy.simplify(slope)
    if x not in slope.free_symbols:
        return (z - expression.xreplace({x: sympy.S.Zero})) / slope
    while expression != x:
        inside = [a for a in expression.args if x in a.free_symbols]
        if len(inside) != 1:
            raise NoInverse(Message("observer.inverse.several", name=x.name))
        outside = [a for a in expression.args if x not in a.free_symbols]
        expression, z = inside[0], _undone(expression, inside[0], outside, z, x, model)
    return z


def _undone(e: Expr, inside: Expr, outside: list[Expr], z: Expr, x: Symbol, model: Model) -> Expr:
    """z with the outermost operation of e undone."""
    if e.is_Add:
        return z - sympy.Add(*outside)
    if e.is_Mul:
        return z / sympy.Mul(*outside)
    if isinstance(e, sympy.exp) or (e.is_Pow and e.base == sympy.E):
        return sympy.log(z)
    if isinstance(e, functions.SignedPower) and outside and outside[0].is_number:
        return functions.SignedPower(z, 1 / outside[0])
    if e.is_Pow and e.base == inside and e.exp.is_Rational:
        return _root(inside, e.exp, z, x, model)
    inverses = {
        "log": sympy.exp,
        "atan": sympy.tan,
        "sinh": lambda z: sympy.log(z + sympy.sqrt(z**2 + 1)),
        "tanh": lambda z: sympy.log((1 + z) / (1 - z)) / 2,
    }
    if e.func.__name__ not in inverses:
        raise NoInverse(Message("observer.inverse.function", function=e.func.__name__, name=x.name))
    return inverses[e.func.__name__](z)


def _root(inside: Expr, exponent: sympy.Rational, z: Expr, x: Symbol, model: Model) -> Expr:
    """The base b for which b**exponent = z."""
    if exponent.p % 2 == 0:
        low, _ = model.domain(x.name)
        if inside != x or low is None or low < 0:
            raise NoInverse(Message("observer.inverse.even", name=x.name))
        return sympy.Pow(z, 1 / exponent)
    if exponent.q % 2 == 0:  # a root: its base is not negative, and neither is z
        return sympy.Pow(z, 1 / exponent)
    return functions.SignedPower(z, 1 / exponent)
