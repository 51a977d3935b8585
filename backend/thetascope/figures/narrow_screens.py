"""The layout of a figure on a narrow screen: labels beside a strip move above it."""

import re
from collections.abc import Iterable, Sequence

from thetascope.figures import style

GAP, LEFT, RIGHT, TOP, BOTTOM = 24, 46, 14, 30, 44
LEGEND_WIDTH, LEGEND_LINE = 310, 19
NUMBERS = 3
"""Number of last values that fit beside a strip's name."""


def narrow(layout: dict, strips: Sequence, theme: style.Theme, entries: Iterable[str]) -> dict:
    """Return the changes of `layout` below about 640 pixels of width, in the notation of Plotly.relayout.

    They are stored in layout.meta.narrow. entries: the texts of the legend, whose lines are estimated from their
    lengths.
    """
    axes = [f"yaxis{place if place > 1 else ''}" for place in range(1, len(strips) + 1)]
    old = layout["height"] - layout["margin"]["t"] - layout["margin"]["b"]
    shared = "xaxis2" not in layout
    heights = [old * (layout[axis]["domain"][1] - layout[axis]["domain"][0]) for axis in axes]
    gap = GAP if shared else GAP + BOTTOM
    total, top = sum(heights) + gap * (len(heights) - 1), TOP + LEGEND_LINE * _legend_lines(entries)
    patch: dict = {
        "height": round(total + top + BOTTOM),
        "margin": {"l": LEFT, "r": RIGHT, "t": top, "b": BOTTOM},
        "dragmode": False,
        "annotations": [],
    }  # touching the figure scrolls the page
    above = total
    for axis, strip, height in zip(axes, strips, heights, strict=True):
        patch[f"{axis}.domain"] = [(above - height) / total, above / total]
        patch["annotations"] += _line_above(strip, theme, above / total)
        above -= height + gap
    for axis in (name for name in layout if name.startswith("xaxis")):
        patch[f"{axis}.nticks"] = 6
    return patch


def _legend_lines(entries: Iterable[str]) -> int:
    lines, used = 0, LEGEND_WIDTH
    for entry in entries:
        width = 46 + 7 * len(re.sub(r"<[^>]*>|&\w+;", "", entry))
        if used + width > LEGEND_WIDTH:
            lines, used = lines + 1, 0
        used += width
    return lines


def _line_above(strip, theme: style.Theme, y: float) -> list[dict]:
    """Return annotations on one line above the strip: symbol and first words on the left, last values on the right."""
    place = {"xref": "paper", "yref": "paper", "y": y, "yanchor": "bottom", "yshift": 1, "showarrow": False}
    words = strip.caption.replace("<br>", " ") if len(strip.caption) < 40 else strip.caption.split("<br>")[0]
    text = f'<span style="font-family:serif;font-size:15px;color:{theme.ink}">{strip.symbol}</span>  {words}'
    name = place | {
        "name": "symbol",
        "text": text,
        "x": 0,
        "xanchor": "left",
        "xshift": -2,
        "borderpad": 0,
        "font": {"family": style.UI, "size": 11, "color": theme.soft},
    }
    finals = sorted((line for line in strip.lines if line.final), key=lambda line: not line.framing)
    if not 0 < len(finals) <= NUMBERS:
        return [name]
    form = style.decimals([line.y[-1] for line in finals])
    numbers = "  ".join(
        f'<span style="color:{line.colour}">{style.aligned(line.y[-1], form)}</span>' for line in finals
    )
    right = {
        "name": "final",
        "text": numbers,
        "x": 1,
        "xanchor": "right",
        "yshift": 2,
        "font": {"family": style.NUMBERS, "size": 10, "color": theme.ink},
    }
    return [name, place | right]
