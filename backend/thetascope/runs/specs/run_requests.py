"""Body of POST /api/runs and content of an experiment file: an experiment, or one of the library with changes."""

from collections.abc import Mapping
from typing import Any

from pydantic import Field, JsonValue

from thetascope.runs.specs.refusals import validated
from thetascope.runs.specs.resolve_spec import library_experiment, with_changes
from thetascope_schemas.experiment.base import Identifier, Strict, example
from thetascope_schemas.experiment.experiment import Experiment


class RunRequest(Strict):
    """An experiment of the library, with values changed by path."""

    model_config = example(experiment="zhao-2012", set={"noise.y.std": 0, "observers.adaptive.gains.rho": 8, "seed": 3})

    experiment: Identifier = Field(description="Id of a library experiment.")
    set: dict[str, JsonValue] = Field(
        default_factory=dict,
        max_length=200,
        description="Path → new value. Items of lists by index, label or name; a number for an input means a constant.",
    )


def parse_request(data: Any) -> Experiment:
    """Return the experiment of a body or file. Raises InvalidSpec, or Unknown for an id that is not in the library."""
    if isinstance(data, dict) and "experiment" in data and "plant" not in data:
        request = validated(RunRequest, data)
        return with_changes(library_experiment(request.experiment), request.set)
    return validated(Experiment, data)


def experiment_of(given: str | Mapping[str, object] | Experiment, changes: Mapping[str, object] | None) -> Experiment:
    """Return an experiment that is given by id, as data or as it is, with changes by path. Raises as parse_request."""
    if isinstance(given, str):
        return with_changes(library_experiment(given), changes or {})
    return with_changes(given if isinstance(given, Experiment) else parse_request(dict(given)), changes or {})
