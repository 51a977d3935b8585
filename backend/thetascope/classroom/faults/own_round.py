"""A round in which each student has a record of their own with a hidden fault, played row by row."""

import asyncio
import logging
from dataclasses import dataclass, field
from math import ceil, floor
from secrets import token_hex
from typing import TYPE_CHECKING

import numpy as np

from thetascope.classroom.faults.computing import Computing
from thetascope.messages import Message
from thetascope.runs.specs.refusals import NotReady, invalid
from thetascope_schemas.service.classroom.requests import AnswerRequest
from thetascope_schemas.service.learning.challenge import MOST_ACCUSATIONS, Accusation, ChallengeAnswer
from thetascope_schemas.service.learning.mystery import MysterySetup

if TYPE_CHECKING:
    from thetascope.classroom.faults.challenge_jobs import ClassRecord, Material

log = logging.getLogger(__name__)

DISTINCT = 24
"""Different hidden faults of one round. With more students than that, some share one: what could be told of one takes
seconds of processor time."""
_AGAIN = (0.0, 2.0, 10.0)
"""Seconds before each attempt to compute what answers are graded with."""
_PLAYED = 0.5
"""Share of the round's time in which the record is played; the rest is for thinking."""


@dataclass
class Seat:
    """A student in the round: the place of the fault, and when the record began to play, s; None: it is prepared."""

    place: int
    begun: float | None = None


@dataclass
class OwnRound:
    """A round of hidden faults.

    Args:
        number: of the round, from 1.
        setup: plant, inputs and suspects.
        seconds: time for the answers.
        started: when the first record could be played; the time runs from then on.
        shown: set by the reveal.
    """

    number: int
    setup: MysterySetup
    seconds: float
    started: float | None = None
    shown: asyncio.Event = field(default_factory=asyncio.Event)
    seats: dict[str, Seat] = field(default_factory=dict)
    answers: dict[str, ChallengeAnswer] = field(default_factory=dict)
    records: dict[int, "ClassRecord"] = field(default_factory=dict)
    materials: dict[int, "Material"] = field(default_factory=dict)
    secret: str = field(default_factory=lambda: token_hex(16))
    tasks: set["asyncio.Task[None]"] = field(default_factory=set)

    @property
    def revealed(self) -> bool:
        """Return whether the hidden faults are shown."""
        return self.shown.is_set()

    @property
    def pace(self) -> float:
        """Seconds of the record in a second."""
        return self.setup.horizon / (_PLAYED * self.seconds)

    def seat(self, student: str) -> Seat:
        """Return a student's seat; a new one gets the next fault."""
        if student not in self.seats:
            self.seats[student] = Seat(len(self.seats) % DISTINCT)
        return self.seats[student]

    # ---- time --------------------------------------------------------------------------------------------------------

    def left(self, now: float) -> float | None:
        """Return the seconds until the reveal; None before the first record is there, and after it."""
        return None if self.started is None or self.revealed else max(0.0, self.started + self.seconds - now)

    def begin_seat(self, student: str, now: float) -> bool:
        """Let a student's record play if it is there; return whether it began now."""
        seat = self.seat(student)
        if seat.begun is not None or seat.place not in self.records:
            return False
        seat.begun = now
        self.started = now if self.started is None else self.started
        return True

    def time(self, student: str, now: float) -> float:
        """Return the time of a student's record that is played, s."""
        begun = self.seat(student).begun
        if self.revealed:
            return self.setup.horizon
        return 0.0 if begun is None else min(self.setup.horizon, (now - begun) * self.pace)

    # ---- rows --------------------------------------------------------------------------------------------------------

    def rows(self, student: str, now: float) -> np.ndarray | None:
        """Return the rows that a student has seen, outputs × rows; None where the record is not there."""
        seat = self.seat(student)
        record = self.records.get(seat.place)
        if record is None or (seat.begun is None and not self.revealed):
            return None
        return record.residuals[:, : floor(self.time(student, now) / self.setup.record + 1e-9) + 1]

    def next_row(self, student: str, now: float) -> float | None:
        """Return the seconds until the next row; None where none follows by itself."""
        seat = self.seat(student)
        if seat.begun is None or self.revealed or self.time(student, now) >= self.setup.horizon:
            return None
        rows = ceil((now - seat.begun) * self.pace / self.setup.record + 1e-6)
        return max(0.0, seat.begun + rows * self.setup.record / self.pace - now)

    # ---- answers -----------------------------------------------------------------------------------------------------

    def answer(self, student: str, given: AnswerRequest, now: float) -> None:
        """Keep an answer. A channel that an earlier answer named, and this one does not, was accused.

        Raises NotReady when the time is up, InvalidSpec for a channel that the plant does not have.
        """
        left = self.left(now)
        if given.round != self.number or self.seat(student).begun is None or left is None or left <= 0:
            raise NotReady(Message("classroom.answer-closed"))
        names = [suspect.channel for suspect in self.setup.suspects]
        for name in (*given.alike, *(() if given.channel is None else (given.channel,))):
            if name not in names:
                raise invalid("channel", name, Message("challenge.channel.unknown", name=name[:64]))
        before = self.answers.get(student)
        accused = () if before is None else before.accused
        named = {given.channel, *given.alike}
        if before is not None and before.channel is not None and before.channel not in named:
            accused = (*accused, Accusation(channel=before.channel, at=before.at))[:MOST_ACCUSATIONS]
        if before is not None and given.channel is not None:  # who comes back to a name has not accused it wrongly
            accused = tuple(one for one in accused if one.channel != given.channel)
        self.answers[student] = ChallengeAnswer(
            verdict=given.verdict,
            channel=given.channel,
            alike=given.alike,
            onset=given.onset,
            size=given.size,
            at=round(self.time(student, now), 3),
            accused=accused,
        )

    # ---- computing ---------------------------------------------------------------------------------------------------

    def key(self, place: int) -> str:
        """Return the key of a fault; nobody else knows the secret in it."""
        return f"class:{self.secret}:{place}"

    async def prepare(self, place: int, computing: Computing) -> bool:
        """Compute the record of a place; return whether it is there now."""
        if place in self.records:
            return True
        try:
            self.records[place] = await computing.record(self.key(place), self.setup.id)
        except Exception:
            log.exception("a record of a classroom could not be computed")
            return False
        return True

    async def examine(self, place: int, computing: Computing) -> None:
        """Compute what answers about the fault of a place are graded with."""
        for pause in _AGAIN:
            if place in self.materials:
                return
            await asyncio.sleep(pause)
            try:
                self.materials[place] = await computing.material(self.key(place), self.setup.id, self.shown)
            except Exception:
                log.exception("the truth of a classroom could not be computed")

    def stop(self) -> None:
        """End the computations."""
        for task in self.tasks:
            task.cancel()
