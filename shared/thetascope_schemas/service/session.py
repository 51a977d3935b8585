"""The messages of a live session: everything that a browser and /api/sessions/{id}/stream send each other, in one file.

Text frames are JSON: commands from the client, events from the server, distinguished by `type`. Binary frames are
samples: a header of HEADER (little endian), then `count` float32 values of each column in turn.

    sequence  uint32   number of the frame within the session, counted from 1
    epoch     uint32   grows whenever the columns or the past change (an observer added, a rewind): see Columns, Rewound
    first     uint64   row number of the first sample: row r is at time r · record
    count     uint32   rows in this frame
    columns   uint32   columns in this frame

A slow viewer gets fewer, larger frames, whose `sequence` is that of the last frame they cover (0 if the server no longer
knows it). A viewer that is too far behind jumps (see Jump).

A client that lost its connection asks for `?after=<sequence>`. If the epoch in Hello is the one it knew, it gets the rows
that it missed; otherwise, or if the server no longer knows that frame, it gets all rows again.

Sentences are messages {code, args, text}. `text` is in the viewer's language: `?lang=`, or else Accept-Language. So is
prose of the spec, such as titles; with `?lang=*` it is a map from language to text, and sentences are English.
"""

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, JsonValue

from thetascope_schemas.experiment.base import Instant, NonNegative, Number, Positive, Reference, Strict, Text, example
from thetascope_schemas.experiment.diagnosis import ObserverDiagnosis
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.experiment.faults import Fault
from thetascope_schemas.experiment.observers import Gain, Label, ObserverConfig
from thetascope_schemas.experiment.signals import Signal
from thetascope_schemas.service.facts import EXAMPLE, Facts
from thetascope_schemas.service.run import AssumptionCheck

PROTOCOL_VERSION = 1
HEADER = "<IIQII"

# ---- close codes (application range of RFC 6455) ----------------------------------------------------------------------

CLOSE_NO_SESSION = 4404  # the session does not exist, or has ended
CLOSE_ORIGIN = 4403  # the page comes from another origin
CLOSE_TOKEN = 4401  # the control token is not this session's
CLOSE_FULL = 4429  # too many viewers
CLOSE_SLOW = 4408  # the viewer does not read its messages
CLOSE_ENDED = 4410  # the session was closed or idle for too long


# ---- commands: client → server ------------------------------------------------------------------------------------------


class Command(Strict):
    """The base of all commands. Each is answered by an Ack or a Refused with its id."""

    id: int = Field(ge=0, le=2**53 - 1, strict=True, description="Number that the client gives the command.")


class Play(Command):
    """Let time run."""

    model_config = example(type="play", id=1)
    type: Literal["play"] = "play"


class Pause(Command):
    """Stop time."""

    model_config = example(type="pause", id=2)
    type: Literal["pause"] = "pause"


class Step(Command):
    """Advance by `rows` rows, as fast as possible, and stay paused."""

    model_config = example(type="step", id=3, rows=1)
    type: Literal["step"] = "step"
    rows: int = Field(default=1, ge=1, le=100_000, strict=True)


class Speed(Command):
    """Simulated seconds per second; null: as fast as possible."""

    model_config = example(type="speed", id=4, value=10)
    type: Literal["speed"] = "speed"
    value: Annotated[float, Field(ge=0.1, le=1000, strict=True)] | None


class Inject(Command):
    """Inject a fault. Its onset and end count from now."""

    model_config = example(type="inject", id=5, fault={"channel": "theta3", "shape": "step", "onset": 0, "size": 0.02})
    type: Literal["inject"] = "inject"
    fault: Fault


class Clear(Command):
    """End faults now: those of one channel, of one output, or all."""

    model_config = example(type="clear", id=6, channel="theta3")
    type: Literal["clear"] = "clear"
    channel: Reference | None = None
    output: Reference | None = None


class SetGainNow(Command):
    """Set a gain of an observer from now on."""

    model_config = example(type="set-gain", id=7, observer="adaptive", gain="rho", value=8)
    type: Literal["set-gain"] = "set-gain"
    observer: Label
    gain: Reference
    value: Gain


