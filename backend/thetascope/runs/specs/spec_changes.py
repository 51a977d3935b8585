"""Differences of two experiments as a list of settings: path, label, from, to."""

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from thetascope import library
from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope_schemas.experiment.base import canonical
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.experiment.plant import Plant

Change = dict[str, Any]

MOST = 40
"""Most differences that are listed."""
_UNSEEN = Experiment.prose | {"title", "description", "source", "record"}
_FIELDS = ("seed", "horizon", "step", "evaluate", "substeps")
_LONGEST = 80
_MISSING = object()


def spec_changes(base: Experiment, spec: Experiment) -> list[Change]:
    """Return how an experiment differs from another, without texts, figures and the spacing of rows.

    Returns:
        path, label (a message as data), from and to (a number, a short text, or None: not given) of each setting. Items
        of lists are found by label, or by channel or output; timed commands count as one.
    """
    several = max(len(base.observers), len(spec.observers)) > 1
    found = [
        {"path": path, "label": _label(path, several).as_data(), "from": _shown(before), "to": _shown(after)}
        for path, before, after in _differences("", _data(base, base.horizon), _data(spec, base.horizon))
    ]
    return found[:MOST]


def differing(specs: Sequence[Experiment]) -> tuple[list[Change], int]:
    """Return the settings in which some experiments differ from the first, and the number of those equal in all.

    Returns:
        path, label and values (one for each experiment) of each setting that differs; the number of the others.
    """
    several = max(len(spec.observers) for spec in specs) > 1
    data = [_data(spec, specs[0].horizon) for spec in specs]
    paths = dict.fromkeys(path for other in data[1:] for path, _, _ in _differences("", data[0], other))
    rows = [
        {"path": path, "label": _label(path, several).as_data(), "values": [_shown(_at(one, path)) for one in data]}
        for path in paths
    ]
    differ = tuple(f"{path}." for path in paths)
    same = sum(not f"{path}.".startswith(differ) for path, _, _ in _leaves("", data[0]))
    return rows[:MOST], same


def _at(data: Any, path: str) -> Any:
    """Return the value at a path, or _MISSING."""
    for name in path.split("."):
        if not isinstance(data, Mapping) or name not in data:
            return _MISSING
        data = data[name]
    return data


def numbers(spec: Experiment) -> dict[str, list[float]]:
    """Return the numbers among the settings by the last part of their path: λ of two observers has two values."""
    found: dict[str, list[float]] = {}
    for path, _, value in _leaves("", _data(spec, spec.horizon)):
        if isinstance(value, int | float) and not isinstance(value, bool):
            found.setdefault(path.rsplit(".", 1)[-1], []).append(float(value))
    return found


def _data(spec: Experiment, span: float) -> dict[str, Any]:
    """Return the experiment as data in which lists are maps from the names of their items.

    `span`: the span of the diagnosis that is not mentioned, the horizon of the experiment before it was changed.
    """
    data = spec.model_dump(mode="json", exclude=set(_UNSEEN))
    plant = spec.plant
    data["plant"] = plant if isinstance(plant, str) else _plant_name(plant)
    if isinstance(plant, Plant) and not _is_library_id(plant.id):
        data["parameters"] = {one.name: one.value for one in plant.parameters} | data["parameters"]
        data["initial"] = {one.name: one.initial for one in plant.states} | data["initial"]
        data["equations"] = _equations(plant)
    data["observers"] = {item.pop("label"): item for item in data["observers"]}
    data["faults"] = _by_site(data["faults"])
    if data["diagnosis"]["span"] == span:
        data["diagnosis"]["span"] = None
    data["commands"] = len(data["commands"])
    record = data["truth"].pop("record", None)
    data["record"] = None if record is None else record["name"] or record["id"]
    data["inputs"] = {name: _signal(signal) for name, signal in data["inputs"].items()}
    data["signals"] = {name: _signal(signal) for name, signal in data["signals"].items()}
    return data


