"""The facts about a plant as answers of the service."""

from dataclasses import asdict
from typing import Any

from thetascope.assembly.workshop.fault_patterns import fault_patterns
from thetascope.assembly.workshop.preview import preview
from thetascope.assembly.workshop.ranking import ranked_observers
from thetascope.assembly.workshop.trial_experiment import trial_experiment
from thetascope_schemas.experiment.base import Text
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.service.plants.trial import (
    FaultPatterns,
    ObserverRanking,
    PlantPreview,
    PlantTrial,
    RankedObserver,
)


def trial_of(plant: Plant, changes: dict[str, Any]) -> PlantTrial:
    """Return an experiment that suits a plant, and its preview. `changes`: fields of it. Raises SpecError."""
    spec = trial_experiment(plant, changes)
    experiment = Experiment.model_validate({name: getattr(spec, name) for name in Experiment.model_fields})
    return PlantTrial(experiment=experiment, preview=PlantPreview.model_validate(asdict(preview(spec))))


def ranking_of(plant: Plant, changes: dict[str, Any]) -> ObserverRanking:
    """Return the observers for a plant, the best first. Raises SpecError."""
    ranked = ranked_observers(plant, trial_experiment(plant, changes, faults=True))
    return ObserverRanking(
        observers=tuple(
            RankedObserver(kind=one.kind, possible=one.possible, error=one.error, holds=one.holds, why=Text.of(one.why))
            for one in ranked
        )
    )


def patterns_of(plant: Plant, name: str) -> FaultPatterns:
    """Return the faults that may act in the equation of a state or output. Raises SpecError."""
    patterns = [vars(one) | {"about": Text.of(one.about)} for one in fault_patterns(plant, name)]
    return FaultPatterns.model_validate({"patterns": patterns})
