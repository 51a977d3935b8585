"""Figures of a run as Plotly's JSON. plotly.py is never imported; the report is in the package report.

figure_names(spec, result.names)                    the available figures
figure(result, spec, plant, "faults", "dark")       one figure: {"data": [...], "layout": {...}}
drawing(result, spec, plant, "faults")              the same before it is drawn, for `figures.printed`
"""

from collections.abc import Sequence
from dataclasses import replace

from thetascope.figures import general_figures, paper_figures
from thetascope.figures.figure_data import FigureData
from thetascope.figures.strips import Drawing, stack
from thetascope.figures.style import theme_named
from thetascope.messages import Message, text_of

__all__ = ["UnknownFigure", "drawing", "figure", "figure_names"]


class UnknownFigure(KeyError):
    """Raised for a figure that this run does not have; `names` are the existing ones."""

    def __init__(self, name: str, names: Sequence[str]):
        super().__init__(name)
        self.name, self.names = name, list(names)

    def __str__(self) -> str:
        return f"there is no figure {self.name!r} in this run; there are: {', '.join(self.names)}"


def figure_names(spec, columns: Sequence[str], language: str = "en") -> list[dict[str, str]]:
    """Return [{"name", "title"}]: the experiment's own figures, then the general ones that these columns can fill.

    An experiment's figure with a general one's name replaces it. Titles are in the language.
    """
    drawable = [entry for entry in spec.figures if paper_figures.drawable(entry, columns)]
    own = {entry.name: text_of(entry.title, language) or entry.name for entry in drawable}
    general = [name for name in general_figures.available(spec, columns) if name not in own]
    titles = own | {name: Message(f"figure.{name}").text(language) for name in general}
    return [{"name": name, "title": title} for name, title in titles.items()]


def figure(result, spec, plant, name: str, theme: str = "light", language: str = "en") -> dict:
    """Return one figure as plain, JSON-ready dictionaries; arrays as {"dtype", "bdata"}, about 4000 points per trace.

    result: the run's `Result`; spec: its Experiment; plant: the Plant it ran on; theme: "light" or "dark"; language: of
    titles, captions and legends. Raises UnknownFigure, and ValueError for another theme.
    """
    return stack(drawing(result, spec, plant, name, theme, language), theme_named(theme))


def drawing(result, spec, plant, name: str, theme: str = "light", language: str = "en") -> Drawing:
    """Return one figure before it is drawn, with all rows of the run. Raises as `figure` does."""
    run = FigureData(result, spec, plant, theme, language)
    flags = [(note.t, note.text) for note in spec.notes]
    try:
        for own in spec.figures:
            if own.name == name:
                return replace(paper_figures.build(run, own), flags=flags)
        return replace(general_figures.build(run, name), flags=flags)
    except KeyError as problem:
        raise UnknownFigure(name, [entry["name"] for entry in figure_names(spec, result.names)]) from problem
