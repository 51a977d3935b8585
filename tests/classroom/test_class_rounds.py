"""Rounds of a class without a service: time, rows, answers, votes; who is asleep; rooms that end by themselves."""

import asyncio
from itertools import count

import numpy as np
import pytest

from thetascope import library
from thetascope.classroom.faults.challenge_jobs import ClassRecord, Material
from thetascope.classroom.faults.outcomes import outcome_of, rank_of
from thetascope.classroom.faults.own_round import DISTINCT, OwnRound
from thetascope.classroom.people.nicknames import animals, free_animal
from thetascope.classroom.room import Room
from thetascope.classroom.rooms import IDLE, LONGEST, MOST_STUDENTS, Rooms
from thetascope.classroom.rounds import FollowRound
from thetascope.runs.specs.refusals import NotReady, OverLimit, Unknown
from thetascope_schemas.service.classroom.requests import AnswerRequest, LeadRequest
from thetascope_schemas.service.learning.challenge import ChallengeAnswer, ChallengeTruth, HiddenFault

SETUP = library.mysteries()["motor"]  # 8 s, a row every 0.02 s
FAULT = HiddenFault(channel="gain_loss", shape="step", onset=2.0, size=0.1)
TRUTH = ChallengeTruth(fault=FAULT, end=8.0, rivals=(), seen=((2.0, 0.0), (8.0, 90.0)))
CARD = {"place": 1, "of": 2, "title": {"en": "T", "zh": "题"}, "options": [{"en": "a", "zh": "甲"}] * 2}


def answer(**change: object) -> AnswerRequest:
    return AnswerRequest(**{"round": 1, "verdict": "channel", "channel": "gain_loss", "onset": 2, "size": 0.1} | change)


@pytest.fixture
def own() -> OwnRound:
    """A round of 80 s whose first student's record plays from 100 s on, five times slower than it was recorded."""
    made = OwnRound(1, SETUP, 80.0)
    made.seat("ada"), made.seat("bob")
    made.records[0] = ClassRecord(np.arange(802, dtype="<f4").reshape(2, 401))
    assert made.begin_seat("ada", 100.0) and not made.begin_seat("ada", 101.0) and not made.begin_seat("bob", 101.0)
    return made


def test_a_record_plays_row_by_row(own):
    """Nobody sees a row before its time; after the reveal all are there."""
    assert own.rows("ada", 100.0).shape == (2, 1) and own.rows("bob", 100.0) is None
    assert own.rows("ada", 110.0).shape == (2, 101) and own.time("ada", 110.0) == pytest.approx(2.0)
    assert own.next_row("ada", 110.05) == pytest.approx(0.05) and own.next_row("ada", 150.0) is None
    assert own.left(110.0) == 70.0
    own.shown.set()
    assert own.rows("ada", 110.0).shape == (2, 401) and own.left(110.0) is own.next_row("ada", 110.0) is None


def test_students_share_faults_beyond_a_number():
    """Grading one fault takes seconds; the first students have different ones."""
    made = OwnRound(1, SETUP, 80.0)
    places = [made.seat(str(n)).place for n in range(DISTINCT + 2)]
    assert places == [*range(DISTINCT), 0, 1] and len({made.key(n) for n in range(DISTINCT)}) == DISTINCT


def test_answers_count_until_the_time_is_up(own):
    """The time of the record is kept with an answer; another name before it was an accusation, unless it came back."""
    own.answer("ada", answer(channel="speed_bias"), 110.0)
    own.answer("ada", answer(), 120.0)
    given = own.answers["ada"]
    assert given.at == pytest.approx(4.0) and [one.channel for one in given.accused] == ["speed_bias"]
    own.answer("ada", answer(channel="speed_bias"), 130.0)
    assert [one.channel for one in own.answers["ada"].accused] == ["gain_loss"]
    for late in (180.0, 300.0):
        with pytest.raises(NotReady):
            own.answer("ada", answer(), late)
    with pytest.raises(NotReady):
        own.answer("bob", answer(), 120.0)  # whose record does not play yet


def test_outcomes_come_with_the_reveal(own):
    """Before it an answer has no outcome; then right answers are ranked by the time after the fault."""
    own.materials[0] = own.materials[1] = Material(
        TRUTH, ChallengeAnswer(verdict="channel", channel="gain_loss", at=3.0)
    )
    own.records[1] = own.records[0]
    own.begin_seat("bob", 100.0)
    own.answer("ada", answer(), 125.0)
    own.answer("bob", answer(), 120.0)
    assert outcome_of(own, "ada") is None and rank_of(own, "ada") is None
    own.shown.set()
    ada = outcome_of(own, "ada")
    assert ada.right and ada.after == pytest.approx(3.0) and ada.fault == FAULT and ada.told == 2.0
    assert (rank_of(own, "bob"), rank_of(own, "ada")) == (1, 2)
    assert outcome_of(own, "eve") is None


def test_votes_of_a_step_that_is_shown_again_start_anew():
    """A step that was run and is shown again is voted on again; one that was not run keeps its votes."""
    made = FollowRound(1)
    before = LeadRequest(step="s", card=CARD)
    made.show(before, 0.0)
    assert made.vote("ada", "s", 1, 1.0) and not made.vote("ada", "other", 1, 1.0) and not made.vote("ada", "s", 2, 1.0)
    made.show(LeadRequest(step="t", card=CARD), 2.0)
    made.show(before, 3.0)
    assert made.counts() == (0, 1)
    made.show(LeadRequest(step="s", card=CARD, phase="after", right=[True, False]), 4.0)
    assert made.mark("ada") == "wrong" and not made.vote("ada", "s", 0, 5.0)
    made.show(before, 6.0)
    assert made.counts() == (0, 0)


def test_nicknames_differ():
    """As long as there are animals; then they are numbered."""
    taken: list = []
    for _ in range(len(animals()) + 5):
        taken.append(free_animal(taken))
    assert len({one.en for one in taken}) == len({one.zh for one in taken}) == len(taken)
    assert {one.en[-1] for one in taken[-5:]} == {"2"}


def test_rooms_end_by_themselves():
    """When nobody uses them, or when they are old; their tokens then open nothing. A room can be full."""
    time = [0.0]

    async def live() -> None:
        rooms = Rooms(None, lambda: time[0])
        room, token = rooms.open("me")
        for _ in range(MOST_STUDENTS):
            rooms.join(room)
        with pytest.raises(OverLimit):
            rooms.join(room)
        time[0] += 200.0
        rooms.sweep()
        assert len(room.students) == 0  # none of them ever connected
        time[0] += IDLE + 1
        rooms.sweep()
        with pytest.raises(Unknown):
            rooms.of_teacher(token)
        used, _ = rooms.open("me")
        for _ in count():
            time[0] += IDLE / 2
            used.touch(time[0])
            rooms.sweep()
            if not len(rooms):
                break
        assert time[0] - used.opened > LONGEST
        rooms.stop()

    asyncio.run(live())


def test_who_sleeps_keeps_the_place():
    """A student without a page is asleep after a few seconds, and awake with the next page."""
    room = Room("ABCDEF", b"", "me", 9, 0.0)
    ada, _ = room.join(0.0)
    room.tick(3.0)
    assert not ada.is_asleep(3.0) and ada.is_asleep(10.0) and room.students == {ada.id: ada}
