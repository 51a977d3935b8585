"""The observers side by side in the report. The best of several values is bold (see `best`); of equal ones none is."""

from collections import Counter
from collections.abc import Mapping, Sequence

from thetascope.diagnosis.evaluation.observer_comparison import COVERED, FOUND, MISSED, Comparison, Row, best
from thetascope.figures.figure_data import Scene
from thetascope.figures.html_symbols import symbol
from thetascope.report.prose import bracketed, chip, hat, number, table

_OUTCOMES = {FOUND: "found", COVERED: "named before", MISSED: "missed"}
_FEW = 8  # windows: with more of them, peaks would make the table too wide to read


def comparison(scene: Scene, compared: Comparison, summary: Mapping[str, dict]) -> str:
    """All tables: at a glance, each fault, errors by window, estimates at the end, settling."""
    parts = [
        _glance(scene, compared),
        _faults(scene, compared.rows),
        _windows(scene, compared),
        _final(scene, summary),
        _settling(scene, compared.rows, summary),
    ]
    return "".join(parts)


def marked(values: Sequence[float | None], texts: Sequence[str]) -> list[str]:
    """The texts, with the best value in bold."""
    winners = best(values)
    return [f"<b class=best>{text}</b>" if place in winners else text for place, text in enumerate(texts)]


def _columns(
    rows: Sequence[Row], columns: Sequence[tuple[str, Sequence[float | None], Sequence[str]]], scene: Scene
) -> str:
    """A table with a line an observer, of columns (head, values to be compared, texts)."""
    cells = [marked(values, texts) for _, values, texts in columns]
    lines = [[chip(scene, row.label), *line] for row, line in zip(rows, zip(*cells, strict=True), strict=True)]
    return table(["observer", *(head for head, _, _ in columns)], lines, len(columns))


def _glance(scene: Scene, compared: Comparison) -> str:
    rows, columns = compared.rows, []
    if any(row.verdicts is not None for row in rows):
        known = [row.count(FOUND) for row in rows]
        texts = [
            "–" if row.verdicts is None else f"{row.count(FOUND)} of {len(row.verdicts) - row.count(COVERED)}"
            for row in rows
        ]
        columns.append(("faults found", [None if n is None else -n for n in known], texts))
        if any(row.count(COVERED) for row in rows):
            columns.append(
                ("named before they began", [None] * len(rows), [_count(row.count(COVERED)) for row in rows])
            )
        for head, counts in (
            ("faults missed", [row.count(MISSED) for row in rows]),
            ("alarms without a fault", [row.false_alarms for row in rows]),
            ("alarms naming a wrong fault", [row.isolation_errors for row in rows]),
        ):
            columns.append((head, counts, [_count(n) for n in counts]))
        delays = [row.delay for row in rows]
        columns.append(("median delay (s)", delays, [_seconds(d) for d in delays]))
    wins, cells = _wins(rows)
    if len(rows) > 1:
        texts = [f"{wins[row.label]} of {cells}" if row.rmse else "–" for row in rows]
        columns.append(("smallest error in", [-wins[row.label] if row.rmse else None for row in rows], texts))
    costs = [None if row.cost is None else 1e6 * row.cost for row in rows]
    columns.append(("computing time (µs per s)", costs, [number(c, 3) for c in costs]))
    return _columns(rows, columns, scene) + f"<p class=soft>{_legend(rows)}</p>"


def _legend(rows: Sequence[Row]) -> str:
    text = "The best value, and what is within 1 % of it, is bold. " if len(rows) > 1 else ""
    if any(row.verdicts is not None for row in rows):
        grace = ", ".join(dict.fromkeys(number(row.grace, 3) for row in rows if row.verdicts is not None))
        text += (
            f"An alarm within {grace} s after a fault is not counted as one without a fault: the estimates are coming "
            "back. "
        )
    if len(rows) > 1:
        text += "Smallest error: how often an observer has the smallest RMSE of a quantity in a window. "
    return (
        text
        + "Computing time is the processor's, for a second of the simulation; it was measured and differs each time."
    )


def _wins(rows: Sequence[Row]) -> tuple[Counter, int]:
    """How often each observer, alone or with others, has the smallest RMSE, and of how many comparisons."""
    wins, cells = Counter(), 0
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


