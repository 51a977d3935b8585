"""What each channel explains to first order, from every onset in question: what is worth being held against the data in full.

The filter is run from each onset with V = 0 there (Willsky & Jones 1976), for a step, for a rise without end and for one
with an end; J and s follow, and from them the energy that each channel explains.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from backend.diagnosis.scene import Scene, within
from backend.diagnosis.standing import Event
from backend.diagnosis.windows import explained, lengths

ONSET = -2 * float(np.log(1 - 0.95**0.5))  # onsets within this of the likeliest may be it, see `onsets`
RISE = 3.0  # what a rise has to explain more than a step; one with an end: half as much again
_LEADERS = 3  # channels whose onsets are looked at closely
_CLOSE = 9
_ENDS = 6  # decisions at which rises may begin or end
_SHORT = 8  # decisions within which a rise cannot be told from a step
_DENSE = 13  # decisions to each side of an onset that are all looked at


@dataclass(frozen=True)
class Case:
    """What each channel explains to first order, by onset and rise: entries × p, less what is asked of rises; J and s."""

    onsets: np.ndarray
    rises: np.ndarray
    energy: np.ndarray
    J: np.ndarray
    s: np.ndarray

    def joined(self, other: "Case") -> "Case":
        names = ("onsets", "rises", "energy", "J", "s")
        return Case(*(np.concatenate([getattr(self, n), getattr(other, n)]) for n in names))

    def best(self, channel: int) -> int:
        return int(self.energy[:, channel].argmax())

    def kinds(self, channel: int) -> list[int]:
        """The best entry of a channel for a step, for a rise without end, and for one with an end."""
        kinds = (self.rises == 0, self.rises == np.inf, (self.rises > 0) & np.isfinite(self.rises))
        return [int(np.flatnonzero(k)[self.energy[k, channel].argmax()]) for k in kinds if k.any()]


def case(scene: Scene, ended: bool) -> Case:
    """Onsets at first far apart, then close to where the leading channels have theirs. ``ended``: rises with an end, too."""
    coarse = np.unique(np.append(scene.at - lengths(scene.at - scene.begin), scene.begin))
    coarse = coarse[coarse < scene.at]
    found = _over(scene, [(o, 0.0) for o in coarse])
    long = coarse[coarse <= scene.at - max(2 * scene.look.calibrated.settle, _SHORT)]
    if len(long):
        found = found.joined(_over(scene, [(o, np.inf) for o in long]))
    if ended and len(long) > 2:
        middle = long[:: max(1, len(long) // _ENDS)]
        found = found.joined(_over(scene, [(a, float(b - a)) for a, b in combinations(middle, 2)]))
    close: dict[float, set[int]] = {}
    for channel in np.argsort(-found.energy.max(axis=0))[:_LEADERS]:
        entry = found.best(int(channel))
        place = int(np.searchsorted(coarse, found.onsets[entry]))
        low, high = coarse[max(place - 1, 0)], coarse[min(place + 1, len(coarse) - 1)]
        close.setdefault(float(found.rises[entry]), set()).update(np.linspace(low, high, _CLOSE).round().astype(int).tolist())
    fine = [(o, r) for r, onsets in close.items() for o in sorted(onsets - set(found.onsets[found.rises == r].tolist()))]
    return found.joined(_over(scene, fine)) if fine else found


def _over(scene: Scene, entries: list[tuple[int, float]]) -> Case:
    p, J, s = len(scene.base.level), [], []
    courses = [Event(0, int(onset), rise) for onset, rise in entries]
    for course in courses:
        answer = scene.run(course.onset, (), lambda d, c=course: np.repeat(c.course(d)[:, None], p, axis=1), abrupt=not course.rise)
        J.append(answer.J)
        s.append(answer.s)
    J, s = np.array(J).reshape(-1, p, p), np.array(s).reshape(-1, p)
    rises = np.array([r for _, r in entries])
    span = np.array([float(c.course(np.array(float(scene.at)))) for c in courses])[:, None]
    energy = explained(np.einsum("dii->di", J) / span**2, s / span, within(scene)) / scene.unit(scene.at - scene.begin)
    return Case(np.array([o for o, _ in entries]), rises, energy - asked(rises)[:, None], J, s)


def onsets(scene: Scene, event: Event) -> tuple[float, float]:
    """The earliest and latest decision at which an event may have begun (95 %).

    Twice the log of the likelihood falls short of its largest value by more than x with probability 1 − (1 − exp(−x/2))²: the
    largest values of two random walks, one to each side (Siegmund, Ann. Statist. 16(4), 1988).
    """
    away = np.union1d(np.arange(1, _DENSE), lengths(max(scene.at - scene.begin, 1)))
    last = max(scene.at - 1, event.first)
    looked = np.unique(np.clip(np.concatenate([event.first - away, [event.first], event.first + away]), scene.begin, last))
    energy = _over(scene, [(int(o), event.rise) for o in looked]).energy[:, event.channel]
    fine = np.arange(looked[0], looked[-1] + 1)
    inside = fine[np.interp(fine, looked, energy) >= energy.max() - ONSET]
    return min(float(inside[0]), event.onset), max(float(inside[-1]), event.onset)


def asked(rises: np.ndarray | float) -> np.ndarray:
    """What a course has to explain more than a step."""
    return RISE * (np.asarray(rises) > 0) * (1.0 + 0.5 * np.isfinite(rises))
