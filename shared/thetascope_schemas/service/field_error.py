"""Conversion of pydantic's errors to this project's form: field, value, code, arguments, problem and remedy."""

import math
import re
import reprlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from pydantic import Field, JsonValue

from thetascope_schemas.experiment.base import Strict, example
from thetascope_schemas.texts.refusal import readable, suggestion

MOST_ERRORS = 20
Render = Callable[[str, Mapping[str, Any]], str]
"""Function that renders the sentence of a code with its arguments."""


class FieldError(Strict):
    """One reason for a refusal: the field, the value that arrived, the problem and the remedy.

    The problem is the sentence of `code`. The remedy is the message `args.remedy` where there is one, else the sentence
    of `code.remedy`, with the same arguments.
    """

    model_config = example(
        field="faults[0].end",
        value=5,
        code="fault.end.before-onset",
        args={"end": 5, "onset": 20},
        problem="the end 5 s is not after the onset 20 s",
        remedy="give an end above 20, or null",
    )

    field: str = Field(description="Path of the field, for example faults[0].end.")
    value: Any = Field(default=None, description="The value that arrived, shortened.")
    code: str = Field(
        default="", description="Key of the problem's sentence in the catalogues, GET /api/messages/{language}."
    )
    args: dict[str, JsonValue] = Field(default_factory=dict, description="Arguments of both sentences by name.")
    problem: str = Field(description="The problem, in the requested language.")
    remedy: str = Field(description="The remedy, in the requested language.")

    def rendered(self, render: Render) -> "FieldError":
        """Return this error with problem and remedy in the words of `render`."""
        if not self.code:
            return self
        problem, remedy = sentences(self.code, self.args, render)
        return self.model_copy(update={"problem": problem, "remedy": remedy})


def sentences(code: str, args: Mapping[str, Any], render: Render) -> tuple[str, str]:
    """Return the problem and the remedy of a code."""
    hint = args.get("remedy")
    if isinstance(hint, Mapping):
        return render(code, args), render(str(hint["code"]), hint["args"])
    return render(code, args), render(f"{code}.remedy", args)


def field_errors(
    errors: Iterable[Mapping[str, Any]], data: object = None, render: Render = readable
) -> list[FieldError]:
    """Return pydantic's errors in this project's form.

    Args:
        errors: `ValidationError.errors()`; the first 20 are kept.
        data: the validated data; with it, paths are those that the sender knows.
        render: renders a code with its arguments; by default as `code(name=value)`.
    """
    return [_field_error(error, data, render) for error in list(errors)[:MOST_ERRORS]]


def _field_error(error: Mapping[str, Any], data: object, render: Render) -> FieldError:
    """Return one of pydantic's errors in this project's form."""
    context = error.get("ctx") or {}
    path, value = _path(error["loc"], data, error["type"]), error.get("input")
    if error["type"] == "refused":
        path = ".".join(part for part in (path, context["field"]) if part).replace(".[", "[")
        value = value if context["value"] is None else context["value"]
        code, args = context["code"], context["args"]
    else:
        code, args = _of_pydantic(error, context)
    problem, remedy = sentences(code, args, render)
    args = {name: _json(argument) for name, argument in args.items()}
    return FieldError(field=path, value=_shown(value), code=code, args=args, problem=problem, remedy=remedy)


def _json(argument: Any) -> Any:
    """Return an argument as JSON has it: numbers that are not finite become their names."""
    if isinstance(argument, float) and not math.isfinite(argument):
        return str(argument)
    if isinstance(argument, Mapping):
        return {name: _json(value) for name, value in argument.items()}
    return [_json(value) for value in argument] if isinstance(argument, list | tuple) else argument


PYDANTIC_CODES = frozenset(
    {
        *("missing", "model_type", "model_attributes_type", "dict_type", "list_type", "tuple_type", "literal_error"),
        *("string_type", "string_too_short", "string_too_long", "string_pattern_mismatch", "too_short", "too_long"),
        *("int_type", "int_from_float", "int_parsing", "float_type", "float_parsing", "finite_number", "bool_type"),
        *("bool_parsing", "greater_than", "greater_than_equal", "less_than", "less_than_equal", "json_invalid"),
        *("union_tag_not_found", "union_tag_invalid", "none_required", "recursion_loop"),
    }
)
"""Kinds of pydantic's own errors that have a sentence; that of `float_type` has the code `schema.float-type`."""


def _of_pydantic(error: Mapping[str, Any], context: Mapping[str, Any]) -> tuple[str, dict[str, Any]]:
    """Return code and arguments of one of pydantic's own errors."""
    kind = error["type"]
    if kind not in PYDANTIC_CODES:
        return "schema.other", {"kind": kind, "detail": error["msg"]}
    args: dict[str, Any] = {name: value for name, value in context.items() if isinstance(value, str | int | float)}
    if kind == "literal_error":
        args = {"names": re.findall(r"'([^']*)'", context["expected"]) or [context["expected"]]}
    elif kind == "union_tag_invalid":
        known, tag = re.findall(r"'([^']*)'", context["expected_tags"]), str(context["tag"])[:80]
        args = {"tag": tag, "discriminator": str(context["discriminator"]).strip("'")}
        args["remedy"] = suggestion(tag, known)
    elif kind == "union_tag_not_found":
        args = {"discriminator": str(context["discriminator"]).strip("'")}
    return f"schema.{kind.replace('_', '-')}", args


def _path(location: Sequence[str | int], data: object, kind: str) -> str:
    """Return a path as a person writes it, without the tags of unions that pydantic adds and `data` does not have."""
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
    """Return a value that is valid JSON and short enough for an error message."""
    if value is None or isinstance(value, bool) or (isinstance(value, float) and math.isfinite(value)):
        return value
    if isinstance(value, int) and abs(value) < 2**53:
        return value
    text = value if isinstance(value, str) else reprlib.repr(value)
    return text if len(text) <= 80 else text[:79] + "…"
