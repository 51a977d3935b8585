"""What decisions are about, and where they stand: plain values."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from thetascope.diagnosis.detection.thresholds import Thresholds
from thetascope.diagnosis.detection.window_tests import ThetaBounds, WindowSums
from thetascope.diagnosis.residuals.backward_pass import BackwardPass
from thetascope.diagnosis.residuals.innovation_filter import InnovationFilter
from thetascope.diagnosis.residuals.segment import Segment

NEVER = 1 << 62  # a decision that does not come


@dataclass(frozen=True)
class Finding:
    """One finding; times are decisions, sizes in the channels' units. ``channel`` None: not explained by the model.

    ``settled``: size and deviation when nothing had happened for a while: what it was, once it is over. ``initial``: those that it was
    named with.
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
    output: int | None = None  # where it is not explained: the output that is at fault
    cleared: int | None = None
    settled: tuple[float, float] | None = None
    initial: tuple[float, float] | None = None


@dataclass(frozen=True)
class Event:
    """One change of one channel's θ from decision ``onset`` on: by ``size`` within ``rise_time`` decisions (0: a step).

    A rise that has no end (inf) goes up by ``size`` in every decision; one that is ``exponential`` goes as 1 − exp(−time/rise).
    """

    channel: int
    onset: float  # at a row, which may be between two decisions
    rise_time: float = 0.0
    size: float = 0.0
    exponential: bool = False

    @property
    def onset_decision(self) -> int:
        """The decision after which its rows come."""
        return int(self.onset)

    @property
    def is_drift(self) -> bool:
        return self.rise_time == np.inf

    @property
    def shape_key(self) -> tuple[int, float, float, bool]:
        """What tells it from other events, whatever its size: two may begin in one channel at one time."""
        return self.channel, self.onset, self.rise_time, self.exponential

    @property
    def is_ramp(self) -> bool:
        """Whether it goes up evenly to an end."""
        return 0 < self.rise_time < np.inf and not self.exponential

    @property
    def course_parameters(self) -> tuple[float, float, float, float, float]:
        """Its course for size 1: where it starts, by how much it goes up in a decision, where it ends, whether it bends (1), and how
        quickly."""
        if self.exponential:
            return 0.0, 0.0, np.inf, 1.0, 1.0 / self.rise_time
        if self.is_drift:
            return 0.0, 1.0, np.inf, 0.0, 0.0
        return (0.0, 1.0 / self.rise_time, 1.0, 0.0, 0.0) if self.rise_time else (1.0, 0.0, np.inf, 0.0, 0.0)

    def course(self, d: np.ndarray) -> np.ndarray:
        """What it is at each time ``d`` (in decisions), for size 1."""
        start, rate, top, bend, decay_rate = self.course_parameters
        since = np.asarray(d - self.onset)
        return np.where(
            since >= 0,
            np.minimum(start + rate * since, top) - bend * np.expm1(-decay_rate * np.maximum(since, 0.0)),
            0.0,
        )

    def is_over(self, decision: int) -> bool:
        """Whether from a decision on it goes on as `KnownTheta` can say."""
        return self.onset + (self.rise_time if self.is_ramp else 0.0) <= decision

    def unit_value(self, decision: float) -> float:
        """How far it has come at a decision, for size 1."""
        start, rate, top, bend, decay_rate = self.course_parameters
        since = decision - self.onset
        return min(start + rate * since, top) - bend * math.expm1(-decay_rate * since) if since >= 0 else 0.0

    def at(self, decision: float) -> float:
        """By how much θ has changed at a decision."""
        return self.size * self.unit_value(decision)


