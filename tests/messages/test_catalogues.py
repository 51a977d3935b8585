"""The catalogues are complete: every code has words in every language, and every entry is used."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from babel.messages.pofile import read_po

from thetascope.api.routes.catalogue import form_codes, members
from thetascope.messages.catalogue import FOLDER, catalogue, languages
from thetascope_schemas.experiment.faults import Fault
from thetascope_schemas.experiment.signals import Signal
from thetascope_schemas.service.field_error import PYDANTIC_CODES

ROOT = Path(__file__).parents[2]
CODE = re.compile(r"[a-z][a-z0-9]*(?:\.[a-z0-9-]+)+")
FIELD = re.compile(r"\{(\w+)(?::[^{}]*)?\}")
CJK = re.compile("[\u3400-\u9fff]")
SAME_IN_CHINESE = {"join.comma"}
"""Entries of the server whose Chinese has no Chinese character, beside those that only join their arguments."""


def server_codes() -> set[str]:
    """Return the codes of the server's catalogues; page.po is the page's."""
    codes = set()
    for path in (FOLDER / "en").glob("*.po"):
        if path.stem != "page":
            codes |= codes_of(path)
    return codes


def codes_of(path: Path) -> set[str]:
    with path.open("rb") as file:
        ids = [entry.id for entry in read_po(file) if entry.id]
    return {id if isinstance(id, str) else id[0] for id in ids}


@cache
def nodes() -> tuple[tuple[str, ast.AST], ...]:
    """Return every node of the code's syntax trees, with its file."""
    files = [path for folder in ("backend", "shared") for path in (ROOT / folder).rglob("*.py")]
    return tuple(
        (str(path.relative_to(ROOT)), node)
        for path in files
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Constant | ast.JoinedStr | ast.Call)
    )


@cache
def used() -> tuple[frozenset[str], tuple[re.Pattern[str], ...]]:
    """Return the texts in code and templates that have the form of codes, and patterns of those composed of parts."""
    codes, patterns = set(), set()
    for _, node in nodes():
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and CODE.fullmatch(node.value):
            codes.add(node.value)
        if isinstance(node, ast.JoinedStr) and (pattern := pattern_of(node)):
            patterns.add(pattern)
    for path in (ROOT / "backend").rglob("templates/*.html"):
        codes |= set(re.findall(rf'"({CODE.pattern})"', path.read_text(encoding="utf-8")))
    return frozenset(codes), tuple(re.compile(pattern) for pattern in sorted(patterns))


def pattern_of(node: ast.JoinedStr) -> str | None:
    """Return the pattern of a composed text that begins like a code with a dot: f"plant.{kind}.unknown"."""
    first = node.values[0]
    if not isinstance(first, ast.Constant) or not re.fullmatch(r"[a-z][a-z0-9]*\.[a-z0-9.-]*", str(first.value)):
        return None
    return "".join(
        re.escape(str(part.value)) if isinstance(part, ast.Constant) else "[a-z0-9-]+" for part in node.values
    )


def messages() -> Iterator[tuple[str, str]]:
    """Yield the codes that the code gives to Message, refuse and the like, with the place."""
    for file, node in nodes():
        if not isinstance(node, ast.Call) or not node.args:
            continue
        name = node.func.id if isinstance(node.func, ast.Name) else getattr(node.func, "attr", "")
        first = node.args[0]
        if name in ("Message", "Wording", "refuse", "say") and isinstance(first, ast.Constant):
            yield str(first.value), f"{file}:{node.lineno}"


def test_every_code_that_is_used_has_words():
    """A message of the server is never shown as its code."""
    known = catalogue("en").templates
    assert {place: code for code, place in messages() if code not in known} == {}


@pytest.mark.parametrize("kind", sorted(PYDANTIC_CODES))
def test_every_kind_of_pydantics_errors_has_words(kind):
    """Codes made of pydantic's own kinds are complete, too."""
    assert f"schema.{kind.replace('_', '-')}" in catalogue("en").templates


def form_descriptions() -> set[str]:
    """Return the codes of the descriptions in the forms of faults and signals."""
    unions = ((Fault, "shape"), (Signal, "kind"))
    return {code for union, tag in unions for model in members(union) for code in form_codes(model, tag).values()}


def test_every_field_of_a_form_has_words():
    """Faults, signals and their fields are described in every language."""
    assert form_descriptions() <= set(catalogue("en").templates)


def test_every_entry_is_used():
    """An entry that no code mentions is removed; remedies and titles belong to their problem."""
    codes, patterns = used()
    kinds = {f"schema.{kind.replace('_', '-')}" for kind in PYDANTIC_CODES} | form_descriptions()

    def is_used(code: str) -> bool:
        base = re.sub(r"\.(remedy|title)$", "", code)
        return bool({code, base} & (codes | kinds)) or any(p.fullmatch(code) or p.fullmatch(base) for p in patterns)

    assert sorted(code for code in server_codes() if not is_used(code)) == []


@pytest.mark.parametrize("language", [name for name in languages() if name != "en"])
def test_every_language_has_the_same_entries_with_the_same_arguments(language):
    """A translation uses the arguments of the English sentence and no others; files correspond."""
    english, other = catalogue("en").templates, catalogue(language).templates
    for path in sorted((FOLDER / "en").glob("*.po")):
        assert codes_of(path) == codes_of(FOLDER / language / path.name), path.name
    assert sorted(english) == sorted(other)
    for code, template in other.items():
        assert fields(template) <= fields(english[code]), code


def fields(template: str | tuple[str, ...]) -> set[str]:
    forms = [template] if isinstance(template, str) else template
    return {name for form in forms for name in FIELD.findall(form)}


def test_chinese_entries_are_chinese():
    """An untranslated entry is found; symbols and joined arguments are not sentences."""

    def words(template: str | tuple[str, ...]) -> str:
        return FIELD.sub("", template if isinstance(template, str) else template[0])

    english, codes = catalogue("en").templates, server_codes()
    chinese = {code: template for code, template in catalogue("zh").templates.items() if code in codes}
    left = {
        code: words(template)
        for code, template in chinese.items()
        if not CJK.search(words(template)) and re.search("[A-Za-z]{2}", words(english[code]))
    }
    assert set(left) <= SAME_IN_CHINESE, left
