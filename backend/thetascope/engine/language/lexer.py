"""Lexer of the expression language: it checks the text of an expression character by character before it is parsed.

The scanner accepts a single line of numbers, known names, known functions, operators and commas in a valid order, with
balanced parentheses of limited depth. It rejects everything else and reports the position. So Python's parser, which
runs next (parser.py), never reads text that could exhaust its stack or that means more than arithmetic.
"""

import keyword
import re
import unicodedata
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from difflib import get_close_matches
from typing import NoReturn

from thetascope.engine.errors import ExpressionError
from thetascope.engine.language.identifiers import end_of_name, normalised, twin
from thetascope.messages import Message

MAX_LENGTH = 2000
MAX_DEPTH = 60
MAX_TOKENS = 600  # numbers, names, functions and operators
SPLIT = Message("expression.split")
OPERAND = Message("expression.operand")
CONSTANTS = ("pi", "π")
WORDS = ("and", "or")

_TOKEN = re.compile(
    r"(?P<blank>[ \t\r\n]+)|(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
    r"|(?P<operator>\*\*|<=|>=|[-+*/^<>])|(?P<mark>[(),])"
)


def _write(text: str) -> Message:
    return Message("expression.write", text=text)


_HINTS = {
    "e": Message("expression.hint.euler"),
    "E": Message("expression.hint.euler"),
    "pow": _write("a**b"),
    "ln": Message("expression.hint.ln"),
    "log10": _write("log(x)/log(10)"),
    "log2": _write("log(x)/log(2)"),
    "sgn": _write("sign(x)"),
    "sat": _write("clip(x, low, high)"),
    "cot": _write("1/tan(x)"),
    "arcsin": _write("asin(x)"),
    "arccos": _write("acos(x)"),
    "arctan": _write("atan(x)"),
    "arctan2": _write("atan2(y, x)"),
    "PI": _write("pi"),
    "Pi": _write("pi"),
    "if": _write("where(condition, value, otherwise)"),
    "else": _write("where(condition, value, otherwise)"),
    "not": Message("expression.hint.not"),
    "lambda": Message("expression.hint.lambda"),
}
_MARKS = {
    "=": Message("expression.mark.equals"),
    "!": Message("expression.mark.not"),
    "&": _write("and"),
    "|": Message("expression.mark.bar"),
    "%": Message("expression.mark.percent"),
    "[": Message("expression.mark.bracket"),
    "{": Message("expression.mark.brace"),
    ".": Message("expression.mark.dot"),
    "'": Message("expression.mark.quote"),
    '"': Message("expression.mark.quote"),
    "\0": Message("expression.mark.null"),
}
_LOOK_ALIKES = dict.fromkeys("−–—", "-") | dict.fromkeys("×·⋅∙", "*") | dict.fromkeys("÷∕", "/")
_LOOK_ALIKES |= {"≤": "<=", "≥": ">=", "²": "^2", "³": "^3", "√": "sqrt(…)", "\u00a0": "a blank"}
_TAIL = re.compile(r"[\w.]*")  # characters after a number that do not belong to it


@dataclass(frozen=True, slots=True)
class Token:
    """A token of the text. Its kind is number, name, table, function, operator, or one of the characters ( ) and comma.

    A name and a table have the normal form of their text, which `start` and `end` delimit.
    """

    kind: str
    text: str
    start: int
    end: int


