"""First-order scan: the energy that each channel explains, for every onset and several shapes.

J and s of a step and of a drift from any decision on, as if the filter had been started there with V = 0, follow from
one pass backwards in time (engine/estimation/backward_information.py); those of a ramp, from runs of the filter up to
where it ends. They give the energy that each channel explains. The best entries are then fitted in full
(likelihood_fit.py).
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from thetascope.diagnosis.detection.window_tests import explained, lengths
from thetascope.diagnosis.isolation.decision_state import Event
from thetascope.diagnosis.isolation.replay import ReplayWindow
from thetascope.diagnosis.yield_points import Steps

ONSET_DROP = -2 * float(
    np.log(1 - 0.95**0.5)
)  # drop of the energy that bounds the 95 % interval of an onset, see `onset_interval`
RISE_PENALTY = 3.0  # energy that a drift has to explain beyond a step; ramps and exponentials, half as much again
_LEADERS = 4  # channels whose ramps are scanned finely
_FINE = 9  # decisions that replace three in the fine scan
_SHORT = 8  # decisions within which a rise looks like a step
_DENSE = 13  # decisions on each side of an onset that are all evaluated


@dataclass(frozen=True)
class FirstOrderScan:
    """What each channel explains to first order, by entry (an onset and a shape). Steps come first.

    Attributes:
        onsets: (entries,), decisions.
        rise_times: (entries,), as in `Event`.
        exponential: (entries,), bool.
        energy: (entries, p), energy explained in units of noise, less the penalty of the shape.
        D, s: (entries, p), diagonal of J, and s, of a course of size 1.
        J: (steps, p, p), of the steps only.
    """

    onsets: np.ndarray
    rise_times: np.ndarray
    exponential: np.ndarray
    energy: np.ndarray
    D: np.ndarray
    s: np.ndarray
    J: np.ndarray

    def joined(self, other: "FirstOrderScan") -> "FirstOrderScan":
        """Return the entries of both; J is that of the first."""

        def both(name: str) -> np.ndarray:
            return np.concatenate([getattr(self, name), getattr(other, name)])

        return FirstOrderScan(
            both("onsets"), both("rise_times"), both("exponential"), both("energy"), both("D"), both("s"), self.J
        )

    def best(self, channel: int) -> int:
        """Return the entry that explains most for a channel."""
        return int(self.energy[:, channel].argmax())

    def best_by_shape(self, channel: int) -> list[int]:
        """Return a channel's best entry among steps, drifts, ramps and exponentials, where there are any."""
        bounded_rise = (self.rise_times > 0) & np.isfinite(self.rise_times)
        shapes = (
            self.rise_times == 0,
            self.rise_times == np.inf,
            bounded_rise & ~self.exponential,
            self.exponential,
        )
        return [int(np.flatnonzero(k)[self.energy[k, channel].argmax()]) for k in shapes if k.any()]


def first_order_scan(window: ReplayWindow, bounded_rises: bool) -> Steps[FirstOrderScan]:
    """Return the scan of a window over all onsets of steps and drifts.

    With `bounded_rises`, ramps and exponentials are scanned too: ramps on a coarse grid of onsets and ends, then finely
    near the best.
    """
    yield
    scan = _scan_steps(window)
    last = window.end - max(2 * window.evidence.thresholds.settle, _SHORT)
    if last >= window.begin:
        scan = scan.joined(_scan_drifts(window, last))
    coarse = np.unique(np.append(window.end - lengths(window.end - window.begin), window.begin))
    grid = coarse[coarse <= last]
    if not bounded_rises or len(grid) < 3:
        return scan
    yield
    ramps = _scan_ramps(window, [(int(a), int(b)) for a, b in combinations(grid, 2)])
    yield
    scan = scan.joined(ramps).joined(_scan_ramps(window, _fine_spans(ramps, grid)))
    taus = 2.0 ** np.arange(2, np.log2(window.end - window.begin))
    exponentials = []
    for tau in taus:
        yield
        exponentials.append(_scan_drifts(window, last, float(tau)))
    for tau in _refined_taus(taus, np.array([e.energy.max(axis=0) for e in exponentials])):
        yield
        exponentials.append(_scan_drifts(window, last, tau))
    for exponential in exponentials:
        scan = scan.joined(exponential)
    return scan


def _refined_taus(taus: np.ndarray, energy: np.ndarray) -> list[float]:
    """Return time constants at the maxima of parabolas through each leading channel's best energies (taus, p)."""
    refined = set()
    for channel in np.argsort(-energy.max(axis=0))[:_LEADERS]:
        k = int(energy[:, channel].argmax())
        if 0 < k < len(taus) - 1:
            before, best, after = energy[k - 1 : k + 2, channel]
            shift = 0.5 * (before - after) / min(before - 2 * best + after, -1e-300)
            refined.add(round(float(taus[k] * 2.0**shift), 1))
    return sorted(refined)


def _fine_spans(ramps: FirstOrderScan, grid: np.ndarray) -> list[tuple[int, int]]:
    """Return (begin, end) of ramps around the best of each leading channel, up to the neighbouring points of the
    grid."""
    spans = set()
    for channel in np.argsort(-ramps.energy.max(axis=0))[:_LEADERS]:
        entry = ramps.best(int(channel))
        onset = ramps.onsets[entry]
        begins, ends = (_around(grid, int(np.searchsorted(grid, d))) for d in (onset, onset + ramps.rise_times[entry]))
        spans |= {(a, b) for a in begins for b in ends if b > a}
    return sorted(spans)


