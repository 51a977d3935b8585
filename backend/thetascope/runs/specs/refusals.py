"""Why a run is not started, not found or not ready, in a form that the service and the command line both print."""

import re
from collections.abc import Iterable
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from thetascope.engine.errors import SpecError
from thetascope_schemas.experiment.base import FieldError, field_errors
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.service.run import Problem

Model = TypeVar("Model", bound=BaseModel)


class Refusal(Exception):
    """A request that cannot be met as it stands: what happened, and what to do about it."""

    def __init__(self, detail: str, remedy: str) -> None:
        super().__init__(f"{detail}; {remedy}")
        self.detail = detail
        self.remedy = remedy


class Unknown(Refusal):
    """There is no such plant, experiment, figure or run."""


class Busy(Refusal):
    """The queue is full."""


class NotReady(Refusal):
    """The run has no result: it is not finished, failed, or was cancelled."""


class InvalidSpec(Exception):
    """A spec, plant or file that is refused, with each field at fault."""

    def __init__(self, errors: Iterable[FieldError]) -> None:
        self.errors = tuple(errors)
        super().__init__("; ".join(sentence(error) for error in self.errors[:3]))


def sentence(error: FieldError) -> str:
    """One error as text: `field: problem (got value); remedy`."""
    got = "" if error.value is None else f" (got {error.value!r})"
    return f"{error.field or 'the data'}: {error.problem}{got}; {error.remedy}"


def invalid(field: str, value: object, problem: str, remedy: str) -> InvalidSpec:
    """An :class:`InvalidSpec` of one field."""
    return InvalidSpec([FieldError(field=field, value=shortened(value), problem=problem, remedy=remedy)])


_PLANT_ONLY = Plant.model_fields.keys() - Experiment.model_fields.keys()


def from_engine(error: SpecError, in_plant: bool = False) -> InvalidSpec:
    """The engine's error in the contract's form; `in_plant` when it came from an experiment with an inline plant."""
    prefix = "plant." if in_plant and re.split(r"[.\[]", error.field)[0] in _PLANT_ONLY else ""
    return invalid(
        prefix + re.sub(r"\.(\d+)(?=[.\[]|$)", r"[\1]", error.field), error.value, error.problem, error.remedy
    )


def refused(error: InvalidSpec) -> Problem:
    """The problem document of a spec that is refused."""
    more = f" (and {len(error.errors) - 1} more)" if len(error.errors) > 1 else ""
    detail = sentence(error.errors[0]) + more
    return Problem(title="The request was refused", status=422, detail=detail, errors=error.errors)


def validated(model: type[Model], data: object) -> Model:
    """`data` as `model`. Raises :class:`InvalidSpec` with the fields as the sender wrote them."""
    try:
        return model.model_validate(data)
    except ValidationError as error:
        raise InvalidSpec(field_errors(error.errors(include_url=False), data)) from None
    except RecursionError:
        raise invalid("", None, "the data is nested too deeply", "flatten it") from None


def shortened(value: object) -> object:
    """A value for an error message: itself when it is a short scalar, else the start of its text."""
    if value is None or isinstance(value, bool | int | float) and abs(value) < 2**53:
        return value
    text = value if isinstance(value, str) else repr(value)
    return text if len(text) <= 80 else text[:79] + "…"
