"""A window of data with the faults known in it, over which the filter is run again under other hypotheses."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from thetascope.diagnosis.detection.window_tests import ThetaBounds
from thetascope.diagnosis.isolation.decision_state import Event, Evidence, KnownTheta
from thetascope.diagnosis.residuals.backward_pass import FutureInformation
from thetascope.diagnosis.residuals.filter_bank import BankResult, HypothesisCourses
from thetascope.diagnosis.residuals.scores import LinearisedFilter
from thetascope.diagnosis.residuals.segment import ReplayResult, Segment
from thetascope.engine.estimation.hypothesis_bank import COURSE

_FADE = COURSE.index("fade")


@dataclass(frozen=True)
class ReplayWindow:
    """The data between two decisions, given θ₀ = `base` and the events `fixed`.

    Attributes:
        evidence: thresholds, filter and data.
        base: θ₀ before the events.
        fixed: events that are taken as given.
        begin, end: the first and the last decision.
        trusted_outputs: (m,), the outputs that the filter uses.
        segment: the rows in between.
        replay: the filter along them.
    """

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
        """Return the window, the filter having been run over it."""

        def known(d: np.ndarray) -> np.ndarray:
            return _course(base, fixed, d)

        state, change = evidence.filter_state(begin), np.zeros(len(base.level))
        if begin == evidence.thresholds.begin:
            for e in fixed:  # see `is_initial`
                change[e.channel] += e.size * (e.onset == begin and not e.rise_time)
            state = evidence.filter.shifted(state, change) if change.any() else state
        segment = evidence.segment(begin, end, known)
        replay = segment.replay(state, begin, trusted_outputs, False)
        return cls(evidence, base, fixed, begin, end, trusted_outputs, segment, replay)

    @cached_property
    def _backward_inputs(self) -> np.ndarray:
        return self.segment.backward_inputs(self.replay.states[0], self.trusted_outputs)

    @cached_property
    def future(self) -> FutureInformation:
        """The information still to come at each decision from `begin` to `end`."""
        return self.evidence.backward_pass.future_information(
            self._backward_inputs, self.trusted_outputs, self.evidence.rows_per_decision
        )

    def exponential_rises(self, tau: float) -> tuple[np.ndarray, np.ndarray]:
        """Return D and s (decisions, p) of exponentials with time constant `tau` (decisions) from each decision on."""
        return self.evidence.backward_pass.exponential_rises(
            self._backward_inputs, self.trusted_outputs, self.evidence.rows_per_decision, tau
        )

    def is_initial(self, onset: int, abrupt: bool) -> bool:
        """Return whether an event is taken to have been present since t = 0: it is abrupt and begins where tests
        begin."""
        return onset == self.evidence.thresholds.begin and abrupt

    def run_bank(self, hypotheses: list[tuple[Event, ...]], size: np.ndarray) -> BankResult:
        """Run one filter per hypothesis from its onset to the end of the window.

        Args:
            hypotheses: events of each, all in different channels.
            size: (hypotheses, events), their sizes.

        Ω of a hypothesis is the response to its events in their channels and to constants in the others.
        """
        onset = np.array([min(e.onset_decision for e in events) for events in hypotheses])
        p, count, start = len(self.base.level), len(hypotheses), min(int(onset.min()), self.end - 1)
        courses = self._uniform_courses(onset, p, Event(0, 0))
        for k, events in enumerate(hypotheses):
            for e, value in zip(events, size[k], strict=True):
                courses[k, e.channel] = (e.onset, *e.course_parameters, value)
        first = self.replay.states[start - self.begin]
        states = np.repeat(self.evidence.filter.without_sensitivity(first)[None], count, axis=0)
        for k, events in enumerate(hypotheses if start == self.evidence.thresholds.begin else ()):
            if onset[k] == start and self.is_initial(start, not any(e.rise_time for e in events)):
                change = np.zeros(p)
                for e, value in zip(events, size[k], strict=True):
                    change[e.channel] += value * (e.onset == start)
                states[k] = self.evidence.filter.shifted(first, change)
        return self._run_courses(states, start, courses, onset, np.array([self.end - start]))

    def run_drifts(self, onsets: list[int], stops: np.ndarray) -> BankResult:
        """Run the bank with Ω the response to drifts of slope 1 per decision in every channel.

        Args:
            onsets: decisions at which they begin, one hypothesis each.
            stops: decisions at which results are returned.
        """
        p, count, start = len(self.base.level), len(onsets), min(onsets)
        courses = self._uniform_courses(np.array(onsets), p, Event(0, 0, np.inf))
        first = self.evidence.filter.without_sensitivity(self.replay.states[start - self.begin])
        return self._run_courses(np.repeat(first[None], count, axis=0), start, courses, np.array(onsets), stops - start)

    def _uniform_courses(self, onset: np.ndarray, channels: int, shape: Event) -> np.ndarray:
        """Return courses of one shape and size 0 from each onset on, in all channels: (hypotheses, channels,
        COURSE)."""
        courses = np.empty((len(onset), channels, len(COURSE)))
        courses[:], courses[:, :, 0] = (0.0, *shape.course_parameters, 0.0), onset[:, None]
        return courses

    def _run_courses(
        self, states: np.ndarray, start: int, courses: np.ndarray, onset: np.ndarray, stops: np.ndarray
    ) -> BankResult:
        thresholds = self.evidence.thresholds
        bounds, early_until = thresholds.bounds, onset + 2.0 * thresholds.settle
        courses[:, :, _FADE] = np.exp(-courses[:, :, _FADE] / self.evidence.rows_per_decision)
        hypotheses = HypothesisCourses(courses, bounds.low, bounds.high, onset * 1.0, early_until)
        return self.segment.run_bank(states, start, hypotheses, self.trusted_outputs, stops)

    def linearised(self, events: tuple[Event, ...]) -> LinearisedFilter:
        """Return the filter under a hypothesis, whose events are all in different channels."""
        change = np.zeros((len(self.times), len(self.base.level)))
        for e in events:
            change[:, e.channel] = e.size * e.course(self.times)
        return self.segment.linearised(self.replay.states[0], change, self.trusted_outputs)

    @property
    def times(self) -> np.ndarray:
        """The times (rows,) of all rows in decisions."""
        return self.segment.times

    def replay_trusting(self, onset: int, trusted_outputs: np.ndarray) -> ReplayResult:
        """Run the filter from `onset` to the end of the window with other trusted outputs."""
        fresh = not self.is_initial(onset, True)
        return self.segment.replay(self.replay.states[onset - self.begin], onset, trusted_outputs, fresh)

    @cached_property
    def energy(self) -> np.ndarray:
        """(decisions + 1,), the energy of the trusted outputs from `begin` to each decision."""
        return self.replay.energy

    def expected_energy(self, length: int, trusted_outputs: np.ndarray | None = None) -> tuple[float, float]:
        """Return mean and standard deviation of the energy of noise over `length` decisions."""
        trusted_outputs = self.trusted_outputs if trusted_outputs is None else trusted_outputs
        return self.evidence.thresholds.noise.expected_energy(length, trusted_outputs)

    @cached_property
    def noise_unit(self) -> float:
        """The mean energy of one number (one output in one row) of noise: the unit of `Explanation.energy`."""
        numbers = (self.end - self.begin) * self.evidence.rows_per_decision * float(self.trusted_outputs.sum())
        return max(self.expected_energy(self.end - self.begin)[0], 1e-300) / max(numbers, 1.0)

    @cached_property
    def bounds(self) -> ThetaBounds:
        """Bounds of further changes of θ: those of θ minus the known θ at the end."""
        present = _course(self.base, self.fixed, np.array([float(self.end)]))[0]
        return self.evidence.thresholds.bounds.relative_to(present)


def _course(base: KnownTheta, events: tuple[Event, ...], d: np.ndarray) -> np.ndarray:
    """Return θ₀ plus events (times, p) at times `d` in decisions."""
    values = base.course(d)
    for e in events:
        values[:, e.channel] += e.size * e.course(d)
    return values
