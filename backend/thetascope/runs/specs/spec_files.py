"""Read plant and experiment files (YAML or JSON) safely, and locate fields in their text."""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import yaml

from thetascope.messages import Message
from thetascope.runs.specs.refusals import sentence
from thetascope_schemas.service.field_error import FieldError

_DEPTH = 40
_SUFFIXES = (".yaml", ".yml", ".json")


@dataclass(frozen=True)
class Place:
    """A line and a column, both counted from 1."""

    line: int
    column: int


class DocumentError(Exception):
    """A file that cannot be read as data.

    Args:
        problem: the error.
        place: its place in the text, if known.
        name: the file, as the user named it.
        remedy: how to correct it; by default the message whose code is the problem's plus `.remedy`, with its
        arguments.
    """

    def __init__(
        self, problem: Message, place: Place | None = None, name: str = "", remedy: Message | None = None
    ) -> None:
        super().__init__(problem, place, name, remedy)
        self.problem, self.place, self.name = problem, place, name
        self.remedy = remedy or Message(f"{problem.code}.remedy", **problem.args)

    def text(self, language: str = "en") -> str:
        """Return `file:line:column: problem; remedy` in a language."""
        sentence = Message("refusal.sentence", problem=self.problem, remedy=self.remedy).text(language)
        place, name = self.place, self.name
        return (f"{name}:{place.line}:{place.column}: " if place else f"{name}: " if name else "") + sentence

    def __str__(self) -> str:
        return self.text()


class DocumentRefused(Exception):
    """A file whose data do not fit the contract.

    Args:
        paragraph: renders the error of one field in a language, with its place in the file.
        errors: the errors, one for each wrong field.
    """

    def __init__(self, paragraph: Callable[[FieldError, str], str], errors: Iterable[FieldError]) -> None:
        self.errors = tuple(errors)
        super().__init__(self.errors)
        self._paragraph = paragraph

    def text(self, language: str = "en") -> str:
        """Return one paragraph for each wrong field."""
        return "\n".join(self._paragraph(error, language) for error in self.errors)

    def __str__(self) -> str:
        return self.text()


@dataclass(frozen=True)
class Document:
    """The data of a file, and the place of each value in its text (by path: `channels[0].enters.x1`).

    `nodes` are key and value of each path as YAML nodes; items of lists have no key. `parts` are the documents of
    fields that are files of their own, by the field's name.
    """

    data: Any
    text: str
    places: dict[str, Place] = field(default_factory=dict)
    name: str = ""
    parts: dict[str, "Document"] = field(default_factory=dict)
    nodes: dict[str, tuple[yaml.Node | None, yaml.Node]] = field(default_factory=dict)

    def place(self, path: str) -> Place | None:
        """Return the place of a path's value, or of the innermost enclosing part that occurs in the text."""
        while path and path not in self.places:
            path = re.sub(r"(\.[^.\[\]]*|\[\d+\]|^[^.\[\]]+)$", "", path)
        return self.places.get(path)

    def refused(self, errors: Iterable[FieldError]) -> DocumentRefused:
        """Return the exception for data that were refused."""
        return DocumentRefused(self.located, errors)

    def refused_text(self, error: FieldError, offset: int, text: str) -> DocumentRefused:
        """Return the exception for an expression; `text` and `offset` are those of :meth:`located`."""
        return DocumentRefused(lambda error, language: self.located(error, language, offset, text), [error])

    def located(self, error: FieldError, language: str = "en", offset: int = 0, text: str = "") -> str:
        """Return `file:line:column: field: problem; remedy`, the line, and a mark under the place.

        For a mistake within an expression, `text` is the expression and `offset` the place in it: the column is exact
        where the expression is on its line unchanged.
        """
        message = sentence(error, language)
        first, _, rest = error.field.partition(".")
        if rest and first in self.parts:
            return self.parts[first].located(error.model_copy(update={"field": rest}), language, offset, text)
        place = self.place(error.field)
        if place is None:
            return f"{self.name}: {message}"
        line = self.text.splitlines()[place.line - 1] if self.text else ""
        index = line.find(text, place.column - 1) if text else -1
        column = place.column if index < 0 else index + 1 + offset
        start = max(0, column - 80)
        mark = f"  {line[start : start + 120]}\n  {' ' * (column - 1 - start)}^"
        return f"{self.name}:{place.line}:{column}: {message}\n{mark}"