def _plant_name(plant: Plant) -> str:
    """Return the id of a plant; one that differs from the library's plant of that id has a star."""
    try:
        known = library.plant(plant.id)
    except SpecError:
        return plant.id
    return plant.id if canonical(known) == canonical(plant) else f"{plant.id}*"


def _is_library_id(id: str) -> bool:
    return id in library.plants()


def _equations(plant: Plant) -> str:
    """Return a short hash of a plant without the values of its parameters and initial states, and without prose."""
    data = canonical(plant)
    assert isinstance(data, dict)
    for group, field in (("parameters", "value"), ("states", "initial")):
        for one in data.get(group, ()):
            one.pop(field, None)
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()[:6]


def _by_site(faults: list[dict[str, Any]]) -> dict[str, Any]:
    """Return faults by channel or output; the second at the same place has the number 2."""
    named: dict[str, Any] = {}
    for fault in faults:
        site = fault.get("channel") or fault.get("output") or ""
        place = next(n for n in range(1, len(faults) + 1) if (site if n == 1 else f"{site}#{n}") not in named)
        named[site if place == 1 else f"{site}#{place}"] = fault
    return named


def _signal(signal: dict[str, Any]) -> Any:
    """Return a constant signal as its value, others unchanged."""
    return signal["value"] if signal.get("kind") == "constant" else signal


def _differences(path: str, before: Any, after: Any) -> Iterator[tuple[str, Any, Any]]:
    """Yield path, old and new value of what differs."""
    if before == after:
        return
    if isinstance(before, Mapping) and isinstance(after, Mapping) and _alike(before, after):
        for name in (*before, *(name for name in after if name not in before)):
            inner = f"{path}.{name}".lstrip(".")
            yield from _differences(inner, before.get(name, _MISSING), after.get(name, _MISSING))
    else:
        yield path, before, after


def _alike(before: Mapping[str, Any], after: Mapping[str, Any]) -> bool:
    """Return whether two maps are of one kind, so that their fields can be compared."""
    return all(before.get(name) == after.get(name) for name in ("kind", "shape", "mode"))


def _leaves(path: str, value: Any) -> Iterator[tuple[str, Any, Any]]:
    """Yield path, _MISSING and value of everything in the data that is no map."""
    if isinstance(value, Mapping):
        for name, item in value.items():
            yield from _leaves(f"{path}.{name}".lstrip("."), item)
    else:
        yield path, _MISSING, value


def _label(path: str, several: bool) -> Message:
    """Return the name of a setting."""
    first, *rest = path.split(".")
    name, more = (rest[0] if rest else ""), rest[1:]
    if first in ("plant", "equations", "record", "commands", *_FIELDS):
        return Message(f"change.{first}")
    if first == "observers":
        return _observer_label(name, more, several)
    if first == "faults":
        site, _, number = name.partition("#")
        fault = (
            Message("change.fault-number", name=site, n=int(number)) if number else Message("change.fault", name=site)
        )
        return Message("change.field", field=more[0], of=fault) if more else fault
    if first in ("parameters", "inputs", "signals", "noise", "initial") and name:
        symbol = Message("change.symbol", name=name) if first not in ("noise", "initial") else None
        of = symbol or Message(f"change.{first}", name=name)
        return of if not more or more == ["std"] else Message("change.field", field=".".join(more), of=of)
    return Message("change.setting", path=path)


def _observer_label(observer: str, more: list[str], several: bool) -> Message:
    """Return the name of a setting of an observer, or of the observer itself."""
    if not more:
        return Message("change.observer", observer=observer)
    setting = Message("change.symbol", name=more[-1])
    if more[0] == "initial" and len(more) > 1:
        setting = Message("change.estimate", name=more[-1])
    return Message("change.of-observer", observer=observer, setting=setting) if several else setting


def _shown(value: Any) -> Any:
    """Return a value as a number or a short text."""
    if value is _MISSING or value is None:
        return None
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return value
    if isinstance(value, Mapping):
        value = value.get("shape") or value.get("kind") or value.get("mode") or value
    text = value if isinstance(value, str) else json.dumps(value)
    return text if len(text) <= _LONGEST else text[: _LONGEST - 1] + "…"
