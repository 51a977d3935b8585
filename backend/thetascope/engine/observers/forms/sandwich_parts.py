"""The parts of a sandwich system in a plant's equations: Zhou & Tan 2012, eqs. (1)–(12).

A front part L1 drives parallel backlash operators (the hysteresis), whose sum drives a back part L2, which is measured.
An operator ``backlash(x, x - x_before, z_before, m1, m2, D1, D2)`` needs two memory states: the previous x and its
previous z. Either may be kept in another unit: as z/k where the operator reads k·z. All other states belong to L1
(those that x depends on) or to L2.
"""

from __future__ import annotations

import copy
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from thetascope.engine.errors import SpecError
from thetascope.engine.language.derivatives import jacobian
from thetascope.engine.language.lazy_sympy import functions, sympy
from thetascope.engine.language.parser import Node, parse
from thetascope.engine.model.plant_model import Model
from thetascope.engine.observers.forms.sizes import TooLarge, expanded
from thetascope.messages import Message

if TYPE_CHECKING:
    from sympy import Expr, ImmutableMatrix, Matrix, Symbol

    from thetascope.engine.language.sympy_functions import Backlash

_ROUNDING = 1e-12  # relative; factors of units are rounded


@dataclass(frozen=True)
class Sandwich:
    """Positions of the states of L1, of L2 and of the memory, and the operators (with definitions expanded)."""

    front: tuple[int, ...]
    back: tuple[int, ...]
    memory: tuple[int, ...]
    operators: tuple[Backlash, ...]

    @property
    def linear_states(self) -> tuple[int, ...]:
        """Return the positions of the states of L1 and L2 in the plant's order; K corrects these."""
        return tuple(sorted((*self.front, *self.back)))


# ---- memory states, from the text alone: a gain's size must be known without SymPy -----------------------------------


def memory_names(data: Mapping) -> tuple[str, ...]:
    """Return the states that occur in an operator's Δx or z, but not in the x of any operator."""
    definitions = {d["name"]: d["expression"] for d in data["definitions"]}
    others = [*data["dynamics"].values(), *(o["expression"] for o in data["outputs"])]
    groups = ("states", "inputs", "signals", "parameters", "algebraic")
    names = {"t", *definitions, *(e["name"] for group in groups for e in data.get(group, ()))}
    tables = {table["name"] for table in data.get("tables", ())}
    driving: set[str] = set()
    remembered: set[str] = set()
    for text in (*definitions.values(), *others):
        for operator in _calls(parse(text, names, tables=tables).tree) if "backlash" in text else ():
            driving |= _mentioned(operator.args[:1], definitions, names, tables)
            remembered |= _mentioned(operator.args[1:3], definitions, names, tables)
    return tuple(s["name"] for s in data["states"] if s["name"] in remembered - driving)


def _calls(node: Node) -> Iterator[Node]:
    if node.kind == "call" and node.name == "backlash":
        yield node
    for arg in node.args:
        yield from _calls(arg)


def _mentioned(nodes: Iterable[Node], definitions: Mapping[str, str], names: set[str], tables: set[str]) -> set[str]:
    """Return the names under the nodes, with definitions expanded."""
    names_below, todo = set(), list(nodes)
    while todo:
        node = todo.pop()
        todo.extend(node.args)
        if node.kind == "name" and node.name not in names_below:
            names_below.add(node.name)
            if node.name in definitions:
                todo.append(parse(definitions[node.name], names, tables=tables).tree)
    return names_below


# ---- the structure ---------------------------------------------------------------------------------------------------


def sandwich(model: Model) -> Sandwich:
    """Return the parts of a plant. Raises SpecError with the reason where the plant is not a sandwich system."""
    if model.time != "discrete":
        raise refused(model, Message("observer.reason.sandwich.continuous"))
    f, h = (m.xreplace(model.expansion) for m in (model.f, model.h))
    operators = tuple(
        sorted(
            f.atoms(functions.Backlash) | h.atoms(functions.Backlash), key=lambda o: [f.has(o) and _first(f, o), str(o)]
        )
    )
    if not operators:
        raise refused(model, Message("observer.reason.sandwich.no-operator"))
    names = memory_names(model.data)
    memory = tuple(i for i, s in enumerate(model.states) if s in names)
    _check_memory(model, f, h, operators, memory)
    rest = [i for i in range(model.n) if i not in memory]
    front = _ancestors(model, f, {s for o in operators for s in o.args[0].free_symbols})
    return Sandwich(tuple(i for i in rest if i in front), tuple(i for i in rest if i not in front), memory, operators)


def _first(f: Matrix, operator: Backlash) -> int:
    return next(i for i, e in enumerate(f) if e.has(operator))


def _ancestors(model: Model, f: Matrix, start: set) -> set[int]:
    """Return the states from which one of the start symbols can be reached in the graph of the dynamics."""
    ancestors: set[int] = set()
    todo = [i for i, s in enumerate(model.x) if s in start]
    while todo:
        i = todo.pop()
        if i not in ancestors:
            ancestors.add(i)
            todo += [j for j, s in enumerate(model.x) if s in f[i].free_symbols]
    return ancestors


