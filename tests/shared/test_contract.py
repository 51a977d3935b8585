"""Properties of all schemas together."""

import json

import pytest
from pydantic import TypeAdapter, ValidationError

import thetascope_schemas as shared
from thetascope.engine.language.parser import FUNCTIONS, MAX_LENGTH
from thetascope.messages import words
from thetascope.messages.catalogue import catalogue
from thetascope_schemas.experiment import base
from thetascope_schemas.experiment.base import Strict
from thetascope_schemas.experiment.faults import Fault
from thetascope_schemas.experiment.signals import Signal
from thetascope_schemas.service import run
from thetascope_schemas.service.field_error import PYDANTIC_CODES, field_errors


def every_schema(parent: type[Strict] = Strict) -> list[type[Strict]]:
    found = []
    for child in parent.__subclasses__():
        found += [child, *every_schema(child)]
    return found


# bases of fault shapes and commands, which never stand alone
ABSTRACT = {"TimedFault", "ChannelFault", "MeasurementFault", "Timed", "Command"}
# what a server says on a session's stream: it is written by the program alone and shown on no form
SAID = {"Hello", "Ack", "Refused", "Status", "Event", "Columns", "Rewound", "Jump", "Spec", "Assumptions"}
# answers that are only sent, never read; tests/api/test_api_answers.py holds them to the service
ANSWERS = ("thetascope_schemas.service.answers", "thetascope_schemas.service.classroom.views")
# the same beside schemas that are read: lists and comparisons of runs, descriptions of printed figures
SENT = {
    *("RunChange", "RunLine", "RunList", "SettingRow", "MeasureRow", "RunComparison"),
    *("PrintedCurve", "PrintedPanel", "PrintedFigure"),
}
SCHEMAS = [
    s
    for s in every_schema()
    if s.__module__.startswith("thetascope_schemas")
    and s.__module__ not in ANSWERS
    and s.__name__ not in ABSTRACT | SAID | SENT
]


@pytest.mark.parametrize("schema", SCHEMAS, ids=lambda schema: schema.__name__)
def test_every_schema_has_a_valid_example(schema: type[Strict]) -> None:
    """It survives the conversion to JSON and back."""
    (example,) = schema.model_json_schema()["examples"]
    model = schema.model_validate_json(json.dumps(example))
    assert schema.model_validate_json(model.model_dump_json()) == model


@pytest.mark.parametrize("schema", SCHEMAS, ids=lambda schema: schema.__name__)
def test_every_schema_refuses_unknown_fields(schema: type[Strict]) -> None:
    """A misspelt field is never ignored: it is named, and the nearest field is suggested."""
    data = dict(schema.model_json_schema()["examples"][0])
    field = next(iter(schema.model_fields))
    data[field + "s_"] = 1
    with pytest.raises(ValidationError) as caught:
        schema.model_validate(data)
    (error,) = field_errors(caught.value.errors(), data, words())
    assert error.field == field + "s_"
    assert error.problem == "unknown field"
    assert field in error.remedy


def test_examples_cover_every_kind_of_signal_and_fault() -> None:
    """The eleven signals and fifteen fault shapes are distinguished by one field."""
    signals = {
        s.model_fields["kind"].default for s in SCHEMAS if s.__module__ == "thetascope_schemas.experiment.signals"
    }
    faults = {
        s.model_fields["shape"].default for s in SCHEMAS if s.__module__ == "thetascope_schemas.experiment.faults"
    }
    smooth = {"sine", "ramp", "chirp", "table", "expression"}
    assert signals == smooth | {"constant", "steps", "pulse", "square", "prbs", "noise"}
    inside = "step ramp drift exponential sine pulse-train random-walk table"
    outside = "stuck freeze dropout outliers noise-burst quantisation delay"
    assert faults == set(f"{inside} {outside}".split())
    for adapter, tag, names in ((TypeAdapter(Signal), "kind", signals), (TypeAdapter(Fault), "shape", faults)):
        for schema in SCHEMAS:
            field = schema.model_fields.get(tag)
            if (
                field
                and field.default in names
                and schema.__module__
                in ("thetascope_schemas.experiment.signals", "thetascope_schemas.experiment.faults")
            ):
                example = schema.model_json_schema()["examples"][0]
                assert type(adapter.validate_python(example)) is schema


def test_schemas_and_engine_agree_on_the_language() -> None:
    """A plant may not name a quantity like a function, so both must have the same functions and limit."""
    assert set(FUNCTIONS) == set(base.FUNCTIONS)
    assert MAX_LENGTH == base.MAX_EXPRESSION


def test_every_field_is_described_or_self_explanatory() -> None:
    """Numbers in the OpenAPI page have a meaning and a unit."""
    for schema in SCHEMAS:
        for name, field in schema.model_json_schema()["properties"].items():
            if field.get("type") == "number":
                assert field.get("description"), f"{schema.__name__}.{name}"


def test_instances_are_immutable() -> None:
    """A hashed spec cannot change."""
    noise = shared.Noise(std=0.1)
    with pytest.raises(ValidationError):
        noise.std = 0.2  # type: ignore[misc]


@pytest.mark.parametrize("value", ["0.1", True, None, float("nan"), float("inf"), 10**400, [1], {}])
def test_only_finite_numbers_are_numbers(value: object) -> None:
    """Text, booleans, infinities and integers beyond double precision are refused, naming the field."""
    with pytest.raises(ValidationError) as caught:
        shared.Noise.model_validate({"std": value})
    (error,) = field_errors(caught.value.errors(), {"std": value}, words())
    assert error.field == "std"
    assert error.remedy
    json.dumps(error.model_dump(), allow_nan=False)  # an error can always be sent


def test_problem_is_rfc_9457() -> None:
    """A problem has type, title, status and detail, and lists each field with value and remedy."""
    problem = run.Problem(
        title="Refused", status=422, errors=[{"field": "a", "value": 1, "problem": "too large", "remedy": "a < 1"}]
    )
    sent = json.loads(problem.model_dump_json())
    assert sent["type"] == "about:blank"
    error = {"field": "a", "value": 1, "code": "", "args": {}, "problem": "too large", "remedy": "a < 1"}
    assert sent["errors"] == [error]


def test_without_catalogues_an_error_is_its_code_and_arguments() -> None:
    """The schemas alone show the code of a refusal and its arguments readably."""
    with pytest.raises(ValidationError) as caught:
        TypeAdapter(Fault).validate_python({"channel": "a", "shape": "step", "onset": 20, "end": 5, "size": 1})
    (error,) = field_errors(caught.value.errors())
    assert (error.code, error.args) == ("fault.end.before-onset", {"end": 5.0, "onset": 20.0})
    assert error.problem == "fault.end.before-onset(end=5, onset=20)"
    assert "fault.end.before-onset(end=5, onset=20)" in str(caught.value)


@pytest.mark.parametrize("language", ["en", "zh"])
def test_every_kind_of_error_of_pydantic_has_words(language: str) -> None:
    """Each kind that the schemas can cause, and the rest together, has a problem and a remedy in every language."""
    templates = catalogue(language).templates
    for kind in PYDANTIC_CODES - {"union_tag_invalid"} | {"other"}:
        code = f"schema.{kind.replace('_', '-')}"
        assert code in templates and f"{code}.remedy" in templates
