"""The library: plants, experiments, lessons and papers as data, read once and validated by the schemas."""

from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import yaml

from thetascope.engine.compiler.cache import digest_of
from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope_schemas import Experiment, Plant, ResolvedExperiment
from thetascope_schemas.service.learning.course import CourseLesson
from thetascope_schemas.service.learning.mystery import MysterySetup
from thetascope_schemas.service.learning.paper import Erratum, Paper
from thetascope_schemas.service.learning.questions import Lesson
from thetascope_schemas.texts.local_text import LocalText
from thetascope_schemas.texts.refusal import suggestion

_HERE = Path(__file__).parent
_FIRST = ("zhao-2012", "shen-hu-2015", "reduced-order-mimo", "zhou-tan-2012", "dc-motor", "dts200", "quadruple-tank")
_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_SCHEMAS = {
    "plants": Plant,
    "experiments": Experiment,
    "lessons": Lesson,
    "course": CourseLesson,
    "mysteries": MysterySetup,
    "papers": Paper,
}


@lru_cache(maxsize=len(_SCHEMAS))
def _names(folder: str) -> tuple[str, ...]:
    return tuple(sorted(path.stem for path in (_HERE / folder).glob("*.yaml")))


@cache
def _read(folder: str, name: str) -> Any:
    """One file, read when it is first used: a run needs two of them, and reading them all takes longer than the run."""
    path = _HERE / folder / f"{name}.yaml"
    item = _SCHEMAS[folder].model_validate(yaml.load(path.read_text(encoding="utf-8"), Loader=_LOADER))
    if item.id != name:
        raise ValueError(f"{path.name}: its id is {item.id!r}; it must be the file's name")
    return _with_errata(item) if folder == "experiments" else item


def _with_errata(item: Experiment) -> Experiment:
    """Return an experiment of a paper with the errata of that paper: they stand in one place."""
    paper = next((id for id in _names("papers") if item.id == id or item.id.startswith(f"{id}-")), None)
    if paper is None:
        return item
    errata = tuple(
        LocalText({lang: _erratum(one, lang) for lang in ("en", "zh")}) for one in _read("papers", paper).errata
    )
    return item.model_copy(update={"errata": errata})


def _erratum(one: Erratum, language: str) -> str:
    printed, used, reason = (getattr(words, language) or words.en for words in (one.printed, one.used, one.reason))
    if language == "zh":
        return f"原文：{printed}。这里：{used}。{reason}"
    return f"Printed: {printed}. Used here: {used}. {reason}"


@lru_cache(maxsize=1)
def plants() -> dict[str, Plant]:
    """Return all library plants by id."""
    return {name: _read("plants", name) for name in _names("plants")}


@lru_cache(maxsize=1)
def experiments() -> dict[str, Experiment]:
    """Return all library experiments by id: the four papers first, then the other stories, then variants."""
    names = _names("experiments")
    return {name: _read("experiments", name) for name in (*_FIRST, *(n for n in names if n not in _FIRST))}


@lru_cache(maxsize=1)
def lessons() -> dict[str, Lesson]:
    """Return the lessons by the id of their experiment."""
    return {name: _read("lessons", name) for name in _names("lessons")}


@lru_cache(maxsize=1)
def course() -> dict[str, CourseLesson]:
    """Return the lessons of the course by id."""
    return {name: _read("course", name) for name in _names("course")}


@lru_cache(maxsize=1)
def mysteries() -> dict[str, MysterySetup]:
    """Return the set-ups from which mysteries are drawn, by id."""
    return {name: _read("mysteries", name) for name in _names("mysteries")}


@lru_cache(maxsize=1)
def papers() -> dict[str, Paper]:
    """Return the papers by id, in the order of their experiments."""
    return {name: _read("papers", name) for name in _FIRST if name in _names("papers")}


@lru_cache(maxsize=1)
def digest() -> str:
    """Return the hash of all its files."""
    return digest_of(_HERE, "*.yaml")


def plant(id: str) -> Plant:
    """Return one plant. Raises SpecError with near matches."""
    return _one("plant", id)


def experiment(id: str) -> Experiment:
    """Return one experiment. Raises SpecError with near matches."""
    return _one("experiment", id)


def plant_in_full(choice: str | Plant) -> Plant:
    """Return a plant that is given by its id or in full. Raises SpecError for an id that the library lacks."""
    return choice if isinstance(choice, Plant) else plant(choice)


def resolve(spec: Experiment) -> ResolvedExperiment:
    """Return the experiment with its plant in full, all names checked against it; one that is resolved stays as it is.

    Raises SpecError for a plant that the library lacks, and pydantic.ValidationError where the experiment does not fit
    its plant.
    """
    return spec if isinstance(spec, ResolvedExperiment) else spec.with_plant(plant_in_full(spec.plant))


def _one(what: str, id: str):
    names = _names(f"{what}s")
    if id in names:
        return _read(f"{what}s", id)
    raise SpecError(
        what, id, Message(f"library.{what}.unknown", id=str(id)[:80]), Message.from_data(suggestion(id, names))
    )
