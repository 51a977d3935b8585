"""The messages of a live session: everything that is exchanged over /api/sessions/{id}/stream.

Text frames are JSON: commands from the client, events from the server, distinguished by `type`. Binary frames are
samples: a header of HEADER (little endian), then `count` float32 values of each column in turn.

    sequence  uint32   number of the frame within the session, counted from 1
    epoch     uint32   grows when the columns or past rows change (observer added, rewind): see Columns, Rewound
    first     uint64   row number of the first sample: row r is at time r · record
    count     uint32   rows in this frame
    columns   uint32   columns in this frame

A slow viewer gets fewer, larger frames, whose `sequence` is that of the last frame they cover (0 if the server no
longer knows it). Rows are skipped for a viewer that is too far behind (see Jump).

A client that offers the subprotocols SUBPROTOCOL and TOKEN + its control token has control; others view. Logs keep
addresses, so these do not hold the token. A client that reconnects asks for `?after=<sequence>`: it gets the rows that
it missed if the epoch in Hello is unchanged and the server still knows that frame, otherwise all rows again.

Sentences are messages {code, args, text}. `text` is in the viewer's language: `?lang=`, or else Accept-Language. So is
prose of the spec, such as titles; with `?lang=*` it is a map from language to text, and sentences are English.
"""

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, JsonValue

from thetascope_schemas.experiment.base import Identifier, Instant, Number, Reference, Strict, example
from thetascope_schemas.experiment.commands import GainChange, NoiseChange, SignalChange, TruthChange
from thetascope_schemas.experiment.diagnosis import ObserverDiagnosis
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.experiment.faults import Fault
from thetascope_schemas.experiment.figures import Note
from thetascope_schemas.experiment.observers import Label, ObserverConfig
from thetascope_schemas.service.event import Event
from thetascope_schemas.service.facts import EXAMPLE, Facts
from thetascope_schemas.service.run import AssumptionCheck

PROTOCOL_VERSION = 1
HEADER = "<IIQII"
SUBPROTOCOL = "thetascope"  # the one that the service selects
TOKEN = "token."  # prefix of the offered subprotocol that carries the control token
KEY = "key."  # prefix of the one that carries the access key in base64url, for pages of other sites
# ---- close codes (application range of RFC 6455) -------------------------------------------------------------
CLOSE_NO_SESSION = 4404  # the session does not exist, or has ended
CLOSE_ORIGIN = 4403  # the page comes from another origin
CLOSE_TOKEN = 4401  # the control token is not this session's
CLOSE_FULL = 4429  # too many viewers
CLOSE_SOCKETS = 4430  # this client has too many connections
CLOSE_SIGN_IN = 4411  # the access key is missing, or was changed
CLOSE_SLOW = 4408  # the viewer does not read its messages
CLOSE_ENDED = 4410  # the session was closed or idle for too long


# ---- commands: client → server -------------------------------------------------------------------------------


class Command(Strict):
    """The base of all commands. Each is answered by an Ack or a Refused with its id."""

    id: int = Field(ge=0, le=2**53 - 1, strict=True, description="Number of the command, chosen by the client.")


class Play(Command):
    """Start or resume the clock."""

    model_config = example(type="play", id=1)
    type: Literal["play"] = "play"


class Pause(Command):
    """Pause the clock."""

    model_config = example(type="pause", id=2)
    type: Literal["pause"] = "pause"


class Step(Command):
    """Advance by `rows` rows as fast as possible, then pause."""

    model_config = example(type="step", id=3, rows=1)
    type: Literal["step"] = "step"
    rows: int = Field(default=1, ge=1, le=100_000, strict=True)


class Speed(Command):
    """Set the speed in simulated seconds per second; null: as fast as possible."""

    model_config = example(type="speed", id=4, value=10)
    type: Literal["speed"] = "speed"
    value: Annotated[float, Field(ge=0.1, le=10_000, strict=True)] | None


class Inject(Command):
    """Inject a fault. Its onset and end are relative to the present time."""

    model_config = example(type="inject", id=5, fault={"channel": "theta3", "shape": "step", "onset": 0, "size": 0.02})
    type: Literal["inject"] = "inject"
    fault: Fault


