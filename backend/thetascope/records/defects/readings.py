"""Peculiar readings of an output: steps of a quantised sensor, frozen and saturated stretches, spikes."""

import numpy as np

from thetascope.messages import Message
from thetascope.records.defects.finding import Finding, Rows, lines_text, stretches

_COARSE = 0.3  # a step of readings counts if it is larger than this share of their scatter
_LEVELS = 20_000  # more different readings than these are not examined for steps
_ON_GRID = 0.2  # of a step by which readings may lie beside the grid
_FROZEN_ROWS, _FROZEN_TIMES = 12, 12.0
_SATURATED_ROWS, _SATURATED_SHARE = 5, 8.0
_SPIKE = 12.0
_MOST_SPIKES = 0.02


def resolution_of(values: np.ndarray) -> float:
    """Return the step between neighbouring readings, 0 where it is small beside their scatter.

    A printed decimal place is a step, too; it does not count where the readings scatter over many of them.
    """
    good = values[~np.isnan(values)]
    levels = np.unique(good)
    if not 3 <= len(levels) <= _LEVELS or len(good) < 20:
        return 0.0
    steps = np.diff(levels)
    step = float(steps.min())
    grid = np.concatenate(([0.0], np.cumsum(np.rint(steps / step))))
    if grid[-1] > 1e7:
        return 0.0
    step = float((grid @ (levels - levels[0])) / (grid @ grid))
    if np.abs(levels - levels[0] - step * grid).max() > _ON_GRID * step:
        return 0.0
    changes = np.sort(np.abs(np.diff(good)))
    scatter = float(np.sqrt(np.mean(changes[: max(1, int(0.99 * len(changes)))] ** 2) / 2))
    if scatter == 0.0:
        scatter = step / 2
    return step if step > _COARSE * scatter else 0.0


def quantised(values: np.ndarray, name: str, column: str | None, unit: str) -> tuple[float, list[Finding]]:
    """Return the step of an output's readings, and the finding."""
    step = resolution_of(values)
    if step == 0.0:
        return 0.0, []
    text = Message("record.finding.quantised", name=name, step=step, unit=unit)
    treatment = Message("record.treatment.quantised", std=step / np.sqrt(12), unit=unit)
    return step, [Finding("quantised", "note", text, treatment, name, column, count=int((~np.isnan(values)).sum()))]


def frozen(
    values: np.ndarray, rows: Rows, name: str, column: str | None, ends: tuple[float, ...] = ()
) -> list[Finding]:
    """Return stretches in which a reading stays exactly the same for much longer than elsewhere.

    Stretches at one of `ends`, where the readings saturate, are left out.
    """
    same = np.concatenate(([False], np.diff(values) == 0))
    runs = stretches(same)
    lengths = np.array([end - begin + 1 for begin, end in runs])
    if not len(lengths):
        return []
    changes = max(1, int((np.diff(values) != 0).sum()))
    usual = max(1.0, len(values) / changes)
    if len(lengths) >= 5:
        usual = max(
            usual, float(np.quantile(lengths[lengths < lengths.max()], 0.9)) if len(set(lengths)) > 1 else usual
        )
    findings = []
    for (begin, end), length in zip(runs, lengths, strict=True):
        if values[begin] in ends or length == len(values):
            continue
        if length >= max(_FROZEN_ROWS, _FROZEN_TIMES * usual):
            marks = rows.marks(np.arange(begin - 1, end))
            text = Message("record.finding.frozen", name=name, t=float(rows.t[begin - 1]), until=float(rows.t[end - 1]))
            until = float(rows.t[end - 1])
            findings.append(
                Finding(
                    "frozen", "doubtful", text, Message("record.treatment.frozen"), name, column, until=until, **marks
                )
            )
    return findings[:10]


def saturated(values: np.ndarray, rows: Rows, name: str, column: str | None, step: float) -> list[Finding]:
    """Return findings where readings pile up at their largest or smallest value, as at the end of a sensor's range."""
    good = values[~np.isnan(values)]
    findings = []
    if len(good) < 50 or good.min() == good.max():
        return []
    width = step or (good.max() - good.min()) / 200
    for end, edge in (("high", good.max()), ("low", good.min())):
        at = values == edge
        longest = max((b - a for a, b in stretches(at) if a > 0), default=0)  # a record may begin at rest
        inward = edge - width if end == "high" else edge + width
        near = (np.abs(values - inward) <= 0.51 * width) & ~at
        if longest >= _SATURATED_ROWS and at.sum() > _SATURATED_SHARE * max(1, int(near.sum())):
            places = np.flatnonzero(at)
            text = Message(f"record.finding.saturated-{end}", name=name, value=float(edge), n=len(places))
            treatment = Message("record.treatment.saturated")
            findings.append(Finding("saturated", "doubtful", text, treatment, name, column, **rows.marks(places)))
    return findings


def spikes(values: np.ndarray, rows: Rows, name: str, column: str | None) -> list[Finding]:
    """Return one finding for single readings far from both neighbours."""
    known = np.flatnonzero(~np.isnan(values))
    y = values[known]
    if len(y) < 20:
        return []
    middle = np.median(np.stack([y[:-2], y[1:-1], y[2:]]), axis=0)
    beyond = np.abs(y[1:-1] - middle)
    changes = np.abs(np.diff(y))
    usual = float(np.median(changes)) / 0.95 or float(np.quantile(changes, 0.95)) or float(changes.mean())
    places = known[np.flatnonzero(beyond > _SPIKE * usual) + 1] if usual else known[:0]
    if not 0 < len(places) <= max(1, _MOST_SPIKES * len(y)):
        return []
    marks = rows.marks(places)
    text = Message("record.finding.spikes", name=name, n=len(places), lines=lines_text(rows.lines[places]))
    return [Finding("spikes", "note", text, Message("record.treatment.spikes"), name, column, **marks)]
