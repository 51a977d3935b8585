"""What all schemas stand on: the strict base class, the number and name types, and refusals that carry a remedy."""

import keyword
import math
import re
import reprlib
from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from typing import Annotated, Any, ClassVar, Protocol

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, JsonValue, model_validator
from pydantic_core import PydanticCustomError

SCHEMA_VERSION = 1
"""Version of these schemas. It enters every spec's hash: raise it when the same spec comes to mean other numbers."""

MAX_EXPRESSION = 2000  # characters of one expression
MAX_STATES = 60
MAX_PORTS = 20  # inputs, and outputs
MAX_CHANNELS = 40
MAX_OBSERVERS = 12
MAX_FAULTS = 200
MAX_POINTS = 200_000  # of one table
MAX_STEPS = 20_000_000  # horizon divided by the step or by any sample time

FUNCTIONS = frozenset(
    (
        "sin",
        "cos",
        "tan",
        "asin",
        "acos",
        "atan",
        "atan2",
        "sinh",
        "cosh",
        "tanh",
        "exp",
        "log",
        "sqrt",
        "abs",
        "sign",
        "min",
        "max",
        "clip",
        "heaviside",
        "step",
        "floor",
        "where",
        "spow",
        "backlash",
    )
)
"""Functions of the expression language (backend/thetascope/engine/language/parser.py; a test holds the two lists together)."""

RESERVED = FUNCTIONS | {"t", "pi"}
"""Names a plant cannot give to a quantity: time, the one constant, and the functions."""


def refuse(problem: str, remedy: str, field: str = "", value: object = None) -> PydanticCustomError:
    """The error that a validator raises: what is wrong with which value of which field, and what to do about it."""
    context = {"problem": problem, "remedy": remedy, "field": field, "value": value}
    return PydanticCustomError("refused", "{problem}; {remedy}", context)


def suggest(word: str, known: Iterable[str]) -> str:
    """A remedy for a misspelt word: the nearest known ones, or all of them."""
    names = sorted(known)
    near = get_close_matches(word, names, n=3, cutoff=0.6)
    if near:
        return f"did you mean {' or '.join(near)}?"
    if not names:
        return "none is declared here: remove it"
    return f"use one of: {', '.join(names[:40])}{', …' if len(names) > 40 else ''}"


def example(**values: object) -> ConfigDict:
    """Model configuration that shows one example in the OpenAPI page."""
    return ConfigDict(json_schema_extra={"examples": [values]})


class Strict(BaseModel):
    """Base of every schema: unknown fields are refused, numbers are finite, an instance does not change.

    `prose` names the fields that change no number of a run; the canonical form leaves them out.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
    prose: ClassVar[frozenset[str]] = frozenset({"title", "description", "source", "unit"})

    @model_validator(mode="before")
    @classmethod
    def _known_fields(cls, data: object) -> object:
        """Refuse unknown fields with the nearest known one (`extra="forbid"` alone would only say "not permitted")."""
        if isinstance(data, Mapping):
            for key in data:
                if key not in cls.model_fields:
                    shown = str(key)[:80]
                    raise refuse("unknown field", suggest(shown, cls.model_fields), shown, data[key])
        return data


def canonical(value: object) -> object:
    """`value` as JSON data in one spelling: no prose, whole floats and -0.0 as integers, single blanks in text."""
    if isinstance(value, Strict):
        fields = type(value).model_fields
        return {name: canonical(getattr(value, name)) for name in fields if name not in value.prose}
    if isinstance(value, Mapping):
        return {str(key): canonical(item) for key, item in value.items()}
    if isinstance(value, str):
        return " ".join(value.split())
    if isinstance(value, Sequence):
        return [canonical(item) for item in value]
    if isinstance(value, float) and value.is_integer() and abs(value) < 2**53:
        return int(value)
    return value


def _not_reserved(name: str) -> str:
    if name in RESERVED or keyword.iskeyword(name):
        meaning = "a word of the language" if keyword.iskeyword(name) else "a function, a constant or the time"
        raise refuse(f"the name {name!r} is reserved ({meaning})", f"choose another, such as {name}_1", value=name)
    return name


def _as_text(value: object) -> object:
    """A plain number where an expression is expected is that number's text (YAML: `enters: {x1: 1}`)."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return value
    if not math.isfinite(value):
        raise refuse("the number is not finite", "give a finite number or an expression", value=str(value))
    return str(canonical(value))


def _short_enough(text: str) -> str:
    if len(text) > MAX_EXPRESSION:
        raise refuse(
            f"the expression has {len(text)} characters and passes the limit at column {MAX_EXPRESSION + 1}",
            f"keep it within {MAX_EXPRESSION} characters, with intermediate quantities under definitions",
            value=text[:60] + "…",
        )
    return text