_FASTEST: type[yaml.SafeLoader] = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # the first needs libyaml


class _Loader(_FASTEST):
    """YAML with the scalars of JSON: YAML 1.1 reads 1e-3 as text, 012 as 10, 1:30 as 90 and `no` as false."""

    yaml_implicit_resolvers: dict = {}


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
        raise DocumentError(Message("document.suffix", name=path.name, suffixes=_SUFFIXES))
    try:
        with path.open("rb") as stream:
            content = stream.read(limit + 1)
    except OSError as error:
        raise unreadable(path, error) from None
    if len(content) > limit:
        raise DocumentError(Message("document.too-large", name=path.name, limit=limit))
    try:
        return replace(parse(content.decode("utf-8-sig")), name=str(path))
    except UnicodeDecodeError as error:
        raise DocumentError(Message("document.no-utf8", name=path.name, byte=error.start)) from None
    except DocumentError as error:
        raise DocumentError(error.problem, error.place, str(path)) from None


def unreadable(path: Path, error: OSError) -> DocumentError:
    """Return the error for a file that the operating system refuses to open."""
    return DocumentError(Message("document.unreadable", name=str(path), detail=error.strerror or str(error)))


def parse(text: str) -> Document:
    """Return the data of YAML or JSON text (parsed as YAML). Anchors, aliases, tags and repeated keys are refused."""
    nodes: _Nodes = {}
    try:
        _scan(text)
        node = yaml.compose(text, Loader=_Loader)
        data = None if node is None else _build(node, "", nodes, None)
    except yaml.MarkedYAMLError as error:
        unfinished = error.context_mark and "end of stream" in str(error.problem)  # a quotation mark is never closed
        mark = error.context_mark if unfinished else error.problem_mark or error.context_mark
        place = mark and Place(mark.line + 1, mark.column + 1)
        detail = str(error.problem or error.context)
        raise DocumentError(Message("document.no-yaml", detail=detail), place) from None
    except yaml.YAMLError as error:
        raise DocumentError(Message("document.no-yaml", detail=str(error))) from None
    return Document(data, text, {path: _place(value) for path, (_, value) in nodes.items()}, nodes=nodes)


def _scan(text: str) -> None:
    """Refuse anchors and aliases (which multiply data), tags, and deep nesting before the data are built."""
    depth = 0
    for event in yaml.parse(text, Loader=_Loader):
        if getattr(event, "anchor", None) is not None:
            raise DocumentError(Message("document.anchor"), _place(event))
        if getattr(event, "tag", None) is not None:
            raise DocumentError(Message("document.tag", tag=event.tag[:80]), _place(event))
        if isinstance(event, yaml.CollectionStartEvent):
            depth += 1
        elif isinstance(event, yaml.CollectionEndEvent):
            depth -= 1
        if depth > _DEPTH:
            raise DocumentError(Message("document.nesting", depth=_DEPTH), _place(event))


_Nodes = dict[str, tuple[yaml.Node | None, yaml.Node]]


def _build(node: yaml.Node, path: str, nodes: _Nodes, key: yaml.Node | None) -> Any:
    nodes[path] = (key, node)
    if isinstance(node, yaml.SequenceNode):
        return [_build(item, f"{path}[{index}]", nodes, None) for index, item in enumerate(node.value)]
    if isinstance(node, yaml.MappingNode):
        return _mapping(node, path, nodes)
    assert isinstance(node, yaml.ScalarNode), "YAML has no other kind of node"
    return _scalar(node)


def _mapping(node: yaml.MappingNode, path: str, nodes: _Nodes) -> dict[str, Any]:
    built: dict[str, Any] = {}
    for key, value in node.value:
        if not isinstance(key, yaml.ScalarNode):
            raise DocumentError(Message("document.key-type"), _place(key))
        name = key.value
        if name in built:
            raise DocumentError(Message("document.key-repeated", name=name[:80]), _place(key))
        built[name] = _build(value, f"{path}.{name}" if path else name, nodes, key)
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
