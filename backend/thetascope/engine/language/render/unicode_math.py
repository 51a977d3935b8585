"""Conversion of mathematics typed in Unicode to MathML, for the equations of observers.

    Υ̇ = ρ(A₀ − k₀c₀)Υ + ρΔ⁻¹Φ − ρk₀Ψ

Letters are italic, names of functions upright (diag, exp, sgn); a combining hat, tilde, bar or dot goes
over its letter; ₀₁ᵢ… and ⁻¹ᵀ… are indices and exponents, _{…} and ^{…} too; √(…) is a root and {a / b} a fraction.
"""

import re
from html import escape

from thetascope.engine.language.render.mathml_symbols import BAR, DOT, HAT, TILDE, accented

ACCENTS = {"\u0302": HAT, "\u0303": TILDE, "\u0304": BAR, "\u0307": DOT}  # from the letter outwards
PRECOMPOSED = {
    "ŷ": "y\u0302",
    "ẑ": "z\u0302",
    "ẋ": "x\u0307",
    "ẏ": "y\u0307",
    "ż": "z\u0307",
    "Ã": "A\u0303",
    "ỹ": "y\u0303",
    "Ṗ": "P\u0307",
}
SUB = dict(zip("₀₁₂₃₄₅₆₇₈₉₊₋ₐₑᵢⱼₖₘₙₚᵣₓ", "0123456789+−aeijkmnprx", strict=True))
SUP = dict(zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻ᵀᵅⁿⁱ", "0123456789+−Tαni", strict=True))
_TOKEN = re.compile(
    r"(?P<space>\s+)|(?P<word>diag|exp|sgn|log|min|max|det|sin|cos)|(?P<number>\d+(?:\.\d+)?)"
    r"|(?P<letter>[^\W\d_][\u0300-\u036f]*)|(?P<other>.)",
    re.DOTALL,
)
_SPACED = set("=<>≤≥+−·∈≈→")
_CLOSE = ' lspace="0" rspace="0.1em"'


def notation(text: str) -> str:
    """Return the MathML of a formula, without the `math` element. Raises ValueError if the text is not valid."""
    for letter, pair in PRECOMPOSED.items():
        text = text.replace(letter, pair)
    reader = _Reader([m for m in _TOKEN.finditer(text)])
    return f"<mrow>{reader.group('')}</mrow>"


class _Reader:
    """A recursive-descent parser of the tokens; `at` is the index of the next token."""

    def __init__(self, tokens: list[re.Match]) -> None:
        self.tokens, self.at = tokens, 0

    def peek(self) -> str:
        """Return the text of the next token, empty at the end."""
        return self.tokens[self.at][0] if self.at < len(self.tokens) else ""

    def group(self, closing: str) -> str:
        """Return everything up to a closing bracket, or up to the end if `closing` is empty."""
        out: list[str] = []
        while self.peek() != closing or (closing == "" and self.at < len(self.tokens)):
            if self.at >= len(self.tokens):
                raise ValueError(f"{closing!r} is missing")
            if self.tokens[self.at]["space"]:
                self.at += 1
                continue
            if self.peek() == "/" and closing == "}":
                self.at += 1
                return f"<mfrac><mrow>{''.join(out)}</mrow><mrow>{self.group(closing)}</mrow></mfrac>"
            out.append(self.scripted())
        return "".join(out)

    def scripted(self) -> str:
        """Return one atom with its indices and exponents."""
        base = self.atom()
        below = self.script("_", SUB)
        above = self.script("^", SUP)
        below = below or self.script("_", SUB)
        if below and above:
            return f"<msubsup>{base}{below}{above}</msubsup>"
        return f"<msub>{base}{below}</msub>" if below else f"<msup>{base}{above}</msup>" if above else base

    def script(self, mark: str, letters: dict[str, str]) -> str:
        """Return an index or exponent, as _{…} or ^{…} or in Unicode's small characters; empty without one."""
        if self.peek() == mark:
            self.at += 1
            if self.peek() != "{":
                raise ValueError(f"write {mark}{{…}}")
            return self.braces()
        out = []
        while self.peek() and self.peek()[0] in letters:
            out.extend(_plain(letters[c]) for c in self.peek())
            self.at += 1
        return f"<mrow>{''.join(out)}</mrow>" if out else ""

    def braces(self) -> str:
        """Return the group between { and }."""
        self.at += 1
        inner = self.group("}")
        self.at += 1
        return f"<mrow>{inner}</mrow>"

    def atom(self) -> str:
        """Return one symbol, number, root or bracketed group."""
        token = self.tokens[self.at]
        text = token[0]
        if text == "{":
            return self.braces()
        self.at += 1
        if text == "√":
            return f"<msqrt>{self.scripted()}</msqrt>"
        if text in "([":
            return self.bracket(text)
        if token["word"]:
            return f'<mi class="upright">{text}</mi>'
        if token["number"]:
            return f"<mn>{text}</mn>"
        if token["letter"]:
            return self.letter(text)
        return f"<mo{'' if text in _SPACED else _CLOSE}>{escape(text)}</mo>"

    def bracket(self, left: str) -> str:
        """Return a bracketed group as one row, so that an exponent applies to the whole group."""
        right = {"(": ")", "[": "]"}[left]
        inner = self.group(right)
        self.at += 1
        before = f'<mo fence="true" form="prefix">{left}</mo>'
        after = f'<mo fence="true" form="postfix">{right}</mo>'
        return f"<mrow>{before}{inner}{after}</mrow>"

    def letter(self, text: str) -> str:
        """Return a letter with its accents. Raises ValueError for an unknown accent."""
        symbol = f"<mi>{escape(text[0])}</mi>"
        marks = [mark for mark in ACCENTS if mark in text[1:]]
        if len(marks) != len(text) - 1:
            raise ValueError(f"an accent of {text!r} is unknown")
        for mark in marks:  # a dot is drawn over a hat, whatever the order in which they were typed
            symbol = accented(symbol, ACCENTS[mark])
        return symbol


def _plain(c: str) -> str:
    return f"<mn>{c}</mn>" if c.isdigit() else f"<mi>{c}</mi>" if c.isalpha() else f"<mo>{c}</mo>"
