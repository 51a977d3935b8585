"""Check the text of a plant: all errors at once, each with its place and, where there is one, the change that helps."""

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from thetascope.engine.errors import SpecError
from thetascope.messages import Message, words
from thetascope.runs.plants.remedies import Fix, fix_of, unquoted
from thetascope.runs.plants.text_places import Span, seen, span_of, word_at
from thetascope.runs.plants.unit_check import Mismatch, mismatches
from thetascope.runs.plants.yaml_repairs import repair
from thetascope.runs.specs.refusals import InvalidSpec, from_engine, invalid, validated
from thetascope.runs.specs.spec_files import Document, DocumentError, parse
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.service.answers import PlantEquations, PlantSizes
from thetascope_schemas.service.field_error import FieldError
from thetascope_schemas.service.plants.text import PlantTextCheck, TextError, TextFix, TextFormat, TextPlace

_MOST = 20


def check_text(text: str, language: str) -> PlantTextCheck:
    """Return the errors of a plant's text, and without errors the plant, its sizes and its equations.

    Every expression is read, also after one with an error. Terms whose units do not fit are warnings. Sentences and
    prose are in a language.
    """
    text = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")
    try:
        document = parse(text)
    except DocumentError as error:
        return _answer(Document(None, text), [_unreadable(text, error, language)], language)
    try:
        plant = validated(Plant, document.data)
    except InvalidSpec as error:
        return _answer(document, [_found(document, one, language) for one in _causes(error.errors)], language)
    data = plant.model_dump(mode="json")
    errors = [_found(document, one, language) for one in _engine_errors(plant, data)]
    if errors:
        return _answer(document, errors, language)
    return _answer(document, [_unit(document, one, language) for one in mismatches(plant)], language, plant)


def _unreadable(text: str, error: DocumentError, language: str) -> TextError:
    """Return the error of a text that is no YAML, where possible with the change after which it is."""
    broken = Document(None, text)
    found = repair(text, error.place) if error.problem.code == "document.no-yaml" else None
    if found is None:
        (problem,) = invalid("", None, error.problem, error.remedy).errors
        return _located(broken, problem, word_at(text, error.place), language)
    (problem,) = invalid("", None, found.problem).errors
    return _located(broken, problem, seen(text, found.span), language, Fix(found.span, found.text))


@dataclass(frozen=True)
class TextFacts:
    """Facts of a plant's text; the defaults are those of a text that cannot be read.

    Args:
        id, title: as they are written; "" if they are not.
        faults: number of its fault channels.
        is_plant: whether it has all fields of a plant; its expressions may have errors.
    """

    id: str = ""
    title: str = ""
    faults: int = 0
    is_plant: bool = False


def facts_of_text(text: str) -> TextFacts:
    """Return the facts of a text. Expressions are not read. A large text takes seconds: call it in a worker."""
    try:
        document = parse(text)
    except DocumentError:
        return TextFacts()
    written = document.data.get("id") if isinstance(document.data, Mapping) else None
    id, title = written[:65] if isinstance(written, str) else "", title_in(document, "en")
    try:
        plant = validated(Plant, document.data)
    except InvalidSpec:
        return TextFacts(id, title)
    return TextFacts(id, title, len(plant.channels), True)


def has_no_errors(text: str) -> bool:
    """Return whether a text is a complete plant whose expressions have no errors."""
    try:
        plant = validated(Plant, parse(text).data)
    except (DocumentError, InvalidSpec):
        return False
    return next(_engine_errors(plant, plant.model_dump(mode="json")), None) is None


def format_of(text: str) -> TextFormat:
    """Return whether a text is meant as JSON or YAML."""
    return "json" if text.lstrip("\ufeff \t\r\n").startswith("{") else "yaml"


def _causes(errors: tuple[FieldError, ...]) -> list[FieldError]:
    """Return errors without lists that are too short only because their items have errors."""
    fields = [error.field for error in errors]
    return [
        error
        for error in errors
        if error.code != "schema.too-short" or not any(field.startswith(f"{error.field}[") for field in fields)
    ]


def _engine_errors(plant: Plant, data: dict[str, Any]) -> Iterator[FieldError]:
    """Yield the errors of the equations. An expression with an error is replaced, so that later ones are read, too."""
    from thetascope.engine.model.plant_model import Model
    from thetascope.engine.programs.program_store import closed_loop_program, plant_program

    for _ in range(_MOST):
        try:
            Model(data)
            plant_program(data)
            if plant.controllers:
                closed_loop_program(data, (), 1)
        except SpecError as error:
            yield from from_engine(error).errors
            if not _neutral(data, error.field):
                return
        else:
            return


