"""What the wall and the phones of a room show."""

from thetascope.classroom.faults.outcomes import outcome_of, own_view, panels_of, rank_of
from thetascope.classroom.faults.own_round import OwnRound
from thetascope.classroom.people.students import Student
from thetascope.classroom.room import Room
from thetascope.classroom.rounds import FollowRound
from thetascope.messages import Message
from thetascope.runs.specs.refusals import NotReady, Unknown
from thetascope_schemas.service.classroom.views import Marked, Replay, RoundView, SeatView, Tile, WallView

_DIGITS = 5


def wall_view(room: Room) -> WallView:
    """Return what the wall shows."""
    votes = room.round.counts() if isinstance(room.round, FollowRound) else ()
    tiles = tuple(_tile(room, student) for student in room.students.values())
    return WallView(code=room.code, tiles=tiles, votes=votes, round=_round_view(room), grades=room.grades)


def seat_view(room: Room, student: Student) -> SeatView:
    """Return what a student's phone shows: nothing of others but their number and, after the reveal, one's rank."""
    step = room.round.step if isinstance(room.round, FollowRound) else None
    own = room.round if isinstance(room.round, OwnRound) else None
    return SeatView(
        code=room.code,
        animal=student.animal,
        name=student.name,
        students=len(room.students),
        round=_round_view(room),
        vote=None if step is None else step.votes.get(student.id),
        answer=None if own is None else own.answers.get(student.id),
        outcome=None if own is None else outcome_of(own, student.id),
        rank=None if own is None else rank_of(own, student.id),
    )


def replay_of(room: Room, id: str) -> Replay:
    """Return a student's record as far as it was played. Raises Unknown, NotReady."""
    if id not in room.students:
        raise Unknown(Message("classroom.no-student"))
    own = room.own()
    rows = own.rows(id, room.now)
    if rows is None:
        raise NotReady(Message("classroom.no-record"))
    return Replay(
        id=id,
        record=own.setup.record,
        panels=panels_of(own.setup),
        values=tuple(tuple(float(f"{value:.{_DIGITS}g}") for value in row) for row in rows.tolist()),
        answer=own.answers.get(id),
        outcome=outcome_of(own, id),
    )


def _round_view(room: Room) -> RoundView | None:
    if room.round is None:
        return None
    if isinstance(room.round, OwnRound):
        return own_view(room.round, room.now)
    live = bool(room.round.lead.session)
    return RoundView(number=room.round.number, kind="follow", lead=room.round.lead_view(live))


def _tile(room: Room, student: Student) -> Tile:
    answered, choice, mark, answer, outcome = False, None, None, None, None
    if isinstance(room.round, FollowRound) and room.round.step is not None:
        step = room.round.step
        vote = step.votes.get(student.id)
        answered, mark = vote is not None, room.round.mark(student.id)
        choice = vote if step.lead.phase == "after" else None
    elif isinstance(room.round, OwnRound):
        answered = student.id in room.round.answers
        outcome = outcome_of(room.round, student.id)
        answer = room.round.answers.get(student.id) if room.round.revealed else None
        mark = _mark(None if outcome is None else outcome.right)
    return Tile(
        id=student.id,
        animal=student.animal,
        name=student.name,
        asleep=student.is_asleep(room.now),
        answered=answered,
        choice=choice,
        mark=mark,
        answer=answer,
        outcome=outcome,
    )


def _mark(right: bool | None) -> Marked:
    return None if right is None else "right" if right else "wrong"
