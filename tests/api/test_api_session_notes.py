"""Notes of a session over the websocket and REST: kept by a fork, a save and a session opened from the saved run."""

import pytest

from tests.api.streams import FAULT, opened, watching
from thetascope.client import ServiceError

EARLY, LATE = {"id": "early", "t": 0.4, "text": "before the fault"}, {"id": "late", "t": 1.0, "text": ""}


def noted(client, address) -> dict:
    """Return a paused session at 1.2 s with two notes."""
    session = opened(client, t=1.2, play=False)
    with watching(address, session) as page:
        for note in (LATE, EARLY):
            assert page.say("add-note", note=note)["type"] == "ack"
    return session


def test_notes_are_kept_by_a_fork_a_save_and_the_session_of_the_saved_run(client, address):
    """The run has the id that it has without notes, and its report lists them; a fork at 0.5 s has the early one."""
    plain = opened(client, t=1.2, play=False)
    saved = client.post(plain["links"]["save"], headers={"X-Control-Token": plain["token"]})
    session = noted(client, address)
    run = client.post(session["links"]["save"], headers={"X-Control-Token": session["token"]})
    assert run["id"] == saved["id"] and run["spec"]["notes"] == [EARLY, LATE]
    again = client.get(f"/api/runs/{run['id']}")
    assert again["spec"]["notes"] == [EARLY, LATE]
    live = client.post("/api/sessions", {"spec": again["spec"], "t": again["spec"]["horizon"], "play": False})
    assert client.get(live["links"]["self"])["spec"]["notes"] == [EARLY, LATE]
    fork = client.post(session["links"]["fork"], {"t": 0.5})
    assert client.get(fork["links"]["self"])["spec"]["notes"] == [EARLY]
    assert client.get(session["links"]["self"])["spec"]["notes"] == [EARLY, LATE]


def test_a_batch_may_hold_notes_and_a_refusal_names_their_field(client, address):
    """All or none; also where the second note is wrong. A viewer's are refused."""
    session = opened(client, t=1.2, play=False)
    with watching(address, session) as page:
        fault, ahead = {"type": "inject", "fault": FAULT}, EARLY | {"id": "ahead", "t": 50}
        answer = page.say("batch", commands=[fault, {"type": "add-note", "note": ahead}])
        assert (answer["field"], answer["code"]) == ("commands[1].note.t", "session.note.ahead")
        assert client.get(session["links"]["self"])["spec"]["notes"] == []
        answer = page.say("batch", commands=[{"type": "add-note", "note": EARLY}, {"type": "remove-note", "note": "x"}])
        assert answer["field"] == "commands[1].note"
        assert page.say("batch", commands=[fault, {"type": "add-note", "note": EARLY}])["type"] == "ack"
        assert page.say("add-note", note=EARLY | {"text": "x" * 501})["field"] == "note.text"
        assert page.say("add-note", note=EARLY | {"id": "<b>"})["field"] == "note.id"
    with watching(address, session, token="") as guest:
        assert guest.receive()["spec"]["notes"] == [EARLY]
        assert guest.say("remove-note", note="early")["code"] == "session.view-only"


def test_an_experiment_with_too_many_notes_is_refused(client):
    """At most a hundred."""
    many = [{"id": f"n{index}", "t": 0.1} for index in range(101)]
    with pytest.raises(ServiceError, match="100"):
        client.post("/api/runs", {"plant": "zhao-contois", "horizon": 1, "notes": many})
