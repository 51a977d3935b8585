"""Check a plant and report on it before a run."""

from thetascope.engine.errors import SpecError
from thetascope.engine.observability.identifiability import Structure, structure
from thetascope.engine.observers.registry import kinds, observer
from thetascope.engine.programs.program_store import closed_loop_program, plant_program
from thetascope.messages import Message, text_of
from thetascope_schemas import Plant


def check_plant(plant: Plant, language: str = "en") -> dict:
    """Parse every equation and return a report on the plant, with sentences in a language.

    The report: sizes, Φ and Ψ as text, equations affine in the states, the structural rank of states and faults and
    those that no input can distinguish (``observability``), and the kinds of observers that can be built for it (with
    the reason where one cannot). Raises ExpressionError, which points into the text.
    """
    from thetascope.engine.model.plant_model import Model

    data = plant.model_dump(mode="json")
    model = Model(data)
    plant_program(data)
    if plant.controllers:
        closed_loop_program(data, (), 1)
    names = [c.name for c in plant.channels]
    return {
        "id": plant.id,
        "valid": True,
        "time": plant.time.kind,
        "sizes": {"states": model.n, "inputs": len(model.u), "outputs": model.m, "channels": len(names)},
        "channels": names,
        "Phi": [[str(e) for e in model.Phi(names).row(i)] for i in range(model.n)],
        "Psi": [[str(e) for e in model.Psi(names).row(i)] for i in range(model.m)],
        "affine": dict(zip(model.states, model.is_affine, strict=True)),
        "observability": _observability(structure(data), language),
        "observers": [_possible(kind, plant, language) for kind in kinds()],
    }


def _observability(found: Structure, language: str) -> dict:
    """Return a structural result as data."""
    groups = [
        {"channels": list(g.channels), "states": list(g.states), "text": text_of(g.text, language)}
        for g in found.groups
    ]
    return {
        "decided": found.decided,
        "rank": found.rank,
        "size": found.size,
        "state_rank": found.state_rank,
        "states": found.states,
        "not_identifiable": list(found.unidentifiable),
        "groups": groups,
        "text": text_of(found.text, language),
    }


def _possible(kind: str, plant: Plant, language: str) -> dict:
    why = obstacle(kind, plant)
    title = text_of(observer(kind).title, language)
    return {"kind": kind, "title": title, "possible": why is None, "why": "" if why is None else why.text(language)}


def obstacle(kind: str, plant: Plant) -> Message | None:
    """Return why an observer cannot be built for a plant with its default gains; None if it can."""
    from thetascope.assembly.build.healthy import healthy_run_of
    from thetascope.assembly.build.observer_builder import estimator
    from thetascope_schemas import ObserverConfig, ResolvedExperiment

    config = ObserverConfig(label="observer", kind=kind)
    step = plant.time.period if plant.time.kind == "discrete" else 0.001
    spec = ResolvedExperiment(plant=plant, horizon=1000 * step, step=step, observers=(config,))
    data = plant.model_dump(mode="json")
    try:
        estimator(0, config, spec, data, step, healthy_run_of(spec, data))
    except SpecError as error:
        return Message("refusal.sentence", problem=error.problem, remedy=error.remedy)
    return None
