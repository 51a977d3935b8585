"""The data for the figures of one run: its columns by meaning, with symbols, units, colours and intervals of faults."""

import re
from functools import cached_property
from typing import Any

import numpy as np

from thetascope.figures import style
from thetascope.figures.html_symbols import HAT, escape, symbol, wrap
from thetascope.figures.strips import Abscissa, Line
from thetascope.messages import Message, text_of

KINDS = {"x": "states", "theta": "channels", "y": "outputs", "u": "inputs", "signal": "signals", "r": "references"}


class FigureData:
    """A `Result`, its experiment and its plant, in one theme and language. Read-only."""

    def __init__(self, result, spec, plant, theme: str, language: str = "en"):
        self.language = language
        self.result, self.spec, self.plant = result, spec, plant
        self.theme = style.theme_named(theme)
        self.t = result.column("t")
        self.time = Abscissa(self.t, self.say("figure.time"))
        self.columns = set(result.names)
        self.labels = list(spec.observer_configs())
        self._rows = {name: row for row, name in enumerate(result.names)}

    def say(self, code: str, **args: Any) -> str:
        """Return the sentence of a code in the language of the figures; not escaped."""
        return Message(code, **args).text(self.language)

    def text(self, prose: str) -> str:
        """Return prose of the experiment or the plant in the language of the figures; not escaped."""
        return text_of(prose, self.language)

    def values(self, column: str) -> np.ndarray:
        """Return one column, shape (rows,). Raises KeyError with the name if the run does not have it."""
        return self.result.data[self._rows[column]]

    def split(self, column: str) -> tuple[str | None, str, str]:
        """Return (observer's label or None, kind, name): "adaptive.theta.theta1" → ("adaptive", "theta", "theta1").

        The kind is x, theta, y, u, signal, "t" for time, or "" for an observer's diagnostic.
        """
        for label in self.labels:
            if column.startswith(label + "."):
                rest = column[len(label) + 1 :]
                kind, _, name = rest.partition(".")
                return (label, kind, name) if name and kind in KINDS else (label, "", rest)
        kind, _, name = column.partition(".")
        return (None, kind, name) if name else (None, "t", column)

    def colour(self, label: str) -> str:
        """Return the colour of an observer's lines."""
        return style.observer_colour(self.theme, self.labels.index(label))

    def legend(self, label: str) -> str:
        """Return the observer's name for the legend, with the time of its divergence if it diverged."""
        lost = self._diverged.get(label)
        return escape(self.say("figure.diverged", label=label, t=lost.time) if lost else label)

    @cached_property
    def _diverged(self) -> dict:
        return {report.label: report.diverged for report in self.result.observers if report.diverged}

    @cached_property
    def _items(self) -> dict[tuple[str, str], object]:
        return {(kind, item.name): item for kind, field in KINDS.items() for item in getattr(self.plant, field)}

    def unit(self, kind: str, name: str) -> str:
        """Return the unit of a quantity of the plant, "" if it has none."""
        unit = getattr(self._items.get((kind, name)), "unit", None)
        return "" if unit in (None, "", "1", "-") else str(unit)

    def caption(self, kind: str, name: str, fallback: str = "") -> str:
        """Return a few words for below the symbol as HTML: the channel's title or the description, and the unit."""
        item = self._items.get((kind, name))
        words = self.text(getattr(item, "title", None) or getattr(item, "description", None) or fallback)
        unit = self.unit(kind, name)
        words = wrap(re.split(r"[;:(；：（，。]|[.,] ", words)[0], lines=2 if unit else 3)
        return "<br>".join(part for part in (words, escape(unit)) if part)

    def symbol(self, column: str) -> str:
        """Return a column's symbol as HTML: time, a quantity, or an estimate with a hat."""
        label, kind, name = self.split(column)
        return "<i>t</i>" if kind == "t" else symbol(name, HAT if label and kind else "")

    def intervals(self, kind: str, name: str) -> list[tuple[float, float]]:
        """Return when a fault acts on a channel (kind "theta") or a measurement (kind "y"), clipped to the run.

        The true faults of a record are not known: those that its diagnosis found are taken.
        """
        end = float(self.t[-1])
        if self.result.record is not None:
            mine = [(a, b) for channel, a, b in self._found if (kind, name) == ("theta", channel)]
            return [(a, min(end if b is None else b, end)) for a, b in mine]
        return [
            (fault.onset, min(end if fault.end is None else fault.end, end))
            for fault in self.spec.faults
            if (fault.site.prefix, fault.site.name) == (kind, name) and fault.onset < end
        ]

    @cached_property
    def _found(self) -> list[tuple[str, float, float | None]]:
        """Return channel, onset and end in s of the confirmed faults of a record."""
        faults = (self.result.record or {}).get("faults", ())
        return [(f["best"]["channel"], f["best"]["onset"]["value"], f["ended"]) for f in faults if f["confirmed"]]

    def changes(self) -> list[float]:
        """Return the times inside the run at which any fault begins or ends."""
        times = {at for _, *both in self._found for at in both if at is not None}
        times |= {at for fault in self.spec.faults for at in (fault.onset, fault.end) if at is not None}
        return sorted(at for at in times if 0 < at < self.t[-1])

    def truth(self, kind: str, name: str, final: bool = True) -> Line:
        """Return the line of a quantity's true value; `final`: narrow screens write its last value."""
        return Line(
            self.values(f"{kind}.{name}"),
            f"{symbol(name)} {self.say('figure.truth')}",
            self.theme.ink,
            self.say("figure.truth"),
            "dash",
            1.2,
            final,
            framing=True,
            layer=1,
            curve="true",
            source=f"{kind}.{name}",
        )

    def estimates(self, kind: str, name: str, final: bool = True) -> list[Line]:
        """Return the line of every observer that estimates the quantity, in the order of the spec."""
        return [
            Line(
                self.values(column),
                f"{symbol(name, HAT)} {escape(label)}",
                self.colour(label),
                self.legend(label),
                final=final,
                layer=-place,
                curve=label,
                source=column,
            )
            for place, label in enumerate(self.labels)
            if (column := f"{label}.{kind}.{name}") in self.columns
        ]
