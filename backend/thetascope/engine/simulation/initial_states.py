"""Initial states of observers, computed from given values and, where the observer uses it, the first measurement."""

from collections.abc import Mapping, Sequence

import numpy as np

from thetascope.engine.compiler.graph import evaluate, variables
from thetascope.engine.simulation.experiment import Experiment


def observer_states(
    experiments: Sequence[Experiment],
    i: int,
    k: int = 0,
    plant: np.ndarray | None = None,
    known: Mapping[str, float] | None = None,
) -> np.ndarray:
    """Return the initial states of observer i at base step k, for experiments of one shape (states × experiments).

    ``plant``: the plant's states at step k (states × experiments); by default its initial states. ``known``: the
    applied u and the measured y of a closed loop at step k.
    """
    first = experiments[0]
    program = first.estimators[i].program
    roots = [program.outputs[f"init.{s}"] for s in program.states]
    used = variables(program.graph, roots)
    values = _same_or_stacked([e.estimators[i].parameters for e in experiments]) | {"t": k * first.step}
    outside: dict[str, np.ndarray | float] = {}
    if used - set(values):
        plant = np.stack([e.x0 for e in experiments], axis=1) if plant is None else plant
        outside = {**_signals(experiments, k), **(known or _measurement(experiments, k, plant))}
    values |= {f"{when}{n}": v for when in ("", "mid.", "end.", "now.") for n, v in outside.items()}
    initial = evaluate(program.graph, roots, values)
    return np.array([np.broadcast_to(np.asarray(v, dtype=float), len(experiments)) for v in initial]).reshape(
        len(roots), len(experiments)
    )


def _same_or_stacked(many: list[dict[str, float]]) -> dict[str, np.ndarray | float]:
    """Return each value as one number where all experiments agree, else as an array over the experiments."""
    first = many[0]
    if len(many) == 1:
        return dict(first)
    return {k: first[k] if len({m[k] for m in many}) == 1 else np.array([m[k] for m in many]) for k in first}


def _signals(experiments: Sequence[Experiment], k: int) -> dict[str, np.ndarray | float]:
    """Return the right limits of all signals at base step k."""
    first = experiments[0]
    at = np.array([k * first.step])
    anchor = at + 1e-4 * first.step
    return {
        n: float(s(at, anchor)[0])
        if all(e.signals[n] is s for e in experiments)
        else np.array([e.signals[n](at, anchor)[0] for e in experiments])
        for n, s in first.signals.items()
    }


def _measurement(experiments: Sequence[Experiment], k: int, plant: np.ndarray) -> dict[str, np.ndarray]:
    """Return y at base step k with the sensors' noise."""
    first = experiments[0]
    values = _signals(experiments, k) | _same_or_stacked([e.parameters for e in experiments])
    values |= {"t": k * first.step} | {s: plant[j] for j, s in enumerate(first.plant.states)}
    clean = evaluate(first.plant.graph, list(first.plant.outputs.values()), values)
    anchor = np.array([(k + 1e-4) * first.step])
    noise = np.array([e.measurement.noise_at(anchor)[0] for e in experiments])
    return {
        name: np.asarray(c) + noise[:, j] for j, (name, c) in enumerate(zip(first.plant.outputs, clean, strict=True))
    }
