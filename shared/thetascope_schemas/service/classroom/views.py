"""What the wall and the phones of a classroom are sent: the whole state, each time that it has changed."""

from typing import Literal

from pydantic import Field

from thetascope_schemas.experiment.base import Number, Strict
from thetascope_schemas.service.classroom.requests import Caption, CurveLine, CurveStrip, StepCard
from thetascope_schemas.service.learning.challenge import ChallengeAnswer, HiddenFault
from thetascope_schemas.service.learning.mystery import MysteryChoice
from thetascope_schemas.service.learning.questions import Words

Marked = Literal["right", "wrong"] | None


class Outcome(Strict):
    """An answer after the reveal: the truth, what could be told of it, and what the detector found."""

    right: bool | None = Field(description="null: there was no answer.")
    points: int | None = Field(description="Of 100; null: there was no answer.")
    fault: HiddenFault | None = Field(description="null: nothing was wrong.")
    after: Number | None = Field(description="Seconds of the record from its beginning to the answer.")
    told: Number | None = Field(description="Time in s from which it could be told from all others; null: never.")
    alike: tuple[str, ...] = Field(description="The channels that look alike until the end.")
    detector: ChallengeAnswer | None
    detector_points: int = Field(description="Points of the detector's answer, of 100.")


class Tile(Strict):
    """A student on the wall."""

    id: str
    animal: Caption
    name: str | None
    asleep: bool = Field(description="Whether no page of this student is connected; the place is kept.")
    answered: bool
    choice: int | None = Field(description="Place of the vote, after the step was run.")
    mark: Marked
    answer: ChallengeAnswer | None = Field(description="About the hidden fault, after the reveal.")
    outcome: Outcome | None = Field(description="After the reveal.")


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
    kind: Literal["follow", "own"]
    revealed: bool = Field(default=False, description="Whether the hidden faults are shown.")
    left: Number | None = Field(default=None, description="Seconds until they are; null: no time runs.")
    title: Words | None = Field(default=None, description="The plant of hidden faults.")
    choices: tuple[MysteryChoice, ...] = Field(default=(), description="The faults among which students choose.")
    horizon: Number | None = Field(default=None, description="Length of a record in s.")
    lead: LeadView | None


class GradesView(Strict):
    """The points of students who came from a learning platform, on their way to its gradebook."""

    sent: int = Field(description="Students whose points the gradebook has taken.")
    waiting: int = Field(description="Students whose points are being sent.")
    failed: int = Field(description="Students whose points the gradebook did not take.")
    why: str = Field(description="Why, in a few words, as `HTTP 403`; empty: nothing failed.")


class WallView(Strict):
    """Everything on the wall. Votes are counted; answers come after the reveal."""

    type: Literal["wall"] = "wall"
    code: str
    tiles: tuple[Tile, ...]
    votes: tuple[int, ...] = Field(description="Votes for each answer of the step.")
    round: RoundView | None
    grades: GradesView | None = Field(default=None, description="null: nobody came from a learning platform.")


class SeatView(Strict):
    """Everything on a student's phone."""

    type: Literal["seat"] = "seat"
    code: str
    animal: Caption
    name: str | None
    students: int = Field(description="Students in the room.")
    round: RoundView | None
    vote: int | None = Field(description="Place of the student's vote in this step.")
    answer: ChallengeAnswer | None = Field(description="The student's answer about the hidden fault.")
    outcome: Outcome | None = Field(description="After the reveal.")
    rank: int | None = Field(description="Place among the right answers by speed, after the reveal.")


class JoinedRoom(Strict):
    """A student's place in a room. The token keeps it."""

    token: str
    seat: SeatView


class ClassSetup(Strict):
    """A plant in which faults can be hidden."""

    id: str
    title: Words


class ClassSetups(Strict):
    """The plants in which faults can be hidden."""

    setups: tuple[ClassSetup, ...]


class RoomOpened(Strict):
    """A room, as its teacher gets it. The token is that of the teacher."""

    token: str
    code: str
    address: str = Field(description="Where students join.")
    reachable: bool = Field(description="Whether other machines can reach that address.")
    qr: tuple[str, ...] = Field(description="The QR code of the address: a text of 0 and 1 for each row.")


class CurvePanel(Strict):
    """A strip of its own for one curve."""

    symbol: str
    title: Caption
    unit: str
    line: CurveLine


class Replay(Strict):
    """The record of a student, for the wall."""

    id: str
    record: Number = Field(description="Time in s between rows.")
    panels: tuple[CurvePanel, ...]
    values: tuple[tuple[Number | None, ...], ...] = Field(description="The rows of each strip.")
    answer: ChallengeAnswer | None
    outcome: Outcome | None


class CurvesHead(Strict):
    """The first text on the stream of curves, and again after every change of columns; binary frames follow it.

    A frame has the header of a session's frames (thetascope_schemas.service.session).
    """

    type: Literal["curves"] = "curves"
    strip: CurveStrip | None = Field(description="null: there are no curves of the teacher's session now.")
    panels: tuple[CurvePanel, ...] = Field(default=(), description="A strip for each curve of a record of one's own.")
    record: Number = Field(description="Time in s between rows.")
    epoch: int
    row: int = Field(description="Number of the first row that follows.")
    horizon: Number | None = Field(description="Length of the axis of time in s; null: it grows.")
