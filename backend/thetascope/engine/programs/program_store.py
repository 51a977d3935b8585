"""Store of the programs of plants and observers: from memory, else from the disk cache, else lowered with SymPy.

The cache key is the hash of the plant's mathematics, the structural options and the engine's source. So a lookup does
not need SymPy, and a change of the code invalidates the cache.
"""

import hashlib
import json
import threading
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from thetascope.engine.compiler import cache
from thetascope.engine.compiler.system import CONTINUOUS, DISCRETE, Program, System
from thetascope.engine.errors import SpecError
from thetascope.engine.observers.support.declaration import Observer
from thetascope.engine.observers.support.draft import Size
from thetascope.messages import Message

_PROSE = ("title", "description", "source", "unit", "typical", "scale")
_CONTROL = ("references", "controllers")
_memory: OrderedDict[str, "Written"] = OrderedDict()
_lock = threading.Lock()
_KEPT = 256


@dataclass(frozen=True)
class Written:
    """A lowered program, and facts determined during its construction (JSON values)."""

    program: Program
    facts: dict


def mathematics(plant: Mapping) -> dict:
    """Return the part of a plant's data that determines equations and design: no prose, units, defaults or bounds, and
    no controllers, which are outside the model."""
    kept = {k: v for k, v in plant.items() if k not in (*_PROSE, *_CONTROL, "id")}
    for part in ("states", "inputs", "outputs", "definitions", "channels"):
        kept[part] = [
            {k: v for k, v in item.items() if k not in (*_PROSE, "default", "bounds")} for item in plant[part]
        ]
    kept["parameters"] = [{"name": p["name"], "value": p["value"]} for p in plant["parameters"]]
    kept["signals"] = [s["name"] for s in plant["signals"]]
    kept["events"] = list(plant.get("events", ()))
    kept["algebraic"] = [{k: v for k, v in a.items() if k not in _PROSE} for a in plant.get("algebraic", ())]
    kept["tables"] = [{k: v for k, v in t.items() if k not in _PROSE} for t in plant.get("tables", ())]
    return kept


def plant_program(plant: Mapping) -> Written:
    """Return the program of a plant or a true plant. Raises ExpressionError for text that is no valid expression."""

    def write() -> Written:
        from thetascope.engine.model.true_plant import model_of

        return Written(model_of(plant).system().lower(), {})

    return _written(["plant", mathematics(plant)], write)


def closed_loop_program(plant: Mapping, sampled: tuple[str, ...], quantisers: int) -> Program:
    """Return the program of a plant with its measurement and controllers (`engine.model.closed_loop`).

    Raises SpecError for controllers that cannot be simulated.
    """

    def write() -> Written:
        from thetascope.engine.model.closed_loop import closed_loop

        return Written(closed_loop(plant, sampled, quantisers).lower(), {})

    control = {part: _bare(plant[part]) for part in _CONTROL}
    return _written(["closed loop", mathematics(plant), control, sampled, quantisers], write).program


def _bare(value: object) -> object:
    """Return JSON data without prose, units, defaults and bounds."""
    if isinstance(value, Mapping):
        return {k: _bare(v) for k, v in value.items() if k not in (*_PROSE, "default", "bounds")}
    return [_bare(v) for v in value] if isinstance(value, list | tuple) else value


def observer_program(
    plant: Mapping, kind: Observer, channels: tuple[str, ...], gains: Mapping[str, Size], options: dict
) -> Written:
    """Return an observer's program for a plant. Raises SpecError if it cannot be built for that plant."""

    def write() -> Written:
        from thetascope.engine.model.plant_model import Model
        from thetascope.engine.observers.support.draft import Draft

        time = {"continuous": CONTINUOUS, "discrete": DISCRETE, "plant": plant["time"]["kind"]}[kind.time]
        if plant.get("events") and not kind.takes_events:
            raise SpecError("observers.kind", kind.id, Message("observer.events", kind=kind.id))
        draft = Draft(Model(plant), channels, dict(gains), options, time)
        kind.write(draft)
        return Written(draft.system(kind.id).lower(), draft.facts)

    return _written([kind.id, mathematics(plant), channels, gains, options], write)


def time_program(text: str) -> Program:
    """Return a program whose output ``value`` is the function of t in the text. Raises ExpressionError."""

    def write() -> Written:
        from thetascope.engine.language.parser import parse
        from thetascope.engine.model.plant_model import clock

        function = parse(text, ["t"], "text").sympy({"t": clock()})
        return Written(System("time", CONTINUOUS, (), (), (), (), {"value": function}).lower(), {})

    return _written(["time", text], write).program


def derived(inputs: list, write: Callable[[], Program]) -> Program:
    """Return a program that `write` derives from another; ``inputs`` must contain the digest of the latter."""
    return _written(inputs, lambda: Written(write(), {})).program


def _written(inputs: list, write: Callable[[], Written]) -> Written:
    """Return the program determined by `inputs` (JSON values): from memory, else from disk, else from `write`."""
    text = json.dumps([inputs, cache.package_digest()], sort_keys=True, separators=(",", ":"))
    key = hashlib.sha256(text.encode()).hexdigest()
    known = _known(key)
    if known is not None:
        return known
    with cache.lock(key):
        return _known(key) or _keep(key, _stored(key) or _write(key, write))


def _known(key: str) -> Written | None:
    """Return a program from memory."""
    with _lock:
        if key in _memory:
            _memory.move_to_end(key)
        return _memory.get(key)


def _keep(key: str, result: Written) -> Written:
    """Keep a program in memory, and return it."""
    with _lock:
        _memory[key] = result
        while len(_memory) > _KEPT:
            _memory.popitem(last=False)
    return result


def _stored(key: str) -> Written | None:
    """Return a program from the disk cache."""
    stored = cache.read("program", key)
    if stored is None:
        return None
    data = json.loads(stored)
    return Written(Program.from_json(data["program"]), data["facts"])


def _write(key: str, write: Callable[[], Written]) -> Written:
    """Return a new program, and store it in the disk cache."""
    result = write()
    body = {"program": result.program.to_json(), "facts": result.facts}
    cache.write("program", key, json.dumps(body, separators=(",", ":")).encode())
    return result
