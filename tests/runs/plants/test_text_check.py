"""The check of a plant's text: every error at its characters, and changes that correct it."""

import re
from pathlib import Path

import pytest

from thetascope import library
from thetascope.messages.catalogue import languages
from thetascope.runs.plants.plant_text import json_text, plant_data, yaml_text
from thetascope.runs.plants.text_check import check_text, format_of
from thetascope.runs.specs.refusals import validated
from thetascope.runs.specs.spec_files import parse
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.service.plants.text import PlantTextCheck, TextPlace

TEXT = """id: two-tanks
title: Two tanks
states:
  - {name: h1, unit: cm, initial: 34, domain: [0, 60]}
  - {name: h2, unit: cm, initial: 20}
inputs:
  - {name: q, unit: cm³/s, default: 50}
outputs:
  - {name: y1, unit: cm, expression: h1}
parameters:
  - {name: A, value: 154, unit: cm², bounds: [1, null]}
  - {name: g, value: 981}
definitions:
  - {name: q12, expression: "2*sqrt(2*g*max(h1 - h2, 0))"}
  - {name: out, expression: "2*sqrt(2*g*max(h2, 0))"}
dynamics:
  h1: (q - q12)/A
  h2: >-
    (q12
     - out)/A
channels:
  - {name: leak, kind: process, enters: {h1: -sqrt(h1)}}
"""
DOCS = Path(__file__).parents[3] / "docs" / "plant-format.md"


def at(text: str, place: TextPlace) -> str:
    """Return the characters at a place, which count as in an editor."""
    units = text.split("\n")[place.line - 1].encode("utf-16-le")
    return units[2 * (place.column - 1) : 2 * (place.column - 1 + place.length)].decode("utf-16-le")


def fixed(text: str, answer: PlantTextCheck) -> str:
    """Return a text after the change of its first error."""
    fix = answer.errors[0].fix
    lines = text.split("\n")
    start = sum(len(line) + 1 for line in lines[: fix.line - 1]) + fix.column - 1
    return text[:start] + fix.text + text[start + fix.length :]


def test_a_plant_without_errors_is_answered_in_full():
    """The answer holds the plant, its sizes and its equations."""
    answer = check_text(TEXT, "en")
    assert answer.valid and answer.errors == () and (answer.id, answer.title) == ("two-tanks", "Two tanks")
    assert answer.plant == validated(Plant, parse(TEXT).data) and answer.sizes.states == 2
    assert [line.name for line in answer.equations.states] == ["h1", "h2"]


@pytest.mark.parametrize(
    ("right", "wrong", "shown"),
    [
        ("2*sqrt(2*g*max(h2", "2*sqr(2*g*max(h2", "sqr"),
        ("2*sqrt(2*g*max(h1", "2*sqrr(2*g*max(h1", "sqrr"),
        ("- out)/A", "- outt)/A", "outt"),  # on a later line of a folded text
        ("(q - q12)", "(q − q12)", "−"),
        ("(q - q12)", "(q q12)", "q12"),
        ("-sqrt(h1)", "-arctan(h1)", "arctan"),
        ("-sqrt(h1)", "-ln(h1)", "ln"),
        ("2*sqrt(2*g*max(h2, 0))", "2sqrt(2*g*max(h2, 0))", "2sqrt"),
        ('"2*sqrt(2*g*max(h2, 0))"', "2*sqrt(2*g*max(h2, 0))", "2*sqrt(2*g*max(h2, 0))"),  # the comma ends the value
        ('max(h2, 0))"', 'max(h2, 0)"', "("),
        ("(q - q12)/A", "(q - q12))/A", ")"),
        ("initial: 20", "initail: 20", "initail"),
        ("value: 981", "value: '981'", "'981'"),
        ("kind: process", "kind: proces", "proces"),
        ("value: 154", "value: 0.5", "0.5"),
        ("  h1: (q - q12)/A\n", "", "dynamics"),
        ("enters: {h1:", "enters: {h11:", "h11"),
        ("  - {name: q, unit", "  - {nam: q, unit", "nam"),
    ],
)
def test_an_error_has_its_characters_and_a_change_that_corrects_it(right, wrong, shown):
    """The underlined characters are the wrong ones, and the change gives a text without errors."""
    text = TEXT.replace(right, wrong)
    assert text != TEXT
    answer = check_text(text, "en")
    (error,) = answer.errors
    assert at(text, error.place) == shown and answer.plant is None
    assert check_text(fixed(text, answer), "en").valid


