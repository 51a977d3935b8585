"""From what is asked for (a library id, changes, a spec) to the spec that determines the numbers,."""

from collections.abc import Mapping

from pydantic import ValidationError

from thetascope import library
from thetascope.engine.errors import SpecError
from thetascope.runs.specs.overrides import changed
from thetascope.runs.specs.refusals import Unknown, from_engine, from_pydantic, validated
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.experiment.plant import Plant


def library_experiment(id: str) -> Experiment:
    """An experiment of the library. Raises :class:`Unknown` with the nearest ids."""
    try:
        return library.experiment(id)
    except SpecError as error:
        raise Unknown(error.problem, error.remedy) from None


def library_plant(id: str) -> Plant:
    """A plant of the library. Raises :class:`Unknown` with the nearest ids."""
    try:
        return library.plant(id)
    except SpecError as error:
        raise Unknown(error.problem, error.remedy) from None


def with_changes(spec: Experiment, changes: Mapping[str, object]) -> Experiment:
    """The spec with values replaced by path (`observers.adaptive.gains.rho`). Raises :class:`InvalidSpec`."""
    return validated(Experiment, changed(spec, changes)) if changes else spec


def plant_of(spec: Experiment) -> Plant:
    """The plant of a spec, in full. Raises :class:`InvalidSpec` for an id that the library does not have."""
    if not isinstance(spec.plant, str):
        return spec.plant
    try:
        return library.plant(spec.plant)
    except SpecError as error:
        raise from_engine(error) from None


def resolved(spec: Experiment) -> Experiment:
    """The spec with its plant in full, all names checked against it. Raises :class:`InvalidSpec`."""
    if not isinstance(spec.plant, str):
        return spec
    plant = plant_of(spec)
    try:
        return spec.with_plant(plant)
    except ValidationError as error:
        raise from_pydantic(error) from None
