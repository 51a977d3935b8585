"""What the outputs of an experiment show of its states and faults: by its equations, and along the very run."""

from backend.assembly.prepare import prepare
from backend.engine.gramian import empirical
from backend.engine.structure import structure
from shared import Experiment, Plant

WINDOW = 0.1  # of the horizon
_INSTANTS = 6


def observability(spec: Experiment, plant: Plant) -> tuple[str, str]:
    """Two sentences: what any input could show (symbolic rank), and what this one does (empirical Gramian)."""
    bare = {"plant": plant, "observers": (), "figures": (), "commands": ()}
    experiment = prepare(Experiment.model_validate(spec.model_copy(update=bare).model_dump(mode="json"))).engine
    return structure(plant.model_dump(mode="json")).text, empirical(experiment, WINDOW * spec.horizon, _INSTANTS).text
