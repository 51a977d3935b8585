"""Comparison of the observers of a run on the same data: errors, settling, faults found and missed, cost."""

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
    """An interval of the run between two events: onsets and ends of faults, start and end of the run."""

    model_config = example(**_WINDOWS[1])

    start: Number = Field(description="Time in s at which it begins.")
    end: Number = Field(description="Time in s at which it ends.")


class StepFollowed(Strict):
    """The settling of an estimate after one step of a fault."""

    model_config = example(**_STEP)

    channel: Reference
    at: Number = Field(description="Time of the step in s.")
    size: Number = Field(description="New value minus old value, in the channel's unit.")
    ten: Number | None = Field(description="Seconds until the error stays within 10 % of the size; null: never.")
    five: Number | None = Field(description="Seconds until the error stays within 5 % of the size; null: never.")


class FaultOutcome(Strict):
    """The outcome for one fault: whether an alarm found it, by the rule in thetascope.diagnosis.evaluation.verdicts."""

    model_config = example(**_FAULT)

    id: str = Field(description="Id of the fault within the experiment or session.")
    kind: Literal["channel", "output"] = Field(description="Fault of a channel of the model, or of a measured output.")
    name: Reference = Field(description="Name of the channel or output.")
    onset: Number = Field(description="Time in s at which it began.")
    until: Number | None = Field(
        description="Time in s until which an alarm counts as finding it; null: the end of the run."
    )
    outcome: Literal["found", "covered", "missed"] = Field(
        description="Covered: an alarm for its channel was on when the fault began, so no new one could be raised."
    )
    delay: Number | None = Field(description="Seconds from the onset to the alarm that found it.")
    alternative: bool = Field(description="Whether the alarm names it only as an alternative.")
    alarm: str = Field(description="Id of the alarm that found or covers it; empty without an alarm.")


class AlarmOutcome(Strict):
    """The verdict on one alarm, and its state at the time of evaluation."""

    model_config = example(**_ALARM)

    id: str = Field(description="Id of the alarm.")
    verdict: Literal["correct", "isolation-error", "false"] = Field(
        description="When it was raised, it named a fault that was present, another fault was present, or none was."
    )
    state: Literal["acting", "covering", "other-fault", "no-fault", "fault-over", "cleared"] = Field(
        description="Cleared, or on while: a fault that it names is active; the active fault began later and is "
        "covered; another fault is active; there has been no fault; the fault has ended, so the alarm clears soon."
    )
    found: tuple[str, ...] = Field(default=(), description="Ids of the faults that it found first.")
    delay: Number | None = Field(default=None, description="Seconds from the newest of these faults to the alarm.")
    covers_since: Number | None = Field(
        default=None, description="Onset in s of the newest active fault that it covers."
    )


class ComparisonRow(Strict):
    """The comparison's row of one observer. Counts of alarms and faults are null if no tests ran on its estimates."""

    model_config = example(**_ROW)

    label: str
    rmse: dict[str, tuple[Number | None, ...]] = Field(
        description="Root mean square error of each column (x.…, theta.…), by window; null: some rows have no number."
    )
    peak: dict[str, tuple[Number | None, ...]] = Field(description="Largest absolute error, in the same form.")
    steps: tuple[StepFollowed, ...] = ()
    faults: tuple[FaultOutcome, ...] | None = Field(
        default=None, description="The outcome for each fault, in order of time."
    )
    alarms: tuple[AlarmOutcome, ...] | None = Field(
        default=None, description="The verdict on each alarm, in order of time."
    )
    found: int | None = Field(default=None, description="Number of faults that an alarm found.")
    covered: int | None = Field(
        default=None, description="Number of faults that began while an alarm for their channel was on."
    )
    missed: int | None = Field(default=None, description="Number of faults neither found nor covered.")
    false_alarms: int | None = Field(
        default=None, description="Number of alarms raised while no fault was present, nor just before."
    )
    isolation_errors: int | None = Field(
        default=None, description="Number of alarms raised during a fault that name none of the faults present."
    )
    delay: Number | None = Field(default=None, description="Median delay in s of the faults found.")
    grace: Number = Field(
        description="Seconds after the end of a fault in which an alarm is not false, because θ̂ is returning to 0."
    )
    cost: Number | None = Field(
        default=None, description="Measured processor time in µs per simulated second; it differs between runs."
    )