class Scanner:
    """Scanner of one text, which may use the quantities `names`, call `functions`, and interpolate in `tables`."""

    def __init__(
        self, text: str, names: Collection[str], functions: Collection[str], field: str, tables: Collection[str] = ()
    ) -> None:
        self.text, self.names, self.functions, self.field, self.tables = text, names, functions, field, tables

    def refuse(self, start: int, end: int, problem: Message, remedy: Message | None = None) -> NoReturn:
        """Raise ExpressionError for the characters start … end."""
        raise ExpressionError(self.field, self.text, start, end, problem, remedy)

    def tokens(self) -> list[Token]:
        """Return the tokens in order. Raises ExpressionError for a token that cannot follow the one before it."""
        if len(self.text) > MAX_LENGTH:
            problem = Message("expression.too-long", length=len(self.text), most=MAX_LENGTH)
            self.refuse(MAX_LENGTH, len(self.text), problem, SPLIT)
        accepted: list[Token] = []
        opened: list[Token] = []
        signs = operations = 0
        for token in self._split():
            self._check_order(accepted[-1] if accepted else None, token)
            signs = signs + 1 if token.kind == "operator" and _operand_expected(accepted) else 0
            if signs > MAX_DEPTH:
                self.refuse(token.start, token.end, Message("expression.signs", most=MAX_DEPTH))
            operations += token.kind not in ("(", ")", ",")
            if operations > MAX_TOKENS:
                self.refuse(token.start, token.end, Message("expression.operations", most=MAX_TOKENS), SPLIT)
            self._balance(opened, token)
            accepted.append(token)
        if _operand_expected(accepted):
            last = accepted[-1] if accepted else Token("blank", "", 0, 0)
            problem = Message("expression.missing-after", text=last.text) if accepted else Message("expression.empty")
            self.refuse(last.start, last.end, problem, OPERAND)
        if opened:
            self.refuse(opened[-1].start, opened[-1].end, Message("expression.parenthesis.open"))
        return accepted

    def _split(self) -> Iterator[Token]:
        """Yield the tokens of the text, without checking their order."""
        position = 0
        while position < len(self.text):
            end = end_of_name(self.text, position)
            if end > position:
                yield self._name(position, end)
                position = end
                continue
            match = _TOKEN.match(self.text, position)
            if match is None:
                self._foreign(position)
            position = match.end()
            if match.lastgroup == "number":
                yield self._number(match)
            elif match.lastgroup != "blank":
                kind = "operator" if match.lastgroup == "operator" else match.group()
                yield Token(kind, match.group(), match.start(), match.end())

    def _foreign(self, position: int) -> NoReturn:
        """Refuse a character that cannot begin a token."""
        char = self.text[position]
        shown = char if char.isprintable() else f"U+{ord(char):04X}"
        if char in _LOOK_ALIKES:
            problem = Message("expression.character.look-alike", char=shown)
            self.refuse(position, position + 1, problem, _write(_LOOK_ALIKES[char]))
        plain = unicodedata.normalize("NFKD", char)[:1]
        if not char.isascii():
            name = unicodedata.name(char, "a character without a name").lower()
            problem = Message("expression.character.foreign", char=shown, name=name)
            self.refuse(position, position + 1, problem, _write(plain) if plain.isascii() and plain.isalnum() else None)
        self.refuse(position, position + 1, Message("expression.character.meaningless", char=shown), _MARKS.get(char))

    def _number(self, match: re.Match[str]) -> Token:
        """Return the token of a number. Refuses numbers that are malformed or that a double cannot represent."""
        start, end, text = match.start(), match.end(), match.group()
        following = _TAIL.match(self.text, end)
        tail = following.group() if following else ""
        stop = end + len(tail)
        if tail in ("j", "J"):
            self.refuse(start, stop, Message("expression.number.complex", text=text + tail))
        if tail[:1] in ("_", ".") or text == "0" and tail[:1] in ("x", "o", "b", "X", "O", "B") and tail[1:2].isalnum():
            self.refuse(start, stop, Message("expression.number.malformed", text=(text + tail)[:40]))
        if tail:
            problem = Message("expression.operator.missing-after", text=text[:40])
            self.refuse(start, stop, problem, _write(f"{text[:20]}*{tail[:20]}"))
        if text.isdigit():
            if len(text) > 1 and text[0] == "0":
                self.refuse(start, end, Message("expression.number.zeros"), _write(text.lstrip("0")[:20] or "0"))
            if len(text) > 16 or int(text) > 2**53:
                self.refuse(start, end, Message("expression.number.inexact"))
        value = float(text)
        if value in (0.0, float("inf")) and (value or re.search("[1-9]", re.split("[eE]", text)[0])):
            self.refuse(start, end, Message("expression.number.large" if value else "expression.number.small"))
        return Token("number", text, start, end)

    def _name(self, start: int, end: int) -> Token:
        """Return the token of a name: a quantity, a table, the constant π, `and`, `or`, or a function before (."""
        text = normalised(self.text[start:end])
        rest = self.text[end:].lstrip(" \t\r\n")
        called = rest.startswith("(")
        if text in WORDS:
            return Token("operator", text, start, end)
        if called and text in self.functions:
            return Token("function", text, start, end)
        if not called and (text in self.names or text in CONSTANTS) and not keyword.iskeyword(text):
            if rest[:1] == "." and not rest[1:2].isdigit():
                self.refuse(
                    start, len(self.text) - len(rest) + 1, Message("expression.attribute", name=text), _MARKS["."]
                )
            return Token("name", "pi" if text in CONSTANTS else text, start, end)
        if not called and text in self.tables:
            return Token("table", text, start, end)
        return self._unknown(text, start, end, called)

    def _unknown(self, text: str, start: int, end: int, called: bool) -> NoReturn:
        """Refuse a name that is not known, with the nearest known names as the remedy."""
        shown = text if len(text) <= 40 else text[:39] + "…"
        if keyword.iskeyword(text):
            self.refuse(start, end, Message("expression.name.reserved", name=shown), _HINTS.get(text))
        if text in self.functions:
            self.refuse(start, end, Message("expression.name.function", name=shown), _write(f"{shown}(…)"))
        if text in self.names or text in CONSTANTS:
            self.refuse(start, end, Message("expression.name.no-function", name=shown))
        if text in self.tables:
            self.refuse(start, end, Message("expression.table.called", name=shown))
        known = self.functions if called else {*self.names, *self.tables, *CONSTANTS[:1]}
        like = twin(text, known)
        if like is not None:
            letter, name = like
            problem = Message(
                "expression.name.twin", name=shown, char=letter, script=unicodedata.name(letter, "").lower()
            )
            self.refuse(start, end, problem, _write(name) if name in known else self._nearest(name, known, called))
        self.refuse(
            start,
            end,
            Message("expression.function.unknown" if called else "expression.name.unknown", name=shown),
            self._nearest(text, known, called),
        )

    def _nearest(self, text: str, known: Collection[str], called: bool) -> Message:
        """Return the remedy for an unknown name: a hint, the nearest known names, or all of them."""
        by_case = [name for name in sorted(known) if name.casefold() == text.casefold()]
        near = by_case or get_close_matches(text[:40], sorted(known), n=3, cutoff=0.5)
        if text in _HINTS:
            return _HINTS[text]
        if near:
            return Message("suggest.near", names=near)
        if called:
            return Message("suggest.all", names=sorted(known))
        names = sorted(self.names)[:12] + ["…"] * (len(self.names) > 12)
        return Message("expression.declare", names=names) if names else Message("expression.declare.none")

    def _check_order(self, before: Token | None, token: Token) -> None:
        """Refuse a token that cannot follow the token before it."""
        expected = before is None or before.kind in ("operator", "(", ",", "function")
        if expected and token.kind in (")", ",") or expected and token.kind == "operator" and token.text not in "+-":
            problem = Message("expression.missing-before", text=token.text)
            if before is not None:
                problem = Message("expression.missing-between", text=token.text, before=before.text)
            self.refuse(token.start, token.end, problem, OPERAND)
        if not expected and token.kind in ("number", "name", "table", "function", "("):
            before_text = before.text[-20:] if before else ""
            problem = Message("expression.operator.missing", before=before_text, text=token.text[:20])
            self.refuse(token.start, token.end, problem)

    def _balance(self, opened: list[Token], token: Token) -> None:
        """Update the open parentheses with a token. Refuses unbalanced or deep ones, and a comma outside a call."""
        if token.kind == "(":
            opened.append(token)
            if len(opened) > MAX_DEPTH:
                self.refuse(token.start, token.end, Message("expression.parentheses.deep", most=MAX_DEPTH), SPLIT)
        elif token.kind == ")":
            if not opened:
                self.refuse(token.start, token.end, Message("expression.parenthesis.close"))
            opened.pop()
        elif token.kind == "," and not opened:
            self.refuse(token.start, token.end, Message("expression.comma"))


def _operand_expected(tokens: list[Token]) -> bool:
    """Return whether an operand must follow these tokens."""
    return not tokens or tokens[-1].kind in ("operator", "(", ",", "function")
