"""The observers in the report: gains, reported facts, and every assumption of their theorems in numbers."""

from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np
from markupsafe import Markup

from thetascope.engine.model.result import CANNOT_TELL, FAILS, HOLDS, Check, ObserverReport
from thetascope.messages import Message
from thetascope.messages.catalogue import catalogue
from thetascope.report.words import ReportContext, mark, number, symbol
from thetascope_schemas.experiment.observers import ObserverConfig

_CODES = {HOLDS: "holds", FAILS: "fails", CANNOT_TELL: "cannot-tell"}
_CLASSES = {HOLDS: "holds", FAILS: "fails"}
_HEAD = ("assumption", "here", "checked", "source", "found", "against")


def observers(report: ReportContext) -> Markup:
    """Return each observer: kind, gains, facts, the verdicts on its theorem's assumptions."""
    configured = report.run.spec.observer_configs()
    found = [_observer(report, one, configured[one.label]) for one in report.run.result.observers]
    return report.render("observers.html", observers=found)


def _observer(report: ReportContext, one: ObserverReport, config: ObserverConfig) -> dict[str, object]:
    gains = [Markup("{} = {}").format(symbol(name), _value(value)) for name, value in config.gains.items()]
    gains += [Markup("{}: {}").format(name, str(value)) for name, value in config.options.items()]
    facts = [Markup("{}: {}").format(_fact_name(report, name), _fact(report, v)) for name, v in one.facts.items()]
    return {
        "chip": report.chip(one.label),
        "title": report.text(one.title) or one.kind,
        "counts": counts(report, one.checks),
        "gains": report.joined(gains) if gains else report.say("report.gains.default"),
        "diverged": one.diverged
        and report.say("report.diverged.observer", t=number(one.diverged.time), cause=report.text(one.diverged.cause)),
        "facts": facts,
        "checks": checks(report, one.checks),
    }


def counts(report: ReportContext, found: Sequence[Check]) -> Markup:
    """Return how many assumptions hold, fail and cannot be decided: "5 hold, 1 fails"."""
    number_of = Counter(check.verdict for check in found)
    parts = [
        report.say(f"report.verdict.{code}.count", n=number_of[verdict])
        for verdict, code in _CODES.items()
        if number_of[verdict]
    ]
    return report.joined(parts) if parts else report.say("report.verdict.none")


def checks(report: ReportContext, found: Sequence[Check]) -> Markup:
    """Return a line for each assumption: name, verdict, sentence, source, the number found and its limit."""
    rows = [
        [
            mark("bold", report.text(c.name)),
            mark("verdict", _CLASSES.get(c.verdict, "unknown"), report.say(f"report.verdict.{_CODES[c.verdict]}")),
            report.text(c.text),
            mark("soft", report.text(c.source)),
            number(c.value),
            number(c.threshold),
        ]
        for c in found
    ]
    return report.table([report.say(f"report.head.{name}") for name in _HEAD], rows, 2)


def _fact_name(report: ReportContext, name: str) -> Markup | str:
    """Return the name of a fact in the report's language; one without words as it is."""
    code = name.lower().replace(" ", "-")
    known = f"fact.{code}" in catalogue(report.language).templates
    return report.say(f"fact.{code}") if known else name.replace("_", " ")


def _fact(report: ReportContext, value: object) -> Markup | str:
    """Return a fact; one that is a message, {code, args}, in the report's language."""
    if isinstance(value, Mapping) and "code" in value:
        return report.text(Message.from_data(value))
    if isinstance(value, bool):
        return report.say("report.yes" if value else "report.no")
    return "–" if value is None else _value(value)


def _value(value: object) -> Markup | str:
    """Return a gain or fact: a number, a list of numbers, or a text."""
    if isinstance(value, bool | str) or value is None:
        return str(value)
    if isinstance(value, int | float | np.number):
        return number(float(value), 6)
    if isinstance(value, np.ndarray | list | tuple) and all(isinstance(v, int | float | np.number) for v in value):
        return Markup("({})").format(Markup(", ").join(number(float(v), 5) for v in value))
    return str(value if not isinstance(value, np.ndarray) else value.tolist())
