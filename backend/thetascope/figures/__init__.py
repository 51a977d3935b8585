"""Figures of a run as Plotly's JSON. plotly.py is never imported; the report is in the package report.

figure_names(spec, result.names)                    what there is to see
figure(result, spec, plant, "faults", "dark")       one figure: {"data": [...], "layout": {...}}
"""

from collections.abc import Sequence

from thetascope.figures import general_figures, paper_figures
from thetascope.figures.figure_data import Scene

__all__ = ["UnknownFigure", "figure", "figure_names"]


class UnknownFigure(KeyError):
    """No figure of that name in this run; `names` are those there are."""

    def __init__(self, name: str, names: Sequence[str]):
        super().__init__(name)
        self.name, self.names = name, list(names)

    def __str__(self) -> str:
        return f"there is no figure {self.name!r} in this run; there are: {', '.join(self.names)}"


def figure_names(spec, columns: Sequence[str]) -> list[dict[str, str]]:
    """[{"name", "title"}]: first the experiment's own figures, then the general ones that these columns can fill.

    An experiment's figure that bears a general one's name stands in its place.
    """
    own = {entry.name: entry.title or entry.name for entry in spec.figures if paper_figures.drawable(entry, columns)}
    others = {name: title for name, title in general_figures.available(spec, columns) if name not in own}
    return [{"name": name, "title": title} for name, title in (own | others).items()]


def figure(result, spec, plant, name: str, theme: str = "light") -> dict:
    """One figure as plain, JSON-ready dictionaries; arrays as {"dtype", "bdata"}, at most some 4000 points a trace.

    result: the run's `Result`; spec: its Experiment; plant: the Plant it ran on; theme: "light" or "dark".
    Raises UnknownFigure, and ValueError for another theme.
    """
    scene = Scene(result, spec, plant, theme)
    try:
        for own in spec.figures:
            if own.name == name:
                return paper_figures.build(scene, own)
        return general_figures.build(scene, name)
    except KeyError as problem:
        raise UnknownFigure(name, [entry["name"] for entry in figure_names(spec, result.names)]) from problem
