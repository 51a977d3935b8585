"""The codes that the page uses are those of the catalogues: none is missing, none is unused."""

import re
from pathlib import Path
from typing import get_args

import pytest

from thetascope.api.routes.catalogue import members
from thetascope.messages.catalogue import catalogue, languages
from thetascope_schemas.experiment.faults import Fault
from thetascope_schemas.service.run import AssumptionCheck

FRONTEND = Path(__file__).parents[2] / "frontend"
LITERAL = re.compile(r"""(['"`])(page\.[^'"`\s]+)\1""")
FIELD = re.compile(r"\$\{[^{}]*\}")
OTHER = {"channel", "output", "onset", "shape"}  # fields of a fault that the form shows by other means


def written() -> set[str]:
    """Return the codes that the page's scripts name; a part that is filled in at run time is `*`."""
    scripts = [path for path in FRONTEND.rglob("*.js") if "vendor" not in path.parts]
    return {FIELD.sub("*", found[2]) for path in scripts for found in LITERAL.finditer(path.read_text("utf-8"))}


def page_codes(language: str) -> set[str]:
    """Return the codes of the page in a language's catalogue."""
    return {code for code in catalogue(language).templates if code.startswith("page.")}


def matches(pattern: str, code: str) -> bool:
    """Return whether a code equals the named one, or belongs to its family."""
    return re.fullmatch(re.escape(pattern).replace(r"\*", r"[\w-]+"), code) is not None


@pytest.mark.parametrize("language", languages())
def test_every_code_that_the_page_uses_has_words(language):
    """A family, such as the shapes of faults, has at least two members."""
    codes, patterns = page_codes(language), written()
    assert len(patterns) > 300
    assert {one for one in patterns if "*" not in one} - codes == set()
    assert [one for one in patterns if "*" in one and sum(matches(one, code) for code in codes) < 2] == []


@pytest.mark.parametrize("language", languages())
def test_every_entry_of_the_page_is_used(language):
    """An unused entry is removed from the catalogue. The remedy of a refusal belongs to its problem."""
    plain = written() | {f"{code}.remedy" for code in written()}
    families = {one for one in plain if "*" in one}
    left = page_codes(language) - plain
    assert sorted(code for code in left if not any(matches(one, code) for one in families)) == []


@pytest.mark.parametrize("language", languages())
def test_every_shape_and_field_of_a_fault_has_words(language):
    """Faults are declared in the schemas; the page names their shapes and fields, and no others."""
    codes = page_codes(language)
    models = members(Fault)
    shapes = {model.model_fields["shape"].default for model in models}
    fields = {name for model in models for name in model.model_fields} - OTHER
    assert {code.removeprefix("page.fault.shape.") for code in codes if code.startswith("page.fault.shape.")} == shapes
    assert {code.removeprefix("page.fault.field.") for code in codes if code.startswith("page.fault.field.")} == fields


@pytest.mark.parametrize("language", languages())
def test_every_verdict_has_words(language):
    """Each verdict of an assumption's check in the contract."""
    codes = page_codes(language)
    allowed = get_args(AssumptionCheck.model_fields["verdict"].annotation)
    verdicts = {f"page.observers.verdict.{verdict.replace(' ', '-')}" for verdict in allowed}
    assert {code for code in codes if code.startswith("page.observers.verdict.")} == verdicts


@pytest.mark.parametrize("language", languages())
def test_named_kinds_of_observers_exist(language):
    """A short name on the page belongs to a kind of observer that can be built;
    a kind without one is shown by its title."""
    from thetascope.engine.observers import registry

    prefix = "page.observers.type."
    named = {code.removeprefix(prefix) for code in page_codes(language) if code.startswith(prefix)}
    assert named <= set(registry.kinds())