def test_every_expression_is_read_after_an_error():
    """Errors of several expressions come together, in the order of the text."""
    text = (
        TEXT.replace("2*sqrt(2*g*max(h1", "2*sqr(2*g*max(h1").replace("- out)", "- outt)").replace("sqrt(h1)", "f(h1)")
    )
    answer = check_text(text, "en")
    assert [at(text, error.place) for error in answer.errors] == ["sqr", "outt", "f"]
    assert [error.field for error in answer.errors][:2] == ["definitions[0].expression", "dynamics.h2"]


@pytest.mark.parametrize(
    ("text", "line"),
    [("", 1), ("hello", 1), ("id: [", 1), ("id: a\nstates:\n  - {name: h,\ninputs: 1\n", 3), ("a: &b 1\nc: *b\n", 1)],
)
def test_text_that_is_no_plant_has_an_error_at_a_place(text, line):
    """Also a text that is no YAML gets a line within the text."""
    answer = check_text(text, "en")
    assert not answer.valid and answer.errors[0].place.line == line and answer.errors[0].remedy


@pytest.mark.parametrize(
    "written",
    ['"2*\\u0073qr(q)"', "'2*sqr(q)'", "2*sqr(q)", '"2*\n    sqr(q)"', "|\n    2*sqr(q)", ">\n    2*\n    sqr(q)"],
)
def test_places_count_quotes_escapes_and_line_breaks(written):
    """The name is found in the source, whatever the style of the YAML scalar."""
    text = TEXT.replace("(q - q12)/A", written)
    (error,) = check_text(text, "en").errors
    shown = at(text, error.place)
    assert shown in ("sqr", "\\u0073qr") and error.fix.text == "sqrt"


def test_columns_are_those_of_an_editor():
    """A character beyond the basic plane counts as two, as in JavaScript."""
    text = TEXT.replace("{name: leak, ", "{name: leak, title: 𝄞, ").replace("-sqrt", "-sqr")
    (error,) = check_text(text, "en").errors
    assert at(text, error.place) == "sqr"


@pytest.mark.parametrize("id", sorted(library.plants()))
@pytest.mark.parametrize("language", languages())
def test_a_library_plant_as_text_is_the_plant(id, language):
    """YAML and JSON that are written for the editor are read as the same plant, in each language."""
    plant = library.plant(id)
    expected = plant.model_dump(mode="json", context={"language": language})
    for text, kind in (
        (yaml_text(plant_data(plant, language)), "yaml"),
        (json_text(plant_data(plant, language)), "json"),
    ):
        read = validated(Plant, parse(text).data)
        assert read.model_dump(mode="json", context={"language": language}) == expected and format_of(text) == kind


def test_the_examples_of_the_documentation_are_valid_as_they_are_pasted():
    """Every complete plant in docs/plant-format.md can be pasted."""
    blocks = re.findall(r"```yaml\n(id: .*?)```", DOCS.read_text(), re.DOTALL)
    answers = [check_text(block, "en") for block in blocks]
    assert len(blocks) >= 5 and [answer.errors for answer in answers] == [()] * len(blocks)


@pytest.mark.parametrize("id", sorted(library.plants()))
def test_units_of_library_plants_fit(id):
    """No plant of the library has a term whose dimension does not fit, nor does an example of the documentation."""
    assert check_text(yaml_text(plant_data(library.plant(id), "en")), "en").errors == ()


UNITS = TEXT.replace("value: 981}", "value: 981, unit: cm/s²}").replace('"2*sqrt', '"a*sqrt')
UNITS = UNITS.replace(
    "  - {name: g,", '  - {name: a, value: 2, unit: cm²}\n  - {name: B, value: 1, unit: ""}\n  - {name: g,'
)


@pytest.mark.parametrize(
    ("right", "wrong", "shown", "words"),
    [
        ("(q - q12)/A", "(q - q12*A)/A", "- q12*A", ["m⁵/s", "cm³/s"]),
        ("(q - q12)/A", "(q - q12)", "(q - q12)", ["cm³/s", "cm/s"]),
        ("expression: h1}", "expression: h1*A}", "h1*A", ["m³", "cm"]),
        ('expression: "a*sqrt(2*g*max(h1 - h2, 0))"', 'expression: "a*exp(g)*sqrt(2*g*h1)"', "g", ["cm/s²", "pure"]),
        ("enters: {h1: -sqrt(h1)}", 'unit: "", enters: {h1: -q}', "-q", ["cm³/s", "cm/s"]),
        ("(q - q12)/A", "(q - q12)/A + where(h1 < g, 0, 0)", "g", ["cm/s²", "cm"]),
        ("expression: h1}", "expression: 'deadzone(h1, g)'}", "g", ["cm/s²", "cm"]),
        ("expression: h1}", "expression: 'play(h1, h2, q)'}", "q", ["cm³/s", "cm"]),
        ("(q - q12)/A", "boucwen(q - q12, h1, 1/B, 1, 1, 1)", "boucwen(q - q12, h1, 1/B, 1, 1, 1)", ["cm³/s", "cm/s"]),
    ],
)
def test_a_term_with_another_unit_is_underlined(right, wrong, shown, words):
    """The term is named with its unit and the one that is needed; the plant can be simulated nevertheless."""
    assert check_text(UNITS, "en").errors == ()
    text = UNITS.replace(right, wrong)
    answer = check_text(text, "en")
    (warning,) = answer.errors
    assert answer.valid and warning.severity == "warning" and answer.plant is not None
    assert at(text, warning.place).strip("- ") == shown.strip("- ")
    assert all(f" {word}" in f" {warning.problem} {warning.remedy}".replace(",", " ") for word in words)