class Clear(Command):
    """End faults now: those of one channel, of one output, or all."""

    model_config = example(type="clear", id=6, channel="theta3")
    type: Literal["clear"] = "clear"
    channel: Reference | None = None
    output: Reference | None = None


class SetGainNow(GainChange, Command):
    """Set a gain of an observer from now on."""

    model_config = example(type="set-gain", id=7, observer="adaptive", gain="rho", value=8)
    type: Literal["set-gain"] = "set-gain"


class SetSignalNow(SignalChange, Command):
    """Set an input or known signal from now on. The signal's time is that of the session."""

    model_config = example(type="set-signal", id=8, name="u", signal={"kind": "constant", "value": 0.05})
    type: Literal["set-signal"] = "set-signal"


class SetNoiseNow(NoiseChange, Command):
    """Set the measurement noise of an output from now on."""

    model_config = example(type="set-noise", id=9, output="y", std=0.002, sample_time=0.01)
    type: Literal["set-noise"] = "set-noise"


class SetTruthNow(TruthChange, Command):
    """Set the true plant and its sensors from now on; observers and the detector keep their model."""

    model_config = example(type="set-truth", id=15, truth={"deviation": 0.02})
    type: Literal["set-truth"] = "set-truth"


class AddObserverNow(Command):
    """Add an observer, whose estimates start now."""

    model_config = example(type="add-observer", id=10, observer={"label": "ekf", "kind": "joint-ekf"})
    type: Literal["add-observer"] = "add-observer"
    observer: ObserverConfig


class RemoveObserverNow(Command):
    """Remove an observer."""

    model_config = example(type="remove-observer", id=11, label="ekf")
    type: Literal["remove-observer"] = "remove-observer"
    label: Label


class Reset(Command):
    """Go back to t = 0 and to the original experiment; the log is cleared."""

    model_config = example(type="reset", id=12)
    type: Literal["reset"] = "reset"


class Seek(Command):
    """Go back to an earlier time. Rows, commands and notes after it are discarded; fork first to keep them."""

    model_config = example(type="seek", id=13, t=20.0)
    type: Literal["seek"] = "seek"
    t: Instant = Field(description="Time in s, rounded to a row, at most the present time.")


class AddNote(Command):
    """Add a note at the present time or an earlier one, or replace the note that has its id. No row changes."""

    model_config = example(type="add-note", id=16, note={"id": "overshoot", "t": 12.5, "text": "The EKF overshoots."})
    type: Literal["add-note"] = "add-note"
    note: Note


class RemoveNote(Command):
    """Remove a note."""

    model_config = example(type="remove-note", id=17, note="overshoot")
    type: Literal["remove-note"] = "remove-note"
    note: Identifier = Field(description="Id of the note.")


def unnumbered(command: object) -> object:
    """Return a command, with the id 0 if it has none: within a batch or a lesson it is not answered separately."""
    return {"id": 0, **command} if isinstance(command, dict) else command


SpecCommand = (
    Inject | Clear | SetGainNow | SetSignalNow | SetNoiseNow | SetTruthNow | AddObserverNow | RemoveObserverNow
)
"""The commands that change the experiment from the present row on."""
NoteCommand = AddNote | RemoveNote
"""The commands that change the experiment's notes, and none of its numbers."""

BatchMember = Annotated[
    Annotated[
        SpecCommand | NoteCommand | Reset,
        Field(discriminator="type"),
    ],
    BeforeValidator(unnumbered),
]
"""A command of a batch, without an id: one that changes the experiment or its notes, or Reset."""


class Batch(Command):
    """Execute several commands in order at the same row. If one is refused, none is executed. There is one answer."""

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
        min_length=1, max_length=20, description="The commands without ids; a refusal names commands[i].field."
    )


SessionCommand = SpecCommand | NoteCommand | Reset | Seek | Batch
"""The commands that change the session; the others control its clock."""

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
    | SetTruthNow
    | AddObserverNow
    | RemoveObserverNow
    | AddNote
    | RemoveNote
    | Reset
    | Seek
    | Batch,
    Field(discriminator="type"),
]


