"""Dates and times of day in text, as nanoseconds."""

import re
from collections.abc import Sequence
from datetime import datetime
from typing import Literal

import numpy as np

NANOSECONDS = 1_000_000_000
_DAY = 86_400
NONE = np.iinfo("i8").min
"""The place of a time that is missing."""
_EPOCH = datetime(1970, 1, 1).toordinal()
_SHARE = 0.2  # of cells that may be wrong in a column of times
_MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")
_CLOCK = r"(?:(\d+)[:时](\d{1,2})(?:[:分](\d{1,2})秒?)?(?:[.,](\d{1,12}))?\s*([AaPp]\.?[Mm]\.?)?)"
_TIME = re.compile(r"(?:(\d+) days?,? ?)?" + _CLOCK)
_ZONE = r"\s*(Z|UTC|GMT|[+-]\d{2}:?\d{2}|[+-]\d{2})?"
_DATE = re.compile(
    r"(?:(\d{4})[-/.年](\d{1,2})[-/.月](\d{1,2})日?|(\d{1,2})[-/.](\d{1,2})[-/.](\d{2,4})"
    r"|(\d{1,2})[-/ ]([A-Za-z]{3})[A-Za-z]*[-/ ](\d{2,4})|(\d{4})(\d{2})(\d{2}))"
    r"(?:[T ,]+(?:" + _CLOCK + r"|(\d{2})(\d{2})(\d{2})?)" + _ZONE + r")?"
)
Order = Literal["day", "month"]


def nanoseconds(
    rows: int, cells: Sequence[tuple[int, str]]
) -> tuple[np.ndarray, Literal["date", "clock"], list[tuple[int, str]]] | None:
    """Return times by row, NONE where a cell has none, their kind, and other cells; or None for other texts.

    Dates count from 1970 (UTC where they have a zone, else as written), times of day from midnight.
    """
    for epoch in ("clock", "date"):
        parse = _clock if epoch == "clock" else _order(cells)
        result, wrong = np.full(rows, NONE), []
        for row, cell in cells:
            ticks = parse(cell)
            if ticks is None:
                wrong.append((row, cell))
            else:
                result[row] = ticks
        if len(wrong) <= _SHARE * len(cells):
            return result, epoch, wrong
    return None


def _clock(cell: str) -> int | None:
    match = _TIME.fullmatch(cell)
    if match is None:
        return None
    seconds = _of_day(match.groups()[1:])
    return None if seconds is None else seconds + int(match[1] or 0) * _DAY * NANOSECONDS


def _of_day(parts: Sequence[str | None]) -> int | None:
    """Return nanoseconds since midnight of hours, minutes, seconds, fraction and am or pm."""
    hours, minutes, seconds, fraction, half = parts
    h, m, s = int(hours or 0), int(minutes or 0), int(seconds or 0)
    if seconds is None and fraction is not None:  # 00:05.3 is minutes and seconds, as spreadsheets write it
        h, m, s = 0, h, m
    if half is not None:
        if not 1 <= h <= 12:
            return None
        h = h % 12 + (12 if half[0] in "Pp" else 0)
    if m > 59 and hours is not None and seconds is not None or s > 60 or h > 10**6:
        return None
    return (h * 3600 + m * 60 + s) * NANOSECONDS + int((fraction or "0").ljust(9, "0")[:9])


def _order(cells: Sequence[tuple[int, str]]):
    """Return the function that reads a date, with days before or after months as the cells show."""
    firsts, seconds = set(), set()
    for _, cell in cells:
        match = _DATE.match(cell)
        if match and match[4]:
            firsts.add(int(match[4]))
            seconds.add(int(match[5]))
    order: Order = "day"
    if any(second > 12 for second in seconds):
        order = "month"
    elif not any(first > 12 for first in firsts) and len(firsts) == 1 and len(seconds) > 1:
        order = "month"  # days change sooner than months
    elif not any(first > 12 for first in firsts) and len(firsts) == 1 and "/" in cells[0][1]:
        order = "month"
    return lambda cell: _date(cell, order)


def _date(cell: str, order: Order) -> int | None:
    match = _DATE.fullmatch(cell)
    if match is None:
        return None
    groups = match.groups()
    if groups[0]:
        year, month, day = int(groups[0]), int(groups[1]), int(groups[2])
    elif groups[3]:
        first, second, year = int(groups[3]), int(groups[4]), int(groups[5])
        day, month = (first, second) if order == "day" else (second, first)
    elif groups[6]:
        day, year = int(groups[6]), int(groups[8])
        month = _MONTHS.index(groups[7].lower()) + 1 if groups[7].lower() in _MONTHS else 0
    else:
        year, month, day = int(groups[9]), int(groups[10]), int(groups[11])
    year += 2000 if year < 70 else 1900 if year < 100 else 0
    try:
        days = datetime(year, month, day).toordinal() - _EPOCH
    except ValueError:
        return None
    if not -90_000 < days < 90_000:  # 64 bits of nanoseconds
        return None
    clock = groups[12:17] if groups[12] else (*groups[17:20], None, None)
    ticks = _of_day(clock)
    if ticks is None or ticks > 2 * _DAY * NANOSECONDS:
        return None
    return days * _DAY * NANOSECONDS + ticks - _zone(groups[20])


def _zone(text: str | None) -> int:
    """Return the nanoseconds by which a zone is ahead of UTC."""
    if text is None or text[0] not in "+-":
        return 0
    digits = text[1:].replace(":", "").ljust(4, "0")
    minutes = int(digits[:2]) * 60 + int(digits[2:])
    return (minutes if text[0] == "+" else -minutes) * 60 * NANOSECONDS
