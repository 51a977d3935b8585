"""The observers in the report: gains, what they report about themselves, every assumption of their theorems in numbers."""

from collections import Counter

import numpy as np

from thetascope.engine.model.result import CANNOT_TELL, FAILS, HOLDS
from thetascope.figures.figure_data import Scene
from thetascope.figures.html_symbols import escape, symbol
from thetascope.report.prose import chip, number, table

_COUNTED = ((HOLDS, "holds", "hold"), (FAILS, "fails", "fail"), (CANNOT_TELL, "cannot be told", "cannot be told"))
_CLASSES = {HOLDS: "holds", FAILS: "fails"}


def observers(scene: Scene) -> str:
    """Each observer: kind, gains, what it reports, how its theorem's assumptions fare here."""
    configured = scene.spec.observer_configs()
    return "".join(_observer(scene, report, configured[report.label]) for report in scene.result.observers)


def _observer(scene: Scene, report, config) -> str:
    gains = [f"{symbol(name)} = {_value(value)}" for name, value in config.gains.items()]
    gains += [f"{escape(name)}: {escape(value)}" for name, value in config.options.items()]
    facts = [f"{escape(str(name).replace('_', ' '))}: {_value(value)}" for name, value in report.facts.items()]
    out = f"<h3>{chip(scene, report.label)} <span class=soft>{escape(report.title or report.kind)}</span></h3>"
    out += f"<p><span class=soft>Assumptions:</span> {counts(report.checks)}</p>"
    out += f"<p><span class=soft>Gains:</span> {', '.join(gains) or 'the defaults'}</p>"
    if report.diverged:
        out += f"<p class=alarm>Diverged at {number(report.diverged.time)} s: {escape(report.diverged.cause)}</p>"
    if facts:
        out += f"<details><summary class=soft>What it computed from them</summary><p>{'<br>'.join(facts)}</p></details>"
    return out + checks(report.checks)


def counts(found) -> str:
    """How many assumptions hold, fail and cannot be told: "5 hold, 1 fails"."""
    number_of = Counter(check.verdict for check in found)
    parts = [
        f"{number_of[verdict]} {one if number_of[verdict] == 1 else many}"
        for verdict, one, many in _COUNTED
        if number_of[verdict]
    ]
    return ", ".join(parts) or "its theorem has none that could be checked"


def checks(found) -> str:
    """A line an assumption: name, verdict, sentence, the number found, the number it is held against, the source."""
    rows = [
        [
            f"<b>{escape(c.name.replace('-', ' '))}</b>",
            f"<span class='verdict {_CLASSES.get(c.verdict, 'unknown')}'>{escape(c.verdict)}</span>",
            escape(c.text),
            f"<span class=soft>{escape(c.source)}</span>",
            number(c.value),
            number(c.threshold),
        ]
        for c in found
    ]
    return table(["assumption", "here", "what was checked", "source", "found", "against"], rows, 2) if rows else ""


def _value(value: object) -> str:
    """A gain or fact: a number, a list or matrix of numbers, or a text."""
    if isinstance(value, bool | str) or value is None:
        return escape(value)
    if isinstance(value, int | float | np.number):
        return number(float(value), 6)
    if isinstance(value, np.ndarray | list | tuple) and all(isinstance(v, int | float | np.number) for v in value):
        return "(" + ", ".join(number(float(v), 5) for v in value) + ")"
    return escape(value if not isinstance(value, np.ndarray) else value.tolist())
