"""Resolve a request (a library id, changes, a spec) to the experiment that determines the numbers."""

from collections.abc import Mapping

from pydantic import ValidationError

from thetascope import library
from thetascope.engine.errors import SpecError
from thetascope.runs.specs.overrides import changed
from thetascope.runs.specs.refusals import Unknown, from_engine, from_pydantic, validated
from thetascope_schemas.experiment.experiment import Experiment, ResolvedExperiment
from thetascope_schemas.experiment.plant import Plant


def library_experiment(id: str) -> Experiment:
    """Return an experiment of the library. Raises :class:`Unknown` with the nearest ids."""
    try:
        return library.experiment(id)
    except SpecError as error:
        raise Unknown(error.problem, error.remedy) from None


def with_changes(spec: Experiment, changes: Mapping[str, object]) -> Experiment:
    """Return the spec with values replaced by path (`observers.adaptive.gains.rho`). Raises :class:`InvalidSpec`."""
    return validated(Experiment, changed(spec, changes)) if changes else spec


def plant_of(choice: str | Plant) -> Plant:
    """Return the plant that a request gives by id or in full. Raises :class:`Unknown` with the nearest ids."""
    try:
        return library.plant_in_full(choice)
    except SpecError as error:
        raise Unknown(error.problem, error.remedy) from None


def resolved(spec: Experiment) -> ResolvedExperiment:
    """Return the spec with its plant in full and all names checked against it. Raises :class:`InvalidSpec`."""
    try:
        return library.resolve(spec)
    except SpecError as error:
        raise from_engine(error) from None
    except ValidationError as error:
        raise from_pydantic(error) from None
