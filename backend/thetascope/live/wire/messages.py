"""Text messages of a live session: reading commands, and refusing anything else."""

import json
from typing import Any

from pydantic import TypeAdapter, ValidationError

from thetascope.engine.errors import SpecError
from thetascope.messages import Message, words
from thetascope.runs.specs.refusals import invalid
from thetascope_schemas.service.field_error import FieldError, field_errors
from thetascope_schemas.service.session import ClientMessage, Refused

_COMMANDS: TypeAdapter[ClientMessage] = TypeAdapter(ClientMessage)
_DEEPEST = 40  # levels of nested lists and objects
_SHORT = 4000  # characters of a long message that count as a further one
_SHOWN = 60  # characters of a message that a refusal quotes


def read(text: str | None, limit: int) -> ClientMessage | Refused:
    """Return the command in a text frame, or its refusal.

    Args:
        text: the frame; None if it was binary.
        limit: characters that it may have.
    """
    if text is None:
        return refusal(None, Message("session.message.binary"))
    if len(text) > limit:
        return refusal(None, Message("session.message.too-long", characters=len(text), limit=limit))
    try:
        data = json.loads(text, parse_constant=_refuse_constant)
    except RecursionError:
        return refusal(None, Message("session.message.too-deep"), text[:_SHOWN])
    except ValueError as error:
        return refusal(None, Message("session.message.json", detail=str(error)), text[:_SHOWN])
    if _is_too_deep(data):
        return refusal(_id(data), Message("session.message.too-deep"))
    if "\\u" in text and not _encodable(data):  # only an escape can be half of a pair
        return refusal(_id(data), Message("session.message.surrogate"))
    try:
        return _COMMANDS.validate_python(data)
    except ValidationError as error:
        return _refused_field(_id(data), field_errors(error.errors(include_url=False), data, words())[0])


def refusal(id: int | None, problem: Message, value: str | None = None) -> Refused:
    """Return the refusal of a message as a whole; its remedy is the problem's own."""
    return _refused_field(id, invalid("", value, problem).errors[0])


def refused(id: int | None, error: SpecError) -> Refused:
    """Return the refusal of a command for one field of it."""
    return _refused_field(id, invalid(error.field, error.value, error.problem, error.remedy).errors[0])


def refused_spec(id: int | None, error: ValidationError) -> Refused:
    """Return the refusal of a command after which the spec would not be valid."""
    return _refused_field(id, field_errors(error.errors(include_url=False), None, words())[0])


def _refused_field(id: int | None, error: FieldError) -> Refused:
    return Refused(id=id, **error.model_dump())


def _id(data: Any) -> int | None:
    """Return the number that the client gave its message, if it gave one."""
    number = data.get("id") if isinstance(data, dict) else None
    return number if isinstance(number, int) and not isinstance(number, bool) and 0 <= number < 2**53 else None


def _is_too_deep(data: Any) -> bool:
    """Return whether lists and objects are nested deeper than is allowed; numbers and texts are not looked at twice."""
    level = [data]
    for _ in range(_DEEPEST):
        level = [item for value in level for item in _items(value) if isinstance(item, dict | list)]
        if not level:
            return False
    return True


def _encodable(data: Any) -> bool:
    """Return whether all texts can be sent back and stored."""
    try:
        json.dumps(data, ensure_ascii=False).encode()
    except UnicodeEncodeError:
        return False
    return True


def _items(data: Any) -> list[Any]:
    if isinstance(data, dict):
        return list(data.values())
    return data if isinstance(data, list) else []


def _refuse_constant(name: str) -> None:
    raise ValueError(f"{name} is not a JSON number")


class Allowance:
    """How many messages a viewer may send: `rate` per second, and a burst of as many as in two seconds.

    A long message counts as several, since it takes longer to read and to carry out. A viewer that sends more is read
    more slowly, so nothing is lost and nothing accumulates here.
    """

    def __init__(self, rate: float, now: float) -> None:
        self._rate, self._most = rate, 2 * rate
        self._left, self._at = self._most, now

    def wait(self, now: float, characters: int = 0) -> float:
        """Count one message with its characters; return the seconds to wait before it is read."""
        weight = 1 + characters / _SHORT
        self._left = min(self._most, self._left + (now - self._at) * self._rate) - weight
        self._at = now
        return max(0.0, -self._left / self._rate)
