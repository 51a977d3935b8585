"""Refusals of the plant schema, without mathematics."""

from collections.abc import Callable
from typing import Any

import pytest
from pydantic import ValidationError

from thetascope.engine.language import identifiers
from thetascope.messages import words
from thetascope_schemas import Plant, field_errors
from thetascope_schemas.experiment.base import FUNCTIONS, MAX_EXPRESSION
from thetascope_schemas.texts import names


def refusal(data: dict[str, Any]) -> tuple[str, str, str]:
    """Return field, problem and remedy of the only error in `data`."""
    with pytest.raises(ValidationError) as caught:
        Plant.model_validate(data)
    (error,) = field_errors(caught.value.errors(), data, words())
    return error.field, error.problem, error.remedy


def test_plant_is_read(plant: dict[str, Any]) -> None:
    """Defaults are filled in, a number stands for its text, and names are listed by group."""
    model = Plant.model_validate(plant)
    assert model.time.kind == "continuous"
    assert model.channels[0].enters == {"x1": "phi", "x2": "1"}
    assert model.names("states", "channels") == ("x1", "x2", "theta1", "theta2")


@pytest.mark.parametrize("name", sorted(FUNCTIONS) + ["t", "pi", "π", "lambda", "if", "None"])
def test_reserved_names_are_refused(plant: dict[str, Any], name: str) -> None:
    """Time, pi, functions and words of the language cannot be names; the remedy is a name that can be used."""
    plant["inputs"][0]["name"] = name
    field, problem, remedy = refusal(plant)
    assert field == "inputs[0].name"
    assert "reserved" in problem
    assert {"lambda": "lam", "π": "pi_1"}.get(name, name + "_1") in remedy


NO_NAMES = ["", "1x", "x-y", "x.y", "x\n", "x" * 33, "x y", "x²", "a·b", "√x", "x\u200b", "x\u202e", "x\ufe0f", "½"]


@pytest.mark.parametrize("name", NO_NAMES)
def test_a_text_that_is_no_identifier_is_refused_as_a_name(plant: dict[str, Any], name: str) -> None:
    """A name has at most 32 letters, digits and underscores; superscripts, dots and invisible characters are none."""
    plant["inputs"][0]["name"] = name
    field, problem, remedy = refusal(plant)
    assert field == "inputs[0].name"
    assert "name" in problem
    assert remedy


@pytest.mark.parametrize(
    ("name", "stored"),
    [("ω", "ω"), ("ϑ", "θ"), ("v₁", "v1"), ("_x", "_x"), ("温度", "温度"), ("é", "é"), ("e\u0301", "é")],
)
def test_a_name_has_one_normal_form(plant: dict[str, Any], name: str, stored: str) -> None:
    """A name may be an identifier in any script; spellings that Unicode calls compatible are one name."""
    plant["inputs"][0]["name"] = name
    assert Plant.model_validate(plant).inputs[0].name == stored


def test_schemas_and_lexer_accept_the_same_characters() -> None:
    """The two definitions of a letter agree on the characters of Unicode, of which every 97th is tried from CJK on."""
    for code in [*range(0x3400), *range(0x3400, 0x110000, 97), *range(0xFE00, 0xFE10), *range(0xFF00, 0x10000)]:
        char = chr(code)
        for first in (True, False):
            assert names.is_letter(char, first) == identifiers.is_letter(char, first), hex(code)


Change = Callable[[dict[str, Any]], object]
CASES: list[tuple[str, str, Change]] = [
    ("dynamics.x3", "x1", lambda p: p["dynamics"].update(x3="1")),
    ("dynamics", "add dynamics.x2", lambda p: p["dynamics"].pop("x2")),
    ("parameters[0].name", "rename", lambda p: p["parameters"][0].update(name="x1")),
    ("channels[0].name", "rename", lambda p: p["channels"][0].update(name="u")),
    ("channels[0].enters.y", "use one of: x1, x2", lambda p: p["channels"][0].update(enters={"y": "1"})),
    ("channels[1].enters.x1", "y", lambda p: p["channels"][1].update(enters={"x1": "1"})),
    ("channels[0].enters", "at least 1", lambda p: p["channels"][0].update(enters={})),
    ("channels[0].kind", "use one of: actuator, process, sensor", lambda p: p["channels"][0].update(kind="plant")),
    ("definitions[0].domain.b", "a", lambda p: p["definitions"][0].update(domain=[0, "b"])),
    ("definitions[0].domain", "[low, high]", lambda p: p["definitions"][0].update(domain=[2, 1])),
    ("states[0].domain", "[low, high]", lambda p: p["states"][0].update(domain=[1, 1])),
    ("parameters[0].value", "[0, 10]", lambda p: p["parameters"][0].update(value=11)),
    ("signals[0].default.width", "width ≤ 1", lambda p: p["signals"][0]["default"].update(width=2)),
    ("signals[0].default", "did you mean pulse", lambda p: p["signals"][0]["default"].update(kind="puls")),
    ("time.period", "give this field", lambda p: p.update(time={"kind": "discrete"})),
    ("states", "at least 1", lambda p: p.update(states=[], dynamics={}, channels=[])),
    ("id", "match", lambda p: p.update(id="Not An Id")),
]


@pytest.mark.parametrize(("field", "remedy", "change"), CASES, ids=[case[0] for case in CASES])
def test_inconsistent_plants_are_refused(plant: dict[str, Any], field: str, remedy: str, change: Change) -> None:
    """Each contradiction is refused with its field and the remedy."""
    change(plant)
    found = refusal(plant)
    assert found[0] == field
    assert remedy in found[2]


@pytest.mark.parametrize(
    ("group", "count", "item"),
    [
        ("states", 61, {"name": "s{}"}),
        ("inputs", 21, {"name": "s{}"}),
        ("outputs", 21, {"name": "s{}", "expression": "x1"}),
        ("channels", 41, {"name": "s{}", "kind": "sensor", "enters": {"y": "1"}}),
    ],
)
def test_sizes_are_limited(plant: dict[str, Any], group: str, count: int, item: dict[str, Any]) -> None:
    """One more than the limit is refused, naming the group."""
    plant[group] = [item | {"name": f"s{index}"} for index in range(count)]
    field, _, remedy = refusal(plant)
    assert field == group
    assert str(count - 1) in remedy


def test_sixty_states_are_accepted(plant: dict[str, Any]) -> None:
    """The limit itself is allowed."""
    names = ["x1"] + [f"s{index}" for index in range(59)]
    plant |= {"states": [{"name": name} for name in names], "dynamics": dict.fromkeys(names, "0")}
    plant |= {"outputs": [{"name": "y", "expression": "x1"}], "definitions": []}
    plant["channels"][0]["enters"] = {"x1": "1"}
    assert len(Plant.model_validate(plant).states) == 60


def test_a_long_expression_is_refused_at_its_column(plant: dict[str, Any]) -> None:
    """2000 characters are accepted; the error points at the next one."""
    plant["dynamics"]["x1"] = "x1" + " " * (MAX_EXPRESSION - 2)
    Plant.model_validate(plant)
    plant["dynamics"]["x1"] += " "
    field, problem, _ = refusal(plant)
    assert field == "dynamics.x1"
    assert "column 2001" in problem
