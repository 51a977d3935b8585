"""The slowest rate of a plant, computed from its equations without SymPy, by which its times are scaled."""

import json
import math
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache

import numpy as np

from thetascope.engine.language.parser import Node, parse
from thetascope.engine.language.syntax_tree import value_of
from thetascope.engine.language.tables import Table, tables_of

_OPTIONAL = ("tables", "algebraic")
SLOWEST = 1e-3  # eigenvalues below this fraction of the largest count as integrators


def pace(model: Mapping) -> float:
    """Return the slowest eigenvalue of ∂f/∂x at the initial state, in 1/s, without integrators; 1 if there is no other.

    ``model`` is the plant's data. Inputs are at their defaults, known signals and t at zero.
    """
    if not model:
        return 1.0
    parts = ("states", "inputs", "parameters", "signals", "definitions", "dynamics", "time")
    used = {k: model[k] for k in parts} | {p: model.get(p, ()) for p in _OPTIONAL}
    return _pace(json.dumps(used, default=str))


@lru_cache(maxsize=256)
def _pace(text: str) -> float:
    model = json.loads(text)
    try:
        A = _jacobian_of_model(model) if model["algebraic"] else _jacobian(model)
    except (ArithmeticError, ValueError):  # the equations have no value at this point
        return 1.0
    if model["time"]["kind"] == "discrete":
        with np.errstate(all="ignore"):
            rates = np.abs(np.log(np.linalg.eigvals(A).astype(complex))) / model["time"]["period"]
    else:
        rates = np.abs(np.linalg.eigvals(A))
    rates = rates[np.isfinite(rates)]
    moving = rates[rates > SLOWEST * rates.max()] if len(rates) else rates
    return float(moving.min()) if len(moving) and moving.min() > 0 else 1.0


def _jacobian_of_model(model: Mapping) -> np.ndarray:
    """Return ∂f/∂x of a plant with algebraic variables, which need SymPy."""
    from thetascope.engine.model.plant_model import Model
    from thetascope.engine.observers.support.linearisation import linearise

    A = linearise(Model({**model, "id": "", "outputs": [], "channels": []}), (), {}, saturate=False).A
    if not np.isfinite(A).all():
        raise ValueError("the derivatives are not finite")
    return A


def _jacobian(model: Mapping) -> np.ndarray:
    """Return ∂f/∂x by central differences."""
    states = [s["name"] for s in model["states"]]
    x = np.array([float(s["initial"]) for s in model["states"]])
    values = {i["name"]: float(i["default"]) for i in model["inputs"]} | {s["name"]: 0.0 for s in model["signals"]}
    values |= {p["name"]: float(p["value"]) for p in model["parameters"]} | {"t": 0.0}
    known, tables = [*values, *states], tables_of(model)
    definitions = []
    for d in model["definitions"]:
        definitions.append((d["name"], parse(d["expression"], known, tables=tables).tree))
        known.append(d["name"])
    dynamics = [parse(model["dynamics"][s], known, tables=tables).tree for s in states]

    def f(x: np.ndarray) -> np.ndarray:
        here = values | dict(zip(states, x, strict=True))
        for name, tree in definitions:
            here[name] = _value(tree, here, tables)
        return np.array([_value(tree, here, tables) for tree in dynamics])

    columns = []
    for i in range(len(x)):
        width = 1e-6 * max(abs(x[i]), 1e-3)
        aside = np.where(np.arange(len(x)) == i, width, 0.0)
        columns.append((f(x + aside) - f(x - aside)) / (2 * width))
    A = np.array(columns).T
    if not np.isfinite(A).all():
        raise ValueError("the derivatives are not finite")
    return A


def _value(node: Node, values: Mapping[str, float], tables: Mapping[str, Table]) -> float:
    if node.value is not None:
        return node.value
    if node.kind == "name":
        return values[node.name]
    if node.name == "interp" and node.kind == "call":
        result = tables[node.args[1].name].value(_value(node.args[0], values, tables))
    else:
        numbers = tuple(Node("number", (), 0, 0, value=float(_value(a, values, tables))) for a in node.args)
        result = float(value_of(replace(node, args=numbers)))
    return result if math.isfinite(result) else math.nan
