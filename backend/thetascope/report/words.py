"""The sentences of the report in one language, and its templates.

Templates escape everything that is not markup already. Markup comes from the templates themselves, from `marks`, and
from symbols and expressions (`figures.html_symbols`), which escape the names in them.
"""

from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from thetascope.figures import html_symbols
from thetascope.figures.figure_data import FigureData
from thetascope.messages import Message, text_of

TEMPLATES = Path(__file__).parent / "templates"


@cache
def environment() -> Environment:
    """Return the environment of the report's templates: everything is escaped, an unknown variable is an error."""
    loader = FileSystemLoader(TEMPLATES)
    return Environment(loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)


@cache
def _macros() -> Any:
    return environment().get_template("marks.html").module


class ReportContext:
    """What the sections of one report share: the run as figures show it, and the language.

    Args:
        run: result, spec, plant, theme and language.
    """

    def __init__(self, run: FigureData) -> None:
        self.run = run
        self.language = run.language

    def render(self, template: str, **context: Any) -> Markup:
        """Return a template filled with a context; `say` is in it."""
        html = environment().get_template(template).render(say=self.say, **context)
        return Markup(html)  # the template has escaped it

    def say(self, code: str, **args: Any) -> Markup:
        """Return the sentence of a code; arguments that are markup stay so, the rest is escaped."""
        marked: dict[str, Markup] = {}
        plain: dict[str, Any] = {}
        for name, value in args.items():
            if isinstance(value, Markup):
                key = f"\x00{len(marked)}\x00"
                marked[key], plain[name] = value, key
            else:
                plain[name] = value
        html = str(escape(Message(code, **plain).text(self.language)))
        for key, value in marked.items():
            html = html.replace(key, str(value))
        return Markup(html)  # escaped above, and the markup put in is markup

    def text(self, value: Any) -> str:
        """Return a message, prose or plain text in the report's language, not escaped yet."""
        return text_of(value, self.language)

    def joined(self, items: Iterable[Any]) -> Markup:
        """Return items with the language's comma between them, each escaped unless it is markup."""
        return Markup(self.say("join.comma")).join(items)

    def table(self, head: Iterable[Any], rows: Iterable[Iterable[Any]], numeric: int) -> Markup:
        """Return a table; the first cell of a row is its heading, the last `numeric` cells are numbers.
        Without rows: nothing."""
        head = list(head)
        return mark("table", head, [list(row) for row in rows], len(head) - numeric)

    def chip(self, label: str) -> Markup:
        """Return an observer's name with its colour; the detector has none."""
        known = label in self.run.labels
        name = label if known else self.say("report.detector-name") if label == "detector" else label
        return mark("chip", name, self.run.colour(label) if known else "")

    def span(self, low: float | None, high: float | None, digits: int = 4) -> Markup | str:
        """Return an interval in brackets; an empty text without an interval."""
        if low is None or high is None:
            return ""
        return mark("bracketed", self.say("report.interval", low=number(low, digits), high=number(high, digits)))


def mark(name: str, *args: Any) -> Markup:
    """Return one of the pieces of marks.html."""
    return getattr(_macros(), name)(*args)


def symbol(name: str) -> Markup:
    """Return the name of a quantity as a symbol."""
    return Markup(html_symbols.symbol(name))  # it escapes the name


def expression(text: str) -> Markup:
    """Return an expression of a plant as one line of markup."""
    return Markup(html_symbols.expression(text))  # it escapes its names and numbers


def hat(name: str) -> Markup:
    """Return θ̂: browsers place the hat by style sheet, better than fonts place the combining one."""
    return Markup(html_symbols.symbol(name).replace("<i>", "<i class=hat>", 1))


def number(value: float | None, digits: int = 4) -> Markup | str:
    """Return a number for a table; a dash for a missing one."""
    if value is None or not np.isfinite(value):
        return "–"
    if value == 0:
        return "0"
    text = f"{value:.{digits}g}".replace("-", "−")
    if "e" not in text:
        return text
    mantissa, _, power = text.partition("e")
    return mark("power", mantissa, power.removeprefix("+").replace("−0", "−").removeprefix("0"))


def unit(text: str) -> str:
    """Return a unit after its number."""
    return f"\u2009{text}" if text else ""


def bracketed(text: str) -> Markup | str:
    """Return a unit in the head of a column."""
    return mark("bracketed", text) if text else ""