class Comparison(Strict):
    """The observers of a run on the same data.

    thetascope.diagnosis.evaluation.observer_comparison defines each measure.
    """

    model_config = example(windows=_WINDOWS, observers=[_ROW])

    windows: tuple[Window, ...] = ()
    observers: tuple[ComparisonRow, ...] = ()


_FOUND = {"id": "theta3@20.0", "outcome": "found", "delay": 0.6}
_IN_WINDOW = {"label": "adaptive", "rmse": 0.0004, "noise": 0.0003, "settled": 0.77, "outcome": "settled"}


class StepFound(Strict):
    """The newest fault of a channel, and its outcome so far."""

    model_config = example(**_FOUND)

    id: str = Field(description="Id of the fault.")
    outcome: Literal["found", "covered", "missed"] | None = Field(
        description="The outcome so far; null without a detector, or if θ is zero."
    )
    delay: Number | None = Field(description="Seconds from the onset to the alarm that found it.")


class ObserverInWindow(Strict):
    """The figures of one observer over a window."""

    model_config = example(**_IN_WINDOW)

    label: str
    rmse: Number | None = Field(description="Root mean square error of the state; null: some rows have no value.")
    noise: Number | None = Field(
        description="Standard deviation of θ̂ about a fitted line, over the last quarter of the window."
    )
    settled: Number | None = Field(
        description="Seconds from the step of θ until θ̂ stays within 10 % of the step's size."
    )
    outcome: Literal["settled", "not-yet", "too-noisy", "unknown"] = Field(
        description="Too noisy: θ̂ reached θ, but noise moves it out of the 10 % band. Unknown: no step, or no θ̂."
    )
    converging: bool | None = Field(
        default=None,
        description="Whether since the last change θ̂ still moves, or y − ŷ is larger, than noise explains, so that "
        "the bias of θ̂ may exceed its band; null: unknown, or without a band.",
    )


class WindowComparison(Strict):
    """The observers of a session over the window that the page shows."""

    model_config = example(t=30, state="x1", channel="theta3", fault=_FOUND, observers=[_IN_WINDOW])

    t: Number = Field(description="Present time of the session in s.")
    state: str = Field(description="The state whose errors are compared.")
    channel: str | None = Field(description="The fault channel; null: the plant has none.")
    fault: StepFound | None = Field(description="The newest fault of the channel; null: none so far.")
    observers: tuple[ObserverInWindow, ...] = ()


_ESTIMATE = {"name": "theta.theta3", "rmse": 0.0011, "noise": 0.0003, "settled": 0.77, "outcome": "settled"}


class EstimateInWindow(Strict):
    """The figures of one estimate of an observer over a window."""

    model_config = example(**_ESTIMATE)

    name: str = Field(description="Column of the true value: x.… of a state, theta.… of a fault.")
    rmse: Number | None = Field(description="Root mean square error; null: some rows have no value.")
    noise: Number | None = Field(
        default=None, description="Of a fault: standard deviation of θ̂ about a fitted line, over the last quarter."
    )
    settled: Number | None = Field(
        default=None, description="Of a fault: seconds from its newest step until θ̂ stays within 10 % of the step."
    )
    outcome: Literal["settled", "not-yet", "too-noisy", "unknown"] = Field(
        default="unknown", description="As in the comparison of one state and one fault."
    )


class ObserverTable(Strict):
    """All estimates of one observer over a window."""

    model_config = example(label="adaptive", estimates=[_ESTIMATE])

    label: str
    estimates: tuple[EstimateInWindow, ...] = Field(description="States first, then faults, in the plant's order.")


class WindowTable(Strict):
    """All estimates of all observers of a session over one window."""

    model_config = example(t=30, observers=[{"label": "adaptive", "estimates": [_ESTIMATE]}])

    t: Number = Field(description="Present time of the session in s.")
    observers: tuple[ObserverTable, ...] = ()
