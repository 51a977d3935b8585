"""The curve of a signal, in few points that a figure can draw."""

import numpy as np

from thetascope.engine.inputs.signals import Signal

_FINE = 4  # samples for each place of a figure
_GOLDEN = 0.6180339887498949
MOST = 10**6  # jumps in the span, from which on samples are evaluated one by one: random values have all in between


def curve(signal: Signal, start: float, end: float, places: int, interval: float | None = None) -> np.ndarray:
    """Return times and values of a signal from start to end (s), shape (2, at most 6·places).

    Straight lines between the points are the signal as a figure with ``places`` columns shows it: with both limits at
    each jump, or, where there are more jumps than columns, with samples of each column.

    Args:
        interval: the shortest time in s between two jumps, if the signal has periodic ones.
    """
    few = interval is None or (end - start) / interval <= places
    breaks = np.unique(signal.breaks(start, end)) if few else np.empty(0)
    every = few and len(breaks) <= places
    if every and signal.held:
        edges = np.array([start, *breaks, end])
        middle = 0.5 * (edges[:-1] + edges[1:])
        return np.stack([np.stack([edges[:-1], edges[1:]], axis=1).ravel(), np.repeat(signal(middle, middle), 2)])
    count = _FINE * places
    jitter = np.modf(np.arange(1, count) * _GOLDEN)[0] - 0.5  # samples in step with a signal would hide its height
    inner = start + (end - start) * np.array([0.0, *(np.arange(1, count) + 0.5 * jitter), count]) / count
    aside = 1e-6 * (end - start) / count
    breaks = breaks if every else np.empty(0)
    times = np.concatenate([inner, breaks, breaks])
    anchors = np.concatenate([np.clip(inner, start + aside, end - aside), breaks - aside, breaks + aside])
    order = np.argsort(anchors, kind="stable")
    times, anchors = times[order], anchors[order]
    if interval is None or (end - start) / interval <= MOST:
        return np.stack([times, signal(times, anchors)])
    single = [signal(times[k : k + 1], anchors[k : k + 1]) for k in range(len(times))]
    return np.stack([times, np.concatenate(single)])
