"""Change values of a spec by path: `observers.adaptive.gains.rho = 8`, `noise.y.std = 0`, `faults.0.size = 0.03`.

A path names fields by key, and items of a list by index (`faults.0` or `faults[0]`) or by their label, name, channel or
output.
"""

import json
import re
from collections.abc import Mapping, Sequence
from typing import Any

from thetascope.messages import Message
from thetascope.runs.specs.refusals import invalid
from thetascope_schemas.experiment.base import Strict
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.texts.local_text import ALL
from thetascope_schemas.texts.names import normalised_path
from thetascope_schemas.texts.refusal import suggestion

_CALLED = ("label", "name", "channel", "output")
_LONGEST = 400


def parse_assignment(text: str) -> tuple[str, object]:
    """Return path and value of a command line's `path=value`; the value is parsed as JSON if possible, else text."""
    path, equals, value = text.partition("=")
    if not equals or not path.strip():
        raise invalid("--set", text, Message("override.no-assignment"))
    try:
        return path.strip(), json.loads(value)
    except ValueError:
        return path.strip(), value.strip()


def changed(spec: Experiment, changes: Mapping[str, object]) -> dict[str, Any]:
    """Return the spec as JSON data with the values at the paths replaced, without validation.

    Raises InvalidSpec for a path that does not exist, with the wrong part and the existing names.
    """
    data = spec.model_dump(mode="json", context={"language": ALL})
    for path, value in changes.items():
        _assign(spec, data, path, value)
    return data


def _assign(spec: Experiment, data: dict[str, Any], path: str, value: object) -> None:
    parts = _parts(path)
    model: object = spec
    container: Any = data
    for index, part in enumerate(parts):
        walked = ".".join(parts[:index])
        key, model = _step(path, walked, part, model, container)
        if index == len(parts) - 1:
            container[key] = _signal(parts, value)
        elif isinstance(container, dict) and key not in container:
            container = container.setdefault(key, {})
        else:
            container = container[key]


def _step(path: str, walked: str, part: str, model: object, container: Any) -> tuple[str | int, object]:
    """Return the key of `part` in the container, and the model there, if any."""
    if isinstance(container, dict):
        if not isinstance(model, Strict) or container.keys() != type(model).model_fields.keys():
            return part, model.get(part) if isinstance(model, Mapping) else None  # a map of names, or set just before
        if part not in type(model).model_fields:
            problem = Message("override.field.unknown", name=part, where=walked or Message("override.the-spec"))
            raise invalid(path, part, problem, Message.from_data(suggestion(part, type(model).model_fields)))
        return part, getattr(model, part)
    if isinstance(container, list):
        index = _index(path, walked, part, container)
        item = model[index] if isinstance(model, Sequence) and index < len(model) else None
        return index, item
    if walked == "plant":
        raise invalid(path, container, Message("override.plant-by-id"))
    raise invalid(path, part, Message("override.no-parts", where=walked, value=_short(container)))


def _index(path: str, walked: str, part: str, items: list[Any]) -> int:
    """Return the index of the item that `part` identifies: a number, or the name of exactly one item."""
    if re.fullmatch(r"\d{1,6}", part):
        if int(part) < len(items):
            return int(part)
        code = "override.index.outside" if items else "override.list-empty"
        raise invalid(path, part, Message(code, where=walked, n=len(items), last=len(items) - 1))
    called = [_names(item) for item in items]
    matching = [index for index, names in enumerate(called) if part in names]
    if len(matching) == 1:
        return matching[0]
    if matching:
        paths = [f"{walked}.{index}" for index in matching]
        raise invalid(path, part, Message("override.item.ambiguous", where=walked, name=part, paths=paths))
    hint = Message.from_data(suggestion(part, {n for c in called for n in c}))
    raise invalid(path, part, Message("override.item.unknown", where=walked, name=part), hint)


def _names(item: object) -> list[str]:
    if not isinstance(item, Mapping):
        return []
    return [str(item[key]) for key in _CALLED if item.get(key) is not None]


def _signal(parts: Sequence[str], value: object) -> object:
    """Return a number given for an input or known signal as a constant signal; other values unchanged."""
    if len(parts) == 2 and parts[0] in ("inputs", "signals") and type(value) in (int, float):
        return {"kind": "constant", "value": value}
    return value


def _parts(path: str) -> list[str]:
    parts = normalised_path(re.sub(r"\[([^\[\]]*)\]", r".\1", path)).split(".")
    if len(path) > _LONGEST or not all(parts):
        raise invalid(path, path, Message("override.no-path"))
    return parts


def _short(value: object) -> str:
    text = json.dumps(value)
    return text if len(text) <= 40 else text[:39] + "…"
