"""Numerical values of the plant's model at a point: f, h, Φ, Ψ and the Jacobians A and C, as observers use them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from thetascope.engine.compiler.lowering import numbers
from thetascope.engine.model.plant_model import Model
from thetascope.engine.observers.support.draft import Draft


@dataclass(frozen=True)
class Linearisation:
    """A plant's model at a point: f (n,), h (m,), A (n×n), C (m×n), Phi (n×p) and Psi (m×p).

    A is ∂(f + Φθ)/∂x and C is ∂(h + Ψθ)/∂x.
    """

    f: np.ndarray
    h: np.ndarray
    A: np.ndarray
    C: np.ndarray
    Phi: np.ndarray
    Psi: np.ndarray


def linearise(
    model: Model, channels: Sequence[str], point: Mapping[str, float], saturate: bool = True
) -> Linearisation:
    """Evaluate the plant's model and its Jacobians at a point.

    Args:
        model: the plant's model.
        channels: the fault channels, the columns of Φ and Ψ.
        point: values by name in their units: states, channels, inputs, known signals, parameters and ``t`` in s. By
            default a state has its initial value, an input its default, a parameter its value, and all others 0.
        saturate: saturate the model to the plant's physical domain, as inside an observer.

    Raises KeyError for a name that the plant does not have.
    """
    values = _defaults(model, channels)
    for name, value in point.items():
        values[_symbol(model, channels, name)] = float(value)
    draft = Draft(model, tuple(channels), {})
    theta = draft.estimate_of_theta()
    at = draft.at(draft.estimate_of_state(), theta, saturate=saturate)

    parts = (at.f, at.h, at.A, at.C, at.Phi, at.Psi)
    flat = numbers([e for part in parts for e in part], values, draft.definitions)
    ends = np.cumsum([len(part) for part in parts])
    f, h, A, C, Phi, Psi = (
        flat[end - len(part) : end].reshape(part.shape) for part, end in zip(parts, ends, strict=True)
    )
    return Linearisation(f[:, 0], h[:, 0], A, C, Phi, Psi)


def _defaults(model: Model, channels: Sequence[str]) -> dict[str, float]:
    data = model.data
    values = {"t": 0.0} | {f"thetah.{c}": 0.0 for c in channels} | {f"signal.{s}": 0.0 for s in model.signal_names}
    values |= {f"xh.{s['name']}": float(s.get("initial", 0.0)) for s in data["states"]}
    values |= {f"u.{u['name']}": float(u.get("default", 0.0)) for u in data["inputs"]}
    return values | {f"m.{p['name']}": float(p["value"]) for p in data["parameters"]}


def _symbol(model: Model, channels: Sequence[str], name: str) -> str:
    groups = (("xh", model.states), ("thetah", channels), ("u", model.inputs), ("signal", model.signal_names))
    for prefix, names in (*groups, ("m", model.parameter_names)):
        if name in names:
            return f"{prefix}.{name}"
    if name == "t":
        return name
    raise KeyError(name)
