"""Names of quantities: identifiers in any script, in Unicode's normal form NFKC, and the words that they cannot be.

The lexer of the expression language (thetascope.engine.language.identifiers) accepts the same characters; a test
compares the two over all of Unicode.
"""

import keyword
import unicodedata
from collections.abc import Collection

from thetascope_schemas.texts.refusal import refuse

MAX_NAME = 32  # characters
PATTERN = r"^[\p{L}_][\p{L}\p{M}\p{Nd}\p{Pc}\u2080-\u2089]*$"
"""Approximate pattern of a name for JSON Schema, with the u flag of ECMAScript."""

CONSTANTS = ("pi", "π")
_SUBSCRIPTS = "₀₁₂₃₄₅₆₇₈₉"
_CATEGORIES = ("Lu", "Ll", "Lt", "Lm", "Lo", "Mn", "Mc", "Nd", "Pc")
_INVISIBLE = frozenset((0x034F, 0x115F, 0x1160, 0x3164, 0xFFA0, *range(0xFE00, 0xFE10), *range(0xE0100, 0xE01F0)))
_INSTEAD = {"lambda": "lam", "π": "pi_1"}


def is_letter(char: str, first: bool = False) -> bool:
    """Return whether a name may contain a character, or begin with it."""
    if char.isascii():
        return char == "_" or char.isalpha() or (not first and char.isdigit())
    if char in _SUBSCRIPTS:
        return not first
    plain = unicodedata.normalize("NFKC", char)
    if "·" in plain or ord(char) in _INVISIBLE or unicodedata.category(char) not in _CATEGORIES:
        return False
    return (plain if first else f"a{plain}").isidentifier()


def normalised(name: object) -> object:
    """Return a name in the normal form NFKC: ϑ becomes θ, x₁ becomes x1. Others are returned unchanged."""
    if not isinstance(name, str) or name.isascii() or not all(map(is_letter, name)):
        return name
    return unicodedata.normalize("NFKC", name)


def normalised_path(path: str) -> str:
    """Return a path of names, such as `adaptive.theta.ΔR`, with each name in the normal form."""
    return path if path.isascii() else ".".join(str(normalised(part)) for part in path.split("."))


def names_normalised(text: str) -> str:
    """Return an expression with its names in the normal form; all other characters stay, x² is a power of x."""
    if text.isascii():
        return text
    pieces, end = [], 0
    while end < len(text):
        start = end
        while end < len(text) and is_letter(text[end], first=end == start):
            end += 1
        pieces.append(str(normalised(text[start:end])) if end > start else text[end])
        end = max(end, start + 1)
    return "".join(pieces)


def well_formed(name: str) -> str:
    """Return a name; refuse one that is not an identifier, with the nearest one that is."""
    if not name:
        raise refuse("schema.name.empty", value=name)
    if len(name) > MAX_NAME:
        raise refuse("schema.name.too-long", value=name, length=len(name), most=MAX_NAME)
    if is_letter(name[0], first=True) and all(map(is_letter, name)):
        return name
    wrong = next((c for i, c in enumerate(name) if not is_letter(c, first=not i)), name[0])
    shown = wrong if wrong.isprintable() and wrong != " " else unicodedata.name(wrong, f"U+{ord(wrong):04X}").lower()
    code = "schema.name.begins" if is_letter(wrong) else "schema.name.contains"
    raise refuse(code, value=name, name=name, char=shown, near=_repaired(name))


def _repaired(name: str) -> str:
    """Return a name with the characters that it cannot contain replaced by underscores."""
    kept = "".join(c if is_letter(c) else "_" for c in unicodedata.normalize("NFKC", name).strip())
    kept = "_".join(part for part in kept.split("_") if part)[: MAX_NAME - 2]
    return kept if kept and is_letter(kept[0], first=True) else f"x_{kept}".rstrip("_")


def not_reserved(name: str, functions: Collection[str]) -> str:
    """Return a name; refuse keywords, the functions of the expression language, π and the time t."""
    instead = _INSTEAD.get(name, f"{name}_1")
    if keyword.iskeyword(name):
        raise refuse("schema.name.keyword", value=name, name=name, instead=instead)
    if name in CONSTANTS:
        raise refuse("schema.name.constant", value=name, name=name, instead=instead)
    if name == "t":
        raise refuse("schema.name.time", value=name, instead=instead)
    if name in functions:
        raise refuse("schema.name.function", value=name, name=name, instead=instead)
    return name