@dataclass(frozen=True)
class KnownTheta:
    """θ₀, what is known of θ: ``level`` (p) at decision ``since``, going up by ``slope`` (p) in every decision, and by ``asymptote`` (p) in
    the end, at ``decay_rate`` (p)."""

    level: np.ndarray
    slope: np.ndarray
    asymptote: np.ndarray
    decay_rate: np.ndarray
    since: int

    @classmethod
    def zero(cls, channels: int, since: int) -> "KnownTheta":
        return cls(*np.zeros((4, channels)), since)

    def course(self, d: np.ndarray) -> np.ndarray:
        """θ₀ at times ``d`` (in decisions): times × p."""
        after = (d - self.since)[:, None]
        value = self.level + self.slope * after
        return value - self.asymptote * np.expm1(-self.decay_rate * after) if self.asymptote.any() else value

    def at(self, decision: int) -> np.ndarray:
        return self.course(np.array([decision]))[0]

    def within_bounds(self, bounds: ThetaBounds) -> "KnownTheta":
        """Within bounds, where it does not move on."""
        level = np.clip(self.level, bounds.low, bounds.high)
        goes = self.slope + self.asymptote * self.decay_rate
        moves = (level == self.level) & ~((level <= bounds.low) & (goes < 0)) & ~((level >= bounds.high) & (goes > 0))
        return replace(self, level=level, slope=self.slope * moves, asymptote=self.asymptote * moves)

    def without(self, channels: list[int]) -> "KnownTheta":
        """With nothing known of these channels."""
        level, slope, asymptote = self.level.copy(), self.slope.copy(), self.asymptote.copy()
        level[channels] = slope[channels] = asymptote[channels] = 0.0
        return replace(self, level=level, slope=slope, asymptote=asymptote)

    def plus(self, events: tuple[Event, ...], decision: int) -> "KnownTheta":
        """With events that began before ``decision``, from there on."""
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
    """An event that may still be seen otherwise. ``finding``: its finding (a new one, or that of the fault it changes).

    ``options``: it, and what else would explain the data as well; ``own``: the finding was raised for it.
    """

    event: Event
    finding: int
    own: bool
    options: tuple[Event, ...]

    @property
    def channels(self) -> set[int]:
        return {o.channel for o in self.options}


@dataclass(frozen=True)
class TentativeEvents:
    """Events since decision ``begin``, before which ``base`` was known; looked at again at decision ``review_at``, unless ``settled``."""

    begin: int
    base: KnownTheta
    entries: tuple[TentativeEvent, ...]
    review_at: int
    settled: bool = False

    @property
    def events(self) -> tuple[Event, ...]:
        return tuple(y.event for y in self.entries)


@dataclass(frozen=True)
class DecisionState:
    """Where decisions stand after decision ``at``."""

    at: int
    start: int  # what is to be explained began here or later
    known: KnownTheta
    trusted_outputs: np.ndarray  # m: outputs that the filter follows
    memory: float = np.inf  # decisions that ``known`` was estimated from
    passed: int = 0  # windows that are tested begin here or later, too: what was noticed before went away again
    detected: int | None = None  # the decision at which what is being named was noticed
    next_attempt: int = 0  # the decision at which naming is tried next
    active: tuple[int, ...] = ()  # indices into ``findings``
    findings: tuple[Finding, ...] = field(default=())
    tentative: TentativeEvents | None = None
    restart: "FilterRestart | None" = None  # to be told to the filter before it goes on

    @classmethod
    def initial(cls, thresholds: Thresholds, channels: int, outputs: int) -> "DecisionState":
        return cls(thresholds.begin, thresholds.begin, KnownTheta.zero(channels, thresholds.begin), np.ones(outputs))


@dataclass(frozen=True)
class FilterRestart:
    """The filter is to go on otherwise: ``states`` are its states at the decisions up to this one as they ought to have been, None: as
    they are."""

    states: np.ndarray | None = None


@dataclass(frozen=True)
class Evidence:
    """What decisions are made from.

    ``segment(begin, at, known)`` gives the rows between two decisions to run the filter over again (`Segment`), what is known of θ being
    a function of time in decisions. ``filter_state(decision)`` is the filter's as it was.
    """

    sums: WindowSums
    thresholds: Thresholds
    segment: Callable[..., Segment]
    filter_state: Callable[[int], np.ndarray]
    filter: InnovationFilter
    backward_pass: BackwardPass
    oldest: int  # the earliest onset for which that can be done
    rows_per_decision: int  # rows of evidence in one decision
