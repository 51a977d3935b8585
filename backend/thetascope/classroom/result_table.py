"""The results of a room as CSV, for a gradebook."""

import csv
import io

from thetascope.classroom.room import Room
from thetascope.classroom.rounds import FollowRound, mark_of
from thetascope.export.csv_format import as_text

HEADER = ("student", "name", "round", "question", "answer", "right")


def csv_of(room: Room) -> bytes:
    """Return a row for each student and question. No cell begins a formula; an answer that is missing is empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEADER)
    for one in (*room.past, *((room.round,) if room.round is not None else ())):
        for row in _of_votes(room, one):
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
            rows.append((student.animal.en, student.name or "", str(one.number), name, said, mark))
    return rows
