"""Find the small change that makes a text readable as YAML: a quote, a colon, spaces in place of tabs and the like."""

import re
from collections.abc import Iterator
from dataclasses import dataclass

from thetascope.messages import Message
from thetascope.runs.plants.text_places import Span
from thetascope.runs.specs.spec_files import DocumentError, Place, parse

_WIDE = str.maketrans("，：；（）［］｛｝“”‘’", ",:;()[]{}\"\"''")
_WIDE_CHARACTER = re.compile("[，：；（）［］｛｝“”‘’]")
_BLOCK_VALUE = re.compile(r"^(\s*(?:- )?[\w-]+:\s+)([^\s\"'{\[|>#&*!].*?)\s*$")
_FLOW_VALUE = re.compile(r"([{,]\s*[\w-]+:\s+)([^\s\"'{\[][^,}]*: [^,}]*?)(\s*[,}])")
_BARE_KEY = re.compile(r"^(\s*[\w-]+)\s*$")
_CLOSING = {"{": "}", "[": "]"}
_BEFORE = 3  # lines before the place that a reader reports, in which the cause may be
_LONGEST = 20_000  # characters of a text in which changes are tried


@dataclass(frozen=True)
class Repair:
    """A change of a text that cannot be read: `span` is replaced by `text`; problem: what is wrong there."""

    span: Span
    text: str
    problem: Message


def repair(text: str, place: Place | None) -> Repair | None:
    """Return the change after which a text can be read, or is wrong only further down; None if none is found."""
    if place is None or len(text) > _LONGEST:
        return None
    lines = text.split("\n")
    last = min(place.line, len(lines)) - 1
    near = [index for index in range(last, max(-1, last - _BEFORE - 1), -1) if lines[index].strip()]
    for index in near:
        for line, problem in _candidates(lines, index):
            changed = "\n".join([*lines[:index], line, *lines[index + 1 :]])
            if line != lines[index] and _reads_on(changed, place.line):
                return _between(text, changed, problem)
    return None


def _reads_on(text: str, line: int) -> bool:
    """Return whether a text can be read beyond a line."""
    try:
        parse(text)
    except DocumentError as error:
        return error.place is not None and error.place.line > line + 1
    return True


def _candidates(lines: list[str], index: int) -> Iterator[tuple[str, Message]]:
    """Yield changes of a line, the likeliest first, each with the error that it mends."""
    line = lines[index]
    wide = _WIDE_CHARACTER.search(line)
    if wide:
        yield line.translate(_WIDE), Message("document.wide", char=wide[0], plain=wide[0].translate(_WIDE))
    head = line[: len(line) - len(line.lstrip())]
    if "\t" in head:
        yield head.replace("\t", "  ") + line.lstrip(), Message("document.tab")
        for indent in _indents(lines, index):
            yield indent + line.lstrip(), Message("document.tab")
    if match := _BLOCK_VALUE.match(line):
        yield match[1] + _quoted(match[2]), Message("document.colon-in-value")
    if match := _FLOW_VALUE.search(line):
        value = match[1] + _quoted(match[2]) + match[3]
        yield line[: match.start()] + value + line[match.end() :], Message("document.colon-in-value")
    if match := _BARE_KEY.match(line):
        yield match[1] + ":", Message("document.colon-missing", name=match[1].strip()[:40])
    for indent in _indents(lines, index):
        yield indent + line.lstrip(), Message("document.indent", spaces=len(indent))
    yield from _closed(line)


def _closed(line: str) -> Iterator[tuple[str, Message]]:
    """Yield a line with its quotation mark or its brackets closed, or without what closes nothing."""
    if line.count('"') % 2:
        tail = len(line.rstrip()) - len(line.rstrip().rstrip("}]"))
        for end in dict.fromkeys((len(line.rstrip()) - tail, len(line))):
            yield line[:end] + '"' + line[end:], Message("document.open-quote")
    open_ones: list[str] = []
    for place, char in enumerate(line):
        if char in _CLOSING:
            open_ones.append(char)
        elif char in _CLOSING.values():
            if open_ones and _CLOSING[open_ones[-1]] != char:
                missing = _CLOSING[open_ones[-1]]
                yield (
                    line[:place] + missing + line[place:],
                    Message("document.open-bracket", char=open_ones[-1], missing=missing),
                )
            if not open_ones or _CLOSING[open_ones[-1]] != char:
                yield line[:place] + line[place + 1 :], Message("document.closing-bracket", char=char)
                return
            open_ones.pop()
    if open_ones:
        missing = "".join(_CLOSING[char] for char in reversed(open_ones))
        yield line.rstrip() + missing, Message("document.open-bracket", char=open_ones[-1], missing=missing)


def _indents(lines: list[str], index: int) -> list[str]:
    """Return the indents of the lines before and after, without that of the line itself."""
    own = lines[index][: len(lines[index]) - len(lines[index].lstrip())]
    before = next((line for line in reversed(lines[:index]) if line.strip()), "")
    after = next((line for line in lines[index + 1 :] if line.strip()), "")
    found = [line[: len(line) - len(line.lstrip())] for line in (before, after)]
    if before.rstrip().endswith(":"):
        found.insert(0, found[0] + "  ")
    return [indent for indent in dict.fromkeys(found) if indent != own and "\t" not in indent]


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _between(text: str, changed: str, problem: Message) -> Repair:
    """Return the change from one text to another: the characters between what both begin and end with."""
    start = next(
        (k for k, (a, b) in enumerate(zip(text, changed, strict=False)) if a != b), min(len(text), len(changed))
    )
    most = min(len(text), len(changed)) - start
    end = next((k for k in range(most) if text[-1 - k] != changed[-1 - k]), most)
    return Repair(Span(start, len(text) - end), changed[start : len(changed) - end], problem)