def _faults(scene: Scene, rows: Sequence[Row]) -> str:
    """A line a fault: after how many seconds each observer's alarm named it."""
    rows = [row for row in rows if row.verdicts]
    if not rows:
        return ""
    lines = []
    for verdicts in zip(*(row.verdicts for row in rows), strict=True):
        fault = verdicts[0]
        texts = [
            (_seconds(v.delay) if v.outcome == FOUND else _OUTCOMES[v.outcome])
            + (" <span class=soft>or another</span>" if v.alternative else "")
            for v in verdicts
        ]
        lines.append([symbol(fault.name), number(fault.onset, 6), *marked([v.delay for v in verdicts], texts)])
    return (
        table(["fault in", "began at (s)", *(chip(scene, row.label) for row in rows)], lines, len(rows) + 1)
        + "<p class=soft>Seconds until an alarm named it; <i>or another</i>: the alarm left more than one fault open.</p>"
    )


def _windows(scene: Scene, compared: Comparison) -> str:
    """RMSE and, in a few windows, peak of every quantity."""
    rows, spans, lines = compared.rows, compared.windows, []
    peaks = len(spans) <= _FEW
    for name in _quantities(rows):
        mine = [row for row in rows if name in row.rmse]
        columns = []
        for place in range(len(spans)):
            rmse = [row.rmse[name][place] for row in mine]
            tops = [row.peak[name][place] for row in mine]
            texts = marked(rmse, [number(v, 3) for v in rmse])
            columns.append(
                [
                    f"{text}<br><span class=soft>{top}</span>" if peaks else text
                    for text, top in zip(texts, marked(tops, [number(v, 3) for v in tops]), strict=True)
                ]
            )
        kind, _, bare = name.partition(".")
        title = symbol(bare) + bracketed(scene.unit(kind, bare))
        lines += [
            [title, chip(scene, row.label), *cells] for row, cells in zip(mine, zip(*columns, strict=True), strict=True)
        ]
    if not lines:
        return ""
    head = [f"{number(w.start, 6)} to {number(w.end, 6)} s" for w in spans]
    below = "; below it the largest error" if peaks else ""
    return (
        table(["error of", "observer", *head], lines, len(spans))
        + f"<p class=soft>Root mean square error between events{below}. A dash: the observer has no number in some row.</p>"
    )


def _final(scene: Scene, summary: Mapping[str, dict]) -> str:
    final = [
        [
            chip(scene, label),
            hat(name) + bracketed(scene.unit("theta", name)),
            number(v["truth"]),
            number(v["estimate"]),
            number(v["error"]),
            number(v["mean_error"]),
            number(v["std"]),
        ]
        for label, entry in summary.items()
        for name, v in entry["theta"].items()
    ]
    if not final:
        return ""
    return (
        table(["observer", "at the end", "true", "estimate", "error", "mean error", "scatter"], final, 5)
        + "<p class=soft>Mean error and scatter (standard deviation) are over the last tenth of the run.</p>"
    )


def _settling(scene: Scene, rows: Sequence[Row], summary: Mapping[str, dict]) -> str:
    """A line a step and observer: when its estimate came within 10 %, stayed within 10 % and within 5 % of the step."""
    keys = list(dict.fromkeys((step.channel, step.at) for row in rows for step in row.steps))
    lines = []
    for key in keys:
        mine = [(row, step) for row in rows for step in row.steps if (step.channel, step.at) == key]
        ten, five = [step.ten for _, step in mine], [step.five for _, step in mine]
        texts = zip(marked(ten, [_settled(v) for v in ten]), marked(five, [_settled(v) for v in five]), strict=True)
        for (row, step), (stays, stays_five) in zip(mine, texts, strict=True):
            reached = next(s["reached"] for s in summary[row.label]["settling"] if (s["channel"], s["at"]) == key)
            lines.append(
                [
                    symbol(step.channel),
                    chip(scene, row.label),
                    number(step.at, 6),
                    number(step.size),
                    "never" if reached is None else f"{reached:.3f}",
                    stays,
                    stays_five,
                ]
            )
    head = [
        "step of",
        "observer",
        "at (s)",
        "size",
        "within 10 % after (s)",
        "stays so after (s)",
        "stays within 5 % after (s)",
    ]
    return table(head, lines, 5) if lines else ""


def _settled(value: float | None) -> str:
    return "does not" if value is None else f"{value:.3f}"
