"""The events in the log of a live session."""

from typing import Literal

from pydantic import Field, JsonValue

from thetascope_schemas.experiment.base import Number, Strict, Text

EventKind = Literal[
    "inject",
    "clear",
    "fault-begins",
    "fault-ends",
    "gain",
    "signal",
    "noise",
    "truth",
    "observer-added",
    "observer-removed",
    "alarm",
    "alarm-over",
    "diverged",
    "rewound",
    "reset",
    "substeps",
]


class Event(Strict):
    """An event for the log. It is never dropped."""

    type: Literal["event"] = "event"
    row: int
    t: Number
    kind: EventKind
    subject: str = Field(
        default="",
        description='Channel, output, observer label or signal; of "diverged", empty if it is the plant itself.',
    )
    observer: str = Field(default="", description="Label of the observer that raised an alarm.")
    fault: str = Field(default="", description="Id of the fault (inject, fault-begins, fault-ends).")
    value: JsonValue = Field(default=None, description="Size, gain value, estimate …")
    message: Text = Field(description="The event in a sentence.")
