"""Line styles that differ without colour: by their dashes, their grey and their width."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import cycle


@dataclass(frozen=True)
class Look:
    """How a curve is drawn. dashes: lengths of dashes and gaps in pt, () for a solid line; width in pt."""

    name: str
    dashes: tuple[float, ...]
    width: float
    colour: str


LOOKS = {
    look.name: look
    for look in (
        Look("line", (), 0.8, "#000000"),
        Look("dashes", (3.6, 1.8), 0.9, "#000000"),
        Look("dash-dot", (5.4, 1.6, 0.9, 1.6), 0.9, "#000000"),
        Look("dots", (0.9, 1.5), 1.0, "#000000"),
        Look("thin-grey", (), 0.5, "#8c8c8c"),
        Look("long-dashes", (8.0, 2.0), 0.9, "#000000"),
        Look("dash-dot-dot", (5.4, 1.4, 0.9, 1.4, 0.9, 1.4), 0.9, "#000000"),
        Look("thick-grey", (), 1.4, "#b0b0b0"),
        Look("grey-dashes", (3.6, 1.8), 0.9, "#8c8c8c"),
        Look("grey-dash-dot", (5.4, 1.6, 0.9, 1.6), 0.9, "#8c8c8c"),
    )
}
"""All line styles. Measured values are grey, true values dashed, as in the figures on the screen."""
RESERVED = {"true": "dashes", "measured": "thick-grey"}
_ORDER = ("line", "thin-grey", "dash-dot", "dots", "long-dashes", "dash-dot-dot", "grey-dashes", "grey-dash-dot")
_FAINTEST = 0.25
"""Difference of lightness (0…1) and of widths (relative) below which two solid lines are hard to tell apart."""


def assign(curves: Mapping[str, str], chosen: Mapping[str, str]) -> dict[str, str]:
    """Return the name of a line style for every curve.

    Args:
        curves: key of the curve → its dash on the screen (solid, dash, dot).
        chosen: key → name of a style that the user chose.
    """
    names = dict(chosen)
    free = [name for name in _ORDER if name not in chosen.values()]
    for key, dash in curves.items():
        wish = RESERVED.get(key) or {"dash": "dashes", "dot": "dots"}.get(dash)
        if key not in names and wish and wish not in names.values():
            names[key] = wish
            free = [name for name in free if name != wish]
    rest = cycle(free or _ORDER)
    return {key: names.get(key) or next(rest) for key in curves}


def coloured(look: Look, mode: str, colour: str) -> Look:
    """Return a style in a mode: "colour" takes the curve's own, "black" none; "grey" keeps the style's."""
    return look if mode == "grey" else replace(look, colour=colour if mode == "colour" else "#000000")


def apart(looks: Iterable[Look]) -> bool:
    """Return whether all styles differ when colours are lost: by dashes, by lightness, or clearly by width."""
    drawn = list(looks)
    return not any(_alike(a, b) for place, a in enumerate(drawn) for b in drawn[:place])


def _alike(a: Look, b: Look) -> bool:
    thin, thick = sorted((a.width, b.width))
    same_width = thick - thin < _FAINTEST * thick
    return a.dashes == b.dashes and same_width and abs(lightness(a.colour) - lightness(b.colour)) < _FAINTEST


def lightness(colour: str) -> float:
    """Return the perceived lightness (0…1) of #rrggbb: CIE L* of its relative luminance."""
    parts = [int(colour[place : place + 2], 16) / 255 for place in (1, 3, 5)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    luminance = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    return 9.033 * luminance if luminance <= 0.008856 else 1.16 * luminance ** (1 / 3) - 0.16
