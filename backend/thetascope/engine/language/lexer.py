"""The text of an expression, read character by character before any parser sees it.

What passes is a single line of numbers, known names, known functions, operators and commas in an admissible order,
with balanced and not too deep parentheses. All else is refused at its place. So Python's parser, which comes next
(parser.py), never meets text that could exhaust its stack or that means more than arithmetic.
"""

import keyword
import re
import unicodedata
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from difflib import get_close_matches
from typing import NoReturn

from thetascope.engine.errors import ExpressionError

MAX_LENGTH = 2000
MAX_DEPTH = 60
MAX_TOKENS = 600  # numbers, names, functions and operators
SPLIT = "split it by means of definitions"
CONSTANTS = ("pi",)
WORDS = ("and", "or")

_TOKEN = re.compile(
    r"(?P<blank>[ \t\r\n]+)|(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
    r"|(?P<name>[A-Za-z_][A-Za-z0-9_]*)|(?P<operator>\*\*|<=|>=|[-+*/^<>])|(?P<mark>[(),])"
)

_HINTS = {
    "e": "for Euler's number write exp(1)",
    "E": "for Euler's number write exp(1)",
    "pow": "write a**b",
    "ln": "write log(x), the natural logarithm",
    "log10": "write log(x)/log(10)",
    "log2": "write log(x)/log(2)",
    "sgn": "write sign(x)",
    "sat": "write clip(x, low, high)",
    "cot": "write 1/tan(x)",
    "arcsin": "write asin(x)",
    "arccos": "write acos(x)",
    "arctan": "write atan(x)",
    "arctan2": "write atan2(y, x)",
    "PI": "write pi",
    "Pi": "write pi",
    "if": "write where(condition, value, otherwise)",
    "else": "write where(condition, value, otherwise)",
    "not": "turn the comparison round, for example x >= 0 for not x < 0",
}
_MARKS = {
    "=": "use <, <=, > or >= inside where(…); an equation's left side is not written",
    "!": "use <, <=, > or >= inside where(…)",
    "&": "write and",
    "|": "write or for conditions, abs(x) for a magnitude",
    "%": "write x - m*floor(x/m) for a remainder",
    "[": "use names without indices, such as x1",
    "{": "use parentheses",
    ".": "only names and numbers are known here, no attributes: use a name as it is declared",
    "'": "no text is needed here: remove the quotes",
    '"': "no text is needed here: remove the quotes",
    "\0": "remove the null character",
}
_LOOK_ALIKES = dict.fromkeys("−–—", "-") | dict.fromkeys("×·⋅∙", "*") | dict.fromkeys("÷∕", "/")
_LOOK_ALIKES |= {"≤": "<=", "≥": ">=", "²": "^2", "³": "^3", "√": "sqrt(…)", "π": "pi", "\u00a0": "a blank"}


@dataclass(frozen=True, slots=True)
class Token:
    """One piece of the text: kind is number, name, function, operator, ( , ) or the comma itself."""

    kind: str
    text: str
    start: int

    @property
    def end(self) -> int:
        return self.start + len(self.text)


