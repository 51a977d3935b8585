"""The true plant: the model with unmodelled dynamics and process noise added to its equations."""

from __future__ import annotations

from collections.abc import Mapping

from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.model.plant_model import Model

TRUTH = "truth"


def true_data(
    plant: Mapping, states: list[str], dynamics: Mapping[str, str], outputs: Mapping[str, str], disturbed: list[str]
) -> dict:
    """Return a true plant as plain data, from which `model_of` makes its equations.

    Args:
        plant: the model, a plant as JSON.
        states: names of the states that the model lacks; they follow the model's.
        dynamics: right-hand sides of these, and expressions that are added to those of the model's states.
        outputs: expressions that are added to outputs, by name.
        disturbed: names of the states with process noise, which enters as an input ``w.<state>``.
    """
    truth = {"states": states, "dynamics": dict(dynamics), "outputs": dict(outputs), "disturbed": disturbed}
    return {**plant, TRUTH: truth}


def true_states(data: Mapping) -> int:
    """Return the number of states of a plant as plain data, with those that its model lacks."""
    return len(data["states"]) + len(data.get(TRUTH, {}).get("states", ()))


def model_of(data: Mapping) -> Model:
    """Return the equations of a plant, or of a true plant (`true_data`).

    Raises:
        ExpressionError: an expression is not valid; a field of the truth begins with ``truth``.
    """
    if TRUTH not in data:
        return Model(data)
    truth, added = data[TRUTH], data[TRUTH]["states"]
    states = [*data["states"], *({"name": name} for name in added)]
    model = Model({**data, "states": states, "dynamics": {**data["dynamics"], **dict.fromkeys(added, "0")}})
    for name, text in truth["dynamics"].items():
        model.f[model.states.index(name)] += model.expression(text, f"truth.dynamics.{name}")
    for name, text in truth["outputs"].items():
        model.h[model.outputs.index(name)] += model.expression(text, f"truth.outputs.{name}.adds")
    model.disturbances = tuple(sympy.Symbol(f"w.{name}", real=True) for name in truth["disturbed"])
    for name, noise in zip(truth["disturbed"], model.disturbances, strict=True):
        model.f[model.states.index(name)] += noise
    return model
