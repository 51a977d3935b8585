"""Where observers start: their initial states, from the numbers given and, where they ask for it, the first measurement."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from backend.engine.graph import evaluate, variables

if TYPE_CHECKING:
    from backend.engine.simulation import Experiment

_AT = np.zeros(1)


def observer_states(experiments: Sequence["Experiment"], i: int) -> np.ndarray:
    """Initial states of observer i in each experiment (all of one shape): states × experiments."""
    first = experiments[0]
    program = first.estimators[i].program
    roots = [program.outputs[f"init.{s}"] for s in program.states]
    used = variables(program.graph, roots)
    values = _same_or_stacked([e.estimators[i].parameters for e in experiments]) | {"t": 0.0}
    outside: dict[str, np.ndarray | float] = {}
    if used - set(values):
        outside = _signals(experiments) | _first_measurement(experiments)
    values |= {f"{when}{n}": v for when in ("", "mid.", "end.", "now.") for n, v in outside.items()}
    found = evaluate(program.graph, roots, values)
    return np.array([np.broadcast_to(np.asarray(v, dtype=float), len(experiments)) for v in found]).reshape(
        len(roots), len(experiments)
    )


def _same_or_stacked(many: list[dict[str, float]]) -> dict[str, np.ndarray | float]:
    """One number where all agree, else an array over the experiments."""
    first = many[0]
    if len(many) == 1:
        return dict(first)
    return {k: first[k] if len({m[k] for m in many}) == 1 else np.array([m[k] for m in many]) for k in first}


def _signals(experiments: Sequence["Experiment"]) -> dict[str, np.ndarray | float]:
    """Right limits at t = 0."""
    first = experiments[0]
    anchor = np.array([1e-4 * first.step])
    return {
        n: float(s(_AT, anchor)[0])
        if all(e.signals[n] is s for e in experiments)
        else np.array([e.signals[n](_AT, anchor)[0] for e in experiments])
        for n, s in first.signals.items()
    }


def _first_measurement(experiments: Sequence["Experiment"]) -> dict[str, np.ndarray]:
    """y at t = 0 as a sensor with noise gives it."""
    first = experiments[0]
    values = _signals(experiments) | _same_or_stacked([e.parameters for e in experiments]) | {"t": 0.0}
    values |= {s: np.array([e.x0[j] for e in experiments]) for j, s in enumerate(first.plant.states)}
    clean = evaluate(first.plant.graph, list(first.plant.outputs.values()), values)
    anchor = np.array([1e-4 * first.step])
    noise = np.array([e.measurement.noise_at(anchor)[0] for e in experiments])
    return {
        name: np.asarray(c) + noise[:, j] for j, (name, c) in enumerate(zip(first.plant.outputs, clean, strict=True))
    }
