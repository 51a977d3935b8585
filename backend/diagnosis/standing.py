"""What decisions are about: findings, where deciding stands, and what it looks at."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from backend.diagnosis.calibration import Calibrated
from backend.diagnosis.windows import Sums

GONE = 0.2  # of its size: a fault whose estimate falls below is over


@dataclass(frozen=True)
class Found:
    """One finding; times are decisions, sizes in the channels' units. ``channel`` None: not explained by the model."""

    at: int
    channel: int | None
    alternatives: tuple[int, ...]
    onset: int
    onset_from: int
    onset_to: int
    size: float
    deviation: float
    statistic: float
    output: int | None = None  # where it is not explained: the output with the largest residual
    cleared: int | None = None


@dataclass(frozen=True)
class Change:
    """θ has changed by ``size`` (p), to which the filter's state now answers with V (n × p)."""

    size: np.ndarray
    V: np.ndarray | None  # None: as it answers a θ that has long been there


@dataclass(frozen=True)
class Standing:
    """Where decisions stand after decision ``at``.

    ``trust``: information (p × p) that ``known`` was found with, were the noise white; ``loud`` (p): the same, each
    window's diagonal times its v, so that loud/trust² is the variance.
    """

    at: int
    start: int  # windows begin here or later
    known: np.ndarray
    trust: np.ndarray
    loud: np.ndarray
    memory: float = np.inf  # decisions that ``known`` was estimated from
    detected: int | None = None  # the decision at which what is being named was noticed
    again: int = 0  # the decision at which naming is tried next, or what is known is estimated anew
    active: tuple[int, ...] = ()  # indices into ``found``
    found: tuple[Found, ...] = field(default=())
    change: Change | None = None  # to be told to the filter before it goes on

    @classmethod
    def beginning(cls, calibrated: Calibrated, channels: int) -> "Standing":
        return cls(calibrated.begin, calibrated.begin, np.zeros(channels), np.zeros((channels, channels)),
                   np.zeros(channels))  # fmt: skip


@dataclass(frozen=True)
class Answer:
    """What a fault from an onset on would look like up to now: sums over the rows since, and V at their end."""

    J: np.ndarray
    s: np.ndarray
    q: float
    V: np.ndarray


@dataclass(frozen=True)
class Look:
    """What decisions are made from. ``answer(onset, at)`` runs the filter again from an onset."""

    sums: Sums
    calibrated: Calibrated
    answer: Callable[[int, int], Answer]
    oldest: int  # the earliest onset for which that can be done
    rows: int  # scalars of evidence in one decision


def changed(now: Standing, i: int, change: float, deviation: float) -> Standing:
    """A fault that is known has changed its size, or has ended."""
    total = float(now.known[now.found[i].channel])
    if abs(total) < max(GONE * abs(total - change), 3.0 * deviation):
        return cleared(now, [i])
    return with_found(now, i, replace(now.found[i], size=total, deviation=deviation))


def cleared(now: Standing, which: list[int]) -> Standing:
    """Findings that are over; what the filter took as known of them becomes zero."""
    known, change = now.known.copy(), now.change
    for i in which:
        channel = now.found[i].channel
        if channel is not None:
            rest = np.zeros_like(known)
            rest[channel] = -known[channel]
            known[channel] = 0.0
            V = None if change is None else change.V
            change = Change((0.0 if change is None else change.size) + rest, V)
        now = with_found(now, i, replace(now.found[i], cleared=now.at))
    active = tuple(k for k in now.active if k not in which)
    memory = now.memory if any(now.found[k].channel is not None for k in active) else np.inf
    return replace(now, known=known, active=active, memory=memory, change=change, start=now.at)


def with_found(now: Standing, i: int, found: Found) -> Standing:
    return replace(now, found=(*now.found[:i], found, *now.found[i + 1 :]))