def _check_memory(model: Model, f: Matrix, h: Matrix, operators: tuple[Backlash, ...], memory: tuple[int, ...]) -> None:
    remembered = {model.x[i]: f[i] for i in memory}
    still = dict.fromkeys(operators, sympy.S.Zero)
    rest = {model.states[i]: f[i] for i in range(model.n) if i not in memory}
    for where, e in (rest | dict(zip(model.outputs, h, strict=True))).items():
        for leak in e.xreplace(still).free_symbols & set(remembered):
            raise refused(model, Message("observer.reason.sandwich.leak", state=leak.name, equation=where))
    for o in operators:
        x, dx, z = o.args[:3]
        if x.has(functions.Backlash):
            raise refused(model, Message("observer.reason.sandwich.series"))
        if not _keeps(z, o, remembered):
            raise refused(model, Message("observer.reason.sandwich.third", argument=str(z)))
        if not _keeps(x - dx, x, remembered):
            raise refused(model, Message("observer.reason.sandwich.second", argument=str(dx), x=str(x)))


def refused(model: Model, why: Message) -> SpecError:
    """Return the error for a plant that is not a sandwich system."""
    return SpecError("observers.kind", model.id, Message("observer.sandwich.none", why=why))


# ---- parts used by the observers and their checks --------------------------------------------------------------------


def before(o: Backlash, states: Collection[Symbol]) -> tuple[Symbol, Expr]:
    """Return the state that keeps an operator's previous x, x − Δx, and the factor from the state to x."""
    state = _multiple(o.args[0] - o.args[1], states)
    assert state is not None, "the parts of a sandwich system were checked"
    return state


def _multiple(e: Expr, states: Collection[Symbol]) -> tuple[Symbol, Expr] | None:
    """Return the state and the factor of an expression that is a constant times one state; None for any other."""
    try:
        e = expanded(e)
    except TooLarge:
        return None
    inside = [s for s in states if e.has(s)]
    if len(inside) != 1:
        return None
    factor = e.coeff(inside[0])
    return (inside[0], factor) if not factor.is_zero and e == sympy.expand(factor * inside[0]) else None


def _keeps(e: Expr, value: Expr, remembered: Mapping[Symbol, Expr]) -> bool:
    """Return whether an operator's argument is a state whose next value is ``value``, in any unit of the state."""
    state = _multiple(e, remembered)
    if state is None:
        return False
    try:
        value = expanded(value)
        difference = expanded(state[1] * remembered[state[0]] - value).as_coefficients_dict().values()
    except TooLarge:
        return False
    size = max((abs(c) for c in value.as_coefficients_dict().values()), default=0)
    return all(abs(c) <= _ROUNDING * size for c in difference)


def input_matrix(model: Model) -> ImmutableMatrix:
    """Return B of (11), ∂f/∂u (n × inputs)."""
    return jacobian(model.f, list(model.u))


def slope(o: Backlash) -> Expr:
    """Return the mean slope of an operator's linear zones."""
    return (o.args[3] + o.args[4]) / 2


def smooth(model: Model) -> Model:
    """Return the plant without hysteresis: each operator replaced by its slope times x."""

    def straight(e: Expr) -> Expr:
        return e.replace(lambda part: isinstance(part, functions.Backlash), lambda o: slope(o) * o.args[0])

    believed = copy.copy(model)
    for name in ("expansion", "_slopes", "is_affine"):  # caches computed for the model with operators
        believed.__dict__.pop(name, None)
    believed.definitions = tuple(replace(d, expression=straight(d.expression)) for d in model.definitions)
    believed.f, believed.h = model.f.applyfunc(straight), model.h.applyfunc(straight)
    return believed


def blocks(model: Model, parts: Sandwich) -> dict[str, ImmutableMatrix]:
    """Return A11, A22, C11, C22 of (11), and A21 = W·diag(active)·X: W maps operators to L2, X maps L1 to them."""
    f, h = (m.xreplace(model.expansion) for m in (model.f, model.h))
    outputs = [sympy.Dummy() for _ in parts.operators]
    cut = dict(zip(parts.operators, outputs, strict=True))
    f, h = f.xreplace(cut), h.xreplace(cut)
    front, back = ([model.x[i] for i in group] for group in (parts.front, parts.back))
    f1, f2 = (sympy.Matrix([f[i] for i in group]) for group in (parts.front, parts.back))
    drives = sympy.Matrix([slope(o) * o.args[0] for o in parts.operators])
    found = {
        "A11": jacobian(f1, front),
        "A22": jacobian(f2, back),
        "C11": jacobian(h, front),
        "C22": jacobian(h, back),
        "W": jacobian(f2, outputs),
        "X": jacobian(drives, front),
    }
    still = dict.fromkeys(outputs, sympy.S.Zero)
    return {name: sympy.ImmutableMatrix(m.xreplace(still)) for name, m in found.items()}
