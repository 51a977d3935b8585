"""The place of an error in the text of a plant: the characters that an editor underlines."""

import re
from dataclasses import dataclass

import yaml

from thetascope.runs.specs.spec_files import Document, Place
from thetascope_schemas.service.field_error import FieldError

_LAST = re.compile(r"(\.[^.\[\]]*|\[\d+\]|^[^.\[\]]+)$")
_EXPRESSION = "expression.at"  # an error with a column in the expression
_UNION = "schema.union-tag-invalid"  # an error in the field that says the kind
_WORD = re.compile(r"\w+|\S")


@dataclass(frozen=True)
class Span:
    """A half-open range of characters of a text."""

    start: int
    end: int


def span_of(document: Document, error: FieldError) -> Span:
    """Return the characters that an error is about: a part of an expression, a value, or a key.

    What is missing is shown at the key of the part in which it is missing.
    """
    path = error.field
    kind = f"{path}.{error.args.get('discriminator')}".lstrip(".")
    if error.code == _UNION and kind in document.nodes:
        path = kind  # the error names the part whose kind is not known; the word that says the kind is wrong
    if path not in document.nodes:
        return _enclosing(document, path)
    key, node = document.nodes[path]
    if error.code == _EXPRESSION and isinstance(node, yaml.ScalarNode):
        column = error.args.get("column")
        start = column - 1 if isinstance(column, int) else 0
        length = len(error.value) if isinstance(error.value, str) else 1
        return scalar_part(document.text, node, start, start + length)
    name = path.rpartition(".")[2]
    if key is not None and (error.code == "schema.field.unknown" or error.value == name):
        return _span(key)
    if isinstance(node, yaml.ScalarNode) and node.end_mark.index > node.start_mark.index:
        return _trimmed(document.text, _span(node))
    return _span(key) if key is not None else _first_line(document.text, node)


def word_at(text: str, place: Place | None) -> Span:
    """Return the word that begins at a place, or the end of the text without one."""
    if place is None:
        return Span(max(0, len(text.rstrip()) - 1), len(text.rstrip()))
    lines = text.split("\n")
    line = min(place.line, len(lines)) - 1
    start = sum(len(before) + 1 for before in lines[:line]) + min(place.column - 1, len(lines[line]))
    word = _WORD.match(text, start)
    if word is not None:
        return Span(start, word.end())
    before = text[:start].rstrip()  # the end of a line: what precedes it
    return Span(max(0, len(before) - 1), max(1, len(before)))


def seen(text: str, span: Span) -> Span:
    """Return a range that an editor can underline: an empty one, or blanks, with the character before or after."""
    if text[span.start : span.end].strip(" "):
        return span
    if span.start > 0 and not text[span.start - 1].isspace():
        return Span(span.start - 1, span.start)
    after = next((k for k in range(span.end, len(text)) if not text[k].isspace()), None)
    return Span(max(0, span.start - 1), max(1, span.start)) if after is None else Span(after, after + 1)


def scalar_part(text: str, node: yaml.ScalarNode, start: int, end: int) -> Span:
    """Return the characters of a text that became the characters start … end of the value of a scalar.

    Quotes, escapes and line breaks within the scalar are counted.
    """
    places = _places(text, node)
    first = places[min(start, len(places) - 1)] if places else node.start_mark.index
    last = places[min(end, len(places)) - 1] + 1 if places and end > start else first + 1
    return Span(first, max(last, first + 1))


def _places(text: str, node: yaml.ScalarNode) -> list[int]:
    """Return for each character of a scalar's value its index in the text."""
    index, end = node.start_mark.index, node.end_mark.index
    if node.style in ("'", '"'):
        index, end = index + 1, end - 1
    elif node.style in ("|", ">"):
        index = text.find("\n", index, end) + 1 or index
    places = []
    for char in node.value:
        if char.isspace():
            while index < end - 1 and not text[index].isspace():
                index += 1
            places.append(index)
            while index < end and char != "\n" and text[index] == "\n":
                index += 1
            index += 1
            continue
        while index < end and text[index].isspace() and char != text[index]:
            index += 1
        places.append(min(index, len(text) - 1))
        if node.style == '"' and text[index : index + 1] == "\\":
            escape = re.compile(r"\\(x..|u.{4}|U.{8}|.)", re.DOTALL).match(text, index)
            index = escape.end() if escape else index + 1
        else:
            index += 2 if node.style == "'" and char == "'" else 1
    return places


def _enclosing(document: Document, path: str) -> Span:
    """Return the key of the innermost part of a path that occurs in the text, else the first line of that part."""
    while path and path not in document.nodes:
        path = _LAST.sub("", path)
    if path not in document.nodes:
        return word_at(document.text, Place(1, 1))
    key, node = document.nodes[path]
    return _span(key) if key is not None else _first_line(document.text, node)


def _first_line(text: str, node: yaml.Node) -> Span:
    start = node.start_mark.index
    end = text.find("\n", start)
    end = len(text) if end < 0 else end
    return _trimmed(text, Span(start, max(start + 1, min(end, node.end_mark.index))))


def _span(node: yaml.Node) -> Span:
    return Span(node.start_mark.index, node.end_mark.index)


def _trimmed(text: str, span: Span) -> Span:
    """Return a range without blanks at its end: that of a block of text reaches up to the next key."""
    return Span(span.start, max(span.start + 1, span.start + len(text[span.start : span.end].rstrip())))
