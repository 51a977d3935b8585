"""Text messages of a live session: reading commands, and the refusal of what is none."""

import json
from typing import Any

from pydantic import TypeAdapter, ValidationError

from thetascope.engine.errors import SpecError
from thetascope.messages import words
from thetascope_schemas.experiment.field_error import FieldError, field_errors
from thetascope_schemas.service.session import ClientMessage, Command, Refused

_COMMANDS: TypeAdapter[Command] = TypeAdapter(ClientMessage)
_DEEPEST = 40


def read(text: str | None, limit: int) -> Command | Refused:
    """The command of a text frame (None: it was a binary one), or why it is none."""
    if text is None:
        return Refused(id=None, problem="the message is binary", remedy="send commands as JSON in text frames")
    if len(text) > limit:
        problem = f"the message has {len(text):,} characters, and {limit:,} are allowed"
        return Refused(id=None, problem=problem, remedy="send less, or raise THETASCOPE_MAX_MESSAGE")
    try:
        data = json.loads(text, parse_constant=_no_number)
    except RecursionError:
        return Refused(id=None, value=text[:60], problem="the message is nested too deeply", remedy="flatten it")
    except ValueError as error:
        return Refused(
            id=None, value=text[:60], problem=f"no valid JSON: {error}", remedy="send one JSON object with type and id"
        )
    if _depth(data) > _DEEPEST:
        return Refused(id=_id(data), problem="the message is nested too deeply", remedy="flatten it")
    if not _encodable(data):
        problem = "a text of the message holds half a character (a lone surrogate)"
        return Refused(id=_id(data), problem=problem, remedy="send whole characters")
    try:
        return _COMMANDS.validate_python(data)
    except ValidationError as error:
        return refused(_id(data), field_errors(error.errors(include_url=False), data, words())[0])


def refused(id: int | None, error: FieldError | SpecError) -> Refused:
    """The refusal of a command for one field of it."""
    value = error.value
    if value is not None and not (isinstance(value, bool | int | float) and abs(value) < 2**53):
        text = value if isinstance(value, str) else repr(value)
        value = text if len(text) <= 80 else text[:79] + "…"
    return Refused(id=id, field=error.field, value=value, problem=str(error.problem), remedy=str(error.remedy))


def refused_spec(id: int | None, error: ValidationError) -> Refused:
    """The refusal of a command that leads to a spec that is none."""
    return refused(id, field_errors(error.errors(include_url=False), None, words())[0])


def _id(data: Any) -> int | None:
    """The number that the client gave its message, where it gave one."""
    number = data.get("id") if isinstance(data, dict) else None
    return number if isinstance(number, int) and not isinstance(number, bool) and 0 <= number < 2**53 else None


def _depth(data: Any) -> int:
    """How deep lists and objects are nested, up to just beyond what is allowed."""
    level, depth = [data], 0
    while depth <= _DEEPEST:
        level = [item for one in level for item in _items(one)]
        if not level:
            return depth
        depth += 1
    return depth


def _encodable(data: Any) -> bool:
    """Whether the texts in it can be sent back, and stored."""
    try:
        json.dumps(data, ensure_ascii=False).encode()
    except UnicodeEncodeError:
        return False
    return True


def _items(data: Any) -> list[Any]:
    if isinstance(data, dict):
        return list(data.values())
    return data if isinstance(data, list) else []


def _no_number(name: str) -> None:
    raise ValueError(f"{name} is no number of JSON")


class Allowance:
    """How many messages a viewer may send: `rate` a second, and a burst of as many as in two seconds.

    Whoever sends more is read more slowly, so nothing is lost and nothing piles up here.
    """

    def __init__(self, rate: float, now: float) -> None:
        self._rate, self._most = rate, 2 * rate
        self._left, self._at = self._most, now

    def wait(self, now: float) -> float:
        """Take one message; the seconds to wait before it is read."""
        self._left = min(self._most, self._left + (now - self._at) * self._rate) - 1
        self._at = now
        return max(0.0, -self._left / self._rate)
