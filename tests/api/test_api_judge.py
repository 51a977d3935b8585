"""POST /api/sessions/{id}/judge: a step of a lesson, measured in a session of the service."""

from tests.api.streams import watching

LESSON = "a-threshold-you-can-defend"
BELOW = 5
"""The place of the step that compares the mean of ten minutes before its mark with that after it."""


def test_numbers_before_the_mark_and_the_value_of_a_dial_are_measured(client, address):
    """Rows before the mark are read where a measure asks for them; a level that was set is the one of the body."""
    lesson = client.get(f"/api/course/{LESSON}")
    session = client.post("/api/sessions", {"spec": lesson["experiments"]["healthy"], "play": False, "t": 100})
    with watching(address, session) as page:
        page.receive()
        page.say("step", rows=100)
        page.until(lambda: page.end == 601)
    path = f"/api/sessions/{session['id']}/judge"
    judged = client.post(path, {"lesson": LESSON, "step": BELOW, "mark": 100})
    assert abs(judged["values"]["before"]) < 0.01, "the mean of the hundred seconds before"
    cries = [
        client.post(path, {"lesson": LESSON, "step": 2, "mark": 20, **dial})["values"]["alarms"]
        for dial in ({}, {"dial": 0.02}, {"dial": 0.05}, {"dial": 1})
    ]
    assert cries[0] is None and cries[1] > cries[2] > cries[3] == 0