class SetSignalNow(Command):
    """Set an input or known signal from now on; its time is the session's."""

    model_config = example(type="set-signal", id=8, name="u", signal={"kind": "constant", "value": 0.05})
    type: Literal["set-signal"] = "set-signal"
    name: Reference
    signal: Signal


class SetNoiseNow(Command):
    """Set the measurement noise of an output from now on."""

    model_config = example(type="set-noise", id=9, output="y", std=0.002, sample_time=0.01)
    type: Literal["set-noise"] = "set-noise"
    output: Reference
    std: NonNegative = Field(description="Standard deviation, in the output's unit.")
    sample_time: Positive = Field(default=0.01, description="Time in s for which a drawn value holds.")


class AddObserverNow(Command):
    """Add an observer, which starts now."""

    model_config = example(type="add-observer", id=10, observer={"label": "ekf", "kind": "joint-ekf"})
    type: Literal["add-observer"] = "add-observer"
    observer: ObserverConfig


class RemoveObserverNow(Command):
    """Remove an observer."""

    model_config = example(type="remove-observer", id=11, label="ekf")
    type: Literal["remove-observer"] = "remove-observer"
    label: Label


class Reset(Command):
    """Go back to t = 0 and the experiment as it was at the start; the log is emptied."""

    model_config = example(type="reset", id=12)
    type: Literal["reset"] = "reset"


class Seek(Command):
    """Go back to an earlier time. Rows and commands after it are discarded; fork first to keep them."""

    model_config = example(type="seek", id=13, t=20.0)
    type: Literal["seek"] = "seek"
    t: Instant = Field(description="Time in s, rounded to a row, at most the present time.")


def unnumbered(command: object) -> object:
    """Return a command without an id with the id 0: within a batch or a lesson it has no answer of its own."""
    return {"id": 0, **command} if isinstance(command, dict) else command


BatchMember = Annotated[
    Annotated[
        Inject | Clear | SetGainNow | SetSignalNow | SetNoiseNow | AddObserverNow | RemoveObserverNow | Reset,
        Field(discriminator="type"),
    ],
    BeforeValidator(unnumbered),
]
"""A command within a batch: one that acts on the session, given without an id."""

SpecCommand = Inject | Clear | SetGainNow | SetSignalNow | SetNoiseNow | AddObserverNow | RemoveObserverNow
"""The commands that change the experiment from the present row on."""


class Batch(Command):
    """Carry out several commands in order at the same row. If one is refused, none is carried out: one answer for all."""

    model_config = example(
        type="batch",
        id=14,
        commands=[
            {"type": "clear", "channel": "theta3"},
            {"type": "inject", "fault": {"channel": "theta3", "shape": "step", "onset": 0, "size": 0.03}},
        ],
    )
    type: Literal["batch"] = "batch"
    commands: tuple[BatchMember, ...] = Field(
        min_length=1, max_length=20, description="The commands, without their ids; a refusal names commands[i].field."
    )


SessionCommand = SpecCommand | Reset | Seek | Batch
"""The commands that are carried out on the session; the others concern its clock."""

ClientMessage = Annotated[
    Play
    | Pause
    | Step
    | Speed
    | Inject
    | Clear
    | SetGainNow
    | SetSignalNow
    | SetNoiseNow
    | AddObserverNow
    | RemoveObserverNow
    | Reset
    | Seek
    | Batch,
    Field(discriminator="type"),
]


# ---- events: server → client ---------------------------------------------------------------------------------------------


class Hello(Strict):
    """The first message on a connection: everything that a page needs to draw itself."""

    type: Literal["hello"] = "hello"
    protocol: int = PROTOCOL_VERSION
    session: str
    role: Literal["control", "view"]
    spec: Experiment = Field(description="The experiment with the faults and timed commands so far, its plant in full.")
    columns: tuple[str, ...]
    epoch: int
    step: Number
    record: Number = Field(description="Time in s between rows.")
    row: int = Field(description="Number of rows so far, which is the number of the next row.")
    playing: bool
    speed: Number | None
    parent: str | None = Field(default=None, description="The session that this one was forked from.")
    log: tuple["Event", ...] = Field(default=(), description="All events so far.")
    facts: Facts = Field(description="Observers, faults, noise, alarms and verdicts at the row that is shown.")