# ---- events: server → client ---------------------------------------------------------------------------------


class Hello(Strict):
    """The first message on a connection: everything that a page needs to display the session."""

    type: Literal["hello"] = "hello"
    protocol: int = PROTOCOL_VERSION
    session: str
    role: Literal["control", "view"]
    spec: Experiment = Field(
        description="The experiment with its complete plant and all faults and timed commands up to now."
    )
    columns: tuple[str, ...]
    epoch: int
    step: Number
    record: Number = Field(description="Time in s between rows.")
    row: int = Field(description="Number of rows so far, and number of the next row.")
    playing: bool
    speed: Number | None
    parent: str | None = Field(default=None, description="The session that this one was forked from.")
    log: tuple["Event", ...] = Field(default=(), description="All events so far.")
    facts: Facts = Field(description="Observers, faults, noise, alarms and verdicts at the row that is shown.")


class Ack(Strict):
    """A command was executed; it takes effect from this row on."""

    type: Literal["ack"] = "ack"
    id: int
    row: int
    t: Number


class Refused(Strict):
    """A command was refused; nothing has changed.

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
    id: int | None = Field(description="Id of the command; null if the message had none.")
    field: str = Field(default="", description="Path of the offending field, for example fault.channel.")
    value: JsonValue = Field(default=None, description="The value that arrived, shortened.")
    code: str = Field(default="", description="Key of the problem's sentence, GET /api/messages/{language}.")
    args: dict[str, JsonValue] = Field(default_factory=dict, description="Arguments of both sentences by name.")
    problem: str = Field(description="Why the command was refused, in the viewer's language.")
    remedy: str = Field(description="How to correct it, in the viewer's language.")


class Status(Strict):
    """The status of the session; it replaces earlier ones."""

    type: Literal["status"] = "status"
    row: int
    t: Number
    playing: bool
    speed: Number | None
    rate: Number | None = Field(description="Measured speed: simulated seconds per second.")
    viewers: int
    ended: bool = Field(default=False, description="The session has reached its last row, or the plant has diverged.")


class Columns(Strict):
    """The columns change from this row on, because an observer was added or removed; a new epoch begins."""

    type: Literal["columns"] = "columns"
    epoch: int
    row: int
    columns: tuple[str, ...]


class Rewound(Strict):
    """Rows and log entries from this row on are discarded; a new epoch begins."""

    type: Literal["rewound"] = "rewound"
    epoch: int
    row: int
    t: Number


class Jump(Strict):
    """Rows `first` … `row` − 1 are skipped for this viewer, which is too slow; GET /api/sessions/{id}/data has them."""

    type: Literal["jump"] = "jump"
    epoch: int
    first: int
    row: int


class Spec(Strict):
    """The experiment with all changes up to now; sent after every command that changes it."""

    type: Literal["spec"] = "spec"
    spec: Experiment


class Assumptions(Strict):
    """The assumption checks of one observer over the session up to now."""

    type: Literal["assumptions"] = "assumptions"
    observer: Label
    checks: tuple[AssumptionCheck, ...]


class DiagnosisNow(Strict):
    """The diagnosis of the session up to now; it replaces earlier ones."""

    model_config = example(
        type="diagnosis",
        diagnosis={"observer": "", "sentence": {"code": "diagnosis.summary.quiet", "args": {}, "text": "No fault."}},
    )

    type: Literal["diagnosis"] = "diagnosis"
    diagnosis: ObserverDiagnosis


class FactsNow(Strict):
    """The facts at the last row shown, sent after every change; they replace earlier ones."""

    model_config = example(type="facts", row=3001, facts=EXAMPLE)

    type: Literal["facts"] = "facts"
    row: int = Field(description="Number of rows shown so far.")
    facts: Facts


ServerMessage = Annotated[
    Hello | Ack | Refused | Status | Event | Columns | Rewound | Jump | Spec | Assumptions | DiagnosisNow | FactsNow,
    Field(discriminator="type"),
]
