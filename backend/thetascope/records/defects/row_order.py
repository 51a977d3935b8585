"""Bring rows into the order of time: reversed, repeated, unordered rows and rows without a time."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from thetascope.messages import Message
from thetascope.records.defects.finding import Finding, Rows, lines_text
from thetascope_schemas.service.record_inspection import Severity

_REVERSED = 0.9  # share of steps backwards in a record whose rows are reversed
_COARSE = 0.1  # share of rows with the time of the row before, beyond which times are written coarsely
_NEAR, _FAR = 4.0, 10.0  # periods within which neighbours agree, and by which a stray time is off
_AHEAD = 0.05  # share of the rows that may lie before the time of an earlier row


@dataclass(frozen=True)
class Ordered:
    """The places of the rows that are kept, in the order of time, their times in s, and what was done."""

    index: np.ndarray
    t: np.ndarray
    turned: bool
    findings: tuple[Finding, ...]


def ordered(t: np.ndarray, cells: np.ndarray, lines: np.ndarray, column: str | None) -> Ordered:
    """Return rows with strictly increasing times.

    Args:
        t: (rows,), times in s as in the file, NaN where one is missing.
        cells: (rows, columns), the numbers in the columns that are used.
        lines: (rows,), their lines in the file.
        column: the column of times.
    """
    findings: list[Finding] = []
    index = np.flatnonzero(~np.isnan(t))
    if len(index) < len(t):
        without = np.flatnonzero(np.isnan(t))
        findings.append(_finding("no-time", "changed", Rows(lines, np.nan_to_num(t)), without, column, dropped=True))
    steps = np.diff(t[index])
    turned = len(steps) > 1 and bool((steps < 0).mean() >= _REVERSED)
    if turned:
        index = index[::-1]
        findings.append(
            Finding(
                "reversed", "changed", Message("record.finding.reversed"), _done("reversed"), None, column, len(index)
            )
        )
    stray = _stray(t[index])
    if stray.any():
        findings.append(_finding("stray-time", "changed", Rows(lines[index], t[index]), np.flatnonzero(stray), column))
        index = index[~stray]
    index, more = _forward(t, index, lines, column)
    findings += more
    index, times, more = _without_repeats(t[index], index, cells, lines, column)
    return Ordered(index, times, turned, (*findings, *more))


def _stray(t: np.ndarray) -> np.ndarray:
    """Return which rows have a time far from those of both neighbours, which agree with each other."""
    stray = np.zeros(len(t), dtype=bool)
    if len(t) > 3:
        period = float(np.median(np.abs(np.diff(t))))
        before, own, after = t[:-2], t[1:-1], t[2:]
        agree = (after > before) & (after - before <= _NEAR * period)
        stray[1:-1] = agree & ((own < before - _FAR * period) | (own > after + _FAR * period))
    return stray


def _forward(
    t: np.ndarray, index: np.ndarray, lines: np.ndarray, column: str | None
) -> tuple[np.ndarray, list[Finding]]:
    """Return rows sorted by time where a few are out of order; where the time begins anew, only say so."""
    highest = np.maximum.accumulate(t[index]) if len(index) else t[index]
    behind = np.flatnonzero(t[index] < highest)
    if not len(behind):
        return index, []
    rows = Rows(lines[index], t[index])
    if len(behind) > max(3, _AHEAD * len(index)):
        back = np.flatnonzero(np.diff(t[index]) < 0) + 1
        return index[: back[0]], [_finding("restarts", "wrong", rows, back, column)]
    return index[np.argsort(t[index], kind="stable")], [_finding("unordered", "changed", rows, behind, column)]


def _without_repeats(
    t: np.ndarray, index: np.ndarray, cells: np.ndarray, lines: np.ndarray, column: str | None
) -> tuple[np.ndarray, np.ndarray, list[Finding]]:
    """Return rows whose times differ: repeated rows are dropped, coarse times are spread over their interval."""
    again = np.flatnonzero(np.diff(t) == 0) + 1
    if not len(again):
        return index, t, []
    rows = Rows(lines[index], t)
    before, after = cells[index[again - 1]], cells[index[again]]
    same = ((before == after) | (np.isnan(before) & np.isnan(after))).all(axis=1)
    if len(again) > _COARSE * len(t) and same.mean() < 0.5:
        finding = _finding("coarse-times", "changed", rows, again, column)
        spread = _spread(t)
        later = np.concatenate(([True], np.diff(spread) > 0))  # large times cannot be told apart so finely
        return index[later], spread[later], [finding]
    findings = []
    if same.any():
        findings.append(_finding("repeated", "changed", rows, again[same], column))
    if not same.all():
        findings.append(_finding("conflicting", "changed", rows, again[~same], column))
    kept = np.ones(len(t), dtype=bool)
    kept[again] = False
    return index[kept], t[kept], findings


def _spread(t: np.ndarray) -> np.ndarray:
    """Return times of which equal ones are spread evenly up to the next time."""
    first = np.flatnonzero(np.concatenate(([True], np.diff(t) > 0)))
    counts = np.diff(np.append(first, len(t)))
    starts = t[first]
    lengths = np.append(np.diff(starts), np.median(np.diff(starts)) if len(starts) > 1 else 1.0)
    position = np.arange(len(t)) - np.repeat(first, counts)
    return np.repeat(starts, counts) + position * np.repeat(lengths / counts, counts)


def _finding(
    kind: str, severity: Severity, rows: Rows, places: np.ndarray, column: str | None, dropped: bool = False
) -> Finding:
    marks: dict[str, Any] = rows.marks(places)
    if dropped:
        marks["times"] = ()
    text = Message(f"record.finding.{kind}", n=len(places), lines=lines_text(rows.lines[places]))
    return Finding(kind, severity, text, _done(kind), None, column, **marks)


def _done(kind: str) -> Message:
    return Message(f"record.treatment.{kind}")
