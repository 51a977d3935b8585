"""Facts about a run or session at one time: its observers, faults and noise, the alarms, and the verdicts on them."""

from typing import Literal

from pydantic import Field, JsonValue

from thetascope_schemas.experiment.base import Number, Strict, Text, example
from thetascope_schemas.experiment.diagnosis import Alarm
from thetascope_schemas.experiment.experiment import Noise
from thetascope_schemas.experiment.faults import Fault
from thetascope_schemas.experiment.measurement import Truth
from thetascope_schemas.experiment.observers import Gain, Label, ObserverConfig
from thetascope_schemas.service.comparison import AlarmOutcome, FaultOutcome

_OBSERVER = {
    "label": "adaptive",
    "kind": "zhao-adaptive",
    "gains": {"rho": 8.0},
    "options": {},
    "config": {"label": "adaptive", "kind": "zhao-adaptive"},
    "since": 0,
    "diverged": None,
}
_FAULT = {
    "id": "theta3@20.0",
    "subject": "theta3",
    "kind": "channel",
    "shape": "step",
    "fault": {"channel": "theta3", "shape": "step", "onset": 20, "size": 0.02},
    "onset": 20,
    "end": None,
    "active": True,
    "ended": False,
}
EXAMPLE = {
    "t": 30,
    "observers": [_OBSERVER],
    "faults": [_FAULT],
    "noise": {"y": {"std": 0.001, "sample_time": 0.01}},
    "truth": {"deviation": 0.02},
    "broken": None,
    "alarms": [],
    "alarm_verdicts": [],
    "fault_outcomes": [],
    "undetected": ["theta3@20.0"],
    "summary": {"code": "diagnosis.summary.looking", "args": {"n": 1}, "text": "A fault is active. Not found yet."},
}


class ObserverLost(Strict):
    """The divergence of an observer: its time and likely cause."""

    model_config = example(t=2.5, cause={"code": "diverged.theta-hat", "args": {}, "text": "θ̂ left all bounds"})

    t: Number = Field(description="Time in s.")
    cause: Text = Field(description="The likely cause.")


class ObserverNow(Strict):
    """An observer that is running at that time."""

    model_config = example(**_OBSERVER)

    label: Label
    kind: str
    gains: dict[str, Gain] = Field(
        description="Present values of the gains that were set; the others have their defaults."
    )
    options: dict[str, JsonValue] = Field(default_factory=dict)
    config: ObserverConfig = Field(description="Its configuration at the start.")
    since: Number = Field(description="Time in s at which it was started.")
    diverged: ObserverLost | None = None


class FaultNow(Strict):
    """A fault of the experiment, and whether it is active at that time."""

    model_config = example(**_FAULT)

    id: str = Field(description="Id within the run or session; it does not change when the fault is cleared.")
    subject: str = Field(description="Name of the channel or output.")
    kind: Literal["channel", "output"]
    shape: str
    fault: Fault = Field(description="The fault; its times count from the start of the run.")
    onset: Number = Field(description="Time in s at which it begins.")
    end: Number | None = Field(description="Time in s at which it ends; null: never.")
    active: bool = Field(description="Whether it is active; in a session, from the next row on.")
    ended: bool = Field(description="Whether it has ended.")


class Facts(Strict):
    """All facts that follow from an experiment and its alarms at one time. One function computes them."""

    model_config = example(**EXAMPLE)

    t: Number = Field(description="The time in s: the end of a run, or the last row shown of a session.")
    observers: tuple[ObserverNow, ...]
    faults: tuple[FaultNow, ...] = Field(description="All faults, past and future, in the order of the experiment.")
    noise: dict[str, Noise] = Field(description="Measurement noise of the noisy outputs, by name.")
    truth: Truth = Field(default_factory=Truth, description="Where the simulated plant differs from the model.")
    broken: Number | None = Field(default=None, description="Time in s at which the plant diverged; null: it has not.")
    alarms: tuple[Alarm, ...] = Field(
        default=(), description="The detector's alarms up to that time, in order of time."
    )
    alarm_verdicts: tuple[AlarmOutcome, ...] = Field(default=(), description="The verdict on each alarm.")
    fault_outcomes: tuple[FaultOutcome, ...] = Field(default=(), description="The outcome for each fault so far.")
    undetected: tuple[str, ...] = Field(
        default=(), description="Ids of the active faults that no present alarm names, one for each site."
    )
    judged: Number | None = Field(
        default=None,
        description="Time in s up to which the detector has judged the rows, while it is a decision or more behind; "
        "null: it has judged all of them, or there is no detector.",
    )
    summary: Text = Field(description="The diagnosis in one sentence.")
