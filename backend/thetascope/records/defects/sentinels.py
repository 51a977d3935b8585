"""Numbers that say that there is no reading, such as -9999: they are recognised beside the other values."""

import numpy as np

_KNOWN = (
    *(-9.0, -99.0, -99.9, -999.0, -999.9, -999.99, -9999.0, -9999.9, -9999.99, -99999.0, -999999.0, -9999999.0),
    *(99.0, 99.9, 999.0, 999.9, 999.99, 9999.0, 9999.9, 9999.99, 99999.0, 999999.0, 9999999.0, 99999999.0),
    *(-1.0, -2.0, -7999.0, 7999.0, 6999.0, -6999.0, -1111.0, -8888.0, 8888.0, -7777.0, 7777.0),
    *(
        -32768.0,
        32767.0,
        65535.0,
        65534.0,
        -32767.0,
        2147483647.0,
        -2147483648.0,
        4294967295.0,
        255.0,
        4095.0,
        -127.0,
        85.0,
    ),
)
_HUGE = 1e20  # beyond the range of every sensor
_FAR = 3.0  # ranges of the other values by which a sentinel lies outside of them
_VERY_FAR = 20.0  # the same for values within the plausible range
_JUMP = 20.0  # times the usual change from row to row
_MOST = 0.5  # share of a column that may be sentinels


def sentinels(cells: np.ndarray, low: float | None = None, high: float | None = None) -> np.ndarray:
    """Return which cells of a column hold a sentinel.

    Args:
        cells: (rows,), as in the file.
        low, high: range that is plausible, in the unit of the cells; None: unknown.

    A value of the usual ones counts if all other values are far from it, or if it is outside the plausible range, where
    others are within; and each time it is reached and left in a jump.
    """
    huge = np.abs(cells) >= _HUGE
    flags = huge.copy()
    unique, counts = np.unique(cells[~np.isnan(cells) & ~huge], return_counts=True)
    if len(unique) < 3:
        return flags
    for value in _KNOWN:
        place = int(np.searchsorted(unique, value))
        if place >= len(unique) or unique[place] != value or counts[place] > _MOST * counts.sum():
            continue
        own = cells == value
        others = cells[~own & ~flags & ~np.isnan(cells)]
        if _is_apart(value, others, low, high) and _jumps(cells, own, others):
            flags |= own
    return flags


def _is_apart(value: float, others: np.ndarray, low: float | None, high: float | None) -> bool:
    """Return whether a value is not one of the others: far away, or outside a range that holds nearly all of them."""
    if not len(others):
        return False
    bottom, top = np.quantile(others, (0.005, 0.995))
    distance = max(bottom - value, value - top)
    if distance <= 0:
        return False
    lowest, highest = -np.inf if low is None else low, np.inf if high is None else high
    plausible = np.isfinite(highest - lowest) and lowest <= value <= highest
    if distance > (_VERY_FAR if plausible else _FAR) * max(top - bottom, 1e-12 * abs(value)):
        return True
    within = ((others >= lowest) & (others <= highest)).mean()
    return bool(not lowest <= value <= highest and within > 0.95 and distance > 0.3 * (top - bottom))


def _jumps(cells: np.ndarray, own: np.ndarray, others: np.ndarray) -> bool:
    """Return whether a value is reached and left in jumps that are much larger than changes elsewhere."""
    steps = np.abs(np.diff(cells))
    edge = own[1:] != own[:-1]
    inner = ~own[1:] & ~own[:-1]
    usual = steps[inner & ~np.isnan(steps)]
    across = steps[edge & ~np.isnan(steps)]
    if not len(across) or not len(usual):
        return True
    return bool(np.median(across) > _JUMP * max(float(np.median(usual)), 1e-12) or np.median(across) > np.ptp(others))