def _around(grid: np.ndarray, place: int) -> list[int]:
    """Return decisions evenly spaced between the two neighbours of a grid point."""
    low, high = grid[max(place - 1, 0)], grid[min(place + 1, len(grid) - 1)]
    return np.unique(np.linspace(low, high, _FINE).round().astype(int)).tolist()


def _scan_steps(window: ReplayWindow) -> FirstOrderScan:
    """Scan steps at all decisions of a window."""
    onsets = np.arange(window.begin, window.end)
    J, s = window.future.ww[:-1], window.future.w[:-1]
    if window.is_initial(window.begin, True):  # V there is the response to faults present since t = 0
        V, J, s = window.evidence.filter.sensitivity(window.replay.states[0]), J.copy(), s.copy()
        cross = V.T @ window.future.vw[0]
        J[0] += V.T @ window.future.vv[0] @ V + cross + cross.T
        s[0] += V.T @ window.future.v[0]
    D = np.einsum("dii->di", J)
    count = len(onsets)
    energy = _energy(window, D, s, np.ones(count), 0.0)
    return FirstOrderScan(onsets, np.zeros(count), np.zeros(count, bool), energy, D, s, J)


def _scan_drifts(window: ReplayWindow, last: int, tau: float | None = None) -> FirstOrderScan:
    """Scan drifts at all decisions up to `last`, or exponentials of time constant `tau`."""
    D, s = (window.future.rr, window.future.r) if tau is None else window.exponential_rises(tau)
    onsets = np.arange(window.begin, last + 1)
    since, count = window.end - onsets, len(onsets)
    rise_time, reach = (np.inf, since) if tau is None else (tau, -np.expm1(-since / tau))
    D, s = D[:count], s[:count]
    energy = _energy(window, D, s, reach, rise_time)
    exponential = np.full(count, tau is not None)
    return FirstOrderScan(onsets, np.full(count, rise_time), exponential, energy, D, s, np.empty(0))


def _scan_ramps(window: ReplayWindow, spans: list[tuple[int, int]]) -> FirstOrderScan:
    """Scan ramps from the first to the second decision of each span, in all channels."""
    onsets, stops = (sorted({span[k] for span in spans}) for k in (0, 1))
    bank = window.run_drifts(onsets, np.array(stops))
    lane, stop = np.array([onsets.index(a) for a, _ in spans]), np.array([stops.index(b) for _, b in spans])
    a, b = np.array(spans).T
    rise_time = (b - a)[:, None] * 1.0
    V = window.evidence.filter.sensitivity(bank.states[lane, stop])
    D, s = window.future.after(b - window.begin, V, np.broadcast_to(rise_time, (len(a), V.shape[2])))
    D = (D + np.einsum("kpp->kp", bank.J[lane, stop])) / rise_time**2
    s = (s + bank.s[lane, stop]) / rise_time
    energy = _energy(window, D, s, np.ones(len(a)), 1.0)
    return FirstOrderScan(a, b - a * 1.0, np.zeros(len(a), bool), energy, D, s, np.empty(0))


def _energy(window: ReplayWindow, D: np.ndarray, s: np.ndarray, reach: np.ndarray, rise_time: float) -> np.ndarray:
    """Return the energy explained (entries, p) in units of noise, less the penalty; `reach`: the course of size 1 at
    the end."""
    reach = reach[:, None]
    return explained(D / reach**2, s / reach, window.bounds) / window.noise_unit - shape_penalty(rise_time)


def onset_interval(window: ReplayWindow, event: Event) -> tuple[float, float]:
    """Return the earliest and latest decision at which an event may have begun (95 %).

    Twice the log-likelihood is below its maximum by more than x with probability 1 − (1 − exp(−x/2))²: the maxima of
    two random walks, one to each side (Siegmund, Ann. Statist. 16(4), 1988).
    """
    if event.is_ramp:
        offsets = np.union1d(np.arange(1, _DENSE), lengths(max(window.end - window.begin, 1)))
        last = max(window.end - int(event.rise_time), window.begin)
        near = np.concatenate([event.onset_decision - offsets, [event.onset_decision], event.onset_decision + offsets])
        onsets = np.unique(np.clip(near, window.begin, last))
        scan = _scan_ramps(window, [(int(o), min(int(o + event.rise_time), window.end)) for o in onsets])
    elif event.rise_time:
        scan = _scan_drifts(window, window.end - 1, event.rise_time if event.exponential else None)
        onsets = scan.onsets
    else:
        scan = _scan_steps(window)
        onsets = scan.onsets
    energy = scan.energy[:, event.channel]
    all_onsets = np.arange(onsets[0], onsets[-1] + 1)
    inside = all_onsets[np.interp(all_onsets, onsets, energy) >= energy.max() - ONSET_DROP]
    return min(float(inside[0]), event.onset), max(float(inside[-1]), event.onset)


def shape_penalty(rise_time: float) -> float:
    """Return the energy that a shape has to explain beyond a step."""
    return RISE_PENALTY * (rise_time > 0) * (1.5 if rise_time < np.inf else 1.0)
