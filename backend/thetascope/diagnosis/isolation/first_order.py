"""What each channel explains to first order, from every onset: what is worth being held against the data in full.

J and s of a step and of a rise without end from any decision on, as if the filter had been run from there with V = 0, follow
from one pass backwards in time (engine/estimation/backward_information.py); those of a rise with an end, from runs of the filter up to where it ends. From
them comes the energy that each channel explains.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from thetascope.diagnosis.detection.window_tests import explained, lengths
from thetascope.diagnosis.isolation.decision_state import Event
from thetascope.diagnosis.isolation.replay import ReplayWindow

ONSET_DROP = -2 * float(np.log(1 - 0.95**0.5))  # onsets within this of the likeliest may be it, see `onset_interval`
RISE_PENALTY = 3.0  # what a rise has to explain more than a step; one with an end: half as much again
_LEADERS = 4  # channels whose rises with an end are looked at closely
_CLOSE = 9  # decisions in place of three
_SHORT = 8  # decisions within which a rise cannot be told from a step
_DENSE = 13  # decisions to each side of an onset that are all looked at


@dataclass(frozen=True)
class FirstOrderScan:
    """What each channel explains to first order, by onset and rise: entries × p, less what is asked of rises; D (the diagonal of
    J) and s of one unit of their course. Steps come first, and ``J`` is theirs."""

    onsets: np.ndarray
    rise_times: np.ndarray
    exponential: np.ndarray
    energy: np.ndarray
    D: np.ndarray
    s: np.ndarray
    J: np.ndarray

    def joined(self, other: "FirstOrderScan") -> "FirstOrderScan":
        names = ("onsets", "rise_times", "exponential", "energy", "D", "s")
        return FirstOrderScan(*(np.concatenate([getattr(self, n), getattr(other, n)]) for n in names), self.J)

    def best(self, channel: int) -> int:
        return int(self.energy[:, channel].argmax())

    def best_by_shape(self, channel: int) -> list[int]:
        """The best entry of a channel for a step, for a rise without end, for one with an end, and for one that bends."""
        kinds = (
            self.rise_times == 0,
            self.rise_times == np.inf,
            (self.rise_times > 0) & np.isfinite(self.rise_times) & ~self.exponential,
            self.exponential,
        )
        return [int(np.flatnonzero(k)[self.energy[k, channel].argmax()]) for k in kinds if k.any()]


def first_order_scan(window: ReplayWindow, ended: bool) -> FirstOrderScan:
    """All onsets of steps and of rises without end; ``ended``: rises with an end, too, begun far apart at first, then closely, and
    rises that bend."""
    found = _scan_steps(window)
    long = window.end - max(2 * window.evidence.thresholds.settle, _SHORT)
    if long >= window.begin:
        found = found.joined(_scan_drifts(window, long))
    coarse = np.unique(np.append(window.end - lengths(window.end - window.begin), window.begin))
    ends = coarse[coarse <= long]
    if not ended or len(ends) < 3:
        return found
    spans = [(int(a), int(b)) for a, b in combinations(ends, 2)]
    coarse = _scan_ramps(window, spans)
    found = found.joined(coarse).joined(_scan_ramps(window, _spans_nearby(coarse, ends)))
    taus = 2.0 ** np.arange(2, np.log2(window.end - window.begin))
    exponential = [_scan_drifts(window, long, float(tau)) for tau in taus]
    exponential += [
        _scan_drifts(window, long, tau)
        for tau in _between_taus(taus, np.array([b.energy.max(axis=0) for b in exponential]))
    ]
    for more in exponential:
        found = found.joined(more)
    return found


def _between_taus(taus: np.ndarray, energy: np.ndarray) -> list[float]:
    """Where parabolas through the most that each channel explains (taus × p) have their tops, for the leading channels."""
    tops = set()
    for channel in np.argsort(-energy.max(axis=0))[:_LEADERS]:
        k = int(energy[:, channel].argmax())
        if 0 < k < len(taus) - 1:
            before, best, after = energy[k - 1 : k + 2, channel]
            shift = 0.5 * (before - after) / min(before - 2 * best + after, -1e-300)
            tops.add(round(float(taus[k] * 2.0**shift), 1))
    return sorted(tops)


def _spans_nearby(found: FirstOrderScan, grid: np.ndarray) -> list[tuple[int, int]]:
    """Spans about those that serve the leading channels best, out to their neighbours on the grid."""
    spans = set()
    for channel in np.argsort(-found.energy.max(axis=0))[:_LEADERS]:
        entry = found.best(int(channel))
        onset = found.onsets[entry]
        begins, ends = (_between(grid, int(np.searchsorted(grid, d))) for d in (onset, onset + found.rise_times[entry]))
        spans |= {(a, b) for a in begins for b in ends if b > a}
    return sorted(spans)


def _between(grid: np.ndarray, place: int) -> list[int]:
    low, high = grid[max(place - 1, 0)], grid[min(place + 1, len(grid) - 1)]
    return np.unique(np.linspace(low, high, _CLOSE).round().astype(int)).tolist()


def _scan_steps(window: ReplayWindow) -> FirstOrderScan:
    onset_interval = np.arange(window.begin, window.end)
    J, s = window.future.ww[:-1], window.future.w[:-1]
    if window.from_start(window.begin, True):  # V answers what has been there from t = 0 on
        V, J, s = window.evidence.filter.sensitivity(window.replay.states[0]), J.copy(), s.copy()
        passed = V.T @ window.future.vw[0]
        J[0] += V.T @ window.future.vv[0] @ V + passed + passed.T
        s[0] += V.T @ window.future.v[0]
    D = np.einsum("dii->di", J)
    count = len(onset_interval)
    return FirstOrderScan(
        onset_interval, np.zeros(count), np.zeros(count, bool), _energy(window, D, s, np.ones(count), 0.0), D, s, J
    )


def _scan_drifts(window: ReplayWindow, last: int, tau: float | None = None) -> FirstOrderScan:
    """Rises without end from all onsets up to the last, or those that bend to their end within ``tau``."""
    D, s = (window.future.rr, window.future.r) if tau is None else window.exponential_rises(tau)
    onset_interval = np.arange(window.begin, last + 1)
    since, count = window.end - onset_interval, len(onset_interval)
    rise, reach = (np.inf, since) if tau is None else (tau, -np.expm1(-since / tau))
    D, s = D[:count], s[:count]
    return FirstOrderScan(
        onset_interval,
        np.full(count, rise),
        np.full(count, tau is not None),
        _energy(window, D, s, reach, rise),
        D,
        s,
        np.empty(0),
    )


def _scan_ramps(window: ReplayWindow, spans: list[tuple[int, int]]) -> FirstOrderScan:
    """Rises of all channels from the first to the second decision of each span."""
    onset_interval, stops = (sorted({span[k] for span in spans}) for k in (0, 1))
    seen = window.run_drifts(onset_interval, np.array(stops))
    lane, stop = np.array([onset_interval.index(a) for a, _ in spans]), np.array([stops.index(b) for _, b in spans])
    a, b = np.array(spans).T
    rise = (b - a)[:, None] * 1.0
    V = window.evidence.filter.sensitivity(seen.states[lane, stop])
    D, s = window.future.after(b - window.begin, V, np.broadcast_to(rise, (len(a), V.shape[2])))
    D, s = (D + np.einsum("kpp->kp", seen.J[lane, stop])) / rise**2, (s + seen.s[lane, stop]) / rise
    return FirstOrderScan(
        a, b - a * 1.0, np.zeros(len(a), bool), _energy(window, D, s, np.ones(len(a)), 1.0), D, s, np.empty(0)
    )


def _energy(window: ReplayWindow, D: np.ndarray, s: np.ndarray, reach: np.ndarray, rise: float) -> np.ndarray:
    """The energy explained in units of noise, less what is asked; ``reach``: how far a course of size 1 has come."""
    reach = reach[:, None]
    return explained(D / reach**2, s / reach, window.bounds) / window.noise_unit - shape_penalty(rise)


def onset_interval(window: ReplayWindow, event: Event) -> tuple[float, float]:
    """The earliest and latest decision at which an event may have begun (95 %).

    Twice the log of the likelihood falls short of its largest value by more than x with probability 1 − (1 − exp(−x/2))²: the
    largest values of two random walks, one to each side (Siegmund, Ann. Statist. 16(4), 1988).
    """
    if event.is_ramp:
        away = np.union1d(np.arange(1, _DENSE), lengths(max(window.end - window.begin, 1)))
        last = max(window.end - int(event.rise_time), window.begin)
        looked = np.unique(
            np.clip(
                np.concatenate([event.onset_decision - away, [event.onset_decision], event.onset_decision + away]),
                window.begin,
                last,
            )
        )
        found = _scan_ramps(window, [(int(o), min(int(o + event.rise_time), window.end)) for o in looked])
    else:
        found = (
            _scan_drifts(window, window.end - 1, event.rise_time if event.exponential else None)
            if event.rise_time
            else _scan_steps(window)
        )
        looked = found.onsets
    energy = found.energy[:, event.channel]
    fine = np.arange(looked[0], looked[-1] + 1)
    inside = fine[np.interp(fine, looked, energy) >= energy.max() - ONSET_DROP]
    return min(float(inside[0]), event.onset), max(float(inside[-1]), event.onset)


def shape_penalty(rise: float) -> float:
    """What a course has to explain more than a step."""
    return RISE_PENALTY * (rise > 0) * (1.5 if rise < np.inf else 1.0)
