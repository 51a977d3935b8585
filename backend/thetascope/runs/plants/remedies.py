"""Remedies that a machine can apply: the characters of a text to replace, and by which text."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any

import yaml

from thetascope.runs.plants.text_places import Span, scalar_part
from thetascope.runs.specs.spec_files import Document
from thetascope_schemas.service.field_error import FieldError

_CALL = re.compile(r"(\w+)\((?:x|y|y, x)\)")
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
_SYMBOLS = re.compile(r"\*|-|/|<=|>=|\^[23]")
_LN = "expression.hint.ln"


@dataclass(frozen=True)
class Fix:
    """A change of the text: the characters of the span are replaced by `text`; an empty span inserts it."""

    span: Span
    text: str


def fix_of(document: Document, error: FieldError, place: Span) -> Fix | None:
    """Return the change that corrects an error at a place, or None where only its author can know."""
    problem = error.args.get("problem")
    plain = {"code": error.code, "args": error.args}
    inner: Mapping[str, Any] = dict(problem) if isinstance(problem, Mapping) else plain
    own = _OF_PROBLEM.get(str(inner["code"]))
    if own is not None:
        return own(document, error, place, inner["args"])
    remedy = error.args.get("remedy")
    if not isinstance(remedy, Mapping):
        return _nearest_choice(document, error, place)
    if remedy["code"] == "expression.declare":
        return _declaration(document, place)
    if error.code == "schema.field.unknown" and (apart := _key_and_value(document, error, place)):
        return apart
    text = _replacement(document.text[place.start : place.end], remedy)
    return None if text is None else Fix(place, text)


def _replacement(present: str, remedy: Mapping[str, Any]) -> str | None:
    """Return the text for a name or sign, from the message that says what to write."""
    args: Mapping[str, Any] = remedy["args"]
    if remedy["code"] == "suggest.near":
        return str(args["names"][0])
    if remedy["code"] == _LN:
        return "log"
    if remedy["code"] != "expression.write":
        return None
    text = str(args["text"])
    call = _CALL.fullmatch(text)
    if call is not None and present.isidentifier():
        return call.group(1)
    plain = text.isidentifier() or _SYMBOLS.fullmatch(text) or _NUMBER.fullmatch(text.partition("*")[0])
    return text if plain and "…" not in text else None


def unquoted(document: Document, error: FieldError) -> Span | None:
    """Return a value that a comma has cut short, up to what was taken for further keys; None for other errors.

    In `{name: w, expression: max(h, 0)}` the comma ends the value, and `0)` becomes a key without a value.
    """
    key, _ = document.nodes.get(error.field, (None, None))
    parent = document.nodes.get(error.field.rpartition(".")[0])
    if error.code != "schema.field.unknown" or key is None or parent is None:
        return None
    mapping = parent[1]
    if not isinstance(mapping, yaml.MappingNode) or not mapping.flow_style:
        return None
    entries = list(mapping.value)
    index = next(i for i, (name, _) in enumerate(entries) if name is key)
    last = index
    while last < len(entries) and not _written(entries[last][1]):
        last += 1
    first = entries[index - 1][1] if index else None
    if last == index or not isinstance(first, yaml.ScalarNode) or first.style:
        return None
    return Span(first.start_mark.index, entries[last - 1][0].end_mark.index)


def _written(node: yaml.Node) -> bool:
    return node.end_mark.index > node.start_mark.index


def _nearest_choice(document: Document, error: FieldError, place: Span) -> Fix | None:
    """Return the nearest of several permitted words, or a number without quotes, or a share for per cent."""
    names = error.args.get("names")
    if error.code == "schema.literal-error" and isinstance(names, list):
        near = get_close_matches(str(error.value), [str(name) for name in names], n=1, cutoff=0.5)
        return Fix(place, near[0]) if near else None
    written = str(error.value).strip()
    if error.code in ("schema.float-type", "schema.int-type") and _NUMBER.fullmatch(written):
        return Fix(place, written)
    if error.code == "schema.float-type" and written.endswith("%") and _NUMBER.fullmatch(written[:-1].strip()):
        return Fix(place, f"{float(written[:-1]) / 100:.12g}")
    return None


def _declaration(document: Document, place: Span) -> Fix | None:
    """Return a further parameter with the name at a place, in the style of the last one; None if the name is taken."""
    name = document.text[place.start : place.end]
    named = any(
        path.endswith(".name") and getattr(node, "value", "") == name for path, (_, node) in document.nodes.items()
    )
    _, parameters = document.nodes.get("parameters", (None, None))
    if named or not name.isidentifier() or not isinstance(parameters, yaml.SequenceNode) or parameters.flow_style:
        return None
    end = len(document.text[: parameters.end_mark.index].rstrip())
    indent = " " * parameters.start_mark.column
    return Fix(Span(end, end), f"\n{indent}- {{name: {name}, value: 1}}")


def _key_and_value(document: Document, error: FieldError, place: Span) -> Fix | None:
    """Return the colon and the blank that a key without a value lacks: `name:i` and `name i` become `name: i`."""
    _, node = document.nodes.get(error.field, (None, None))
    parts = re.fullmatch(r"(\w+)(?:\s+|\s*:)(\S+)", document.text[place.start : place.end])
    if node is None or _written(node) or parts is None:
        return None
    return Fix(place, f"{parts[1]}: {parts[2]}")


def _close_parenthesis(document: Document, error: FieldError, place: Span, args: Mapping) -> Fix | None:
    """Return the insertion of ) at the end of the expression."""
    _, node = document.nodes[error.field]
    if not isinstance(node, yaml.ScalarNode):
        return None
    end = scalar_part(document.text, node, len(node.value) - 1, len(node.value)).end
    return Fix(Span(end, end), ")")


def _delete(document: Document, error: FieldError, place: Span, args: Mapping) -> Fix:
    return Fix(place, "")


def _multiply(document: Document, error: FieldError, place: Span, args: Mapping) -> Fix:
    """Return the insertion of * between two operands."""
    return Fix(Span(place.start, place.start), "*")


def _into_bounds(document: Document, error: FieldError, place: Span, args: Mapping) -> Fix | None:
    """Return the nearest permitted value of a parameter."""
    number, low, high = args["number"], args["low"], args["high"]
    bound = low if isinstance(low, int | float) and number < low else high
    return Fix(place, f"{bound:.12g}") if isinstance(bound, int | float) else None


def _missing_equation(document: Document, error: FieldError, place: Span, args: Mapping) -> Fix | None:
    """Return a further line of `dynamics`: the equation of a state that has none, with the right-hand side 0."""
    _, node = document.nodes.get("dynamics", (None, None))
    if not isinstance(node, yaml.MappingNode) or node.flow_style or not node.value:
        return None
    indent = " " * node.value[0][0].start_mark.column
    last = node.value[-1][1].end_mark.index
    end = len(document.text[:last].rstrip())
    return Fix(Span(end, end), f"\n{indent}{args['state']}: 0")


_OF_PROBLEM = {
    "expression.parenthesis.open": _close_parenthesis,
    "expression.parenthesis.close": _delete,
    "expression.operator.missing": _multiply,
    "plant.parameter.outside-bounds": _into_bounds,
    "plant.state.no-equation": _missing_equation,
}
