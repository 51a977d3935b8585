"""The gains that the observers of an experiment run with, every default filled in."""

from thetascope import library
from thetascope.assembly.build.experiment_builder import engine
from thetascope_schemas import Experiment


def present_gains(spec: Experiment) -> dict[str, dict[str, float | list[float]]]:
    """Per observer label: each gain as a number or a list. Raises SpecError where the experiment cannot run."""
    plant = library.plant(spec.plant) if isinstance(spec.plant, str) else spec.plant
    found: dict[str, dict[str, float | list[float]]] = {}
    for estimator in engine(spec.with_plant(plant)).estimators:
        numbers = estimator.parameters
        gains: dict[str, float | list[float]] = {}
        for gain in estimator.kind.gains:
            name = f"g.{gain.name}"
            if name in numbers:
                gains[gain.name] = numbers[name]
            else:
                column = []
                while f"{name}.{len(column)}" in numbers:
                    column.append(numbers[f"{name}.{len(column)}"])
                gains[gain.name] = column
        found[estimator.label] = gains
    return found
