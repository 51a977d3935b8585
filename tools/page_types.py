"""Write the page's types of the wire and of REST: `python -m tools.page_types`.

The source is the JSON schemas of the models: both unions of messages of a live session, and the answers and bodies of
all routes. Each schema becomes one TypeScript declaration. A test compares the file with the output of `page`.
"""

import re
import sys
from pathlib import Path
from typing import Any

from fastapi.routing import APIRoute, iter_route_contexts
from pydantic import TypeAdapter
from pydantic.json_schema import GenerateJsonSchema

from thetascope.api.http.openapi import BODIES
from thetascope.server.app import create_app
from thetascope.settings import Settings
from thetascope_schemas.service.classroom.views import CurvesHead
from thetascope_schemas.service.run import Problem
from thetascope_schemas.service.session import ClientMessage, ServerMessage

FILE = Path(__file__).resolve().parents[1] / "frontend" / "types" / "service.d.ts"

HEAD = """// Written by `python -m tools.page_types` from the service's schemas. Do not edit.
// Bodies of requests and commands have optional fields where the schema has a default; answers and events have all
// fields.
"""

_PLAIN = {
    "string": "string",
    "number": "number",
    "integer": "number",
    "boolean": "boolean",
    "null": "null",
}


def main() -> int:
    """Write the types to their file."""
    FILE.parent.mkdir(exist_ok=True)
    FILE.write_text(page(), encoding="utf-8")
    print(FILE)
    return 0


def page() -> str:
    """Return the TypeScript declarations of all schemas, sorted by name."""
    schemas = _schemas()
    return HEAD + "\n" + "\n".join(declaration(name, schemas[name]) for name in sorted(schemas, key=_name))


class AllFields(GenerateJsonSchema):
    """Schemas in which all fields of an answer are required; pydantic's treat fields with a default as optional."""

    def field_is_required(self, field: Any, total: bool) -> bool:
        """Return whether the field is always present."""
        return self.mode == "serialization" or super().field_is_required(field, total)


def _schemas() -> dict[str, Any]:
    """Return all schemas by name. A model whose input and output differ has two: the input's name ends with -Input."""
    answers = dict.fromkeys(
        model
        for context in iter_route_contexts(create_app(Settings(Path())).routes)
        if isinstance(route := context.original_route, APIRoute)
        for model in (route.response_model, *(response.get("model") for response in route.responses.values()))
        if model is not None
    )
    inputs = [(model, "validation", TypeAdapter(model)) for model in (*BODIES, ClientMessage)]
    outputs = [(model, "serialization", TypeAdapter(model)) for model in (*answers, Problem, ServerMessage, CurvesHead)]
    schemas, common = TypeAdapter.json_schemas([*inputs, *outputs], schema_generator=AllFields)
    unions = {
        "ClientMessage": schemas[ClientMessage, "validation"],
        "ServerMessage": schemas[ServerMessage, "serialization"],
    }
    return common["$defs"] | unions


def declaration(name: str, schema: dict[str, Any]) -> str:
    """Return the declaration of a schema: an interface for an object with known fields, an alias otherwise."""
    if "properties" not in schema:
        return f"{_comment(schema)}export type {_name(name)} = {of(schema)};\n"
    required = set(schema.get("required", ()))
    lines = "".join(
        f"{_comment(field, '  ')}  {key}{'' if key in required or 'const' in field else '?'}: {of(field)};\n"
        for key, field in schema["properties"].items()
    )
    return f"{_comment(schema)}export interface {_name(name)} {{\n{lines}}}\n"


def of(schema: dict[str, Any]) -> str:
    """Return the type of a schema as TypeScript."""
    if "$ref" in schema:
        return _name(schema["$ref"].rsplit("/", 1)[1])
    for union in ("anyOf", "oneOf"):
        if union in schema:
            return " | ".join(dict.fromkeys(of(option) for option in schema[union]))
    if "const" in schema:
        return _literal(schema["const"])
    if "enum" in schema:
        return " | ".join(map(_literal, schema["enum"]))
    if schema.get("type") == "array":
        if "prefixItems" in schema:
            return f"[{', '.join(map(of, schema['prefixItems']))}]"
        return f"({of(schema['items'])})[]" if "items" in schema else "unknown[]"
    if schema.get("type") == "object":
        values = [schema.get("additionalProperties"), *schema.get("patternProperties", {}).values()]
        return (
            f"{{[name: string]: {' | '.join(of(value) for value in values if isinstance(value, dict)) or 'unknown'}}}"
        )
    return _PLAIN[schema["type"]] if "type" in schema else "unknown"


def _literal(value: object) -> str:
    return f"'{value}'" if isinstance(value, str) else str(value).lower()


def _name(name: str) -> str:
    """Return a schema's name as an identifier: Experiment-Input → ExperimentInput, Experiment-Output → Experiment."""
    short = re.sub(r"-Output$", "", name).replace("-", "")
    return "".join(part[:1].upper() + part[1:] for part in short.split("__")[-2:]) if "__" in short else short


def _comment(schema: dict[str, Any], indent: str = "") -> str:
    text = " ".join(schema.get("description", "").split("\n\n")[0].split())
    return f"{indent}/** {text.replace('*/', '')} */\n" if text else ""


if __name__ == "__main__":
    sys.exit(main())
