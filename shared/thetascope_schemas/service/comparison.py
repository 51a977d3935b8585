"""The observers of a run compared on the same data: errors, settling, faults found and missed, cost."""

from typing import Literal

from pydantic import Field

from thetascope_schemas.experiment.base import Number, Reference, Strict, example

_WINDOWS = [{"start": 0, "end": 20}, {"start": 20, "end": 100}]
_STEP = {"channel": "theta3", "at": 20, "size": 0.02, "ten": 0.77, "five": 1.04}
_FAULT = {
    "id": "theta3@20.0",
    "kind": "channel",
    "name": "theta3",
    "onset": 20,
    "until": None,
    "outcome": "found",
    "delay": 0.6,
    "alternative": False,
    "alarm": "theta3-1",
}
_ALARM = {
    "id": "theta3-1",
    "verdict": "correct",
    "state": "acting",
    "found": ["theta3@20.0"],
    "delay": 0.6,
    "covers_since": None,
}
_ROW = {
    "label": "adaptive",
    "rmse": {"x.x1": [0.002, 0.0004], "theta.theta3": [0.001, 0.0011]},
    "peak": {"x.x1": [0.02, 0.004], "theta.theta3": [0.01, 0.02]},
    "steps": [_STEP],
    "faults": [_FAULT],
    "alarms": [_ALARM],
    "found": 1,
    "covered": 0,
    "missed": 0,
    "false_alarms": 0,
    "isolation_errors": 0,
    "delay": 0.6,
    "grace": 5,
    "cost": 57.8,
}


class Window(Strict):
    """A stretch of the run between two events: onsets and ends of faults, the run's beginning and end."""

    model_config = example(**_WINDOWS[1])

    start: Number = Field(description="Time in s of the event at which it begins.")
    end: Number = Field(description="Time in s of the event at which it ends.")


class StepFollowed(Strict):
    """How soon an estimate followed one step of a fault."""

    model_config = example(**_STEP)

    channel: Reference
    at: Number = Field(description="Time of the step in s.")
    size: Number = Field(description="New value less the old, in the channel's unit.")
    ten: Number | None = Field(description="Seconds until it stays within 10 % of the size; null: it does not.")
    five: Number | None = Field(description="Seconds until it stays within 5 % of the size; null: it does not.")


class FaultOutcome(Strict):
    """The outcome for one fault: whether an observer's alarms found it (diagnosis/evaluation/verdicts.py has the rule)."""

    model_config = example(**_FAULT)

    id: str = Field(description="Id of the fault within the experiment or session.")
    kind: Literal["channel", "output"] = Field(description="A channel of the model, or a measurement.")
    name: Reference = Field(description="Name of the channel or output.")
    onset: Number = Field(description="Time in s at which it began.")
    until: Number | None = Field(description="Time in s until which it could be found; null: the end of the run.")
    outcome: Literal["found", "covered", "missed"] = Field(
        description="Covered: an alarm for its channel was on when it began, so none could be raised."
    )
    delay: Number | None = Field(description="Seconds from the onset to the alarm that found it.")
    alternative: bool = Field(description="Found only as one of the alternatives that an alarm leaves open.")
    alarm: str = Field(description="Id of the alarm that found or covers it; empty: none.")


class AlarmOutcome(Strict):
    """The verdict on one alarm, and what it means at the time of judging."""

    model_config = example(**_ALARM)

    id: str = Field(description="Id of the alarm.")
    verdict: Literal["correct", "isolation-error", "false"] = Field(
        description="As it was raised: it names a fault that was present, another one was, or none was."
    )
    state: Literal["acting", "covering", "other-fault", "no-fault", "fault-over", "cleared"] = Field(
        description="Now: cleared; or still on, and a fault that it names acts; the fault that acts began later and is "
        "covered; another fault acts; none ever did; the fault has ended and the alarm is about to clear."
    )
    found: tuple[str, ...] = Field(default=(), description="Ids of the faults that it was the first to find.")
    delay: Number | None = Field(default=None, description="Seconds from the newest of these to the alarm.")
    covers_since: Number | None = Field(
        default=None, description="Onset in s of the newest fault that it covers and that acts."
    )


