"""A stretch of data with what is known of it, over which the filter can be run again under other assumptions."""

from dataclasses import dataclass

import numpy as np

from backend.diagnosis.standing import Event, Known, Look, Replay
from backend.diagnosis.windows import Range


@dataclass(frozen=True)
class Scene:
    """The data between decisions ``begin`` and ``at`` given what is known; ``track``: the filter along them."""

    look: Look
    base: Known
    fixed: tuple[Event, ...]
    begin: int
    at: int
    heed: np.ndarray
    track: Replay

    @classmethod
    def of(cls, look: Look, base: Known, fixed: tuple[Event, ...], begin: int, at: int, heed: np.ndarray) -> "Scene":
        def known(d):
            return _course(base, fixed, d)

        return cls(look, base, fixed, begin, at, heed, look.replay(look.state(begin), begin, at, known, None, heed, False))

    def run(self, onset: int, events: tuple[Event, ...], profile, heed: np.ndarray | None = None, abrupt: bool = True) -> Replay:
        """The filter from an onset on, as if the events were so; Ω answers the profile.

        Where watching begins, what begins there is taken to have been there from t = 0 on, if it is ``abrupt``.
        """
        first = onset == self.look.calibrated.begin and abrupt

        def known(d):
            return _course(self.base, (*self.fixed, *events), d)

        state = self.track.states[onset - self.begin]
        if first:
            change = np.zeros(len(self.base.level))
            for e in events:
                change[e.channel] += e.size * (e.onset == onset)
            state = self.look.moved(state, change)
        return self.look.replay(state, onset, self.at, known, profile, self.heed if heed is None else heed, not first)

    def spent(self, onset: int) -> float:
        """Energy before an onset."""
        return float(self.track.energy[onset - self.begin])

    def expected(self, length: int, heed: np.ndarray | None = None) -> tuple[float, float]:
        """Energy that noise has over so many decisions, and its standard deviation."""
        noise = self.look.calibrated.noise
        k = int(noise.nearest(length))
        share = float(np.mean(self.heed if heed is None else heed)) * length / noise.lengths[k]
        return float(noise.energy[k]) * share, float(noise.scatter[k]) * share**0.5

    def unit(self, length: int) -> float:
        """Energy of one number that noise is."""
        numbers = length * self.look.rows * float(self.heed.sum())
        return max(self.expected(length)[0], 1e-300) / max(numbers, 1.0)


def _course(base: Known, events: tuple[Event, ...], d: np.ndarray) -> np.ndarray:
    values = base.course(d)
    for e in events:
        values[:, e.channel] += e.size * e.course(d)
    return values


def within(scene: Scene) -> Range:
    """Bounds of what θ may be besides what is known at the end."""
    return scene.look.calibrated.within.given(_course(scene.base, scene.fixed, np.array([float(scene.at)]))[0])
