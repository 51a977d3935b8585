"""A stretch of data with what is known of it, over which the filter can be run again under other assumptions."""

from dataclasses import dataclass

import numpy as np

from thetascope.diagnosis.detection.window_tests import ThetaBounds
from thetascope.diagnosis.isolation.decision_state import Event, Evidence, KnownTheta
from thetascope.diagnosis.residuals.backward_pass import FutureInformation
from thetascope.diagnosis.residuals.filter_bank import BankResult, HypothesisCourses
from thetascope.diagnosis.residuals.segment import ReplayResult, Segment
from thetascope.diagnosis.yield_points import once
from thetascope.engine.estimation.hypothesis_bank import COURSE

_FADE = COURSE.index("fade")


@dataclass(frozen=True)
class ReplayWindow:
    """The data between decisions ``begin`` and ``end`` given what is known; ``replay``: the filter along them."""

    evidence: Evidence
    base: KnownTheta
    fixed: tuple[Event, ...]
    begin: int
    end: int
    trusted_outputs: np.ndarray
    segment: Segment
    replay: ReplayResult

    @classmethod
    def of(
        cls,
        evidence: Evidence,
        base: KnownTheta,
        fixed: tuple[Event, ...],
        begin: int,
        end: int,
        trusted_outputs: np.ndarray,
    ) -> "ReplayWindow":
        def known(d):
            return _course(base, fixed, d)

        state, change = evidence.filter_state(begin), np.zeros(len(base.level))
        if begin == evidence.thresholds.begin:
            for e in fixed:  # see `from_start`
                change[e.channel] += e.size * (e.onset == begin and not e.rise_time)
            state = evidence.filter.shifted(state, change) if change.any() else state
        segment = evidence.segment(begin, end, known)
        return cls(
            evidence,
            base,
            fixed,
            begin,
            end,
            trusted_outputs,
            segment,
            segment.replay(state, begin, trusted_outputs, False),
        )

    @once
    def _backward_inputs(self) -> np.ndarray:
        return self.segment.backward_inputs(self.replay.states[0], self.trusted_outputs)

    @once
    def future(self) -> FutureInformation:
        """The evidence still to come at each decision from ``begin`` to ``end``."""
        return self.evidence.backward_pass.future_information(
            self._backward_inputs, self.trusted_outputs, self.evidence.rows_per_decision
        )

    def exponential_rises(self, tau: float) -> tuple[np.ndarray, np.ndarray]:
        """D and s (decisions × p) of rises that bend to their end within ``tau`` decisions."""
        return self.evidence.backward_pass.exponential_rises(
            self._backward_inputs, self.trusted_outputs, self.evidence.rows_per_decision, tau
        )

    def from_start(self, onset: int, abrupt: bool) -> bool:
        """Whether what begins there is taken to have been there from t = 0 on: where watching begins, if it is ``abrupt``."""
        return onset == self.evidence.thresholds.begin and abrupt

    def run_bank(self, tries: list[tuple[Event, ...]], size: np.ndarray) -> BankResult:
        """The filter from the onset of each try on, as if its events were so, of sizes ``size`` (tries × events); Ω answers them, and
        constants in other channels."""
        onset = np.array([min(e.onset_decision for e in events) for events in tries])
        p, count, start = len(self.base.level), len(tries), min(int(onset.min()), self.end - 1)
        told = self._uniform_courses(onset, p, Event(0, 0))
        for k, events in enumerate(tries):
            for e, v in zip(events, size[k], strict=True):
                told[k, e.channel] = (e.onset, *e.course_parameters, v)
        states = np.repeat(
            self.evidence.filter.without_sensitivity(self.replay.states[start - self.begin])[None], count, axis=0
        )
        for k, events in enumerate(tries if start == self.evidence.thresholds.begin else ()):
            if onset[k] == start and self.from_start(start, not any(e.rise_time for e in events)):
                change = np.zeros(p)
                for e, v in zip(events, size[k], strict=True):
                    change[e.channel] += v * (e.onset == start)
                states[k] = self.evidence.filter.shifted(self.replay.states[start - self.begin], change)
        return self._run_bank(states, start, told, onset, np.array([self.end - start]))

    def run_drifts(self, onsets: list[int], stops: np.ndarray) -> BankResult:
        """The filter with Ω answering rises without end, of one a decision, from ``onsets`` on in all channels; at decisions ``stops``."""
        p, count, start = len(self.base.level), len(onsets), min(onsets)
        told = self._uniform_courses(np.array(onsets), p, Event(0, 0, np.inf))
        states = np.repeat(
            self.evidence.filter.without_sensitivity(self.replay.states[start - self.begin])[None], count, axis=0
        )
        return self._run_bank(states, start, told, np.array(onsets), stops - start)

    def _uniform_courses(self, onset: np.ndarray, channels: int, shape: Event) -> np.ndarray:
        """The same course of size 0 from each onset on in all channels: suppositions × channels × numbers."""
        told = np.empty((len(onset), channels, len(COURSE)))
        told[:], told[:, :, 0] = (0.0, *shape.course_parameters, 0.0), onset[:, None]
        return told

    def _run_bank(
        self, states: np.ndarray, start: int, told: np.ndarray, onset: np.ndarray, stops: np.ndarray
    ) -> BankResult:
        cal = self.evidence.thresholds
        told[:, :, _FADE] = np.exp(-told[:, :, _FADE] / self.evidence.rows_per_decision)
        courses = HypothesisCourses(told, cal.bounds.low, cal.bounds.high, onset * 1.0, onset + 2.0 * cal.settle)
        return self.segment.run_bank(states, start, courses, self.trusted_outputs, stops)

    def replay_trusting(self, onset: int, trusted_outputs: np.ndarray) -> ReplayResult:
        """The filter from an onset on, following other outputs."""
        return self.segment.replay(
            self.replay.states[onset - self.begin], onset, trusted_outputs, not self.from_start(onset, True)
        )

    @once
    def energy(self) -> np.ndarray:
        """Of the outputs heeded, from the beginning to each decision."""
        return self.replay.energy

    def expected_energy(self, length: int, trusted_outputs: np.ndarray | None = None) -> tuple[float, float]:
        """Energy that noise has over so many decisions, and its standard deviation."""
        return self.evidence.thresholds.noise.expected_energy(
            length, self.trusted_outputs if trusted_outputs is None else trusted_outputs
        )

    @once
    def noise_unit(self) -> float:
        """Energy of one number that noise is."""
        numbers = (self.end - self.begin) * self.evidence.rows_per_decision * float(self.trusted_outputs.sum())
        return max(self.expected_energy(self.end - self.begin)[0], 1e-300) / max(numbers, 1.0)

    @once
    def bounds(self) -> ThetaBounds:
        """Bounds of what θ may be besides what is known at the end."""
        return self.evidence.thresholds.bounds.relative_to(
            _course(self.base, self.fixed, np.array([float(self.end)]))[0]
        )


def _course(base: KnownTheta, events: tuple[Event, ...], d: np.ndarray) -> np.ndarray:
    values = base.course(d)
    for e in events:
        values[:, e.channel] += e.size * e.course(d)
    return values
