"""Symbols and texts of figures, which are HTML with <i>, <sub>, <sup> and <br>, as mathtext, LaTeX and plain text."""

import html
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from thetascope.figures.html_symbols import GREEK

_TAG = re.compile(r"<(/?)(i|sub|sup|br)>")
_ACCENTS = {"\u0302": "hat", "\u0303": "tilde", "\u0307": "dot"}
_COMMANDS = {letter: f"\\{name}" for name, letter in GREEK.items()} | {"\u03bf": "o"}
_LOWERED = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
_RAISED = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
_LATEX = {
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    **{char: "\\" + char for char in "%$#&_{}"},
    "−": "$-$",
    "°": r"\textdegree{}",
    "²": "$^{2}$",
    "³": "$^{3}$",
    "·": r"$\cdot$",
    "…": r"\ldots{}",
    "\u2009": r"\,",
    **{letter: f"${command}$" for letter, command in _COMMANDS.items() if command.startswith("\\")},
}
_FORMULA = re.compile(
    rf"(?P<formula>[ -~−{''.join(_COMMANDS)}\u0302\u0303\u0307]+)|[^ -~−{''.join(_COMMANDS)}\u0302\u0303\u0307]+"
)
_WIDE = re.compile("[\u2e80-\uffff]")
_INVISIBLE = re.compile("[\x00-\x1f\x7f-\x9f\u2028\u2029]")
_POWER = re.compile(r"(?<=[A-Za-zµμΩ])\^?(-?\d)(?![\w.])")


@dataclass(frozen=True)
class _Part:
    """A stretch of text. kind: text, i, sub or sup."""

    kind: str
    text: str


def _parts(source: str) -> list[_Part]:
    """Return the stretches of HTML. Control characters and separators of lines become blanks: TeX obeys some."""
    parts, kinds, at = [], ["text"], 0
    for tag in _TAG.finditer(source):
        parts.append(_Part(kinds[-1], _unescaped(source[at : tag.start()])))
        at = tag.end()
        if tag[2] == "br":
            parts.append(_Part("text", "\n"))
        elif not tag[1]:
            kinds.append(tag[2])
        elif len(kinds) > 1:
            kinds.pop()
    parts.append(_Part(kinds[-1], _unescaped(source[at:])))
    return [part for part in parts if part.text]


def _unescaped(text: str) -> str:
    return _INVISIBLE.sub(" ", html.unescape(text))


def mathtext(source: str) -> str:
    """Return HTML as matplotlib's text: symbols in $…$, dollar signs escaped.

    Beside Chinese the symbols are written in plain text, since matplotlib sets text with formulas in one font.
    """
    text = _set(_parts(source), lambda text: text.replace("$", r"\$"))
    return plain(source).replace("$", r"\$") if "$" in text and _WIDE.search(text) else text


def latex(source: str) -> str:
    """Return HTML as LaTeX, with its special characters escaped; line breaks become blanks."""
    return _set(_parts(source), latex_text).replace("\n", " ")


def latex_text(text: str) -> str:
    """Return plain text as LaTeX."""
    return "".join(_LATEX.get(char, char) for char in text)


def plain(source: str) -> str:
    """Return HTML as plain text: indices of digits are lowered, line breaks become blanks."""

    def written(part: _Part) -> str:
        table = {"sub": _LOWERED, "sup": _RAISED}.get(part.kind)
        return part.text.translate(table) if table else part.text

    return " ".join("".join(written(part) for part in _parts(source)).split())


def unit_html(unit: str) -> str:
    """Return a unit as HTML with raised powers: 1/h2 → 1/h<sup>2</sup>."""
    text = html.escape(unit).replace("**", "^").replace("*", "·")
    return _POWER.sub(lambda power: f"<sup>{power[1].replace('-', '−')}</sup>", text)


def _set(parts: list[_Part], escape: Callable[[str], str]) -> str:
    """Return the parts with neighbouring symbols and indices in one pair of dollar signs."""
    out, formula = [], ""
    for part in _for_formulas(parts):
        if part.kind == "text":
            out += [f"${formula}$"] if formula else []
            out.append(escape(part.text))
            formula = ""
        elif part.kind == "i":
            formula += ("\\ " if formula else "") + _letters(part.text)
        else:
            formula += f"{'' if formula else '{}'}{'_' if part.kind == 'sub' else '^'}{{{_upright(part.text)}}}"
    out += [f"${formula}$"] if formula else []
    return "".join(out)


def _for_formulas(parts: list[_Part]) -> Iterator[_Part]:
    """Yield the parts; characters that fonts of mathematics do not have become text."""
    for part in parts:
        if part.kind == "text":
            yield part
            continue
        for piece in _FORMULA.finditer(part.text):
            yield _Part(part.kind if piece["formula"] else "text", piece[0])


def _upright(text: str) -> str:
    inside = "".join(f"{_COMMANDS[char]} " if char in _COMMANDS else _escaped(char) for char in text.replace("−", "-"))
    return rf"\mathrm{{{inside}}}"


def _escaped(text: str) -> str:
    return re.sub(r"([%$#&_{}])", r"\\\1", text).replace("\n", " ")


def _letters(text: str) -> str:
    """Return italic text as a formula: one letter by its command, accents over letters, words as words."""
    letters = re.findall(r"[^\u0300-\u036f][\u0300-\u036f]?", text)
    if len(letters) > 1 and text.isascii():
        return rf"\mathit{{{_escaped(text).replace(' ', chr(92) + ' ')}}}"
    return "".join(_accented(letter) for letter in letters)


def _accented(letter: str) -> str:
    base = _COMMANDS.get(letter[0]) or (r"\ " if letter[0].isspace() else _escaped(letter[0]))
    if len(letter) > 1 and letter[1] in _ACCENTS:
        return rf"\{_ACCENTS[letter[1]]}{{{base}}}"
    return base + " " if base.startswith("\\") else base