class ComparisonRow(Strict):
    """One observer's part of the comparison. Counts of alarms and faults are null if no tests ran on it."""

    model_config = example(**_ROW)

    label: str
    rmse: dict[str, tuple[Number | None, ...]] = Field(
        description="Root mean square error by column (x.…, theta.…), one a window; null: not all rows have a number."
    )
    peak: dict[str, tuple[Number | None, ...]] = Field(description="Largest error likewise.")
    steps: tuple[StepFollowed, ...] = ()
    faults: tuple[FaultOutcome, ...] | None = Field(
        default=None, description="The outcome for each fault, in order of time."
    )
    alarms: tuple[AlarmOutcome, ...] | None = Field(
        default=None, description="The verdict on each alarm, in order of time."
    )
    found: int | None = Field(default=None, description="Faults that an alarm found.")
    covered: int | None = Field(
        default=None, description="Faults for whose channel an alarm was on already when they began."
    )
    missed: int | None = Field(default=None, description="Faults neither found nor covered.")
    false_alarms: int | None = Field(
        default=None, description="Alarms raised while no fault was present, nor just before."
    )
    isolation_errors: int | None = Field(
        default=None, description="Alarms raised during a fault that name none of those present."
    )
    delay: Number | None = Field(default=None, description="Median delay in s of the faults found.")
    grace: Number = Field(description="Seconds after a fault within which an alarm is not false: θ̂ is coming back.")
    cost: Number | None = Field(
        default=None, description="Processor time in µs per simulated second, measured: another number each time."
    )


class Comparison(Strict):
    """The observers of a run on the same data; backend/thetascope/diagnosis/evaluation/observer_comparison.py defines each measure."""

    model_config = example(windows=_WINDOWS, observers=[_ROW])

    windows: tuple[Window, ...] = ()
    observers: tuple[ComparisonRow, ...] = ()


_FOUND = {"id": "theta3@20.0", "outcome": "found", "delay": 0.6}
_IN_WINDOW = {"label": "adaptive", "rmse": 0.0004, "noise": 0.0003, "settled": 0.77, "outcome": "settled"}


class StepFound(Strict):
    """The newest fault of a channel, and whether the detector has found it."""

    model_config = example(**_FOUND)

    id: str = Field(description="Id of the fault.")
    outcome: Literal["found", "covered", "missed"] | None = Field(
        description="The verdict so far; null without a detector, or if θ is zero."
    )
    delay: Number | None = Field(description="Seconds from the onset to the alarm that found it.")


class ObserverInWindow(Strict):
    """The figures of one observer over a window."""

    model_config = example(**_IN_WINDOW)

    label: str
    rmse: Number | None = Field(description="Root mean square error of the state; null: not all rows have a value.")
    noise: Number | None = Field(description="Standard deviation of θ̂ about its straight line, over the last quarter.")
    settled: Number | None = Field(description="Seconds from the step of θ until θ̂ stays within 10 % of its size.")
    outcome: Literal["settled", "not-yet", "too-noisy", "unknown"] = Field(
        description="Too noisy: θ̂ has reached θ, but noise keeps moving it out of the 10 %. Unknown: no step, or no θ̂."
    )


class WindowComparison(Strict):
    """The observers of a session over the window that a page shows."""

    model_config = example(t=30, state="x1", channel="theta3", fault=_FOUND, observers=[_IN_WINDOW])

    t: Number = Field(description="Time in s up to which the session has come.")
    state: str = Field(description="The state whose error is given.")
    channel: str | None = Field(description="The fault channel; null: the plant has none.")
    fault: StepFound | None = Field(description="Its newest fault; null: none so far.")
    observers: tuple[ObserverInWindow, ...] = ()
