"""The style of every figure: colours, type and the shared parts of a Plotly layout.

Colour means observer everywhere, by the observer's position in the spec. The palette is that of Okabe and Ito, adjusted
for dark. Its orange is reserved for faults and its darkened vermilion for limits, so no observer after the second uses
either. True values are drawn in ink, dashed.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import floor, isfinite, log10

UI = "ui-sans-serif, system-ui, 'Segoe UI', Roboto, 'Noto Sans', 'Noto Sans SC', 'DejaVu Sans', sans-serif"
MATH = "'STIX Two Text', 'Cambria Math', Cambria, 'Times New Roman', 'Liberation Serif', serif"
NUMBERS = "ui-monospace, 'SF Mono', 'Cascadia Mono', 'DejaVu Sans Mono', monospace"


@dataclass(frozen=True)
class Theme:
    """Colours of one theme, as the page's style sheet has them."""

    card: str
    ink: str
    soft: str
    line: str
    grid: str
    fault: str
    fault_line: str
    alarm: str
    observers: tuple[str, ...]


THEMES = {
    "light": Theme(
        "#ffffff",
        "#1b1f24",
        "#626b76",
        "#e3e0d8",
        "#eeece6",
        "rgba(230,159,0,0.15)",
        "#b87900",
        "#c2410c",
        ("#0072b2", "#d55e00", "#009e73", "#b0508f", "#3aa0dc", "#8a7a00", "#5f6b76"),
    ),
    "dark": Theme(
        "#151a20",
        "#e9e7e2",
        "#96a0ab",
        "#262d35",
        "#1d232a",
        "rgba(230,159,0,0.13)",
        "#e0a63a",
        "#fb7a3c",
        ("#56b4e9", "#f08a4b", "#2fc08f", "#d98cbf", "#3f8fd0", "#e3d648", "#a9b3bd"),
    ),
}
DASHES = {"solid": "solid", "dash": "5px,3px", "dot": "1.5px,3px"}


def theme_named(name: str) -> Theme:
    """Return the theme of that name. Raises ValueError that lists the themes for any other name."""
    if name not in THEMES:
        raise ValueError(f"theme is {name!r}; use one of: {', '.join(THEMES)}")
    return THEMES[name]


def observer_colour(theme: Theme, place: int) -> str:
    """Return the colour of the observer at `place` (0, 1, …) in the spec; after the seventh the colours repeat."""
    return theme.observers[place % len(theme.observers)]


def mix(colour: str, other: str, share: float) -> str:
    """Return `colour` mixed with a share (0…1) of `other` (both #rrggbb), for another quantity of an observer."""
    a, b = (tuple(int(c[i : i + 2], 16) for i in (1, 3, 5)) for c in (colour, other))
    return "#" + "".join(f"{round(x + (y - x) * share):02x}" for x, y in zip(a, b, strict=True))


def base_layout(theme: Theme, height: int, margin: dict) -> dict:
    """Return the parts that all figures' layouts have in common."""
    return {
        "height": height,
        "margin": margin,
        "autosize": True,
        "paper_bgcolor": theme.card,
        "plot_bgcolor": theme.card,
        "font": {"family": UI, "size": 12, "color": theme.soft},
        "hovermode": "closest",
        "hoverdistance": 40,
        "dragmode": "zoom",
        "hoverlabel": {
            "bgcolor": theme.card,
            "bordercolor": theme.line,
            "font": {"family": UI, "size": 12, "color": theme.ink},
        },
        "legend": {
            "orientation": "h",
            "x": 0,
            "xanchor": "left",
            "y": 1,
            "yanchor": "top",
            "yref": "container",
            "bgcolor": "rgba(0,0,0,0)",
            "font": {"size": 12, "color": theme.ink},
            "itemwidth": 30,
            "tracegroupgap": 0,
        },
        "modebar": {"bgcolor": "rgba(0,0,0,0)", "color": theme.soft, "activecolor": theme.ink},
    }


def axis(theme: Theme, **more) -> dict:
    """Return one axis: a hairline frame, subdued numbers, powers of ten written as such."""
    return {
        "showline": True,
        "linecolor": theme.line,
        "linewidth": 1,
        "mirror": True,
        "zeroline": False,
        "ticks": "",
        "gridcolor": theme.grid,
        "gridwidth": 1,
        "exponentformat": "power",
        "minexponent": 4,
        "tickfont": {"family": NUMBERS, "size": 10, "color": theme.soft},
        **more,
    }


def decimals(values: Sequence[float]) -> str:
    """Return one format for the numbers beside a strip, so that their points align: four digits of the largest."""
    size = max((abs(v) for v in values if isfinite(v)), default=0.0)
    if size == 0:
        return ".4f"
    places = 3 - floor(log10(size))
    return f".{max(places, 0)}f" if -2 < places < 8 else ".2e"


def aligned(value: float, form: str) -> str:
    """Return a number in a format of `decimals`, with a true minus sign; a dash for None or NaN."""
    return format(value, form).replace("-", "−") if isfinite(value) else "—"
