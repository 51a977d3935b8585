"""What the wall and the phones of a classroom are sent: the whole state, each time that it has changed."""

from typing import Literal

from pydantic import Field

from thetascope_schemas.experiment.base import Number, Strict
from thetascope_schemas.service.classroom.requests import Caption, CurveStrip, StepCard

Marked = Literal["right", "wrong"] | None


class Tile(Strict):
    """A student on the wall."""

    id: str
    animal: Caption
    name: str | None
    asleep: bool = Field(description="Whether no page of this student is connected; the place is kept.")
    answered: bool
    choice: int | None = Field(description="Place of the vote, after the step was run.")
    mark: Marked


class LeadView(Strict):
    """What the teacher shows."""

    live: bool = Field(description="Whether curves of a session come on the stream of curves.")
    step: str
    card: StepCard | None
    phase: Literal["before", "running", "after"]
    since: Number | None = Field(description="Where the axis of time begins, in s; null: it follows.")
    until: Number | None = Field(description="Time in s until which the step will run; null: it has run.")
    right: tuple[bool, ...]


class RoundView(Strict):
    """The present round."""

    number: int = Field(description="Of the round, counted from 1.")
    kind: Literal["follow"]
    lead: LeadView | None


class WallView(Strict):
    """Everything on the wall. Votes are counted; answers come after the reveal."""

    type: Literal["wall"] = "wall"
    code: str
    tiles: tuple[Tile, ...]
    votes: tuple[int, ...] = Field(description="Votes for each answer of the step.")
    round: RoundView | None


class SeatView(Strict):
    """Everything on a student's phone."""

    type: Literal["seat"] = "seat"
    code: str
    animal: Caption
    name: str | None
    students: int = Field(description="Students in the room.")
    round: RoundView | None
    vote: int | None = Field(description="Place of the student's vote in this step.")


class JoinedRoom(Strict):
    """A student's place in a room. The token keeps it."""

    token: str
    seat: SeatView


class RoomOpened(Strict):
    """A room, as its teacher gets it. The token is that of the teacher."""

    token: str
    code: str
    address: str = Field(description="Where students join.")
    reachable: bool = Field(description="Whether other machines can reach that address.")
    qr: tuple[str, ...] = Field(description="The QR code of the address: a text of 0 and 1 for each row.")


class CurvesHead(Strict):
    """The first text on the stream of curves, and again after every change of columns; binary frames follow it.

    A frame has the header of a session's frames (thetascope_schemas.service.session).
    """

    type: Literal["curves"] = "curves"
    strip: CurveStrip | None = Field(description="null: there are no curves now.")
    record: Number = Field(description="Time in s between rows.")
    epoch: int
    row: int = Field(description="Number of the first row that follows.")
    horizon: Number | None = Field(description="Length of the axis of time in s; null: it grows.")
