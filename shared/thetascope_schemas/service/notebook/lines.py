"""Lists of runs: what was changed in each, its measures, and what its owner calls it."""

from datetime import datetime
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, model_validator

from thetascope_schemas.experiment.base import Number, Strict, Text, example
from thetascope_schemas.service.health import RunUsage
from thetascope_schemas.service.run import Status
from thetascope_schemas.texts.one_line import one_line
from thetascope_schemas.texts.refusal import refuse

RunKind = Literal["run", "session", "record"]
Setting = Number | str | None

_CHANGE = {
    "path": "observers.adaptive.gains.lambda",
    "label": {"code": "change.symbol", "args": {"name": "lambda"}, "text": "lambda"},
    "from": 4,
    "to": 8,
}
_COUNTS = {"all": 148, "pinned": 4, "kinds": {"run": 128, "session": 14, "record": 6}, "found": 6}


def _tag(text: str) -> str:
    """Return a tag with single blanks; refuse an empty one, and characters that a list of tags cannot hold."""
    tag = " ".join(text.split())
    if not tag or any(char in '"\\,' or not char.isprintable() for char in tag):
        raise refuse("notebook.tag", value=text[:80])
    return tag


Tag = Annotated[str, Field(max_length=40), AfterValidator(_tag)]


class RunChange(Strict):
    """A setting in which a run differs from the library's experiment."""

    model_config = example(**_CHANGE)

    path: str = Field(description="Path of the setting; items of lists by label, channel or output.")
    label: Text = Field(description="Name of the setting.")
    before: Setting = Field(alias="from", description="Value in the library's experiment; null: it is not given there.")
    to: Setting = Field(description="Value in the run; null: it is not given.")

    @model_validator(mode="before")
    @classmethod
    def _known_fields(cls, data: object) -> object:
        """Return the data unchanged: `from`, a keyword of Python, is no name of a field."""
        return data


class RunCurve(Strict):
    """A fault of a run and its estimate at a few evenly spaced times."""

    model_config = example(channel="theta3", truth=[0, 0.02], estimate=[0.001, 0.0199])

    channel: str
    truth: tuple[Number | None, ...] | None = Field(default=None, description="The fault; null: unknown, in a record.")
    estimate: tuple[Number | None, ...]


class RunLine(Strict):
    """A run in a list."""

    id: str
    title: str
    status: Status | Literal["damaged"] = Field(
        description="damaged: what is stored does not have its checksum; run the experiment again, or remove the run."
    )
    progress: Number = Field(default=1, ge=0, le=1, description="Completed share, 0 to 1.")
    created: datetime
    pinned: bool
    name: str = Field(default="", description="Name that this client gave it.")
    tags: tuple[str, ...] = Field(default=(), description="Tags that this client gave it.")
    warning: str = Field(default="", description="That name and tags are damaged in the store and left out.")
    mine: bool = Field(default=True, description="Whether this client may name, tag, pin and remove it.")
    kind: RunKind = Field(
        default="run", description="session: a live session that was saved; record: observers on a record."
    )
    experiment: str | None = Field(default=None, description="Id of the library's experiment that it follows.")
    plant: str | None = Field(default=None, description="Id of its plant.")
    record: str | None = Field(default=None, description="Name of its record.")
    changes: tuple[RunChange, ...] | None = Field(
        default=None, description="Differences from the library's experiment; null: it follows none."
    )
    observer: str | None = Field(default=None, description="The observer whose measures follow.")
    state: str | None = Field(default=None, description="The state of the RMSE.")
    rmse: Number | None = Field(default=None, description="Root mean square error of the state over the run.")
    delay: Number | None = Field(default=None, description="Median delay in s of the faults found.")
    false_alarms: int | None = None
    curve: RunCurve | None = None
    links: dict[str, str]


class RunGroup(Strict):
    """A group of the runs that were found."""

    model_config = example(key="zhao-2012", title="Adaptive observer for actuator and sensor faults", n=6)

    key: str = Field(description="Id of the experiment, empty without one; or the tags as a JSON list.")
    title: str
    n: int = Field(description="Number of runs of the group that were found.")


class RunTag(Strict):
    """A tag with the number of its runs."""

    model_config = example(tag="lab 2", n=12)

    tag: str
    n: int


class RunCounts(Strict):
    """How many runs the list has, without filter, and how many were found."""

    model_config = example(**_COUNTS)

    all: int
    pinned: int
    kinds: dict[RunKind, int]
    found: int = Field(description="Stored runs that meet the filter.")


class RunList(Strict):
    """Active runs, then the stored ones; and figures of the store."""

    runs: tuple[RunLine, ...]
    groups: tuple[RunGroup, ...] = ()
    tags: tuple[RunTag, ...] = ()
    counts: RunCounts
    store: RunUsage


class RunNotes(Strict):
    """What a client changes about a run of its own; fields that are left out stay."""

    model_config = example(name="quick", tags=["fig. 4"], pinned=True)

    name: Annotated[str, Field(max_length=120), AfterValidator(one_line)] | None = None
    tags: Annotated[tuple[Tag, ...], Field(max_length=12)] | None = None
    pinned: bool | None = None
