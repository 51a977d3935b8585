"""Fewer points without losing a spike, and arrays as Plotly reads them fastest.

A screen is some 2000 pixels wide. Of a longer trace each bucket of consecutive samples keeps its smallest and its
largest, at the times where they occurred: the drawn line covers the same pixels as the full one, and what is kept
are samples of the run, never averages.
"""

from base64 import b64encode

import numpy as np

LIMIT = 4000
"""Points a trace may have before it is thinned."""
PEAKS = 1000
"""Buckets of a thinned |error| on a logarithmic axis."""
_F4 = np.finfo(np.float32)


def _buckets(rows: int, count: int) -> tuple[int, int]:
    """(width, number) of the whole buckets that `rows` samples make when about `count` are wanted."""
    width = -(-rows // count)
    return width, rows // width


def _extreme(values: np.ndarray, width: int, number: int, sign: int) -> np.ndarray:
    """Row index of the largest sign·value of every bucket, and of the last incomplete one. A NaN never wins over a number."""
    signed = values if sign > 0 else -values
    if np.isnan(signed).any():
        signed = np.where(np.isnan(signed), -np.inf, signed)
    whole = width * number
    rows = signed[:whole].reshape(number, width).argmax(axis=1) + np.arange(0, whole, width)
    return rows if whole == values.size else np.append(rows, whole + signed[whole:].argmax())


def _ordered(rows: int, *picks: np.ndarray) -> np.ndarray:
    """The picks of every bucket in order of time, without repeats, with the first and the last row of the run."""
    index = np.sort(np.stack(picks), axis=0).T.ravel()
    index = np.concatenate(([0], index, [rows - 1]))
    return index[np.append(True, index[1:] != index[:-1])]


def extremes(values: np.ndarray, limit: int = LIMIT) -> np.ndarray | None:
    """Rows to keep, ascending, at most limit + 4: the extremes of each bucket and both ends. None: keep all.

    values: shape (rows,). A bucket that is NaN throughout keeps one NaN, so that a gap stays a gap.
    """
    if values.size <= limit:
        return None
    width, number = _buckets(values.size, limit // 2)
    return _ordered(values.size, _extreme(values, width, number, 1), _extreme(values, width, number, -1))


def curve_extremes(x: np.ndarray, y: np.ndarray, limit: int = LIMIT) -> np.ndarray | None:
    """As `extremes` for a curve y over x that is not time (a loop, a phase portrait): both coordinates' extremes."""
    if x.size <= limit:
        return None
    width, number = _buckets(x.size, limit // 4)
    return _ordered(x.size, *(_extreme(v, width, number, sign) for v in (x, y) for sign in (1, -1)))


def peaks(values: np.ndarray, buckets: int = PEAKS) -> np.ndarray | None:
    """Rows of the largest value of each bucket: for |error| on a logarithmic axis.

    The least |error| of a bucket is the accident of a change of sign and would draw a curtain down to 1e-17.
    """
    if values.size <= 2 * buckets:
        return None
    width, number = _buckets(values.size, buckets)
    return _extreme(values, width, number, 1)


def typed(values: np.ndarray) -> dict[str, str]:
    """{"dtype", "bdata"}: Plotly's typed array, little-endian, base64.

    float32 where its 6e-8 cannot be seen (the spread is not small beside the size), else float64. What is not finite
    becomes NaN, which Plotly leaves out.
    """
    values = np.asarray(values, dtype=np.float64)
    low, high = values.min(), values.max()
    if not (np.isfinite(low) and np.isfinite(high)):
        values = np.where(np.isfinite(values), values, np.nan)
        finite = values[~np.isnan(values)]
        low, high = (finite.min(), finite.max()) if finite.size else (0.0, 0.0)
    size = max(abs(low), abs(high))
    small = size < _F4.max and (high - low) > 1e-2 * size and (size == 0 or size > 1e-30)
    kind = np.dtype("<f4") if small else np.dtype("<f8")
    return {"dtype": "f4" if small else "f8", "bdata": b64encode(values.astype(kind).data).decode("ascii")}
