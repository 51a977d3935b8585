"""Nicknames: an animal for each student, and names that students choose, made harmless."""

import unicodedata
from functools import cache
from pathlib import Path
from random import SystemRandom

import yaml

from thetascope_schemas.service.classroom.requests import MOST_NAME, Caption

_FILE = Path(__file__).parent / "animals.yaml"
_RANDOM = SystemRandom()


@cache
def animals() -> tuple[Caption, ...]:
    """Return all animals."""
    return tuple(Caption(**one) for one in yaml.safe_load(_FILE.read_text(encoding="utf-8")))


def free_animal(taken: list[Caption]) -> Caption:
    """Return an animal that few others have; a second one of a kind is numbered."""
    counts = {animal.en: 0 for animal in animals()}
    for one in taken:
        kind = one.en.rpartition(" ")[0] if one.en[-1:].isdigit() else one.en
        counts[kind] = counts.get(kind, 0) + 1
    least = min(counts.values())
    chosen = _RANDOM.choice([animal for animal in animals() if counts[animal.en] == least])
    if least == 0:
        return chosen
    names = {one.en for one in taken}
    number = next(n for n in range(2, len(taken) + 3) if f"{chosen.en} {n}" not in names)
    return Caption(en=f"{chosen.en} {number}", zh=f"{chosen.zh} {number}")


def harmless(name: str) -> str | None:
    """Return a name as one short line without control, invisible or direction-changing characters; None if it is empty.

    Marks that stack on one letter are limited to two, so that a name cannot cover its neighbours.
    """
    text, marks = "", 0
    for character in unicodedata.normalize("NFC", name):
        kind = unicodedata.category(character)
        if kind in ("Zs", "Zl", "Zp"):
            character, kind = " ", "Zs"
        if kind[0] == "C":
            continue
        marks = marks + 1 if kind[0] == "M" else 0
        if marks <= 2:
            text += character
    return " ".join(text.split())[:MOST_NAME].strip() or None
