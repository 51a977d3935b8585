"""A plain alarm: the band has left zero. It serves until tests with a set rate of false alarms take its place.

An estimate is out when it is above SIGMAS standard deviations for HOLD seconds, or its mean over the last MEAN seconds
above MEAN_SIGMAS of them (a mean over many correlation times is much surer than one value); in both cases also above
SHARE of the channel's typical size. An alarm is raised only while the residual is at the level of the noise: during the
transient after a fault all estimates move, and which one it was shows when the observer has settled again.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from shared.session import Event

SIGMAS = 5.0
MEAN_SIGMAS = 2.0
SHARE = 0.1  # of the typical size
HOLD = 0.4  # s; an alarm is over when the estimate is back for as long
MEAN = 3.0  # s
CALM = 0.7  # s of quiet residual before an alarm is raised
SETTLED = 4.0  # s of quiet residual before anything is believed at all
LOUD = 4.0  # standard deviations of the noise


@dataclass(frozen=True)
class Watch:
    """Where the watching of one estimate stands."""

    above: int = 0  # rows on end
    below: int = 0
    on: bool = False
    recent: tuple[np.ndarray, ...] = ()  # θ̂/σ over the last MEAN seconds


@dataclass(frozen=True)
class Alarms:
    """State of all alarms of a session: a value, so that rewinding is taking an older one."""

    quiet: dict[str, int] = field(default_factory=dict)  # rows of quiet residual on end, by observer
    settled: frozenset[str] = frozenset()
    watches: dict[tuple[str, str], Watch] = field(default_factory=dict)


@dataclass(frozen=True)
class Seen:
    """The columns of one observer in a stretch of rows."""

    label: str
    channels: tuple[str, ...]
    theta: np.ndarray  # channels × rows
    sigma: np.ndarray  # channels × rows
    residual: np.ndarray  # largest |y − ŷ| in standard deviations of the noise, over the outputs
    typical: np.ndarray  # by channel


def watch(state: Alarms, seen: Seen, first_row: int, record: float, pace: float) -> tuple[Alarms, list[Event]]:
    """Look at a stretch of rows; the new state and what happened in it.

    ``pace``: how much slower than a plant whose story takes a hundred seconds this one is; all times are longer by it.
    """
    hold, calm, settle, mean = (max(2, round(s * pace / record)) for s in (HOLD, CALM, SETTLED, MEAN))
    quiet = _run_lengths(seen.residual < LOUD, state.quiet.get(seen.label, 0))
    settled = np.full(len(quiet), True) if seen.label in state.settled else np.maximum.accumulate(quiet >= settle)
    ready = settled & (quiet >= calm)
    watches, events = dict(state.watches), []
    for c, channel in enumerate(seen.channels):
        key = (seen.label, channel)
        before = watches.get(key, Watch())
        watches[key], changes = _channel(before, seen, c, (ready, settled & (quiet >= mean)), hold, mean)
        events += [_event(seen, c, r, first_row, record, on) for r, on in changes]
    after = replace(
        state,
        quiet={**state.quiet, seen.label: int(quiet[-1]) if len(quiet) else state.quiet.get(seen.label, 0)},
        settled=state.settled | ({seen.label} if len(settled) and settled[-1] else set()),
        watches=watches,
    )
    return after, events


def _run_lengths(true: np.ndarray, before: int) -> np.ndarray:
    """At each row, how many rows on end have been true, ``before`` of them earlier."""
    rows = np.arange(1, len(true) + 1)
    broken = np.maximum.accumulate(np.where(true, 0, rows))
    return rows - broken + np.where(broken == 0, before, 0)


def _channel(before: Watch, seen: Seen, c: int, ready: tuple[np.ndarray, np.ndarray], hold: int, mean: int):
    """One estimate: its watch after these rows, and (row, on) where its alarm changed.

    ``ready``: rows at which a value, and at which a mean, may raise an alarm.
    """
    theta, floor = np.abs(seen.theta[c]), SHARE * seen.typical[c]
    sigma = np.maximum(np.nan_to_num(seen.sigma[c], nan=np.inf), floor / SIGMAS)
    scaled = np.nan_to_num(seen.theta[c] / sigma)
    past = np.concatenate([*before.recent, scaled])
    total = np.concatenate([[0.0], np.cumsum(past)])
    at = np.arange(len(past) - len(scaled), len(past)) + 1
    means = np.abs(total[at] - total[np.maximum(at - mean, 0)]) / mean
    means = np.where(ready[1], means, 0.0)
    out = (theta > SIGMAS * sigma) | (means > MEAN_SIGMAS)
    above = _run_lengths(theta > SIGMAS * sigma, before.above)
    below = _run_lengths(~out, before.below)
    rising = ready[0] & ((above >= hold) | (means > MEAN_SIGMAS))
    rows = np.arange(1, len(out) + 1)
    last_set = np.maximum.accumulate(np.where(rising, rows, 0))
    last_cleared = np.maximum.accumulate(np.where(~rising & (below >= hold), rows, 0))
    states = np.where(last_set == last_cleared, before.on, last_set > last_cleared)  # equal: neither has happened
    changes = [(int(r), bool(states[r])) for r in np.flatnonzero(np.diff(states, prepend=before.on))]
    if not len(out):
        return before, changes
    return Watch(int(above[-1]), int(below[-1]), bool(states[-1]), (past[-mean:],)), changes


def _event(seen: Seen, c: int, r: int, first_row: int, record: float, on: bool) -> Event:
    row, size = first_row + r, float(seen.theta[c, r])
    channel = seen.channels[c]
    value = {"estimate": size, "sigma": float(np.nan_to_num(seen.sigma[c, r]))}
    text = f"alarm: {channel}, size {size:.3g}" if on else f"alarm over: {channel}"
    return Event(row=row, t=row * record, kind="alarm" if on else "alarm-over", subject=channel, observer=seen.label,
                 value=value, text=text)  # fmt: skip
