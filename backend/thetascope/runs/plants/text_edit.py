"""Change the text of a plant without touching the rest of it: values, further items of lists, further equations."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import yaml

from thetascope.runs.plants.plant_text import block_item, flow, json_text, yaml_text
from thetascope.runs.plants.text_check import format_of
from thetascope.runs.specs.refusals import invalid
from thetascope.runs.specs.spec_files import Document, DocumentError, parse
from thetascope_schemas.service.plants.text import TextEdit, TextFormat


@dataclass(frozen=True)
class Edited:
    """A text after a change, and the numbers of the lines that are new, from 1."""

    text: str
    lines: tuple[int, ...]


def converted(text: str, to: TextFormat) -> str:
    """Return a plant's text as YAML or JSON; unchanged where it is so already. Raises DocumentError."""
    if format_of(text) == to:
        return text
    data = parse(text).data
    if not isinstance(data, dict):
        return text
    return json_text(data) if to == "json" else yaml_text(data)


def edited(
    text: str,
    values: Mapping[str, float],
    items: Mapping[str, list[dict[str, Any]]],
    equations: Mapping[str, str],
) -> Edited:
    """Return a text with numbers replaced, items added to lists, and equations added to `dynamics`.

    Args:
        text: of the plant, YAML or JSON.
        values: by path, as `parameters[0].value`; a path that the text lacks is left out.
        items: by list, as `channels`, in the order of the lists in the text.
        equations: right-hand sides by state.

    Raises DocumentError for a text that is no YAML.
    """
    before = text.split("\n")
    for path, value in values.items():
        text = _with_value(parse(text), path, value)
    for field, added in items.items():
        for item in added:
            text = _with_item(parse(text), field, item)
    for name, expression in equations.items():
        text = _with_equation(parse(text), name, expression)
    return Edited(text, _new_lines(before, text.split("\n")))


def edited_as(asked: TextEdit) -> Edited:
    """Return a text with the changes of a request, in the format of the request. Raises InvalidSpec."""
    try:
        changed = edited(asked.text, asked.values, asked.items_by_list(), asked.equations)
        return changed if asked.format is None else Edited(converted(changed.text, asked.format), changed.lines)
    except DocumentError as error:
        raise invalid("text", None, error.problem, error.remedy) from None


def _with_value(document: Document, path: str, value: float) -> str:
    _, node = document.nodes.get(path, (None, None))
    if isinstance(node, yaml.ScalarNode) and node.end_mark.index > node.start_mark.index:
        return _replaced(document.text, node.start_mark.index, node.end_mark.index, f"{value:.12g}")
    parent, _, name = path.rpartition(".")
    _, mapping = document.nodes.get(parent, (None, None))
    if not isinstance(mapping, yaml.MappingNode) or not mapping.flow_style or not mapping.value:
        return document.text
    end = mapping.value[-1][1].end_mark.index
    return _replaced(document.text, end, end, f", {_key(document, name)}: {value:.12g}")


def _with_item(document: Document, field: str, item: dict[str, Any]) -> str:
    text = document.text
    _, node = document.nodes.get(field, (None, None))
    if not isinstance(node, yaml.SequenceNode) or not node.value and not node.flow_style:
        return _with_list(document, field, item, node)
    last = node.value[-1].end_mark.index if node.value else node.start_mark.index + 1
    if node.flow_style and (node.value or format_of(text) == "json"):
        separator = ",\n    " if node.value else ""
        written = json.dumps(item, ensure_ascii=False) if format_of(text) == "json" else flow(item)
        return _replaced(text, last, last, separator + written)
    if node.flow_style:
        return _replaced(text, node.start_mark.index, node.end_mark.index, "\n" + block_item(item, 2).rstrip("\n"))
    end = len(text[:last].rstrip())
    indent = node.value[0].start_mark.column - 2
    return _replaced(text, end, end, "\n" + block_item(item, max(0, indent)).rstrip("\n"))


def _with_list(document: Document, field: str, item: dict[str, Any], node: yaml.Node | None) -> str:
    """Return the text with a list that it did not have."""
    text = document.text
    if format_of(text) == "json":
        _, root = document.nodes[""]
        end = root.value[-1][1].end_mark.index
        return _replaced(text, end, end, f',\n  "{field}": [{json.dumps(item, ensure_ascii=False)}]')
    if node is not None:  # `channels:` without a value
        key, _ = document.nodes[field]
        end = text.index(":", key.end_mark.index if key is not None else 0) + 1
        return _replaced(text, end, end, "\n" + block_item(item, 2).rstrip("\n"))
    return text.rstrip() + f"\n{field}:\n" + block_item(item, 2)


def _with_equation(document: Document, name: str, expression: str) -> str:
    _, node = document.nodes.get("dynamics", (None, None))
    if not isinstance(node, yaml.MappingNode) or not node.value:
        return document.text
    last = node.value[-1][1].end_mark.index
    quoted = json.dumps(expression, ensure_ascii=False)
    if node.flow_style:
        return _replaced(document.text, last, last, f", {_key(document, name)}: {quoted}")
    end = len(document.text[:last].rstrip())
    indent = " " * node.value[0][0].start_mark.column
    return _replaced(document.text, end, end, f"\n{indent}{name}: {quoted}")


def _key(document: Document, name: str) -> str:
    return json.dumps(name, ensure_ascii=False) if format_of(document.text) == "json" else name


def _replaced(text: str, start: int, end: int, by: str) -> str:
    return text[:start] + by + text[end:]


def _new_lines(before: list[str], after: list[str]) -> tuple[int, ...]:
    """Return the numbers of the lines that are in no place of the text before."""
    known = set(before)
    return tuple(number for number, line in enumerate(after, 1) if line not in known)
