"""What decisions are about, and where they stand: plain values."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from backend.diagnosis.calibration import Calibrated
from backend.diagnosis.windows import Range, Sums


@dataclass(frozen=True)
class Found:
    """One finding; times are decisions, sizes in the channels' units. ``channel`` None: not explained by the model."""

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


@dataclass(frozen=True)
class Event:
    """One change of one channel's θ from decision ``onset`` on: by ``size`` within ``rise`` decisions (0: a step).

    A rise that has no end (inf) goes up by ``size`` in every decision.
    """

    channel: int
    onset: float  # at a row, which may be between two decisions
    rise: float = 0.0
    size: float = 0.0

    @property
    def first(self) -> int:
        """The decision after which its rows come."""
        return int(self.onset)

    @property
    def endless(self) -> bool:
        return self.rise == np.inf

    def course(self, d: np.ndarray) -> np.ndarray:
        """What it is at each time ``d`` (in decisions), for size 1."""
        since = d - self.onset
        if self.endless:
            return np.maximum(since, 0.0)
        return np.clip(since / self.rise, 0.0, 1.0) if self.rise else (since >= 0) * 1.0

    def at(self, decision: int) -> float:
        """By how much θ has changed at a decision."""
        return float(self.size * self.course(np.array(decision)))


@dataclass(frozen=True)
class Known:
    """θ₀, what is known of θ: ``level`` (p) at decision ``since``, going up by ``slope`` (p) in every decision."""

    level: np.ndarray
    slope: np.ndarray
    since: int

    def course(self, d: np.ndarray) -> np.ndarray:
        """θ₀ at times ``d`` (in decisions): times × p."""
        return self.level + self.slope * (d - self.since)[:, None]

    def at(self, decision: int) -> np.ndarray:
        return self.level + self.slope * (decision - self.since)

    def inside(self, within: Range) -> "Known":
        """Within bounds, where it does not move on."""
        level = np.clip(self.level, within.low, within.high)
        return Known(level, np.where(level == self.level, self.slope, 0.0), self.since)

    def plus(self, events: tuple[Event, ...], decision: int) -> "Known":
        """With events that began before ``decision``, from there on."""
        level, slope = self.at(decision), self.slope.copy()
        for e in events:
            level[e.channel] += e.at(decision)
            slope[e.channel] += e.size * e.endless
        return Known(level, slope, decision)


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
    """Events since decision ``begin``, before which ``base`` was known; looked at again at decision ``review``."""

    begin: int
    base: Known
    young: tuple[Young, ...]
    review: int

    @property
    def events(self) -> tuple[Event, ...]:
        return tuple(y.event for y in self.young)


@dataclass(frozen=True)
class Standing:
    """Where decisions stand after decision ``at``."""

    at: int
    start: int  # windows begin here or later
    known: Known
    heed: np.ndarray  # m: outputs that the filter follows
    memory: float = np.inf  # decisions that ``known`` was estimated from
    detected: int | None = None  # the decision at which what is being named was noticed
    again: int = 0  # the decision at which naming is tried next
    active: tuple[int, ...] = ()  # indices into ``found``
    found: tuple[Found, ...] = field(default=())
    pending: Pending | None = None
    change: "Change | None" = None  # to be told to the filter before it goes on

    @classmethod
    def beginning(cls, calibrated: Calibrated, channels: int, outputs: int) -> "Standing":
        nothing = Known(np.zeros(channels), np.zeros(channels), calibrated.begin)
        return cls(calibrated.begin, calibrated.begin, nothing, np.ones(outputs))


@dataclass(frozen=True)
class Change:
    """The filter is to go on otherwise: from estimates of x and P as in ``state``, None: as they are."""

    state: np.ndarray | None = None


@dataclass(frozen=True)
class Replay:
    """The filter run again over decisions: sums of all outputs, and its states at each decision, the first included."""

    J: np.ndarray
    s: np.ndarray
    q: np.ndarray  # decisions + 1, m: from the first on
    states: np.ndarray
    heed: np.ndarray
    early: np.ndarray  # p: the diagonal of J while answers take their form

    @property
    def energy(self) -> np.ndarray:
        """Of the outputs heeded, from the first decision on."""
        return self.q @ self.heed


@dataclass(frozen=True)
class Look:
    """What decisions are made from.

    ``replay(state, begin, at, known, profile, heed)`` runs the filter again from a state, θ₀ and the profile being functions
    of time in decisions; ``state(decision)`` is the filter's as it was; ``answers(state)`` its V (n × p).
    """

    sums: Sums
    calibrated: Calibrated
    replay: Callable[..., Replay]
    state: Callable[[int], np.ndarray]
    moved: Callable[[np.ndarray, np.ndarray], np.ndarray]
    oldest: int  # the earliest onset for which that can be done
    rows: int  # rows of evidence in one decision
    patience: np.ndarray  # m: rows after which an output that shows the same number stands still
