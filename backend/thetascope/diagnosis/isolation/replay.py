"""A stretch of data with what is known of it, over which the filter can be run again under other assumptions."""

from dataclasses import dataclass

import numpy as np

from thetascope.diagnosis.detection.window_tests import Range
from thetascope.diagnosis.isolation.decision_state import Event, Known, Look
from thetascope.diagnosis.residuals.backward_pass import Ahead
from thetascope.diagnosis.residuals.filter_bank import Courses, Supposed
from thetascope.diagnosis.residuals.segment import Replay, Stretch
from thetascope.diagnosis.yield_points import once
from thetascope.engine.estimation.hypothesis_bank import COURSE

_FADE = COURSE.index("fade")


@dataclass(frozen=True)
class Scene:
    """The data between decisions ``begin`` and ``at`` given what is known; ``track``: the filter along them."""

    look: Look
    base: Known
    fixed: tuple[Event, ...]
    begin: int
    at: int
    heed: np.ndarray
    stretch: Stretch
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
        stretch = look.stretch(begin, at, known)
        return cls(look, base, fixed, begin, at, heed, stretch, stretch.replay(state, begin, heed, False))

    @once
    def _handed(self) -> np.ndarray:
        return self.stretch.handed(self.track.states[0], self.heed)

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
        told = self._told(onset, p, Event(0, 0))
        for k, events in enumerate(tries):
            for e, v in zip(events, size[k], strict=True):
                told[k, e.channel] = (e.onset, *e.form, v)
        states = np.repeat(self.look.filter.unanswered(self.track.states[start - self.begin])[None], count, axis=0)
        for k, events in enumerate(tries if start == self.look.calibrated.begin else ()):
            if onset[k] == start and self.first(start, not any(e.rise for e in events)):
                change = np.zeros(p)
                for e, v in zip(events, size[k], strict=True):
                    change[e.channel] += v * (e.onset == start)
                states[k] = self.look.filter.moved(self.track.states[start - self.begin], change)
        return self._suppose(states, start, told, onset, np.array([self.at - start]))

    def rising(self, onsets: list[int], stops: np.ndarray) -> Supposed:
        """The filter with Ω answering rises without end, of one a decision, from ``onsets`` on in all channels; at decisions ``stops``."""
        p, count, start = len(self.base.level), len(onsets), min(onsets)
        told = self._told(np.array(onsets), p, Event(0, 0, np.inf))
        states = np.repeat(self.look.filter.unanswered(self.track.states[start - self.begin])[None], count, axis=0)
        return self._suppose(states, start, told, np.array(onsets), stops - start)

    def _told(self, onset: np.ndarray, channels: int, shape: Event) -> np.ndarray:
        """The same course of size 0 from each onset on in all channels: suppositions × channels × numbers."""
        told = np.empty((len(onset), channels, len(COURSE)))
        told[:], told[:, :, 0] = (0.0, *shape.form, 0.0), onset[:, None]
        return told

    def _suppose(
        self, states: np.ndarray, start: int, told: np.ndarray, onset: np.ndarray, stops: np.ndarray
    ) -> Supposed:
        cal = self.look.calibrated
        told[:, :, _FADE] = np.exp(-told[:, :, _FADE] / self.look.rows)
        courses = Courses(told, cal.within.low, cal.within.high, onset * 1.0, onset + 2.0 * cal.settle)
        return self.stretch.suppose(states, start, courses, self.heed, stops)

    def unheeded(self, onset: int, heed: np.ndarray) -> Replay:
        """The filter from an onset on, following other outputs."""
        return self.stretch.replay(self.track.states[onset - self.begin], onset, heed, not self.first(onset, True))

    @once
    def energy(self) -> np.ndarray:
        """Of the outputs heeded, from the beginning to each decision."""
        return self.track.energy

    def expected(self, length: int, heed: np.ndarray | None = None) -> tuple[float, float]:
        """Energy that noise has over so many decisions, and its standard deviation."""
        return self.look.calibrated.noise.expected(length, self.heed if heed is None else heed)

    @once
    def unit(self) -> float:
        """Energy of one number that noise is."""
        numbers = (self.at - self.begin) * self.look.rows * float(self.heed.sum())
        return max(self.expected(self.at - self.begin)[0], 1e-300) / max(numbers, 1.0)

    @once
    def within(self) -> Range:
        """Bounds of what θ may be besides what is known at the end."""
        return self.look.calibrated.within.given(_course(self.base, self.fixed, np.array([float(self.at)]))[0])


def _course(base: Known, events: tuple[Event, ...], d: np.ndarray) -> np.ndarray:
    values = base.course(d)
    for e in events:
        values[:, e.channel] += e.size * e.course(d)
    return values
