"""Notes of a session: they are part of its spec, and of none of its numbers."""

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from tests.live.stage import Stage, kinds, same, staged
from tests.runs.samples import spec
from thetascope import library
from thetascope.engine.errors import SpecError
from thetascope.live.session.session import Session
from thetascope_schemas import Experiment
from thetascope_schemas.experiment.figures import MAX_NOTE, MAX_NOTES, Note
from thetascope_schemas.service.session import ClientMessage

COMMAND = TypeAdapter(ClientMessage)
FAULT = {"channel": "gain", "shape": "step", "onset": 0, "size": 0.3}


def begun(rows: int = 101, **changes) -> Session:
    session = Session(library.resolve(spec(**({"evaluate": 0.01} | changes))), 10_000)
    session.advance(rows)
    return session


def do(session: Session, type: str, **fields):
    return session.handle(COMMAND.validate_python({"type": type, "id": 0, **fields}))


def add(session: Session, id: str, t: float, text: str = "") -> None:
    assert do(session, "add-note", note={"id": id, "t": t, "text": text}) == ([], False)


def notes(session: Session) -> list[tuple[str, float, str]]:
    return [(note.id, note.t, note.text) for note in session.spec.notes]


def test_notes_are_added_changed_and_removed_in_order_of_time():
    """Of the id that is there already it is a change; what is removed can be added again as it was."""
    session = begun()
    add(session, "late", 0.9, "late")
    add(session, "early", 0.2)
    assert notes(session) == [("early", 0.2, ""), ("late", 0.9, "late")]
    add(session, "early", 0.2, "here it begins")
    do(session, "remove-note", note="late")
    assert notes(session) == [("early", 0.2, "here it begins")]
    add(session, "late", 0.9, "late")
    assert [id for id, _, _ in notes(session)] == ["early", "late"]


def test_notes_change_neither_a_row_nor_the_id_of_the_run():
    """Rows, events and epoch are those of a session without notes, and so is the hash of the spec."""
    plain, noted = begun(), begun()
    for session in (plain, noted):
        do(session, "inject", fault=FAULT)
        if session is noted:
            add(session, "first", 0.5, "before the fault is seen")
        session.advance(50)
        do(session, "set-noise", output="y", std=0.02)
        if session is noted:
            do(session, "remove-note", note="first")
            add(session, "second", 1.2)
        session.advance(50)
    np.testing.assert_array_equal(noted.rows(0, noted.row), plain.rows(0, plain.row))
    assert (noted.log, noted.epoch) == (plain.log, plain.epoch)
    assert noted.spec != plain.spec and noted.spec.spec_hash() == plain.spec.spec_hash()


def test_going_back_discards_notes_on_what_comes_after_it():
    """A fork at an earlier time likewise; what the session began with stays, also after a reset."""
    own = {"id": "own", "t": 5.0, "text": "of the experiment"}
    session = begun(notes=[own])
    add(session, "early", 0.2)
    add(session, "late", 0.9)
    fork = session.fork(50)
    assert [id for id, _, _ in notes(fork)] == ["early", "own"]
    assert [id for id, _, _ in notes(session)] == ["early", "late", "own"]
    add(session, "own", 5.0, "another text")  # its moment is still to come, and its text may change
    do(session, "seek", t=0.5)
    assert notes(session) == [("early", 0.2, ""), ("own", 5.0, "another text")]
    do(session, "reset")
    assert notes(session) == [("own", 5.0, "of the experiment")]


def test_a_note_that_does_not_fit_is_refused_with_its_field():
    """Ahead of time, unknown, too many: the session is as it was."""
    session = begun()
    for index in range(MAX_NOTES):
        add(session, f"n{index}", 0.1)
    before = session.spec
    for type, note, field, code in (
        ("add-note", {"id": "ahead", "t": 2.0}, "note.t", "session.note.ahead"),
        ("add-note", {"id": "more", "t": 0.5}, "note", "session.notes.many"),
        ("remove-note", "nothing", "note", "session.note.unknown"),
    ):
        with pytest.raises(SpecError) as refused:
            do(session, type, note=note)
        assert (refused.value.field, refused.value.problem.code) == (field, code)
    assert session.spec is before
    add(session, "n7", 0.4, "one of them may still change")
    for wrong in ({"id": "UPPER", "t": 0}, {"id": "a", "t": -1}, {"id": "a", "t": 0, "text": "x" * (MAX_NOTE + 1)}):
        with pytest.raises(ValidationError):
            COMMAND.validate_python({"type": "add-note", "id": 1, "note": wrong})


def test_the_text_of_a_note_is_one_line_that_can_be_shown():
    """Line breaks, control characters and those that turn the direction of writing become blanks."""
    text = Note(id="a", t=0, text=" one\r\ntwo\x00\x1b[31m\u202ethree <b>θ̂</b> ").text
    assert text == "one two [31m three <b>θ̂</b>"


def test_an_experiment_names_the_notes_that_share_an_id():
    """As of observers and figures."""
    twice = [{"id": "same", "t": 1}, {"id": "same", "t": 2}]
    with pytest.raises(ValidationError, match="same"):
        Experiment.model_validate(spec().model_dump() | {"notes": twice})


def test_viewers_see_the_notes_of_the_owner_and_add_none():
    """In a room: an answer, the new experiment for all, no event; frames go on as if nothing had happened."""

    async def scenario(stage: Stage) -> None:
        owner, guest = await stage.connect(), await stage.connect(control=False)
        await stage.say(owner, "play")
        await stage.go(0.4)
        answer = await stage.say(owner, "add-note", note={"id": "a", "t": 0.2, "text": "look here"})
        assert answer["type"] == "ack"
        await stage.go(0.3)
        assert guest.of("spec")[-1]["spec"]["notes"] == [{"id": "a", "t": 0.2, "text": "look here"}]
        assert kinds(owner.of("event"))[:1] == ["fault-begins"] and owner.of("rewound") == []
        for command in ({"type": "add-note", "note": {"id": "b", "t": 0.1}}, {"type": "remove-note", "note": "a"}):
            answer = await stage.say(guest, **command)
            assert (answer["type"], answer["code"]) == ("refused", "session.view-only")
        late = await stage.connect()
        await stage.go(0.1)
        assert [note["id"] for note in late.texts[0]["spec"]["notes"]] == ["a"]
        saved = stage.room.spec()
        assert [note.id for note in saved.notes] == ["a"]
        same(owner.rows(), stage.session.spec, owner.texts[0]["columns"])

    staged(scenario)
