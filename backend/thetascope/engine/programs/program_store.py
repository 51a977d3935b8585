"""Programs of plants and observers: from memory, from the disk cache, else written down and lowered with SymPy.

The cache key is made of the plant's mathematics, the structural choices and the source of this package, so it is found
without SymPy, and never after the code has changed.
"""

import hashlib
import json
import threading
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from thetascope.engine.compiler import cache
from thetascope.engine.compiler.system import CONTINUOUS, DISCRETE, Program, System
from thetascope.engine.observers.support.declaration import Observer
from thetascope.engine.observers.support.draft import Size

_PROSE = ("title", "description", "source", "unit", "typical")
_memory: OrderedDict[str, "Written"] = OrderedDict()
_lock = threading.RLock()
_KEPT = 256


@dataclass(frozen=True)
class Written:
    """A lowered program and what was found out while writing it down (JSON values)."""

    program: Program
    facts: dict


def mathematics(plant: Mapping) -> dict:
    """A plant's data without what neither an equation nor its design depends on: prose, units, defaults, bounds, signals."""
    kept = {k: v for k, v in plant.items() if k not in (*_PROSE, "id")}
    for part in ("states", "inputs", "outputs", "definitions", "channels"):
        kept[part] = [
            {k: v for k, v in item.items() if k not in (*_PROSE, "default", "bounds")} for item in plant[part]
        ]
    kept["parameters"] = [{"name": p["name"], "value": p["value"]} for p in plant["parameters"]]
    kept["signals"] = [s["name"] for s in plant["signals"]]
    return kept


def plant_program(plant: Mapping) -> Written:
    """The plant's program. Raises ExpressionError for text that is no admissible expression."""

    def write() -> Written:
        from thetascope.engine.model.plant_model import Model

        return Written(Model(plant).system().lower(), {})

    return _written(["plant", mathematics(plant)], write)


def observer_program(
    plant: Mapping, kind: Observer, channels: tuple[str, ...], gains: Mapping[str, Size], options: dict
) -> Written:
    """An observer's program for a plant. Raises SpecError where it cannot be built for that plant."""

    def write() -> Written:
        from thetascope.engine.model.plant_model import Model
        from thetascope.engine.observers.support.draft import Draft

        time = {"continuous": CONTINUOUS, "discrete": DISCRETE, "plant": plant["time"]["kind"]}[kind.time]
        draft = Draft(Model(plant), channels, dict(gains), options, time)
        kind.write(draft)
        return Written(draft.system(kind.id).lower(), draft.facts)

    return _written([kind.id, mathematics(plant), channels, gains, options], write)


def time_program(text: str) -> Program:
    """A function of t given as text, as output ``value``. Raises ExpressionError."""

    def write() -> Written:
        from thetascope.engine.language.parser import parse
        from thetascope.engine.model.plant_model import clock

        function = parse(text, ["t"], "text").sympy({"t": clock()})
        return Written(System("time", CONTINUOUS, (), (), (), (), {"value": function}).lower(), {})

    return _written(["time", text], write).program


def derived(what: list, write: Callable[[], Program]) -> Program:
    """A program made from another; ``what`` is the key, with the other's digest in it."""
    return _written(what, lambda: Written(write(), {})).program


def _written(what: list, write: Callable[[], Written]) -> Written:
    text = json.dumps([what, cache.package_digest()], sort_keys=True, separators=(",", ":"))
    key = hashlib.sha256(text.encode()).hexdigest()
    with _lock:
        if key in _memory:
            _memory.move_to_end(key)
            return _memory[key]
        stored = cache.read("program", key)
        if stored is not None:
            data = json.loads(stored)
            made = Written(Program.from_json(data["program"]), data["facts"])
        else:
            made = write()
            body = {"program": made.program.to_json(), "facts": made.facts}
            cache.write("program", key, json.dumps(body, separators=(",", ":")).encode())
        _memory[key] = made
        while len(_memory) > _KEPT:
            _memory.popitem(last=False)
        return made
