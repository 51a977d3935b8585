"""The gains that the observers of an experiment run with, every default filled in."""

from thetascope.assembly.build.experiment_builder import engine
from thetascope_schemas import ResolvedExperiment


def present_gains(spec: ResolvedExperiment) -> dict[str, dict[str, float | list[float]]]:
    """Per observer label: each gain as a number or a list. Raises SpecError where the experiment cannot run."""
    found: dict[str, dict[str, float | list[float]]] = {}
    for estimator in engine(spec).estimators:
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
