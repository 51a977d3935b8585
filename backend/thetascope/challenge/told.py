"""What could be told of a fault, and when: how well every other explanation fits the noise-free readings.

A rival is a channel with its best size, onset and course (sudden or a ramp). Until a time it differs from the truth by
D standard deviations of the noise, D² = Σ (y − y_rival)²/σ² over the readings so far. No test of these readings
separates the two better. D never falls with time, and neither does the least D over all rivals of a channel.
"""

import numpy as np

from thetascope import library
from thetascope.challenge.experiments import setup_plant, sizes_of
from thetascope.challenge.signatures import Signatures, signatures_of
from thetascope_schemas.service.learning.challenge import NO_FAULT, ChallengeTruth, HiddenFault, Rival
from thetascope_schemas.service.learning.mystery import MysterySetup, Suspect

TOLD, FAIR = 5.0, 3.0
"""Standard deviations from which an explanation is excluded, and from which it may fairly be left out."""
_NEAR, _WIDENING = 6, 1.25  # rows about the true onset that are all tried; farther onsets spread by this factor
_PLACES = 24  # sizes in each direction from which the best is refined
_REFINEMENTS = 4
_SEEN = 60  # times at which the distance from no fault is kept


def truth_of(id: str, program: int, fault: HiddenFault | None) -> ChallengeTruth:
    """Return the truth of a challenge with all that could be told of it. Takes about a second of processor time."""
    setup = library.mysteries()[id]
    if fault is None:
        return ChallengeTruth(fault=None, end=setup.horizon)
    signatures = signatures_of(id, program)
    none, target = signatures.outputs_with([None, fault])
    from_none = np.cumsum(((target - none) ** 2).sum(1))
    rivals = [_rival(NO_FAULT, from_none, signatures.t)]
    plant = setup_plant(id)
    for suspect in setup.suspects:
        if suspect.channel != fault.channel:
            search = _Search(setup, suspect, sizes_of(plant, suspect), signatures, none, target)
            rivals.append(_rival(suspect.channel, search.least(fault.onset), signatures.t))
    places = np.unique(np.linspace(0, len(signatures.t) - 1, _SEEN).astype(int))
    seen = tuple((float(signatures.t[i]), round(float(np.sqrt(from_none[i])), 2)) for i in places)
    return ChallengeTruth(fault=fault, end=setup.horizon, rivals=tuple(rivals), seen=seen)


def deviations_at_end(id: str, program: int, fault: HiddenFault) -> float:
    """Return how many deviations of the noise separate a fault from no fault at the end of the record."""
    none, target = signatures_of(id, program).outputs_with([None, fault])
    return float(np.sqrt(((target - none) ** 2).sum()))


def _rival(channel: str, squares: np.ndarray, t: np.ndarray) -> Rival:
    def since(limit: float) -> float | None:
        beyond = squares >= limit**2
        return float(t[int(np.argmax(beyond))]) if beyond.any() else None

    return Rival(channel=channel, fair_until=since(FAIR), until=since(TOLD))


class _Search:
    """The fits of one rival channel to the readings, over its courses, onsets and sizes."""

    def __init__(
        self,
        setup: MysterySetup,
        suspect: Suspect,
        sizes: tuple[float, float],
        signatures: Signatures,
        none: np.ndarray,
        target: np.ndarray,
    ):
        self.setup, self.suspect, self.signatures, self.none = setup, suspect, signatures, none
        self.ends = [size for size in sizes if size != 0]
        self.residual = target - none
        self.tried: set[int] = set()

    def least(self, onset: float) -> np.ndarray:
        """Return the least D² up to each row (rows,); `onset`: of the true fault, about which more onsets are tried."""
        rows, true = len(self.signatures.t), round(onset / self.setup.record)
        least, best = self._over(_onsets(true, rows))
        for _ in range(2):  # finer about the onsets that fit best when it is decided, and at the end
            decided = min(int(np.searchsorted(least, TOLD**2)), rows - 1)
            around = {int(best[place]) + k for place in (decided, rows - 1) for k in range(-4, 5)}
            more, where = self._over(sorted(k for k in around if 0 <= k < rows - 1))
            best = np.where(more < least, where, best)
            least = np.minimum(least, more)
        return least

    def _over(self, onsets: list[int]) -> tuple[np.ndarray, np.ndarray]:
        """Return the least D² (rows,) over onsets that were not tried yet, and the row of the onset that has it."""
        rows = len(self.signatures.t)
        least, best = np.full(rows, np.inf), np.zeros(rows, dtype=int)
        onsets = [k for k in onsets if k not in self.tried]
        self.tried.update(onsets)
        if not onsets:
            return least, best
        for duration in (None, self.setup.ramp):
            for end in self.ends:
                squares = self._fits(onsets, duration, end)
                lowest = squares.min(0)
                best = np.where(lowest < least, np.array(onsets)[squares.argmin(0)], best)
                least = np.minimum(least, lowest)
        return least, best

    def _fits(self, onsets: list[int], duration: float | None, end: float) -> np.ndarray:
        """Return the least D² (onsets, rows) over sizes from 0 to `end`, through readings that are quadratic in it."""
        faults = [self._fault(k, duration, size) for k in onsets for size in (end / 2, end)]
        readings = self.signatures.outputs_with(faults) - self.none
        half, whole = readings[0::2], readings[1::2]
        p, q = 4 * half - whole, 2 * (whole - 2 * half)  # readings p s + q s² for s = size/end

        def sums(a: np.ndarray, b: np.ndarray) -> np.ndarray:
            return np.cumsum(np.einsum("...rm,...rm->...r", a, b), axis=-1)

        rr, rp, rq = sums(self.residual, self.residual), sums(self.residual, p), sums(self.residual, q)
        pp, pq, qq = sums(p, p), sums(p, q), sums(q, q)
        powers = (rr, -2 * rp, pp - 2 * rq, 2 * pq, qq)

        def value(s: np.ndarray | float) -> np.ndarray:
            return powers[0] + s * (powers[1] + s * (powers[2] + s * (powers[3] + s * powers[4])))

        s, least = np.zeros_like(pp), np.broadcast_to(rr, pp.shape).copy()
        for place in np.linspace(0, 1, _PLACES + 1)[1:]:
            at = value(place)
            s, least = np.where(at < least, place, s), np.minimum(at, least)
        for _ in range(_REFINEMENTS):
            slope = powers[1] + s * (2 * powers[2] + s * (3 * powers[3] + 4 * s * powers[4]))
            bend = 2 * powers[2] + s * (6 * powers[3] + 12 * s * powers[4])
            s = np.clip(s - np.where(bend > 0, slope / np.where(bend > 0, bend, 1.0), 0.0), 0.0, 1.0)
        return np.maximum(np.minimum(value(s), least), 0.0)

    def _fault(self, row: int, duration: float | None, size: float) -> HiddenFault:
        shape = "step" if duration is None else "ramp"
        onset = row * self.setup.record
        return HiddenFault(channel=self.suspect.channel, shape=shape, onset=onset, size=size, duration=duration)


def _onsets(true: int, rows: int) -> list[int]:
    """Return rows at which a rival may begin: all near the true onset, fewer farther away."""
    offsets, step = list(range(_NEAR + 1)), float(_NEAR)
    while step < rows:
        step *= _WIDENING
        offsets.append(round(step))
    return sorted({k for d in offsets for k in (true - d, true + d) if 0 <= k < rows - 1})
