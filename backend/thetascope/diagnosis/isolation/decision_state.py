"""What decisions are about, and where they stand: plain values."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from thetascope.diagnosis.detection.thresholds import Calibrated
from thetascope.diagnosis.detection.window_tests import Range, Sums
from thetascope.diagnosis.residuals.backward_pass import Backwards
from thetascope.diagnosis.residuals.innovation_filter import Filter
from thetascope.diagnosis.residuals.segment import Stretch

NEVER = 1 << 62  # a decision that does not come


@dataclass(frozen=True)
class Found:
    """One finding; times are decisions, sizes in the channels' units. ``channel`` None: not explained by the model.

    ``stood``: size and deviation when nothing had happened for a while: what it was, once it is over. ``first``: those that it was
    named with.
    """

    at: int
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
    stood: tuple[float, float] | None = None
    first: tuple[float, float] | None = None


@dataclass(frozen=True)
class Event:
    """One change of one channel's θ from decision ``onset`` on: by ``size`` within ``rise`` decisions (0: a step).

    A rise that has no end (inf) goes up by ``size`` in every decision; one that is ``bent`` goes as 1 − exp(−time/rise).
    """

    channel: int
    onset: float  # at a row, which may be between two decisions
    rise: float = 0.0
    size: float = 0.0
    bent: bool = False

    @property
    def first(self) -> int:
        """The decision after which its rows come."""
        return int(self.onset)

    @property
    def endless(self) -> bool:
        return self.rise == np.inf

    @property
    def course_key(self) -> tuple[int, float, float, bool]:
        """What tells it from other events, whatever its size: two may begin in one channel at one time."""
        return self.channel, self.onset, self.rise, self.bent

    @property
    def ends(self) -> bool:
        """Whether it goes up evenly to an end."""
        return 0 < self.rise < np.inf and not self.bent

    @property
    def form(self) -> tuple[float, float, float, float, float]:
        """Its course for size 1: where it starts, by how much it goes up in a decision, where it ends, whether it bends (1), and how
        quickly."""
        if self.bent:
            return 0.0, 0.0, np.inf, 1.0, 1.0 / self.rise
        if self.endless:
            return 0.0, 1.0, np.inf, 0.0, 0.0
        return (0.0, 1.0 / self.rise, 1.0, 0.0, 0.0) if self.rise else (1.0, 0.0, np.inf, 0.0, 0.0)

    def course(self, d: np.ndarray) -> np.ndarray:
        """What it is at each time ``d`` (in decisions), for size 1."""
        start, rate, top, bend, pace = self.form
        since = np.asarray(d - self.onset)
        return np.where(
            since >= 0, np.minimum(start + rate * since, top) - bend * np.expm1(-pace * np.maximum(since, 0.0)), 0.0
        )

    def over(self, decision: int) -> bool:
        """Whether from a decision on it goes on as `Known` can say."""
        return self.onset + (self.rise if self.ends else 0.0) <= decision

    def reached(self, decision: float) -> float:
        """How far it has come at a decision, for size 1."""
        start, rate, top, bend, pace = self.form
        since = decision - self.onset
        return min(start + rate * since, top) - bend * math.expm1(-pace * since) if since >= 0 else 0.0

    def at(self, decision: float) -> float:
        """By how much θ has changed at a decision."""
        return self.size * self.reached(decision)


@dataclass(frozen=True)
class Known:
    """θ₀, what is known of θ: ``level`` (p) at decision ``since``, going up by ``slope`` (p) in every decision, and by ``rest`` (p) in
    the end, at ``pace`` (p)."""

    level: np.ndarray
    slope: np.ndarray
    rest: np.ndarray
    pace: np.ndarray
    since: int

    @classmethod
    def nothing(cls, channels: int, since: int) -> "Known":
        return cls(*np.zeros((4, channels)), since)

    def course(self, d: np.ndarray) -> np.ndarray:
        """θ₀ at times ``d`` (in decisions): times × p."""
        after = (d - self.since)[:, None]
        value = self.level + self.slope * after
        return value - self.rest * np.expm1(-self.pace * after) if self.rest.any() else value

    def at(self, decision: int) -> np.ndarray:
        return self.course(np.array([decision]))[0]

    def inside(self, within: Range) -> "Known":
        """Within bounds, where it does not move on."""
        level = np.clip(self.level, within.low, within.high)
        goes = self.slope + self.rest * self.pace
        moves = (level == self.level) & ~((level <= within.low) & (goes < 0)) & ~((level >= within.high) & (goes > 0))
        return replace(self, level=level, slope=self.slope * moves, rest=self.rest * moves)

    def without(self, channels: list[int]) -> "Known":
        """With nothing known of these channels."""
        level, slope, rest = self.level.copy(), self.slope.copy(), self.rest.copy()
        level[channels] = slope[channels] = rest[channels] = 0.0
        return replace(self, level=level, slope=slope, rest=rest)

    def plus(self, events: tuple[Event, ...], decision: int) -> "Known":
        """With events that began before ``decision``, from there on."""
        level, slope, pace = self.at(decision), self.slope.copy(), self.pace.copy()
        rest = self.rest * np.exp(-self.pace * (decision - self.since))
        for e in events:
            level[e.channel] += e.at(decision)
            slope[e.channel] += e.size * e.endless
            if e.bent:
                rest[e.channel] += e.size - e.at(decision)
                pace[e.channel] = 1.0 / e.rise
        return Known(level, slope, rest, pace, decision)


@dataclass(frozen=True)
class Young:
    """An event that may still be seen otherwise. ``found``: its finding (a new one, or that of the fault it changes).

    ``options``: it, and what else would explain the data as well; ``own``: the finding was raised for it.
    """

    event: Event
    found: int
    own: bool
    options: tuple[Event, ...]

    @property
    def channels(self) -> set[int]:
        return {o.channel for o in self.options}


@dataclass(frozen=True)
class Pending:
    """Events since decision ``begin``, before which ``base`` was known; looked at again at decision ``review``, unless ``settled``."""

    begin: int
    base: Known
    young: tuple[Young, ...]
    review: int
    settled: bool = False

    @property
    def events(self) -> tuple[Event, ...]:
        return tuple(y.event for y in self.young)


@dataclass(frozen=True)
class Standing:
    """Where decisions stand after decision ``at``."""

    at: int
    start: int  # what is to be explained began here or later
    known: Known
    heed: np.ndarray  # m: outputs that the filter follows
    memory: float = np.inf  # decisions that ``known`` was estimated from
    passed: int = 0  # windows that are tested begin here or later, too: what was noticed before went away again
    detected: int | None = None  # the decision at which what is being named was noticed
    again: int = 0  # the decision at which naming is tried next
    active: tuple[int, ...] = ()  # indices into ``found``
    found: tuple[Found, ...] = field(default=())
    pending: Pending | None = None
    change: "Change | None" = None  # to be told to the filter before it goes on

    @classmethod
    def beginning(cls, calibrated: Calibrated, channels: int, outputs: int) -> "Standing":
        return cls(calibrated.begin, calibrated.begin, Known.nothing(channels, calibrated.begin), np.ones(outputs))


@dataclass(frozen=True)
class Change:
    """The filter is to go on otherwise: ``states`` are its states at the decisions up to this one as they ought to have been, None: as
    they are."""

    states: np.ndarray | None = None


@dataclass(frozen=True)
class Look:
    """What decisions are made from.

    ``stretch(begin, at, known)`` gives the rows between two decisions to run the filter over again (`Stretch`), what is known of θ being
    a function of time in decisions. ``state(decision)`` is the filter's as it was.
    """

    sums: Sums
    calibrated: Calibrated
    stretch: Callable[..., Stretch]
    state: Callable[[int], np.ndarray]
    filter: Filter
    backwards: Backwards
    oldest: int  # the earliest onset for which that can be done
    rows: int  # rows of evidence in one decision
