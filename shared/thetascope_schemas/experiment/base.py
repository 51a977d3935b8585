"""The base of all schemas: the strict base class, the number and name types, and messages as they are sent."""

import hashlib
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from typing import Annotated, Any, ClassVar, Protocol, runtime_checkable

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    JsonValue,
    Tag,
    model_validator,
)

from thetascope_schemas.texts.local_text import LocalProse
from thetascope_schemas.texts.names import MAX_NAME, PATTERN, names_normalised, normalised, not_reserved, well_formed
from thetascope_schemas.texts.refusal import refuse, suggestion

SCHEMA_VERSION = 1
"""Version of these schemas, part of every spec's hash. Increase it when the same spec results in other numbers."""

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
        "boucwen",
        "deadzone",
        "play",
        "satplay",
        "interp",
    )
)
"""Functions of the expression language in thetascope.engine.language.builtins; a test compares the two lists."""

MAX_TABLES = 40
MAX_ALGEBRAIC = 12
MAX_EVENTS = 20
MAX_ROWS = 5000  # of one table of a plant


def example(**values: Any) -> ConfigDict:
    """Return a model configuration with an example for OpenAPI."""
    return ConfigDict(json_schema_extra={"examples": [values]})


class Strict(BaseModel):
    """Base of every schema: unknown fields are refused, numbers are finite, instances are immutable.

    `prose` names the fields that do not affect the numbers of a run; the canonical form omits them. It also omits those
    in `optional` where they are empty, so that a field that is added to a schema changes no hash.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
    prose: ClassVar[frozenset[str]] = frozenset({"title", "description", "source", "unit"})
    optional: ClassVar[frozenset[str]] = frozenset()

    @model_validator(mode="before")
    @classmethod
    def _known_fields(cls, data: object) -> object:
        """Refuse an unknown field and suggest the nearest known one, which `extra="forbid"` alone does not do."""
        if isinstance(data, Mapping):
            for key in data:
                if key not in cls.model_fields:
                    shown = str(key)[:80]
                    hint = suggestion(shown, cls.model_fields)
                    raise refuse("schema.field.unknown", field=shown, value=data[key], remedy=hint)
        return data


def canonical(value: object) -> object:
    """Return `value` as unique JSON data: no prose, integral floats and -0.0 as integers, single blanks in text."""
    if isinstance(value, Strict):
        fields = {name: getattr(value, name) for name in type(value).model_fields if name not in value.prose}
        return {name: canonical(item) for name, item in fields.items() if item or name not in value.optional}
    if isinstance(value, Mapping):
        return {str(key): canonical(item) for key, item in value.items()}
    if isinstance(value, str):
        return " ".join(value.split())
    if isinstance(value, Sequence):
        return [canonical(item) for item in value]
    if isinstance(value, float) and value.is_integer() and abs(value) < 2**53:
        return int(value)
    return value


def encoded(document: object) -> bytes:
    """Return unique JSON data as bytes: UTF-8, sorted keys."""
    return json.dumps(document, sort_keys=True, separators=(",", ":"), allow_nan=False).encode()


def digest(content: bytes) -> str:
    """Return the first 32 hexadecimal digits of the SHA-256, which is an id in this program."""
    return hashlib.sha256(content).hexdigest()[:32]


def _as_text(value: object) -> object:
    """Return the text of a plain number where an expression is expected (YAML: `enters: {x1: 1}`)."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return value
    if not math.isfinite(value):
        raise refuse("schema.expression.not-finite", value=str(value))
    return str(canonical(value))


def _short_enough(text: str) -> str:
    """Return an expression; refuse one of more than MAX_EXPRESSION characters."""
    if len(text) > MAX_EXPRESSION:
        raise refuse(
            "schema.expression.too-long",
            value=text[:60] + "…",
            characters=len(text),
            limit=MAX_EXPRESSION,
            column=MAX_EXPRESSION + 1,
        )
    return text