def _neutral(data: Any, field: str) -> bool:
    """Replace the expression at a path by one without errors; return whether there was an expression."""
    *path, last = field.split(".")
    for part in path:
        try:
            data = data[int(part) if isinstance(data, list) else part]
        except (KeyError, IndexError, ValueError, TypeError):
            return False
    neutral = (
        {"when": "1 > 0", "equation": f"{data.get('name')} = 1"}.get(last, "1") if isinstance(data, dict) else None
    )
    if neutral is None or not isinstance(data.get(last), str) or data[last] == neutral:
        return False
    data[last] = neutral
    return True


def _unit(document: Document, wrong: Mismatch, language: str) -> TextError:
    """Return the warning about a term whose unit does not fit."""
    term = wrong.text[wrong.start : wrong.end]
    args = {"problem": wrong.problem.as_data(), "column": wrong.start + 1}
    args["remedy"] = Message(f"{wrong.problem.code}.remedy", **wrong.problem.args).as_data()
    error = FieldError(field=wrong.field, value=term, code="expression.at", args=args, problem="", remedy="")
    shown = _found(document, error, language)
    near = wrong.problem.args.get("near")
    fix = TextFix(**shown.place.model_dump(), text=str(near)) if near else None
    return shown.model_copy(update={"severity": "warning", "fix": fix})


def _found(document: Document, error: FieldError, language: str) -> TextError:
    value = unquoted(document, error)
    if value is not None:
        text = document.text[value.start : value.end]
        if re.fullmatch(r"[-+]?\d+,\d+", text):
            (comma,) = invalid(error.field, text, Message("document.decimal-comma")).errors
            return _located(document, comma, value, language, Fix(value, text.replace(",", ".")))
        (comma,) = invalid(error.field, text, Message("document.unquoted")).errors
        return _located(document, comma, value, language, Fix(value, json.dumps(text, ensure_ascii=False)))
    return _located(document, error, span_of(document, error), language)


def _located(document: Document, error: FieldError, place: Span, language: str, fix: Fix | None = None) -> TextError:
    """Return an error with its place and its change. An editor shows the place, so the sentence omits the column."""
    fix = fix or fix_of(document, error, place)
    shown = error.rendered(words(language))
    problem = error.args.get("problem")
    if error.code == "expression.at" and isinstance(problem, dict):
        shown = shown.model_copy(update={"problem": Message.from_data(problem).text(language)})
    return TextError(
        **{name: getattr(shown, name) for name in FieldError.model_fields},
        place=TextPlace(**_coordinates(document.text, place)),
        fix=None if fix is None else TextFix(**_coordinates(document.text, fix.span), text=fix.text),
    )


def _coordinates(text: str, span: Span) -> dict[str, int]:
    begin = text.rfind("\n", 0, span.start) + 1
    return {
        "line": text.count("\n", 0, span.start) + 1,
        "column": _units(text[begin : span.start]) + 1,
        "length": _units(text[span.start : span.end]),
    }


def _units(text: str) -> int:
    return len(text) + sum(char > "\uffff" for char in text)


def _answer(document: Document, errors: list[TextError], language: str, plant: Plant | None = None) -> PlantTextCheck:
    from thetascope.assembly.analyses.equations import equations_of

    data = document.data if isinstance(document.data, dict) else {}
    return PlantTextCheck(
        format=format_of(document.text),
        id=str(data.get("id") or "")[:64],
        title=title_in(document, language),
        valid=plant is not None,
        errors=tuple(sorted(errors, key=lambda error: (error.place.line, error.place.column))),
        plant=plant,
        sizes=None if plant is None else _sizes(plant),
        equations=None if plant is None else PlantEquations(**equations_of(plant, (), language)["plant"]),
    )


def _sizes(plant: Plant) -> PlantSizes:
    return PlantSizes(
        states=len(plant.states), inputs=len(plant.inputs), outputs=len(plant.outputs), channels=len(plant.channels)
    )


def title_in(document: Document, language: str) -> str:
    """Return the title in a text, also of a plant with errors; "" if it has no title."""
    title = document.data.get("title") if isinstance(document.data, dict) else None
    if isinstance(title, dict):
        title = title.get(language, next(iter(title.values()), ""))
    return str(title or "")[:200]
