"""The library: plants, experiments and lessons as data, read once and validated by the schemas."""

from difflib import get_close_matches
from functools import lru_cache
from pathlib import Path

import yaml

from backend.engine.errors import SpecError
from shared import Experiment, Plant
from shared.lesson import Lesson

_HERE = Path(__file__).parent
_FIRST = ("zhao-2012", "shen-hu-2015", "reduced-order-mimo", "zhou-tan-2012", "dc-motor", "dts200", "quadruple-tank")


def _load(folder: str, schema):
    found = {}
    for path in sorted((_HERE / folder).glob("*.yaml")):
        item = schema.model_validate(yaml.load(path.read_text(encoding="utf-8"), Loader=_LOADER))
        if item.id != path.stem:
            raise ValueError(f"{path.name}: its id is {item.id!r}; it must be the file's name")
        found[item.id] = item
    return found


_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


@lru_cache(maxsize=1)
def plants() -> dict[str, Plant]:
    """All library plants by id."""
    return _load("plants", Plant)


@lru_cache(maxsize=1)
def experiments() -> dict[str, Experiment]:
    """All library experiments by id: the four papers first, then the other stories, then variants."""
    found = _load("experiments", Experiment)
    return {id: found[id] for id in (*_FIRST, *(id for id in found if id not in _FIRST))}


@lru_cache(maxsize=1)
def lessons() -> dict[str, Lesson]:
    """What to try, by the id of the experiment."""
    return _load("lessons", Lesson)


def plant(id: str) -> Plant:
    """One plant. Raises SpecError with near matches."""
    return _one("plant", id, plants())


def experiment(id: str) -> Experiment:
    """One experiment. Raises SpecError with near matches."""
    return _one("experiment", id, experiments())


def _one(what: str, id: str, all_of_them: dict):
    if id in all_of_them:
        return all_of_them[id]
    near = get_close_matches(str(id), all_of_them, n=3, cutoff=0.4)
    raise SpecError(what, id, f"the library has no {what} of that id",
                    f"did you mean {' or '.join(near)}?" if near else f"choose from {', '.join(all_of_them)}")  # fmt: skip
