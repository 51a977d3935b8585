"""Names as identifiers: letters of any script, digits and underscores, in Unicode's normal form NFKC.

θ and ω are names like x1. A subscript digit counts as a digit, so x₁ and x1 are one name; a superscript digit is a
power and belongs to no name. Unicode's middle dot, a letter of Catalan, is a sign of multiplication here.
"""

import unicodedata
from collections.abc import Iterable

_INVISIBLE = frozenset((0x034F, 0x115F, 0x1160, 0x3164, 0xFFA0, *range(0xFE00, 0xFE10), *range(0xE0100, 0xE01F0)))
_SUBSCRIPTS = frozenset("₀₁₂₃₄₅₆₇₈₉")
_CATEGORIES = frozenset(("Lu", "Ll", "Lt", "Lm", "Lo", "Mn", "Mc", "Nd", "Pc"))
_CYRILLIC = "\u0410\u0412\u0421\u0415\u041d\u0406\u0408\u041a\u041c\u041e\u0420\u0405\u0422\u0425\u0423"
_CYRILLIC += "\u0430\u0441\u0435\u0456\u0458\u043e\u0440\u0455\u0445\u0443"
_GREEK = "\u0391\u0392\u0395\u0396\u0397\u0399\u039a\u039c\u039d\u039f\u03a1\u03a4\u03a5\u03a7\u03bf\u03bd"
_TWINS = ((_CYRILLIC, "ABCEHIJKMOPSTXYaceijopsxy"), (_GREEK, "ABEZHIKMNOPTYXov"))
_LATIN = {ord(twin): latin for twins, latins in _TWINS for twin, latin in zip(twins, latins, strict=True)}


def normalised(text: str) -> str:
    """Return a text in the normal form NFKC: ϑ becomes θ, x₁ becomes x1."""
    return text if text.isascii() else unicodedata.normalize("NFKC", text)


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


def end_of_name(text: str, start: int) -> int:
    """Return the position after the name that begins at `start`; `start` itself if none does."""
    end = start
    while end < len(text) and is_letter(text[end], first=end == start):
        end += 1
    return end


def twin(name: str, known: Iterable[str]) -> tuple[str, str] | None:
    """Return the letter that makes a name differ from the name that it looks like, and that name.

    It looks like a known name, or like one in Latin letters if it has Cyrillic ones; None if it does not.
    """
    plain = name.translate(_LATIN)
    alike = [other for other in known if other != name and other.translate(_LATIN) == plain]
    if not alike and plain.isascii() and any(letter in _CYRILLIC for letter in name):
        alike = [plain]
    return next(((a, alike[0]) for a, b in zip(name, alike[0], strict=True) if a != b), None) if alike else None
