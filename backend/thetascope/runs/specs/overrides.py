"""Changes to a spec by path: `observers.adaptive.gains.rho = 8`, `noise.y.std = 0`, `faults.0.size = 0.03`.

A path names fields by key, items of a list by index (`faults.0` or `faults[0]`) or by what they are called: their
label, name, channel or output.
"""

import json
import re
from collections.abc import Mapping, Sequence
from typing import Any

from thetascope.runs.specs.refusals import invalid
from thetascope_schemas.experiment.base import Strict, suggest
from thetascope_schemas.experiment.experiment import Experiment

_CALLED = ("label", "name", "channel", "output")
_LONGEST = 400


def parse_assignment(text: str) -> tuple[str, object]:
    """`path=value` of the command line; the value is read as JSON where it is JSON, else it is text."""
    path, equals, value = text.partition("=")
    if not equals or not path.strip():
        raise invalid("--set", text, "is no assignment", "write path=value, for example --set seed=3")
    try:
        return path.strip(), json.loads(value)
    except ValueError:
        return path.strip(), value.strip()


def changed(spec: Experiment, changes: Mapping[str, object]) -> dict[str, Any]:
    """The spec as JSON data with the values at the paths replaced; it is not validated yet.

    Raises InvalidSpec for a path that leads nowhere, saying which part and what there is.
    """
    data = spec.model_dump(mode="json")
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
    """The key of `part` in the container, and the model (if any) that stands there."""
    if isinstance(container, dict):
        if not isinstance(model, Strict) or container.keys() != type(model).model_fields.keys():
            return part, model.get(part) if isinstance(model, Mapping) else None  # a map of names, or set just before
        if part not in type(model).model_fields:
            where = f"{walked} has" if walked else "the spec has"
            raise invalid(path, part, f"{where} no field {part!r}", suggest(part, type(model).model_fields))
        return part, getattr(model, part)
    if isinstance(container, list):
        index = _index(path, walked, part, container)
        item = model[index] if isinstance(model, Sequence) and index < len(model) else None
        return index, item
    if walked == "plant":
        raise invalid(
            path,
            container,
            "the plant is given by its id, so its text cannot be changed here",
            "use parameters.NAME, initial.STATE, inputs.NAME or signals.NAME",
        )
    raise invalid(path, part, f"{walked} is {_short(container)}, which has no parts", f"set {walked} as a whole")


def _index(path: str, walked: str, part: str, items: list[Any]) -> int:
    """Index of the item that `part` means: a number, or what exactly one item is called."""
    if re.fullmatch(r"\d{1,6}", part):
        if int(part) < len(items):
            return int(part)
        there = f"has {len(items)} items, 0 to {len(items) - 1}" if items else "is empty"
        raise invalid(path, part, f"{walked} {there}", f"use one of these, or set {walked} as a whole")
    called = [_names(item) for item in items]
    found = [index for index, names in enumerate(called) if part in names]
    if len(found) == 1:
        return found[0]
    if found:
        hint = " or ".join(f"{walked}.{index}" for index in found)
        raise invalid(path, part, f"several of {walked} are called {part!r}", f"use the index: {hint}")
    raise invalid(path, part, f"none of {walked} is called {part!r}", suggest(part, {n for c in called for n in c}))


def _names(item: object) -> list[str]:
    if not isinstance(item, Mapping):
        return []
    return [str(item[key]) for key in _CALLED if item.get(key) is not None]


def _signal(parts: Sequence[str], value: object) -> object:
    """A bare number for an input or known signal means that constant."""
    if len(parts) == 2 and parts[0] in ("inputs", "signals") and type(value) in (int, float):
        return {"kind": "constant", "value": value}
    return value


def _parts(path: str) -> list[str]:
    parts = re.sub(r"\[([^\[\]]*)\]", r".\1", path).split(".")
    if len(path) > _LONGEST or not all(parts):
        raise invalid(path, path, "is no path", "write names and indices separated by dots, such as faults.0.size")
    return parts


def _short(value: object) -> str:
    text = json.dumps(value)
    return text if len(text) <= 40 else text[:39] + "…"
