"""A stretch of data with what is known of it, over which the filter can be run again under other assumptions."""

from dataclasses import dataclass

import numpy as np

from backend.diagnosis.ahead import Ahead
from backend.diagnosis.pauses import once
from backend.diagnosis.standing import Event, Known, Look, Replay
from backend.diagnosis.supposing import Courses, Supposed
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

        state, change = look.state(begin), np.zeros(len(base.level))
        if begin == look.calibrated.begin:
            for e in fixed:  # see `first`
                change[e.channel] += e.size * (e.onset == begin and not e.rise)
            state = look.filter.moved(state, change) if change.any() else state
        return cls(look, base, fixed, begin, at, heed, look.replay(state, begin, at, known, heed, False))

    def known(self, d: np.ndarray) -> np.ndarray:
        """What is known of θ at times ``d`` (in decisions): times × p."""
        return _course(self.base, self.fixed, d)

    @once
    def _handed(self) -> np.ndarray:
        return self.look.handed(self.track.states[0], self.begin, self.at, self.known, self.heed)

    @once
    def ahead(self) -> Ahead:
        """The evidence still to come at each decision from ``begin`` to ``at``."""
        return self.look.backwards.ahead(self._handed, self.heed, self.look.rows)

    def bending(self, tau: float) -> tuple[np.ndarray, np.ndarray]:
        """D and s (decisions × p) of rises that bend to their end within ``tau`` decisions."""
        return self.look.backwards.bending(self._handed, self.heed, self.look.rows, tau)

    def first(self, onset: int, abrupt: bool) -> bool:
        """Whether what begins there is taken to have been there from t = 0 on: where watching begins, if it is ``abrupt``."""
        return onset == self.look.calibrated.begin and abrupt

    def supposing(self, tries: list[tuple[Event, ...]], size: np.ndarray) -> Supposed:
        """The filter from the onset of each try on, as if its events were so, of sizes ``size`` (tries × events); Ω answers them, and
        constants in other channels."""
        onset = np.array([min(e.first for e in events) for events in tries])
        p, count, start = len(self.base.level), len(tries), min(int(onset.min()), self.at - 1)
        told = np.empty((count, p, 7))
        told[:] = np.stack([onset, *(np.full(count, v) for v in (*Event(0, 0).form, 0.0))], axis=1)[:, None]
        told[np.arange(count)[:, None], [[e.channel for e in events] for events in tries]] = [
            [(e.onset, *e.form, v) for e, v in zip(events, sizes, strict=True)] for events, sizes in zip(tries, size, strict=True)]  # fmt: skip
        states = np.repeat(self.look.filter.unanswered(self.track.states[start - self.begin])[None], count, axis=0)
        for k, events in enumerate(tries):
            if onset[k] == start and self.first(start, not any(e.rise for e in events)):
                change = np.zeros(p)
                for e, v in zip(events, size[k], strict=True):
                    change[e.channel] += v * (e.onset == start)
                states[k] = self.look.filter.moved(self.track.states[start - self.begin], change)
        return self._suppose(states, start, told, onset, np.array([self.at - start]))

    def rising(self, onsets: list[int], stops: np.ndarray) -> Supposed:
        """The filter with Ω answering rises without end, of one a decision, from ``onsets`` on in all channels; at decisions ``stops``."""
        p, count, start = len(self.base.level), len(onsets), min(onsets)
        told = np.empty((count, p, 7))
        told[:, :, 0], told[:, :, 1:] = np.array(onsets, dtype=float)[:, None], (*Event(0, 0, np.inf).form, 0.0)
        states = np.repeat(self.look.filter.unanswered(self.track.states[start - self.begin])[None], count, axis=0)
        return self._suppose(states, start, told, np.array(onsets), stops - start)

    def _suppose(self, states: np.ndarray, start: int, told: np.ndarray, onset: np.ndarray, stops: np.ndarray) -> Supposed:
        cal = self.look.calibrated
        told[:, :, 5] = np.exp(-told[:, :, 5] / self.look.rows)
        courses = Courses(*np.moveaxis(told, 2, 0), cal.within.low, cal.within.high, onset * 1.0, onset + 2.0 * cal.settle)
        return self.look.suppose(states, start, self.known, courses, self.heed, stops)

    def unheeded(self, onset: int, heed: np.ndarray) -> Replay:
        """The filter from an onset on, following other outputs."""
        return self.look.replay(self.track.states[onset - self.begin], onset, self.at, self.known, heed, not self.first(onset, True))

    @once
    def energy(self) -> np.ndarray:
        """Of the outputs heeded, from the beginning to each decision."""
        return self.track.energy

    def expected(self, length: int, heed: np.ndarray | None = None) -> tuple[float, float]:
        """Energy that noise has over so many decisions, and its standard deviation."""
        noise = self.look.calibrated.noise
        k = int(noise.nearest(length))
        share = float(np.mean(self.heed if heed is None else heed)) * length / noise.lengths[k]
        return float(noise.energy[k]) * share, float(noise.scatter[k]) * share**0.5

    @once
    def unit(self) -> float:
        """Energy of one number that noise is."""
        numbers = (self.at - self.begin) * self.look.rows * float(self.heed.sum())
        return max(self.expected(self.at - self.begin)[0], 1e-300) / max(numbers, 1.0)

    @once
    def within(self) -> Range:
        """Bounds of what θ may be besides what is known at the end."""
        return self.look.calibrated.within.given(self.known(np.array([float(self.at)]))[0])


def _course(base: Known, events: tuple[Event, ...], d: np.ndarray) -> np.ndarray:
    values = base.course(d)
    for e in events:
        values[:, e.channel] += e.size * e.course(d)
    return values
