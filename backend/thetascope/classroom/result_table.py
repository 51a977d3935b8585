"""The results of a room as CSV, for a gradebook."""

import csv
import io

from thetascope.classroom.faults.outcomes import outcome_of
from thetascope.classroom.faults.own_round import OwnRound
from thetascope.classroom.room import Room
from thetascope.classroom.rounds import FollowRound, mark_of
from thetascope.export.csv_format import as_text

HEADER = ("student", "name", "round", "question", "answer", "right", "seconds", "points")

_SAID = {"none": "nothing is wrong", "cannot-be-told": "cannot be told"}


def csv_of(room: Room) -> bytes:
    """Return a row for each student and question. No cell begins a formula; an answer that is missing is empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEADER)
    for one in (*room.past, *((room.round,) if room.round is not None else ())):
        for row in _of_votes(room, one) if isinstance(one, FollowRound) else _of_answers(room, one):
            writer.writerow([as_text(cell) for cell in row])
    return text.getvalue().encode()


def _of_votes(room: Room, one: FollowRound) -> list[tuple[str, ...]]:
    """Return the votes of all students for the steps that were shown."""
    rows = []
    for name, step in one.steps.items():
        card = step.lead.card
        if card is None or not card.options:
            continue
        for student in room.students.values():
            choice = step.votes.get(student.id)
            said = "" if choice is None else card.options[choice].en
            mark = {"right": "1", "wrong": "0", None: ""}[mark_of(step, student.id)]
            rows.append((student.animal.en, student.name or "", str(one.number), name, said, mark, "", ""))
    return rows


def _of_answers(room: Room, one: OwnRound) -> list[tuple[str, ...]]:
    """Return the answers of all students about the hidden faults; marks and points come after the reveal."""
    rows = []
    for student in room.students.values():
        answer, outcome = one.answers.get(student.id), outcome_of(one, student.id)
        said = "" if answer is None else _SAID.get(answer.verdict, answer.channel or "")
        if answer is not None and answer.alike:
            said = f"{said}: {' / '.join(answer.alike)}"
        right = "" if outcome is None or outcome.right is None else str(int(outcome.right))
        after = "" if outcome is None or outcome.after is None else str(outcome.after)
        points = "" if outcome is None or outcome.points is None else str(outcome.points)
        question = f"hidden fault: {one.setup.title.en}"
        names = (student.animal.en, student.name or "", str(one.number))
        rows.append((*names, question, said, right, after, points))
    return rows
