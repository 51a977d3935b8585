"""Facts about a run or a session at one time: observers, faults and noise that act then, alarms and verdicts on them."""

from typing import Literal

from pydantic import Field, JsonValue

from thetascope_schemas.experiment.base import Number, Strict, Text, example
from thetascope_schemas.experiment.diagnosis import Alarm
from thetascope_schemas.experiment.experiment import Noise
from thetascope_schemas.experiment.faults import Fault
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
    "broken": None,
    "alarms": [],
    "alarm_verdicts": [],
    "fault_outcomes": [],
    "unseen": ["theta3@20.0"],
    "summary": {"code": "diagnosis.summary.looking", "args": {"n": 1}, "text": "A fault is active. Not found yet."},
}


class ObserverLost(Strict):
    """When an observer diverged, and the likely cause."""

    model_config = example(t=2.5, cause={"code": "diverged.theta-hat", "args": {}, "text": "θ̂ left all bounds"})

    t: Number = Field(description="Time in s.")
    cause: Text = Field(description="The likely cause.")


class ObserverNow(Strict):
    """An observer that runs at that time."""

    model_config = example(**_OBSERVER)

    label: Label
    kind: str
    gains: dict[str, Gain] = Field(description="Present values of the gains that were set; others have their defaults.")
    options: dict[str, JsonValue] = Field(default_factory=dict)
    config: ObserverConfig = Field(description="Its configuration when it was started.")
    since: Number = Field(description="Time in s at which it was started.")
    diverged: ObserverLost | None = None


class FaultNow(Strict):
    """A fault of the experiment, and whether it acts at that time."""

    model_config = example(**_FAULT)

    id: str = Field(description="Id within the run or session; it stays when the fault is cleared.")
    subject: str = Field(description="Name of the channel or output.")
    kind: Literal["channel", "output"]
    shape: str
    fault: Fault = Field(description="The fault itself; its times count from the start.")
    onset: Number = Field(description="Time in s at which it begins.")
    end: Number | None = Field(description="Time in s at which it ends; null: it stays.")
    active: bool = Field(description="Whether it acts. In a session: from the next row on.")
    ended: bool = Field(description="Whether it is over.")


class Facts(Strict):
    """Everything that follows from the experiment and its findings at one time, computed by one function for all."""

    model_config = example(**EXAMPLE)

    t: Number = Field(description="The time in s: of a run, its end; of a session, the last row that was shown.")
    observers: tuple[ObserverNow, ...]
    faults: tuple[FaultNow, ...] = Field(description="All faults so far and to come, in the order of the experiment.")
    noise: dict[str, Noise] = Field(description="Measurement noise of every output that has some.")
    broken: Number | None = Field(default=None, description="Time in s at which the plant itself diverged.")
    alarms: tuple[Alarm, ...] = Field(
        default=(), description="The detector's alarms up to that time, in order of time."
    )
    alarm_verdicts: tuple[AlarmOutcome, ...] = Field(default=(), description="The verdict on each of them.")
    fault_outcomes: tuple[FaultOutcome, ...] = Field(default=(), description="The outcome for each fault so far.")
    unseen: tuple[str, ...] = Field(
        default=(), description="Ids of the faults that act and that no alarm names now, one a site."
    )
    summary: Text = Field(description="The diagnosis in one sentence.")
