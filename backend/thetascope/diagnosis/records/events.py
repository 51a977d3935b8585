"""Faults as events with a course over time, and the courses of all faults together."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

STEP, RAMP, DRIFT, RISE, PLATEAU, END = "step", "ramp", "drift", "rise", "plateau", "end"
"""Courses: a step; a ramp from zero; a step that goes on as a ramp; an exponential rise; a ramp that ends; the end."""


@dataclass(frozen=True)
class FaultEvent:
    """One change of a fault channel.

    Attributes:
        channel: its place among the plant's channels.
        shape: STEP, RAMP, DRIFT, RISE, PLATEAU or END.
        onset: s.
        size: in the channel's unit, of a rise or plateau the final one; of a ramp its slope per second.
        slope: of a drift, per second.
        tau: time constant of a rise, duration of the ramp of a plateau, s.
    """

    channel: int
    shape: str
    onset: float
    size: float = 0.0
    slope: float = 0.0
    tau: float = 1.0

    def values(self, t: np.ndarray) -> np.ndarray:
        """Return the fault at times t; 0 for END."""
        since = np.maximum(t - self.onset, 0.0)
        begun = t >= self.onset
        if self.shape == STEP:
            return self.size * begun
        if self.shape == RAMP:
            return self.size * since
        if self.shape == DRIFT:
            return self.size * begun + self.slope * since
        if self.shape == RISE:
            return self.size * -np.expm1(-since / self.tau)
        if self.shape == PLATEAU:
            return self.size * np.minimum(since / self.tau, 1.0)
        return np.zeros_like(t)

    def means(self, t: np.ndarray, width: np.ndarray) -> np.ndarray:
        """Return the mean of the fault over the intervals from t to t + width."""
        first, last = np.maximum(t - self.onset, 0.0), np.maximum(t + width - self.onset, 0.0)
        span = np.maximum(width, 1e-300)
        on = (last - first) / span
        if self.shape == STEP:
            return self.size * on
        risen = (last - first) * (last + first) / (2.0 * span)
        if self.shape == RAMP:
            return self.size * risen
        if self.shape == DRIFT:
            return self.size * on + self.slope * risen
        if self.shape == RISE:
            gone = self.tau * (np.exp(-first / self.tau) - np.exp(-last / self.tau)) / span
            return self.size * (on - gone)
        if self.shape == PLATEAU:
            late = [np.maximum(edge - self.tau, 0.0) for edge in (first, last)]
            beyond = (late[1] - late[0]) * (late[1] + late[0]) / (2.0 * span)
            return self.size * (risen - beyond) / self.tau
        return np.zeros_like(t)

    def parameters(self) -> list[str]:
        """Return the names of the numbers that describe the event."""
        return {
            END: ["onset"],
            RISE: ["size", "onset", "tau"],
            PLATEAU: ["size", "onset", "tau"],
            DRIFT: ["size", "onset", "slope"],
        }.get(self.shape, ["size", "onset"])

    def moved(self, **changes) -> "FaultEvent":
        """Return the event with other numbers."""
        return replace(self, **changes)


def courses(
    events: Sequence[FaultEvent], channels: int, t: np.ndarray, width: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the faults of a story (rows, channels): their means over the intervals after each row, and in the rows.

    An END sets its channel to zero from its onset on, whatever came before.
    """
    interval, row = np.zeros((len(t), channels)), np.zeros((len(t), channels))
    for event in events:
        if event.shape == END:
            ended = np.clip((t + width - event.onset) / np.maximum(width, 1e-300), 0.0, 1.0)
            interval[:, event.channel] *= 1.0 - ended
            row[t >= event.onset, event.channel] = 0.0
        else:
            interval[:, event.channel] += event.means(t, width)
            row[:, event.channel] += event.values(t)
    return interval, row