class Scanner:
    """Reads one text. `names` are the quantities it may mention, `functions` the functions it may call."""

    def __init__(self, text: str, names: Collection[str], functions: Collection[str], field: str) -> None:
        self.text, self.names, self.functions, self.field = text, names, functions, field

    def refuse(self, start: int, end: int, problem: str, remedy: str) -> NoReturn:
        raise ExpressionError(self.field, self.text, start, end, problem, remedy)

    def tokens(self) -> list[Token]:
        """The tokens in order, each checked against what may follow what came before it."""
        if len(self.text) > MAX_LENGTH:
            problem = f"the expression has {len(self.text)} characters, more than {MAX_LENGTH}: it is too long"
            self.refuse(MAX_LENGTH, len(self.text), problem, SPLIT)
        found: list[Token] = []
        opened: list[Token] = []
        signs = operations = 0
        for token in self._split():
            self._check_order(found[-1] if found else None, token)
            signs = signs + 1 if token.kind == "operator" and _operand_expected(found) else 0
            if signs > MAX_DEPTH:
                self.refuse(token.start, token.end, f"more than {MAX_DEPTH} signs in a row", "keep one sign")
            operations += token.kind not in ("(", ")", ",")
            if operations > MAX_TOKENS:
                self.refuse(token.start, token.end, f"more than {MAX_TOKENS} operations and operands", SPLIT)
            self._balance(opened, token)
            found.append(token)
        if _operand_expected(found):
            last = found[-1] if found else Token("blank", "", 0)
            problem = f"something is missing after {last.text!r}" if found else "the expression is empty"
            self.refuse(last.start, last.end, problem, "write a number, a name or a function there")
        if opened:
            self.refuse(opened[-1].start, opened[-1].end, "this parenthesis is never closed", "add ) where it ends")
        return found

    def _split(self) -> Iterator[Token]:
        position = 0
        while position < len(self.text):
            match = _TOKEN.match(self.text, position)
            if match is None:
                self._foreign(position)
            position = match.end()
            if match.lastgroup == "name":
                yield self._name(match)
            elif match.lastgroup == "number":
                yield self._number(match)
            elif match.lastgroup != "blank":
                kind = "operator" if match.lastgroup == "operator" else match.group()
                yield Token(kind, match.group(), match.start())

    def _foreign(self, position: int) -> NoReturn:
        """A character that begins nothing."""
        char = self.text[position]
        shown = char if char.isprintable() else f"U+{ord(char):04X}"
        if char in _LOOK_ALIKES:
            self.refuse(position, position + 1, f"the character {shown!r} is not known", f"write {_LOOK_ALIKES[char]}")
        plain = unicodedata.normalize("NFKD", char)[:1]
        if not char.isascii():
            name = unicodedata.name(char, "a character without a name").lower()
            remedy = f"write {plain}" if plain.isascii() and plain.isalnum() else "write names in plain ASCII letters"
            self.refuse(position, position + 1, f"{shown!r} ({name}) is not an ASCII character", remedy)
        self.refuse(
            position, position + 1, f"the character {shown!r} has no meaning here", _MARKS.get(char, "remove it")
        )

    def _number(self, match: re.Match[str]) -> Token:
        start, end, text = match.start(), match.end(), match.group()
        tail = re.compile(r"[A-Za-z0-9_.]*").match(self.text, end).group()
        stop = end + len(tail)
        if tail in ("j", "J"):
            self.refuse(start, stop, f"complex numbers such as {text + tail} are not known", "write real numbers")
        if tail[:1] in ("_", ".") or text == "0" and tail[:1] in ("x", "o", "b", "X", "O", "B") and tail[1:2].isalnum():
            self.refuse(start, stop, f"{(text + tail)[:40]!r} is not a number", "write decimal digits, as in 1500.0")
        if tail:
            self.refuse(start, stop, f"an operator is missing after {text[:40]}", f"write {text[:20]}*{tail[:20]}")
        if text.isdigit():
            if len(text) > 1 and text[0] == "0":
                self.refuse(start, end, "a whole number does not begin with 0", f"write {text.lstrip('0')[:20] or 0}")
            if len(text) > 16 or int(text) > 2**53:
                self.refuse(start, end, "the whole number is too large to be exact", "write it as a decimal: 1.5e20")
        value = float(text)
        if value in (0.0, float("inf")) and (value or re.search("[1-9]", re.split("[eE]", text)[0])):
            self.refuse(start, end, f"the number is too {'large' if value else 'small'}", "keep within 1e-307 … 1e308")
        return Token("number", text, start)

    def _name(self, match: re.Match[str]) -> Token:
        """A name is a quantity, the constant, a word between conditions, or, before a parenthesis, a function."""
        text, start, end = match.group(), match.start(), match.end()
        rest = self.text[end:].lstrip(" \t\r\n")
        called = rest.startswith("(")
        if text in WORDS:
            return Token("operator", text, start)
        if called and text in self.functions:
            return Token("function", text, start)
        if not called and (text in self.names or text in CONSTANTS) and not keyword.iskeyword(text):
            if rest[:1] == "." and not rest[1:2].isdigit():
                self.refuse(start, len(self.text) - len(rest) + 1, f"{text} has no attributes", _MARKS["."])
            return Token("name", text, start)
        self._unknown(text, start, end, called)

    def _unknown(self, text: str, start: int, end: int, called: bool) -> NoReturn:
        shown = text if len(text) <= 40 else text[:39] + "…"
        if keyword.iskeyword(text):
            remedy = _HINTS.get(text, f"use another name, such as {text}_1")
            self.refuse(start, end, f"{shown!r} is a reserved word", remedy)
        if text in self.functions:
            self.refuse(start, end, f"{shown} is a function", f"write {shown}(…)")
        if text in self.names or text in CONSTANTS:
            self.refuse(start, end, f"{shown} is not a function", f"write {shown}*(…) for a product")
        known = self.functions if called else {*self.names, *CONSTANTS}
        what = "function" if called else "name"
        near = get_close_matches(text[:40], sorted(known), n=3, cutoff=0.5)
        if text in _HINTS:
            remedy = _HINTS[text]
        elif near:
            remedy = f"did you mean {' or '.join(near)}?"
        elif called:
            remedy = f"use one of: {', '.join(sorted(known))}"
        else:
            listed = ", ".join(sorted(self.names)[:12]) + (", …" if len(self.names) > 12 else "")
            remedy = f"declare it, or use one of: {listed or 'numbers, pi (no names are declared)'}"
        self.refuse(start, end, f"unknown {what} {shown!r}", remedy)

    def _check_order(self, before: Token | None, token: Token) -> None:
        expected = before is None or before.kind in ("operator", "(", ",", "function")
        if expected and token.kind in (")", ",") or expected and token.kind == "operator" and token.text not in "+-":
            after = f" after {before.text!r}" if before else ""
            problem = f"something is missing before {token.text!r}{after}"
            self.refuse(token.start, token.end, problem, "write a number, a name or a function there")
        if not expected and token.kind in ("number", "name", "function", "("):
            problem = f"an operator is missing between {before.text[-20:]!r} and {token.text[:20]!r}"
            self.refuse(token.start, token.end, problem, "write * for a product")

    def _balance(self, opened: list[Token], token: Token) -> None:
        if token.kind == "(":
            opened.append(token)
            if len(opened) > MAX_DEPTH:
                problem = f"parentheses are nested deeper than {MAX_DEPTH}"
                self.refuse(token.start, token.end, problem, SPLIT)
        elif token.kind == ")":
            if not opened:
                self.refuse(token.start, token.end, "this parenthesis closes nothing", "remove it or add ( before it")
            opened.pop()
        elif token.kind == "," and not opened:
            self.refuse(
                token.start, token.end, "a comma stands outside a function", "write one expression; 1.5, not 1,5"
            )


def _operand_expected(found: list[Token]) -> bool:
    return not found or found[-1].kind in ("operator", "(", ",", "function")
