"""Solve z = T(x, t) for x, one state at a time; slow general solvers are never applied to a user's equations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from thetascope.engine.language.lazy_sympy import functions, sympy
from thetascope.engine.model.plant_model import Model
from thetascope.engine.observers.forms.sizes import simpler
from thetascope.messages import Message

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    Rest = list[tuple[Symbol, Expr]]  # equations not used yet
    Known = dict[Symbol, Expr]  # states solved for already
    Solved = tuple[set[Symbol], dict[Symbol, Expr]]  # the equations used, and the states they give

MAX_JOINT = 4  # most states to solve for jointly where no equation has a single unknown left


class NoInverse(Exception):
    """Raised when states cannot be solved for; ``message`` names them and gives the reasons."""

    def __init__(self, message: Message) -> None:
        super().__init__(message)
        self.message = message


def invert(equations: Sequence[tuple[Symbol, Expr]], model: Model) -> dict[Symbol, Expr]:
    """Return each state of the model as a function of the left-hand sides z_k, t and parameters.

    Repeatedly isolates the unknown of an equation with a single unknown state; if there is no such equation, solves a
    few equations that are jointly affine in as many unknowns. Raises NoInverse.
    """
    rest, known = list(equations), {}
    unknown = set(model.x)
    while unknown:
        why: list[Message] = []
        solution = _single(rest, known, unknown, model, why) or _joint(rest, known, unknown)
        if not solution:
            names = [s.name for s in model.x if s in unknown]
            none = Message("observer.inverse.none", names=names)
            raise NoInverse(Message("observer.inverse.none-because", names=names, why=why) if why else none)
        used, solved = solution
        known |= solved
        unknown -= set(solved)
        rest = [equation for equation in rest if equation[0] not in used]
    return known


def _single(rest: Rest, known: Known, unknown: set[Symbol], model: Model, why: list[Message]) -> Solved | None:
    """Return the solution of an equation with one unknown state; ``why`` collects the reasons that others failed."""
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
    """Return the solution of the smallest square set of equations that are jointly affine in the unknowns."""
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
        M = sympy.Matrix([[e.diff(s) for s in ordered] for _, e in members]).applyfunc(simpler)
        if M.free_symbols & unknown or simpler(M.det()) == 0:
            continue
        offset = sympy.Matrix([z - e.xreplace(dict.fromkeys(ordered, sympy.S.Zero)) for z, e in members])
        solved = M.LUsolve(offset)
        return {z for z, _ in members}, {s: simpler(e).xreplace(known) for s, e in zip(ordered, solved, strict=True)}
    return None


def isolate(expression: Expr, x: Symbol, z: Expr, model: Model) -> Expr:
    """Return the x for which ``expression`` equals z. Raises NoInverse where it is not unique.

    Handles affine expressions, and x in one place under invertible functions. An even power, or a root with several
    branches, uses the branch in the physical domain of x.
    """
    slope = expression.diff(x)
    if x in slope.free_symbols:
        slope = simpler(slope)
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
    """Return z with the outermost operation of e inverted."""
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
    """Return the base b for which b**exponent = z."""
    if exponent.p % 2 == 0:
        low, _ = model.domain(x.name)
        if inside != x or low is None or low < 0:
            raise NoInverse(Message("observer.inverse.even", name=x.name))
        return sympy.Pow(z, 1 / exponent)
    if exponent.q % 2 == 0:  # a root: neither its base nor z is negative
        return sympy.Pow(z, 1 / exponent)
    return functions.SignedPower(z, 1 / exponent)
