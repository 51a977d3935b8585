"""The observers side by side in the report. The best of several values is bold (see `best`); of equal ones none is."""

from collections import Counter
from collections.abc import Mapping, Sequence

from markupsafe import Markup

from thetascope.diagnosis.evaluation.observer_comparison import COVERED, FOUND, MISSED, Comparison, Row, best
from thetascope.report.words import ReportContext, bracketed, hat, mark, number, symbol

_OUTCOMES = {FOUND: "found", COVERED: "covered", MISSED: "missed"}
_FEW = 8  # windows: with more of them, peaks would make the table too wide to read
Cell = Markup | str
Part = dict[str, Cell]
"""A table and the legend below it."""


def comparison(report: ReportContext, compared: Comparison, summary: Mapping[str, dict]) -> Markup:
    """Return all tables: at a glance, each fault, errors by window, estimates at the end, settling."""
    parts = [
        _glance(report, compared),
        _faults(report, compared.rows),
        _windows(report, compared),
        _final(report, summary),
        _settling(report, compared.rows, summary),
    ]
    return report.render("comparison.html", parts=[part for part in parts if part["table"]])


def marked(values: Sequence[float | None], texts: Sequence[Cell]) -> list[Cell]:
    """Return the texts, with the best value in bold."""
    winners = best(values)
    return [mark("best", text) if place in winners else text for place, text in enumerate(texts)]


def _glance(report: ReportContext, compared: Comparison) -> Part:
    rows = compared.rows
    columns = _judged(report, rows) if any(row.verdicts is not None for row in rows) else []
    wins, cells = _wins(rows)
    if len(rows) > 1:
        texts = [report.say("report.of", n=wins[row.label], all=cells) if row.rmse else "–" for row in rows]
        columns.append(("smallest-error", [-wins[row.label] if row.rmse else None for row in rows], texts))
    costs = [None if row.cost is None else 1e6 * row.cost for row in rows]
    columns.append(("cost", costs, [number(c, 3) for c in costs]))
    texts_of = [marked(values, texts) for _, values, texts in columns]
    lines = [[report.chip(row.label), *line] for row, line in zip(rows, zip(*texts_of, strict=True), strict=True)]
    head = [report.say(f"report.head.{name}") for name in ("observer", *(name for name, _, _ in columns))]
    return {"table": report.table(head, lines, len(columns)), "legend": _legend(report, rows)}


def _judged(report: ReportContext, rows: Sequence[Row]) -> list[tuple[str, Sequence[float | None], Sequence[Cell]]]:
    """Return the columns about faults and alarms: name of the head, values to be compared, texts."""
    known = [row.count(FOUND) for row in rows]
    texts: list[Cell] = [
        "–"
        if row.verdicts is None
        else report.say("report.of", n=row.count(FOUND) or 0, all=len(row.verdicts) - (row.count(COVERED) or 0))
        for row in rows
    ]
    columns: list[tuple[str, Sequence[float | None], Sequence[Cell]]] = [
        ("found-count", [None if n is None else -n for n in known], texts)
    ]
    if any(row.count(COVERED) for row in rows):
        columns.append(("covered", [None] * len(rows), [_count(row.count(COVERED)) for row in rows]))
    for name, counts in (
        ("missed-count", [row.count(MISSED) for row in rows]),
        ("false-alarms", [row.false_alarms for row in rows]),
        ("wrong-alarms", [row.isolation_errors for row in rows]),
    ):
        columns.append((name, counts, [_count(n) for n in counts]))
    delays = [row.delay for row in rows]
    return [*columns, ("delay", delays, [_seconds(d) for d in delays])]


def _legend(report: ReportContext, rows: Sequence[Row]) -> Markup:
    judged = [row for row in rows if row.verdicts is not None]
    grace = list(dict.fromkeys(number(row.grace, 3) for row in judged))
    sentences = [report.say("report.legend.cost")]
    if len(rows) > 1:
        sentences.insert(0, report.say("report.legend.smallest-error"))
    if judged:
        sentences.insert(0, report.say("report.legend.grace", grace=report.joined(grace)))
    if len(rows) > 1:
        sentences.insert(0, report.say("report.legend.best"))
    return Markup(" ").join(sentences)


def _wins(rows: Sequence[Row]) -> tuple[Counter[str], int]:
    """Return how often each observer, alone or with others, has the smallest RMSE, and the number of comparisons."""
    wins: Counter[str] = Counter()
    cells = 0
    for name in _quantities(rows):
        for values in zip(*(row.rmse.get(name) or _none(rows) for row in rows), strict=True):
            cells += sum(v is not None for v in values) > 1
            wins.update(rows[place].label for place in best(values))
    return wins, cells


