"""Plant and experiment files (YAML or JSON): reading them safely, and finding the place of a field in the text."""

import re
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import yaml

from thetascope.runs.specs.refusals import sentence
from thetascope_schemas.experiment.base import FieldError

_DEPTH = 40
_SUFFIXES = (".yaml", ".yml", ".json")


@dataclass(frozen=True)
class Place:
    """Line and column, both from 1."""

    line: int
    column: int


class DocumentError(Exception):
    """A file that cannot be read as data, or whose data is refused: what, where, and what to do about it."""

    def __init__(self, problem: str, remedy: str, place: Place | None = None, name: str = "") -> None:
        self.problem, self.remedy, self.place, self.name = problem, remedy, place, name
        where = f"{name}:{place.line}:{place.column}: " if place else f"{name}: " if name else ""
        super().__init__(f"{where}{problem}; {remedy}")


class DocumentRefused(Exception):
    """A file whose data does not fit the contract; the message has one paragraph for each field at fault."""


@dataclass(frozen=True)
class Document:
    """The data of a file, and where in its text each value stands (by path: `channels[0].enters.x1`)."""

    data: Any
    text: str
    places: dict[str, Place] = field(default_factory=dict)
    name: str = ""

    def place(self, path: str) -> Place | None:
        """Where the value of a path stands, or the nearest thing around it that is in the text."""
        while path and path not in self.places:
            path = re.sub(r"(\.[^.\[\]]*|\[\d+\]|^[^.\[\]]+)$", "", path)
        return self.places.get(path)

    def refused(self, errors: Iterable[FieldError]) -> DocumentRefused:
        """The exception for data that was refused."""
        return DocumentRefused("\n".join(self.located(error) for error in errors))

    def located(self, error: FieldError, offset: int = 0, text: str = "") -> str:
        """`file:line:column: field: problem; remedy`, the line, and a mark under the place.

        For a mistake within an expression, `text` is the expression and `offset` the place in it: the column is exact
        where the expression stands on its line as it is.
        """
        message = sentence(error)
        place = self.place(error.field)
        if place is None:
            return f"{self.name}: {message}"
        line = self.text.splitlines()[place.line - 1] if self.text else ""
        found = line.find(text, place.column - 1) if text else -1
        column = place.column if found < 0 else found + 1 + offset
        start = max(0, column - 80)
        mark = f"  {line[start : start + 120]}\n  {' ' * (column - 1 - start)}^"
        return f"{self.name}:{place.line}:{column}: {message}\n{mark}"


class _Loader(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):
    """YAML with the scalars of JSON: YAML 1.1 takes 1e-3 for text, 012 for 10, 1:30 for 90 and `no` for false."""

    yaml_implicit_resolvers: dict = {}  # noqa: RUF012 - the name and form are PyYAML's


for _kind, _pattern, _first in (
    ("int", r"[-+]?\d+$", "-+0123456789"),
    ("float", r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$", "-+.0123456789"),
    ("bool", r"(true|True|TRUE|false|False|FALSE)$", "tTfF"),
    ("null", r"(~|null|Null|NULL|)$", ["~", "n", "N", ""]),
):
    _Loader.add_implicit_resolver(f"tag:yaml.org,2002:{_kind}", re.compile(_pattern), list(_first))


def read(path: Path, limit: int) -> Document:
    """Read a file of at most `limit` bytes. Raises :class:`DocumentError`."""
    if path.suffix.lower() not in _SUFFIXES:
        raise DocumentError(f"{path.name} is neither YAML nor JSON", f"name the file {' or '.join(_SUFFIXES)}")
    try:
        with path.open("rb") as stream:
            content = stream.read(limit + 1)
    except OSError as error:
        raise DocumentError(f"{path} cannot be read: {error.strerror}", "check the name and the permissions") from None
    if len(content) > limit:
        raise DocumentError(
            f"{path.name} is larger than {limit:,} bytes", "make it smaller, or raise THETASCOPE_MAX_BODY"
        )
    try:
        return replace(parse(content.decode("utf-8-sig")), name=str(path))
    except UnicodeDecodeError as error:
        raise DocumentError(f"{path.name} is no UTF-8 text (byte {error.start})", "save it as UTF-8") from None
    except DocumentError as error:
        raise DocumentError(error.problem, error.remedy, error.place, str(path)) from None


def parse(text: str) -> Document:
    """The data of YAML or JSON text (JSON is YAML here). Anchors, aliases, tags and repeated keys are refused."""
    places: dict[str, Place] = {}
    try:
        _scan(text)
        node = yaml.compose(text, Loader=_Loader)
        data = None if node is None else _build(node, "", places)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = mark and Place(mark.line + 1, mark.column + 1)
        raise DocumentError(
            f"the text is no valid YAML: {error.problem or error.context}", "correct it", place
        ) from None
    except yaml.YAMLError as error:
        raise DocumentError(f"the text is no valid YAML: {error}", "correct it") from None
    return Document(data, text, places)


def _scan(text: str) -> None:
    """Refuse what the data must not hold before it is built: anchors and aliases (which multiply), tags, depth."""
    depth = 0
    for event in yaml.parse(text, Loader=_Loader):
        if getattr(event, "anchor", None) is not None:
            raise DocumentError("anchors (&) and aliases (*) are not accepted", "write the value out", _place(event))
        if getattr(event, "tag", None) is not None:
            raise DocumentError(f"the tag {event.tag[:80]!r} is not accepted", "leave the tag out", _place(event))
        if isinstance(event, yaml.CollectionStartEvent):
            depth += 1
        elif isinstance(event, yaml.CollectionEndEvent):
            depth -= 1
        if depth > _DEPTH:
            raise DocumentError(f"the data is nested deeper than {_DEPTH} levels", "flatten it", _place(event))


def _build(node: yaml.Node, path: str, places: dict[str, Place]) -> Any:
    places[path] = _place(node)
    if isinstance(node, yaml.SequenceNode):
        return [_build(item, f"{path}[{index}]", places) for index, item in enumerate(node.value)]
    if isinstance(node, yaml.MappingNode):
        return _mapping(node, path, places)
    return _scalar(node)


def _mapping(node: yaml.MappingNode, path: str, places: dict[str, Place]) -> dict[str, Any]:
    built: dict[str, Any] = {}
    for key, value in node.value:
        if not isinstance(key, yaml.ScalarNode):
            raise DocumentError("a key is a list or a map", "use a plain word as the key", _place(key))
        name = key.value
        if name in built:
            raise DocumentError(f"the key {name[:80]!r} is there twice", "keep one of them", _place(key))
        built[name] = _build(value, f"{path}.{name}" if path else name, places)
    return built


def _scalar(node: yaml.ScalarNode) -> Any:
    kind, text = node.tag.rpartition(":")[2], node.value
    if kind == "float" or (kind == "int" and len(text) > 18):
        return float(text)
    if kind == "int":
        return int(text)
    if kind == "bool":
        return text.lower() == "true"
    if kind == "null":
        return None
    return text


def _place(marked: yaml.Event | yaml.Node) -> Place:
    mark = marked.start_mark
    return Place(mark.line + 1, mark.column + 1)
