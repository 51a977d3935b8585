"""Reasons why a run is not started, not found or not ready, for the service and for the command line.

The exceptions carry messages. `text(language)` renders them; `str()` is English.
"""

import re
from collections.abc import Iterable
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from thetascope.engine.errors import SpecError
from thetascope.messages import Message, words
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.service.field_error import FieldError, field_errors

Model = TypeVar("Model", bound=BaseModel)


class Refusal(Exception):
    """A request that cannot be fulfilled.

    Args:
        problem: the reason.
        remedy: what to do; by default the message whose code is the problem's plus `.remedy`, with its arguments.
    """

    def __init__(self, problem: Message, remedy: Message | None = None) -> None:
        super().__init__(problem, remedy)
        self.problem = problem
        self.remedy = remedy or Message(f"{problem.code}.remedy", **problem.args)

    def text(self, language: str = "en") -> str:
        """Return `problem; remedy` in a language."""
        return Message("refusal.sentence", problem=self.problem, remedy=self.remedy).text(language)

    def __str__(self) -> str:
        return self.text()


class Unknown(Refusal):
    """The plant, experiment, figure or run does not exist."""


class Busy(Refusal):
    """The queue is full."""


class NotOwner(Refusal):
    """The run belongs to other clients."""


class OverLimit(Refusal):
    """The client has, or has used, as much as one client may.

    Args:
        problem: which limit; its remedy is the entry with `.remedy`.
        retry: seconds after which to try again.
    """

    def __init__(self, problem: Message, retry: float) -> None:
        super().__init__(problem)
        self.retry = retry


class NotReady(Refusal):
    """The run has no result: it is not finished, failed, or was cancelled."""


class InvalidSpec(Exception):
    """A spec, plant or file that is refused, with an error for each wrong field."""

    def __init__(self, errors: Iterable[FieldError]) -> None:
        self.errors = tuple(errors)
        super().__init__(self.errors)

    def text(self, language: str = "en") -> str:
        """Return the first three errors in a language."""
        return "; ".join(sentence(error, language) for error in self.errors[:3])

    def __str__(self) -> str:
        return self.text()


def sentence(error: FieldError, language: str = "en") -> str:
    """Return one error as text: `field: problem (got value); remedy`."""
    error = error.rendered(words(language))
    parts = {"field": error.field or Message("refusal.data"), "problem": error.problem, "remedy": error.remedy}
    if error.value is None:
        return Message("refusal.field", **parts).text(language)
    return Message("refusal.field-value", **parts, value=repr(error.value)).text(language)


def invalid(field: str, value: object, problem: Message, remedy: Message | None = None) -> InvalidSpec:
    """Return an :class:`InvalidSpec` of one field; the remedy is by default the problem's own."""
    data = problem.as_data()
    if remedy is not None and remedy != Message(f"{problem.code}.remedy", **problem.args):
        data["args"]["remedy"] = remedy.as_data()
    error = FieldError(field=field, value=shortened(value), problem="", remedy="", **data)
    return InvalidSpec([error.rendered(words())])


_PLANT_ONLY = Plant.model_fields.keys() - Experiment.model_fields.keys()


def from_engine(error: SpecError, in_plant: bool = False) -> InvalidSpec:
    """Return the engine's error in the contract's form; `in_plant` if it comes from an experiment's inline plant."""
    prefix = "plant." if in_plant and re.split(r"[.\[]", error.field)[0] in _PLANT_ONLY else ""
    field = prefix + re.sub(r"\.(\d+)(?=[.\[]|$)", r"[\1]", error.field)
    return invalid(field, error.value, error.problem, error.remedy)


def from_pydantic(error: ValidationError, data: object = None) -> InvalidSpec:
    """Return pydantic's error in the contract's form; with `data`, paths read as the sender wrote them."""
    return InvalidSpec(field_errors(error.errors(include_url=False), data, words()))


def validated(model: type[Model], data: object) -> Model:
    """Return `data` as `model`. Raises :class:`InvalidSpec` with the fields as the sender wrote them."""
    try:
        return model.model_validate(data)
    except ValidationError as error:
        raise from_pydantic(error, data) from None
    except RecursionError:
        raise invalid("", None, Message("document.too-deep")) from None


def shortened(value: object) -> object:
    """Return a value for an error message: itself when it is a short scalar, else the start of its text."""
    if value is None or isinstance(value, bool | int | float) and abs(value) < 2**53:
        return value
    text = value if isinstance(value, str) else repr(value)
    return text if len(text) <= 80 else text[:79] + "…"