def ordered(bounds: tuple[Any, Any]) -> tuple[Any, Any]:
    """Return bounds [low, high]; refuse them if low is not below high."""
    low, high = bounds
    if isinstance(low, float) and isinstance(high, float) and not low < high:
        raise refuse("schema.bounds.not-increasing", low=low, high=high)
    return bounds


Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
"""A finite number; neither a text nor a boolean is converted to one."""
Positive = Annotated[float, Field(strict=True, gt=0, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(strict=True, ge=0, allow_inf_nan=False)]
MAX_TIME = 1e30
"""The latest time in s. It only keeps powers of times finite: a run may take 1e-12 s or 1e12 s, see MAX_STEPS."""
Instant = Annotated[float, Field(strict=True, ge=0, le=MAX_TIME, allow_inf_nan=False)]
"""A time in s."""
Seed = Annotated[int, Field(strict=True, ge=0, le=2**53 - 1)]
"""Seed of a random generator, at most 2^53 − 1, so that every JSON reader keeps it exactly."""
Flag = Annotated[bool, Field(strict=True)]

Identifier = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]{0,63}$")]
Reference = Annotated[
    str,
    BeforeValidator(normalised),
    AfterValidator(well_formed),
    Field(json_schema_extra={"pattern": PATTERN, "maxLength": MAX_NAME}),
]
"""The name of a quantity that is declared elsewhere, in Unicode's normal form NFKC."""
Name = Annotated[Reference, AfterValidator(partial(not_reserved, functions=FUNCTIONS))]
"""The name in a declaration: an identifier in any script of at most 32 characters; not reserved."""
Title = Annotated[str, LocalProse(max_length=200)]
"""A line of prose, in one language or in several."""
Prose = Annotated[str, LocalProse(max_length=10_000)]
Unit = Annotated[str, Field(max_length=32, description="Unit in plain text, empty when dimensionless.")]
ExpressionText = Annotated[
    str,
    BeforeValidator(_as_text),
    AfterValidator(_short_enough),
    AfterValidator(names_normalised),
    Field(min_length=1, json_schema_extra={"maxLength": MAX_EXPRESSION}),
]
Bounds = Annotated[tuple[Number | None, Number | None], AfterValidator(ordered)]
"""[low, high]; null: no bound on that side."""
UNBOUNDED: tuple[None, None] = (None, None)


def _limit_kind(value: object) -> str:
    return "name" if isinstance(value, str) else "none" if value is None else "number"


Limit = Annotated[
    Annotated[Number, Tag("number")] | Annotated[Reference, Tag("name")] | Annotated[None, Tag("none")],
    Discriminator(_limit_kind),
]
"""A number, the name of a parameter, or null for no limit."""


def check_known(names: Iterable[str], known: Iterable[str], field: str, code: str) -> None:
    """Refuse the first of `names` that is not in `known`, with the problem `code`; suggest the nearest known names."""
    declared = tuple(known)
    for name in names:
        if name not in declared:
            raise refuse(code, f"{field}.{name}", name, name=name, remedy=suggestion(name, declared))


@runtime_checkable
class Worded(Protocol):
    """Protocol of a message that can be rendered, such as `thetascope.messages.Message`."""

    def as_data(self) -> dict[str, Any]:
        """Return {code, args} as plain data."""
        ...

    def text(self, language: str = "en") -> str:
        """Return the sentence in a language."""
        ...


class Text(Strict):
    """A message: code, arguments, and the sentence in the requested language.

    A plain text, as earlier versions stored sentences, is read as a sentence without a code.
    """

    model_config = example(code="common.states", args={"n": 2}, text="2 states")

    code: str = Field(description="Key of the sentence in the catalogues, GET /api/messages/{language}.")
    args: dict[str, JsonValue] = Field(
        default_factory=dict, description="Arguments of the sentence by name; a nested message is {code, args}."
    )
    text: str = Field(default="", description="The sentence in the requested language.")

    @model_validator(mode="before")
    @classmethod
    def _plain(cls, value: Any) -> Any:
        return {"code": "", "text": value} if isinstance(value, str) else value

    @classmethod
    def of(cls, message: Worded, language: str = "en") -> "Text":
        """Return a message with its sentence in a language."""
        return cls(**message.as_data(), text=message.text(language))