def _quantities(rows: Sequence[Row]) -> list[str]:
    return list(dict.fromkeys(name for row in rows for name in row.rmse))


def _none(rows: Sequence[Row]) -> tuple[None, ...]:
    return (None,) * next((len(v) for row in rows for v in row.rmse.values()), 0)


def _count(value: int | None) -> str:
    return "–" if value is None else str(value)


def _seconds(value: float | None) -> str:
    return "–" if value is None else f"{value:.3f}"


def _faults(report: ReportContext, rows: Sequence[Row]) -> Part:
    """Return a line for each fault: after how many seconds each observer's alarm named it."""
    rows = [row for row in rows if row.verdicts]
    lines = []
    for verdicts in zip(*(row.verdicts or () for row in rows), strict=True):
        fault = verdicts[0]
        texts = []
        for v in verdicts:
            text = _seconds(v.delay) if v.outcome == FOUND else report.say(f"report.outcome.{_OUTCOMES[v.outcome]}")
            other = mark("soft", report.say("report.or-another")) if v.alternative else ""
            texts.append(Markup("{} {}").format(text, other) if other else text)
        lines.append([symbol(fault.name), number(fault.onset, 6), *marked([v.delay for v in verdicts], texts)])
    head = [report.say("report.head.fault-in"), report.say("report.head.began"), *(report.chip(r.label) for r in rows)]
    return {"table": report.table(head, lines, len(rows) + 1), "legend": report.say("report.legend.faults")}


def _windows(report: ReportContext, compared: Comparison) -> Part:
    """Return RMSE and, in a few windows, peak of every quantity."""
    rows, spans, lines = compared.rows, compared.windows, []
    peaks = len(spans) <= _FEW
    for name in _quantities(rows):
        mine = [row for row in rows if name in row.rmse]
        columns = []
        for place in range(len(spans)):
            rmse, tops = [row.rmse[name][place] for row in mine], [row.peak[name][place] for row in mine]
            texts = marked(rmse, [number(v, 3) for v in rmse])
            under = marked(tops, [number(v, 3) for v in tops])
            columns.append([mark("below", *pair) for pair in zip(texts, under, strict=True)] if peaks else texts)
        kind, _, bare = name.partition(".")
        title = symbol(bare) + bracketed(report.run.unit(kind, bare))
        lines += [
            [title, report.chip(row.label), *cells] for row, cells in zip(mine, zip(*columns, strict=True), strict=True)
        ]
    spans_said = [report.say("report.span", low=number(w.start, 6), high=number(w.end, 6)) for w in spans]
    head = [report.say("report.head.error-of"), report.say("report.head.observer"), *spans_said]
    legend = report.say("report.legend.windows-peaks" if peaks else "report.legend.windows")
    return {"table": report.table(head, lines, len(spans)), "legend": legend}


def _final(report: ReportContext, summary: Mapping[str, dict]) -> Part:
    """Return the estimates at the end."""
    lines = [
        [
            report.chip(label),
            hat(name) + bracketed(report.run.unit("theta", name)),
            *(number(v[key]) for key in ("truth", "estimate", "error", "mean_error", "std")),
        ]
        for label, entry in summary.items()
        for name, v in entry["theta"].items()
    ]
    names = ("observer", "at-end", "true", "estimate", "error", "mean-error", "scatter")
    head = [report.say(f"report.head.{name}") for name in names]
    return {"table": report.table(head, lines, 5), "legend": report.say("report.legend.final")}


def _settling(report: ReportContext, rows: Sequence[Row], summary: Mapping[str, dict]) -> Part:
    """Return a line for each step and observer: when its estimate came within 10 %, stayed within 10 % and 5 %."""
    keys = list(dict.fromkeys((step.channel, step.at) for row in rows for step in row.steps))
    lines = []
    for key in keys:
        mine = [(row, step) for row in rows for step in row.steps if (step.channel, step.at) == key]
        stays = [
            marked(values, [report.say("report.does-not") if v is None else _seconds(v) for v in values])
            for values in ([step.ten for _, step in mine], [step.five for _, step in mine])
        ]
        for place, (row, step) in enumerate(mine):
            reached = next(s["reached"] for s in summary[row.label]["settling"] if (s["channel"], s["at"]) == key)
            lines.append(
                [
                    symbol(step.channel),
                    report.chip(row.label),
                    number(step.at, 6),
                    number(step.size),
                    report.say("report.never") if reached is None else _seconds(reached),
                    *(column[place] for column in stays),
                ]
            )
    names = ("step-of", "observer", "at", "step-size", "within-ten", "stays-ten", "stays-five")
    return {"table": report.table([report.say(f"report.head.{name}") for name in names], lines, 5), "legend": ""}