@pytest.mark.parametrize("known", ["unit: cm, ", ""])
def test_units_that_are_left_out_are_no_warning(known):
    """Where a quantity has no unit, its equations are not judged: many plants have none."""
    text = re.sub(r"unit: [^,}]*, ", known and "", UNITS).replace(", unit: cm/s²", "")
    assert check_text(text, "en").errors == ()


def test_sentences_are_in_the_chosen_language():
    """The problem and the remedy are Chinese, without a column: the editor shows the place."""
    (error,) = check_text(TEXT.replace("2*sqrt(2*g*max(h2", "2*sqr(2*g*max(h2"), "zh").errors
    assert re.search("[\u4e00-\u9fff]", error.problem) and "sqrt" in error.remedy and "列" not in error.problem


@pytest.mark.parametrize(
    ("right", "wrong", "shown"),
    [
        ("title: Two tanks", "title: Tanks: two", "Tanks: two"),
        ("  h1: (q", "\th1: (q", "\t"),
        ("  h1: (q - q12)/A", "   h1: (q - q12)/A", "h"),
        ("inputs:", "inputs", "s"),
        ("name: h2, unit", "name: h2，unit", "，"),
        ("initial: 20}", "initial: 20", "0"),
        ("bounds: [1, null]}", "bounds: [1, null}", "l"),
        ('max(h2, 0))"}', "max(h2, 0))}", ")"),
        ("name: q, unit", "name:q, unit", "name:q"),
        ("value: 154", "value: 154%", "154%"),
        ("value: 981", "value: 9,81", "9,81"),
    ],
)
def test_a_text_that_is_hardly_yaml_is_corrected_with_one_change(right, wrong, shown):
    """The sentence names the cause, not the parser's trouble further down, and after the change the text is a plant."""
    text = TEXT.replace(right, wrong, 1)
    answer = check_text(text, "en")
    error = answer.errors[0]
    assert not answer.valid and at(text, error.place) == shown and "not valid YAML" not in error.problem
    assert check_text(fixed(text, answer), "en").valid


def test_an_unknown_word_for_a_kind_is_underlined_itself():
    """The change replaces the word, not the part whose kind it says."""
    text = TEXT.replace("states:", "time: {kind: continous}\nstates:")
    answer = check_text(text, "en")
    assert at(text, answer.errors[0].place) == "continous" and answer.errors[0].fix.text == "continuous"
    assert check_text(fixed(text, answer), "en").valid


def test_an_unknown_name_becomes_a_parameter_unless_it_is_taken():
    """A name like no other is declared with one click; the name of a channel cannot be."""
    text = TEXT.replace("(q - q12)/A", "(q - q12)/A - evaporation")
    answer = check_text(text, "en")
    assert answer.errors[0].fix.length == 0
    assert [p.name for p in check_text(fixed(text, answer), "en").plant.parameters] == ["A", "g", "evaporation"]
    assert check_text(TEXT.replace("(q - q12)/A", "(q - q12)/A - leak"), "en").errors[0].fix is None


@pytest.mark.parametrize(("unit", "near"), [("kgm2", "kg·m²"), ("L/mn", "L/min"), ("furlongs·x", None)])
def test_a_unit_that_is_not_known_is_a_warning(unit, near):
    """Equations with it are not checked, which the viewer should know."""
    text = TEXT.replace("value: 154, unit: cm²", f"value: 154, unit: {unit}")
    (warning,) = check_text(text, "en").errors
    assert warning.severity == "warning" and at(text, warning.place) == unit
    assert (warning.fix and warning.fix.text) == near


def test_units_in_sentences_are_those_of_the_plant():
    """Rates of states have their own unit per second, and a product below the line has brackets."""
    answer = check_text(TEXT.replace("h1: (q - q12)/A", "h1: q - q12").replace("2*sqrt", "g*sqrt"), "en")
    assert "cm³/s" in answer.errors[0].problem and "cm/s is needed" in answer.errors[0].problem
