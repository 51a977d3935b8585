"""The values that decisions are made of: findings, fault events, known faults, and the state after a decision.

Everything here is immutable. Times are in decisions (blocks of rows, counted from t = 0) unless stated otherwise; p is
the number of fault channels, m the number of outputs.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from thetascope.diagnosis.detection.thresholds import Thresholds
from thetascope.diagnosis.detection.window_tests import ThetaBounds, WindowSums
from thetascope.diagnosis.residuals.backward_pass import BackwardPass
from thetascope.diagnosis.residuals.innovation_filter import InnovationFilter
from thetascope.diagnosis.residuals.segment import Segment

NEVER = 1 << 62  # a decision that is never reached


@dataclass(frozen=True)
class Finding:
    """A fault that was detected, as the data so far describe it. Times are decisions, sizes in the channel's unit.

    Attributes:
        raised_at: decision at which the alarm was raised.
        channel: index of the fault channel; None if no fault of the model explains the data.
        alternatives: other channels that explain the data equally well.
        onset, onset_from, onset_to: estimated onset and its 95 % interval.
        size, deviation: estimated size and its standard deviation.
        skew: how far the middle of the size's interval is from the size.
        statistic: value of the test statistic when the alarm was raised.
        output: index of the faulty output if `channel` is None.
        cleared: decision at which the fault was over; None while it is on.
        settled: (size, deviation, skew) at the last time without a recent change, which is reported once it is over.
        initial: (size, deviation) when the fault was first isolated.
    """

    raised_at: int
    channel: int | None
    alternatives: tuple[int, ...]
    onset: float
    onset_from: float
    onset_to: float
    size: float
    deviation: float
    statistic: float
    output: int | None = None
    cleared: int | None = None
    settled: tuple[float, float, float] | None = None
    initial: tuple[float, float] | None = None
    skew: float = 0.0


@dataclass(frozen=True)
class Event:
    """A change of θ in one channel. Its course u(d) for size 1, d decisions after the onset, is

    - a step: 1 (`rise_time` = 0),
    - a ramp: min(d / rise_time, 1) (0 < `rise_time` < ∞),
    - a drift: d, without end (`rise_time` = ∞; `size` is then the slope per decision),
    - an exponential: 1 − exp(−d / rise_time) (`exponential`).

    Attributes:
        channel: index of the fault channel.
        onset: decision of the onset; at a row, which may lie between two decisions.
        rise_time: see above, in decisions.
        size: factor of the course, in the channel's unit.
    """

    channel: int
    onset: float
    rise_time: float = 0.0
    size: float = 0.0
    exponential: bool = False

    @property
    def onset_decision(self) -> int:
        """The last decision at or before the onset."""
        return int(self.onset)

    @property
    def is_drift(self) -> bool:
        """Whether it rises without end."""
        return self.rise_time == np.inf

    @property
    def is_ramp(self) -> bool:
        """Whether it rises at a constant rate to an end."""
        return 0 < self.rise_time < np.inf and not self.exponential

    @property
    def shape_key(self) -> tuple[int, float, float, bool]:
        """Everything but the size. Two events of one channel may have the same onset."""
        return self.channel, self.onset, self.rise_time, self.exponential

    @property
    def course_parameters(self) -> tuple[float, float, float, float, float]:
        """(start, rate, top, bend, decay) of u(d) = min(start + rate·d, top) + bend·(1 − exp(−decay·d)), d in
        decisions."""
        if self.exponential:
            return 0.0, 0.0, np.inf, 1.0, 1.0 / self.rise_time
        if self.is_drift:
            return 0.0, 1.0, np.inf, 0.0, 0.0
        return (0.0, 1.0 / self.rise_time, 1.0, 0.0, 0.0) if self.rise_time else (1.0, 0.0, np.inf, 0.0, 0.0)

    def course(self, d: np.ndarray) -> np.ndarray:
        """Return the course for size 1 at times `d` (any shape, in decisions)."""
        start, rate, top, bend, decay = self.course_parameters
        since = np.asarray(d - self.onset)
        rising = np.minimum(start + rate * since, top) - bend * np.expm1(-decay * np.maximum(since, 0.0))
        return np.where(since >= 0, rising, 0.0)

    def is_over(self, decision: int) -> bool:
        """Return whether `KnownTheta` can represent the course from a decision on: no ramp is still rising."""
        return self.onset + (self.rise_time if self.is_ramp else 0.0) <= decision

    def unit_value(self, decision: float) -> float:
        """Return the course for size 1 at one decision."""
        start, rate, top, bend, decay = self.course_parameters
        since = decision - self.onset
        return min(start + rate * since, top) - bend * math.expm1(-decay * since) if since >= 0 else 0.0

    def at(self, decision: float) -> float:
        """Return the change of θ at one decision."""
        return self.size * self.unit_value(decision)


@dataclass(frozen=True)
class KnownTheta:
    """θ₀, the faults that are taken as known, as a function of time:

    θ₀(d) = level + slope (d − since) + asymptote (1 − exp(−decay_rate (d − since))).

    Attributes:
        level, slope, asymptote, decay_rate: (p,), per decision where they are rates.
        since: the decision to which `level` belongs.
    """

    level: np.ndarray
    slope: np.ndarray
    asymptote: np.ndarray
    decay_rate: np.ndarray
    since: float

    @classmethod
    def zero(cls, channels: int, since: float) -> "KnownTheta":
        """Return θ₀ = 0."""
        level, slope, asymptote, decay_rate = np.zeros((4, channels))
        return cls(level, slope, asymptote, decay_rate, since)

    def course(self, d: np.ndarray) -> np.ndarray:
        """Return θ₀ (times, p) at times `d` (times,) in decisions."""
        after = (d - self.since)[:, None]
        value = self.level + self.slope * after
        return value - self.asymptote * np.expm1(-self.decay_rate * after) if self.asymptote.any() else value

    def at(self, decision: float) -> np.ndarray:
        """Return θ₀ (p,) at one decision."""
        return self.course(np.array([decision]))[0]

    def within_bounds(self, bounds: ThetaBounds) -> "KnownTheta":
        """Return θ₀ clipped to bounds; a channel that would leave them stops moving."""
        level = np.clip(self.level, bounds.low, bounds.high)
        rate = self.slope + self.asymptote * self.decay_rate
        moves = (level == self.level) & ~((level <= bounds.low) & (rate < 0)) & ~((level >= bounds.high) & (rate > 0))
        return replace(self, level=level, slope=self.slope * moves, asymptote=self.asymptote * moves)

    def without(self, channels: list[int]) -> "KnownTheta":
        """Return θ₀ with zero in some channels."""
        level, slope, asymptote = self.level.copy(), self.slope.copy(), self.asymptote.copy()
        level[channels] = slope[channels] = asymptote[channels] = 0.0
        return replace(self, level=level, slope=slope, asymptote=asymptote)

    def plus(self, events: tuple[Event, ...], decision: float) -> "KnownTheta":
        """Return θ₀ from a decision on, with events added that began before it and satisfy `Event.is_over`."""
        level, slope, decay_rate = self.at(decision), self.slope.copy(), self.decay_rate.copy()
        asymptote = self.asymptote * np.exp(-self.decay_rate * (decision - self.since))
        for e in events:
            level[e.channel] += e.at(decision)
            slope[e.channel] += e.size * e.is_drift
            if e.exponential:
                asymptote[e.channel] += e.size - e.at(decision)
                decay_rate[e.channel] = 1.0 / e.rise_time
        return KnownTheta(level, slope, asymptote, decay_rate, decision)


@dataclass(frozen=True)
class TentativeEvent:
    """An event that may still be revised.

    Attributes:
        event: its current estimate.
        finding: index of the finding that it belongs to: a new one, or that of the fault it changes.
        own: whether that finding was raised for this event.
        options: `event` and the events that explain the data equally well.
    """

    event: Event
    finding: int
    own: bool
    options: tuple[Event, ...]

    @property
    def channels(self) -> set[int]:
        """The channels of its options."""
        return {o.channel for o in self.options}


@dataclass(frozen=True)
class TentativeEvents:
    """The latest events, which may still be revised, oldest first.

    Attributes:
        begin: decision from which on they are estimated.
        base: θ₀ before that decision.
        entries: the events.
        review_at: decision of their next review.
        settled: whether they are old enough to be left alone.
    """

    begin: int
    base: KnownTheta
    entries: tuple[TentativeEvent, ...]
    review_at: int
    settled: bool = False

    @property
    def events(self) -> tuple[Event, ...]:
        """The events alone."""
        return tuple(entry.event for entry in self.entries)


@dataclass(frozen=True)
class DecisionState:
    """The state of detection and isolation after decision `at`.

    Attributes:
        at: number of the latest decision.
        start: unexplained changes began at this decision or later.
        known: θ₀ that the filter takes as known.
        trusted_outputs: (m,), 1 for outputs that the filter uses, 0 for those it ignores.
        memory: number of decisions that `known` was estimated from.
        passed: windows under test begin at this decision or later, because an earlier change vanished again.
        detected: decision at which the change that is being isolated was detected; None: nothing is being isolated.
        next_attempt: decision of the next attempt at isolation.
        active: indices into `findings` of those that are on.
        findings: all findings, in the order in which they were raised.
        tentative: the latest events, while they may be revised.
        restart: how the filter has to be changed before it continues; None: it continues as it is.
    """

    at: int
    start: int
    known: KnownTheta
    trusted_outputs: np.ndarray
    memory: float = np.inf
    passed: int = 0
    detected: int | None = None
    next_attempt: int = 0
    active: tuple[int, ...] = ()
    findings: tuple[Finding, ...] = field(default=())
    tentative: TentativeEvents | None = None
    restart: "FilterRestart | None" = None

    @classmethod
    def initial(cls, thresholds: Thresholds, channels: int, outputs: int) -> "DecisionState":
        """Return the state before the first decision: no fault known, all outputs trusted."""
        return cls(thresholds.begin, thresholds.begin, KnownTheta.zero(channels, thresholds.begin), np.ones(outputs))


@dataclass(frozen=True)
class FilterRestart:
    """The filter continues with another θ₀ or other trusted outputs.

    Attributes:
        states: corrected filter states at the latest decisions, up to the present one (decisions, filter states); None:
            they stay.
    """

    states: np.ndarray | None = None


@dataclass(frozen=True)
class Evidence:
    """Everything that decisions are based on.

    Attributes:
        sums: sums of evidence at decisions.
        thresholds: thresholds and the statistics of noise.
        segment: (begin, end, θ₀ as a function of times in decisions) → the rows between two decisions, for running the
            filter again.
        filter_state: decision → the filter's state there.
        filter, backward_pass: the innovation filter and its backward pass.
        oldest: the earliest decision for which `segment` and `filter_state` have data.
        rows_per_decision: number of rows in one decision.
    """

    sums: WindowSums
    thresholds: Thresholds
    segment: Callable[[int, int, Callable[[np.ndarray], np.ndarray]], Segment]
    filter_state: Callable[[int], np.ndarray]
    filter: InnovationFilter
    backward_pass: BackwardPass
    oldest: int
    rows_per_decision: int
