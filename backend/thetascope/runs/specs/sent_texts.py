"""Read texts that a client sent, JSON and YAML.

Large ones are read in worker processes: a service that parses one answers nobody meanwhile.
"""

from collections.abc import Callable
from typing import Any

import orjson
from pydantic import BaseModel

from thetascope.messages import Message
from thetascope.runs.specs.refusals import invalid, validated
from thetascope.runs.specs.spec_files import DocumentError, parse
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.service.record import Record
from thetascope_schemas.texts.local_text import ALL


def json_of(body: bytes) -> Any:
    """Return the JSON data of a body. Raises InvalidSpec with the place of the error."""
    try:
        return orjson.loads(body)
    except orjson.JSONDecodeError as error:
        problem = Message("body.json", line=error.lineno, column=error.colno, detail=error.msg)
        raise invalid("", body[:60].decode(errors="replace"), problem) from None


def valid_json(body: bytes, read: Callable[[Any], BaseModel]) -> bytes:
    """Return the JSON of a body that `read` accepts, without what does not count. Raises InvalidSpec."""
    value = read(json_of(body))
    return value.model_dump_json(exclude_unset=True, context={"language": ALL}).encode()


def valid_yaml(body: bytes, read: Callable[[Any], BaseModel]) -> bytes:
    """Return a body in YAML that `read` accepts as JSON. Raises InvalidSpec, with line and column for no YAML."""
    value = read(_data_of(body, "body.yaml"))
    return value.model_dump_json(exclude_unset=True, context={"language": ALL}).encode()


def record_of(body: bytes) -> tuple[str, bytes, Record]:
    """Return a record in JSON as the name and the bytes of a file, and the record without its samples.

    Raises InvalidSpec.
    """
    record = validated(Record, json_of(body))
    return *_file_of(record), record.model_copy(update={"columns": None, "csv": None})


def _file_of(record: Record) -> tuple[str, bytes]:
    """Return name and bytes of a record that came as JSON; columns become a JSON file of columns."""
    if (record.csv is None) == (record.columns is None):
        raise invalid("columns", None, Message("record.columns-or-csv"))
    if record.csv is not None:
        return "record.csv", record.csv.encode()
    return "record.json", orjson.dumps(record.columns)


def plant_of_text(text: bytes) -> Plant:
    """Return the plant of YAML or JSON text. Raises InvalidSpec with line and column."""
    return validated(Plant, _data_of(text))


def _data_of(text: bytes, name: str = "plant") -> Any:
    """Return the data of YAML or JSON text. Raises InvalidSpec with line and column."""
    try:
        return parse(text.decode("utf-8-sig")).data
    except UnicodeDecodeError as error:
        raise invalid("", None, Message("document.no-utf8", name=name, byte=error.start)) from None
    except DocumentError as error:
        if error.place is None:
            raise invalid("", None, error.problem, error.remedy) from None
        line, column = error.place.line, error.place.column
        problem = Message("document.at", line=line, column=column, problem=error.problem)
        raise invalid("", None, problem, error.remedy) from None
