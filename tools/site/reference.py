"""Pages of the site that are made from the program: the schemas of plants and experiments, and the commands."""

import argparse
import json
from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from thetascope.cli.main import parser
from thetascope.cli.words import Words
from thetascope_schemas import Diagnosis, Experiment, Plant, Record, Run

_ROOTS: dict[str, type[BaseModel]] = {
    "A plant": Plant,
    "An experiment": Experiment,
    "A run": Run,
    "The diagnosis of a run": Diagnosis,
    "A record": Record,
}
_LIMITS = {
    "minimum": "≥",
    "exclusiveMinimum": ">",
    "maximum": "≤",
    "exclusiveMaximum": "<",
    "maxLength": "characters ≤",
    "maxItems": "entries ≤",
}
_INTRODUCTION = "Plants and experiments are YAML or JSON. Every field is checked; an unknown one is an error."


def schemas() -> str:
    """Return the page of the schemas: a table of the fields of each object, where it is used first."""
    lines = ["# Schemas", "", _INTRODUCTION, ""]
    done: set[str] = set()
    for title, root in _ROOTS.items():
        schema = root.model_json_schema()
        lines += [f"## {title}", ""]
        for name, definition in ({root.__name__: schema} | schema.get("$defs", {})).items():
            if name not in done and _has_fields(definition):
                done.add(name)
                lines += _table(name, definition, schema.get("$defs", {}))
    return "\n".join(lines)


def _has_fields(definition: dict[str, Any]) -> bool:
    return bool(definition.get("properties"))


def _table(name: str, definition: dict[str, Any], others: dict[str, Any]) -> Iterator[str]:
    """Yield the lines of one object; `others` are those that it may refer to."""
    yield f"### {name}"
    yield ""
    if first := (definition.get("description") or "").split("\n\n")[0]:
        yield from (_cell(first), "")
    required = set(definition.get("required", []))
    yield "| field | type | default | meaning |"
    yield "|---|---|---|---|"
    for field, value in definition["properties"].items():
        default = "required" if field in required else f"`{json.dumps(value.get('default'), ensure_ascii=False)}`"
        yield f"| `{field}` | {_type(value, others)} | {_cell(default)} | {_cell(value.get('description', ''))} |"
    yield ""


def _type(value: dict[str, Any], others: dict[str, Any]) -> str:
    """Return the type of a value in words, with its limits."""
    if "$ref" in value:
        name = value["$ref"].rpartition("/")[2]
        return f"[{name}](#{name.lower()})" if _has_fields(others[name]) else name
    if kinds := value.get("anyOf") or value.get("oneOf"):
        return " or ".join(dict.fromkeys(_type(kind, others) for kind in kinds))
    if "const" in value:
        return f"`{value['const']}`"
    if "enum" in value:
        return ", ".join(f"`{entry}`" for entry in value["enum"])
    kind = value.get("type", "any")
    if kind == "array":
        kind = "list of " + _type(value["items"], others) if "items" in value else "list"
    elif kind == "object" and isinstance(value.get("additionalProperties"), dict):
        kind = "names to " + _type(value["additionalProperties"], others)
    return ", ".join([kind, *(f"{sign} {value[key]:g}" for key, sign in _LIMITS.items() if key in value)])


def commands() -> str:
    """Return the page of the commands: the help of each."""
    lines = ["# Commands", "", "`thetascope` is in `.venv/bin`, or on the path where the package is installed.", ""]
    top = parser(Words("en"))
    for action in top._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, command in action.choices.items():
                lines += [f"## thetascope {name}", "", "```text", command.format_help().rstrip(), "```", ""]
    return "\n".join(lines)


def _cell(text: str) -> str:
    """Return text on one line that a table can hold."""
    return text.replace("|", "\\|").replace("\n", " ")