def ordered(bounds: tuple[Any, Any]) -> tuple[Any, Any]:
    low, high = bounds
    if isinstance(low, float) and isinstance(high, float) and not low < high:
        raise refuse(f"the lower bound {low:g} is not below the upper bound {high:g}", "give them as [low, high]")
    return bounds


Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
"""A finite number; neither a text nor a truth value is taken for one."""
Positive = Annotated[float, Field(strict=True, gt=0, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(strict=True, ge=0, allow_inf_nan=False)]
MAX_TIME = 1e9
"""The latest time in s: beyond it steps of a microsecond are lost in rounding."""
Instant = Annotated[float, Field(strict=True, ge=0, le=MAX_TIME, allow_inf_nan=False)]
"""A time in s."""
Seed = Annotated[int, Field(strict=True, ge=0, le=2**53 - 1)]
"""Seed of a generator; at most 2^53 − 1, so that every JSON reader keeps it exact."""
Flag = Annotated[bool, Field(strict=True)]

Identifier = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]{0,63}$")]
Reference = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]{0,31}$")]
"""The name of something declared elsewhere."""
Name = Annotated[Reference, AfterValidator(_not_reserved)]
"""A name that is declared here: a letter, then up to 31 letters, digits or underscores, and not reserved."""
Title = Annotated[str, Field(max_length=200)]
Prose = Annotated[str, Field(max_length=10_000)]
Unit = Annotated[str, Field(max_length=32, description="Unit in plain text, empty when dimensionless.")]
ExpressionText = Annotated[
    str,
    BeforeValidator(_as_text),
    AfterValidator(_short_enough),
    Field(min_length=1, json_schema_extra={"maxLength": MAX_EXPRESSION}),
]
Bounds = Annotated[tuple[Number | None, Number | None], AfterValidator(ordered)]
"""[low, high]; null leaves a side open."""
UNBOUNDED: tuple[None, None] = (None, None)


class Worded(Protocol):
    """A message that can be rendered: `thetascope.messages.Message`, without importing it."""

    def as_data(self) -> dict[str, Any]: ...

    def text(self, language: str = "en") -> str: ...


class Text(Strict):
    """A message: code, arguments, and the sentence in the asked language."""

    model_config = example(code="common.states", args={"n": 2}, text="2 states")

    code: str = Field(description="Key of the sentence in the catalogues, GET /api/messages/{language}.")
    args: dict[str, JsonValue] = Field(
        default_factory=dict, description="Arguments of the sentence by name; a nested message is {code, args}."
    )
    text: str = Field("", description="The sentence in the asked language.")

    @classmethod
    def of(cls, message: Worded, language: str = "en") -> "Text":
        """Return a message with its sentence in a language."""
        return cls(**message.as_data(), text=message.text(language))


class FieldError(Strict):
    """One reason for a refusal: the field, the value that arrived, the problem and the remedy."""

    model_config = example(field="faults[0].end", value=5, problem="the end is not after the onset", remedy="end > 20")

    field: str = Field(description="Path of the field, for example faults[0].end.")
    value: Any = Field(None, description="What arrived, shortened.")
    problem: str = Field(description="What is wrong with it.")
    remedy: str = Field(description="What to do about it.")


_REMEDIES = {
    "missing": "give this field",
    "float_type": "give a number, without quotes (in YAML 1.1 files write 1.0e-3, not 1e-3)",
    "int_type": "give a whole number",
    "finite_number": "give a finite number",
    "bool_type": "give true or false",
    "string_type": "give a text",
    "string_pattern_mismatch": "write it to match {pattern}",
    "union_tag_not_found": "give {discriminator}, which tells the kind",
    "json_invalid": "send valid JSON",
    "literal_error": "use one of: {expected}",
    "greater_than": "give a value above {gt}",
    "greater_than_equal": "give a value of at least {ge}",
    "less_than_equal": "give a value of at most {le}",
    "too_short": "give at least {min_length}",
    "too_long": "give at most {max_length}",
    "string_too_short": "give at least {min_length} characters",
    "string_too_long": "give at most {max_length} characters",
    "model_type": "give a mapping of fields to values",
    "model_attributes_type": "give a mapping of fields to values",
    "dict_type": "give a mapping of names to values",
    "tuple_type": "give a list",
}


def _remedy(error: Mapping[str, Any], context: Mapping[str, Any]) -> str:
    if error["type"] == "union_tag_invalid":
        return suggest(str(context["tag"])[:80], re.findall(r"'([^']*)'", context["expected_tags"]))
    template = _REMEDIES.get(error["type"])
    return template.format_map(context) if template else "give a value that the schema in /docs permits"


def _path(location: Sequence[str | int], data: object, kind: str) -> str:
    """Path as a person writes it. Tags of unions, which pydantic adds, are dropped where `data` has no such key."""
    path, known = "", data is not None
    for index, part in enumerate(location):
        if known and isinstance(data, Mapping):
            if part not in data and not (kind == "missing" and index == len(location) - 1):
                continue
            data = data.get(part)
        elif known and isinstance(data, list | tuple) and isinstance(part, int):
            data = data[part] if part < len(data) else None
        elif known:
            continue
        path += f"[{part}]" if isinstance(part, int) else f".{part}" if path else str(part)
    return path


def _shown(value: object) -> object:
    """A value short enough for an error message and always valid JSON."""
    if value is None or isinstance(value, bool) or (isinstance(value, float) and math.isfinite(value)):
        return value
    if isinstance(value, int) and abs(value) < 2**53:
        return value
    text = value if isinstance(value, str) else reprlib.repr(value)
    return text if len(text) <= 80 else text[:79] + "…"


def field_errors(errors: Iterable[Mapping[str, Any]], data: object = None) -> list[FieldError]:
    """Pydantic's errors in this project's form.

    Args:
        errors: `ValidationError.errors()`, at most the first 20 are kept.
        data: the data that was validated; with it, paths read as the sender wrote them.
    """
    found = []
    for error in list(errors)[:20]:
        context = error.get("ctx") or {}
        path = _path(error["loc"], data, error["type"])
        if error["type"] == "refused":
            path = ".".join(part for part in (path, context["field"]) if part).replace(".[", "[")
            value = context["value"] if context["value"] is not None else error.get("input")
            problem, remedy = context["problem"], context["remedy"]
        else:
            value, problem = error.get("input"), error["msg"]
            remedy = _remedy(error, context)
        found.append(FieldError(field=path, value=_shown(value), problem=problem, remedy=remedy))
    return found
