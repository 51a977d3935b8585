"""Reduce traces to fewer points without losing spikes, and encode arrays in the form that Plotly reads fastest.

A screen is about 2000 pixels wide. Each bucket of consecutive samples of a longer trace keeps its smallest and its
largest value at the original times: the line covers the same pixels as the full one, and its points are samples of the
run, never averages.
"""

from base64 import b64encode

import numpy as np

LIMIT = 4000
"""Number of points up to which a trace is drawn in full."""
PEAKS = 1000
"""Number of buckets of a reduced |error| on a logarithmic axis."""
_F4 = np.finfo(np.float32)


def _buckets(rows: int, count: int) -> tuple[int, int]:
    """Return (width, number) of the full buckets of `rows` samples for about `count` buckets."""
    width = -(-rows // count)
    return width, rows // width


def _extreme(values: np.ndarray, width: int, number: int, sign: int) -> np.ndarray:
    """Return the row of the largest sign·value of every bucket, and of the last, incomplete one; NaN never wins."""
    signed = values if sign > 0 else -values
    if np.isnan(signed).any():
        signed = np.where(np.isnan(signed), -np.inf, signed)
    whole = width * number
    rows = signed[:whole].reshape(number, width).argmax(axis=1) + np.arange(0, whole, width)
    return rows if whole == values.size else np.append(rows, whole + signed[whole:].argmax())


def _ordered(rows: int, *picks: np.ndarray) -> np.ndarray:
    """Return the picks of every bucket in order of time, without repeats, with the run's first and last row."""
    index = np.sort(np.stack(picks), axis=0).T.ravel()
    index = np.concatenate(([0], index, [rows - 1]))
    return index[np.append(True, index[1:] != index[:-1])]


def extremes(values: np.ndarray, limit: int = LIMIT) -> np.ndarray | None:
    """Return the rows to keep, ascending, at most limit + 4: extremes of each bucket and both ends. None: keep all.

    values: shape (rows,). A bucket that is NaN throughout keeps one NaN, so that a gap remains a gap.
    """
    if values.size <= limit:
        return None
    width, number = _buckets(values.size, limit // 2)
    return _ordered(values.size, _extreme(values, width, number, 1), _extreme(values, width, number, -1))


def curve_extremes(x: np.ndarray, y: np.ndarray, limit: int = LIMIT) -> np.ndarray | None:
    """Return the same as `extremes` for a curve y over x (a loop, a phase portrait): extremes of both coordinates."""
    if x.size <= limit:
        return None
    width, number = _buckets(x.size, limit // 4)
    return _ordered(x.size, *(_extreme(v, width, number, sign) for v in (x, y) for sign in (1, -1)))


def peaks(values: np.ndarray, buckets: int = PEAKS) -> np.ndarray | None:
    """Return the row of the largest value of each bucket, for |error| on a logarithmic axis.

    The smallest |error| of a bucket is usually a zero crossing and would draw vertical lines down to 1e-17.
    """
    if values.size <= 2 * buckets:
        return None
    width, number = _buckets(values.size, buckets)
    return _extreme(values, width, number, 1)


def typed(values: np.ndarray) -> dict[str, str]:
    """Return {"dtype", "bdata"}: Plotly's typed array, little-endian, base64.

    float32 where its relative error of 6e-8 cannot be seen (the spread is not small relative to the size), else
    float64. Values that are not finite become NaN, which Plotly leaves out.
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