class Ack(Strict):
    """A command was carried out, and takes effect from this row on."""

    type: Literal["ack"] = "ack"
    id: int
    row: int
    t: Number


class Refused(Strict):
    """A command was not carried out; nothing has changed.

    The problem is the sentence of `code`. The remedy is the message `args.remedy` where there is one, else the sentence
    of `code.remedy`, with the same arguments.
    """

    model_config = example(
        type="refused",
        id=7,
        field="t",
        value=20,
        code="session.seek.ahead",
        args={"t": 12.5},
        problem="the session is at 12.5 s",
        remedy="give at most 12.5, or let time run",
    )

    type: Literal["refused"] = "refused"
    id: int | None = Field(description="The command's id; null if the message had none.")
    field: str = Field(default="", description="Path of the field at fault, for example fault.channel.")
    value: JsonValue = Field(default=None, description="The value that arrived, shortened.")
    code: str = Field(default="", description="Key of the problem's sentence, GET /api/messages/{language}.")
    args: dict[str, JsonValue] = Field(default_factory=dict, description="Arguments of both sentences by name.")
    problem: str = Field(description="Why the command was refused, in the viewer's language.")
    remedy: str = Field(description="How to correct it, in the viewer's language.")


class Status(Strict):
    """The status of the session. A newer one replaces an older one."""

    type: Literal["status"] = "status"
    row: int
    t: Number
    playing: bool
    speed: Number | None
    rate: Number | None = Field(description="Measured speed: simulated seconds per second.")
    viewers: int
    ended: bool = Field(default=False, description="The session has reached its last row, or the plant has diverged.")


EventKind = Literal[
    "inject",
    "clear",
    "fault-begins",
    "fault-ends",
    "gain",
    "signal",
    "noise",
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
    observer: str = Field(default="", description="The observer that raised it (alarms).")
    fault: str = Field(default="", description="Id of the fault that it is about (inject, fault-begins, fault-ends).")
    value: JsonValue = Field(default=None, description="Size, gain value, estimate …")
    message: Text = Field(description="The event in a sentence.")


class Columns(Strict):
    """The columns change from this row on (observers added or removed); a new epoch begins."""

    type: Literal["columns"] = "columns"
    epoch: int
    row: int
    columns: tuple[str, ...]


class Rewound(Strict):
    """Rows from this one on are void; a new epoch begins. The log ends here as well."""

    type: Literal["rewound"] = "rewound"
    epoch: int
    row: int
    t: Number


class Jump(Strict):
    """Rows `first` … `row` − 1 are not sent, because this viewer is too far behind; GET /api/sessions/{id}/data has them."""

    type: Literal["jump"] = "jump"
    epoch: int
    first: int
    row: int


class Spec(Strict):
    """The experiment with everything done so far, after every command that changes it."""

    type: Literal["spec"] = "spec"
    spec: Experiment


class Assumptions(Strict):
    """The assumption checks of one observer over the session so far."""

    type: Literal["assumptions"] = "assumptions"
    observer: Label
    checks: tuple[AssumptionCheck, ...]


class DiagnosisNow(Strict):
    """The diagnosis of the session so far. A newer one replaces an older one."""

    model_config = example(
        type="diagnosis",
        diagnosis={"observer": "", "sentence": {"code": "diagnosis.summary.quiet", "args": {}, "text": "No fault."}},
    )

    type: Literal["diagnosis"] = "diagnosis"
    diagnosis: ObserverDiagnosis


class FactsNow(Strict):
    """The facts at the row that is shown, after every change of them. A newer one replaces an older one."""

    model_config = example(type="facts", row=3001, facts=EXAMPLE)

    type: Literal["facts"] = "facts"
    row: int = Field(description="Rows shown so far.")
    facts: Facts


ServerMessage = Annotated[
    Hello | Ack | Refused | Status | Event | Columns | Rewound | Jump | Spec | Assumptions | DiagnosisNow | FactsNow,
    Field(discriminator="type"),
]
