"""/api/sessions over HTTP and its websocket, on the service as its users have it."""

import base64
import json
import random
import time

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed

from backend.client import Client, ServiceError
from shared.session import (
    CLOSE_ENDED,
    CLOSE_FULL,
    CLOSE_NO_SESSION,
    CLOSE_ORIGIN,
    CLOSE_TOKEN,
)
from tests.api.conftest import service, until
from tests.api.streams import Page, watching
from tests.live.test_messages import malformed
from tests.runs.samples import spec_data

FAULT = {"channel": "gain", "shape": "step", "onset": 0, "size": 0.3}


def opened(client: Client, **fields: object) -> dict:
    """A session on the small plant."""
    return client.post("/api/sessions", {"spec": spec_data(record=0.01), **fields})


def delete(client: Client, session: dict, token: str) -> int:
    """Status of a DELETE with this control token."""
    client._connection.request("DELETE", session["links"]["self"], headers={"X-Control-Token": token})
    answer = client._connection.getresponse()
    answer.read()
    return answer.status


def closed(page: Page) -> int:
    """The code with which the service closes a connection."""
    with pytest.raises(ConnectionClosed) as end:
        while True:
            page.receive()
    return end.value.rcvd.code


def test_a_session_plays_at_once_and_says_how_it_stands(client, address):
    """Open, look, watch: rows come at about thirty frames a second with real time."""
    session = opened(client)
    with watching(address, session) as page:
        hello = page.receive()
        assert (hello["type"], hello["role"], hello["session"], hello["playing"]) == ("hello", "control", session["id"], True)
        page.until(lambda: page.end > 150)
        begin, first = time.monotonic(), page.end
        page.until(lambda: page.end > first + 200)
        assert 1.6 < time.monotonic() - begin < 2.6
        status = client.get(session["links"]["self"])
        assert status["playing"] and status["viewers"] == 1 and abs(status["row"] - page.end) < 30
        assert status["spec"]["observers"][0]["label"] == "kalman" and status["parent"] is None


def test_a_saved_session_is_a_run_with_the_very_numbers_that_were_shown(client, address):
    """After faults, a changed input and noise, a rewind and an observer that came: every column, bit for bit."""
    session = opened(client, speed=10)
    with watching(address, session) as page:
        page.until(lambda: page.end > 50)
        page.say("inject", fault=FAULT)
        page.until(lambda: page.end > 150)
        page.say("set-signal", name="u", signal={"kind": "sine", "amplitude": 2, "frequency": 1})
        page.until(lambda: page.end > 250)
        assert page.say("seek", t=1.8)["row"] == 180
        page.say("set-noise", output="y", std=0.02)
        page.say("add-observer", observer={"label": "other", "kind": "adaptive-kalman"})
        page.say("clear")
        page.until(lambda: page.end > 400)
        page.say("pause")
        client.get(session["links"]["self"])
    with watching(address, session) as late:
        columns = late.receive()["columns"]
        row = client.get(session["links"]["self"])["row"]
        late.until(lambda: late.end == row)
    run = client.post(session["links"]["save"])
    data = client.data(run["id"])
    rows = late.rows()
    assert [name for name in columns if data[name].astype("<f4").tobytes() != rows[columns.index(name)].tobytes()] == []
    assert run["spec"]["horizon"] == pytest.approx((row - 1) * 0.01)
    assert client.request("POST", session["links"]["save"])[0] == 200, "saved before"


def test_a_library_experiment_opens_at_a_time_and_paused(client, address):
    """Permalinks: the session stands at t, has the past up to there, and moves when it is told to."""
    session = client.post(
        "/api/sessions", {"experiment": "zhao-2012", "set": {"noise.y.std": 0}, "play": False, "t": 1.5}
    )
    with watching(address, session) as page:
        hello = page.receive()
        assert (hello["row"], hello["playing"]) == (151, False)
        page.until(lambda: page.end == 151)
        page.say("step", rows=10)
        page.until(lambda: page.end == 161)
    assert client.get(session["links"]["self"])["t"] == pytest.approx(1.6)


def test_who_has_no_token_watches_and_who_has_a_wrong_one_does_not(client, address):
    """View-only: same rows, no commands; the fork has a token of its own."""
    session = opened(client)
    with watching(address, session, token="") as guest:
        assert guest.receive()["role"] == "view"
        assert guest.say("inject", fault=FAULT)["type"] == "refused"
    with watching(address, session, token="guess") as page:
        assert closed(page) == CLOSE_TOKEN
    fork = client.post(session["links"]["fork"])
    assert fork["parent"] == session["id"] and fork["token"] != session["token"]
    with watching(address, fork, token=session["token"]) as page:
        assert closed(page) == CLOSE_TOKEN
    with watching(address, fork) as page:
        assert page.receive()["parent"] == session["id"]
        assert page.say("inject", fault=FAULT)["type"] == "ack"
    assert client.get(session["links"]["self"])["spec"]["faults"] == spec_of(session, client)["faults"]
    assert len(client.get(fork["links"]["self"])["spec"]["faults"]) == 2


def spec_of(session: dict, client: Client) -> dict:
    return client.get(session["links"]["self"])["spec"]


def test_a_fork_begins_at_an_earlier_time_with_the_same_past(client):
    """Its data up to there are the first session's."""
    session = opened(client, t=3, play=False)
    fork = client.post(session["links"]["fork"], {"t": 2})
    assert client.get(fork["links"]["self"])["row"] == 201
    both = [client.get(s["links"]["data"] + "?to=2")["columns"] for s in (session, fork)]
    assert both[0] == both[1] and len(both[0]["t"]) == 201
    with pytest.raises(ServiceError, match="stands at 3 s"):
        client.post(session["links"]["fork"], {"t": 4})


def test_pages_of_other_origins_are_sent_away_and_this_one_is_not(client, address):
    """The Origin of a browser must be the host that it speaks to; programs send none."""
    session = opened(client)
    for origin in ("http://evil.example", "null", address + "0", "http://127.0.0.1"):
        with watching(address, session, origin=origin) as page:
            assert closed(page) == CLOSE_ORIGIN
    with watching(address, session, origin=address) as page:
        assert page.receive()["type"] == "hello"


def test_a_lost_connection_resumes_without_a_gap(client, address):
    """Cut while it plays; with the number of the last frame the rest comes, and nothing twice."""
    session = opened(client, speed=5)
    with watching(address, session) as page:
        page.until(lambda: page.end > 200)
        page.connection.socket.shutdown(2)
    time.sleep(0.5)
    with watching(address, session, query=f"after={page.frames[-1].sequence}") as again:
        again.until(lambda: again.end > page.end + 400)
        assert again.texts[0]["epoch"] == page.texts[0]["epoch"]
        assert again.frames[0].first == page.end
    page.frames += again.frames
    stored = client.get(session["links"]["data"] + f"?to={(page.end - 1) * 0.01}&format=bdata")["columns"]
    rows = page.rows()
    for name, mine in zip(page.texts[0]["columns"], rows, strict=True):
        assert np.frombuffer(base64.b64decode(stored[name]["bdata"]), "<f8").astype("<f4").tobytes() == mine.tobytes()


def test_a_viewer_that_reads_one_message_a_second_leaves_the_others_alone(client, address):
    """At 200 times real time it lags, jumps or gets large frames; the session keeps its pace and the other viewer its rows."""
    session = opened(client, speed=200)
    with watching(address, session, max_queue=1) as slow, watching(address, session) as page:
        slow.receive()
        page.until(lambda: page.frames)
        begin, first = time.monotonic(), page.end
        for second in (1, 2, 3):
            page.until(lambda end=begin + second: time.monotonic() > end)
            slow.receive()
        rate = (page.end - first) * 0.01 / (time.monotonic() - begin)
        assert 150 < rate < 250
        gaps = [b.first - a.end for a, b in zip(page.frames, page.frames[1:], strict=False)]
        assert set(gaps) == {0}


def test_two_hundred_malformed_messages_are_each_answered_and_change_nothing(tmp_path):
    """Sent in one go; the session's numbers stay those of its spec."""
    draw = random.Random(5)
    with service(tmp_path, max_message=20_000, message_rate=2000) as address, Client(address) as client:
        session = opened(client)
        before = spec_of(session, client)
        with watching(address, session) as page:
            page.receive()
            for _ in range(200):
                text = malformed(draw)
                page.connection.send(b"\x00\xff" if text is None else text)
            page.until(lambda: len(page.of("refused")) == 200)
            assert page.of("ack") == [] and page.of("rewound") == []
            assert page.say("pause")["type"] == "ack"
        assert spec_of(session, client) == before
        assert client.health()["status"] == "ok"


def test_a_message_that_is_far_too_large_closes_the_connection(tmp_path):
    """One that is somewhat too large is refused; the session goes on without the other."""
    with service(tmp_path, max_message=1000) as address, Client(address) as client:
        session = opened(client)
        with watching(address, session) as page:
            page.connection.send(" " * 1500)
            page.until(lambda: page.of("refused"))
            page.connection.send(" " * 20_000)
            assert closed(page) == 1009
        with watching(address, session) as page:
            assert page.receive()["type"] == "hello"


def test_commands_that_come_too_fast_are_read_at_the_rate_that_is_allowed(tmp_path):
    """None is lost; forty at ten a second, with a burst of twenty, take two seconds."""
    with (
        service(tmp_path, message_rate=10) as address,
        Client(address) as client,
        watching(address, opened(client)) as page,
    ):
        begin = time.monotonic()
        for number in range(40):
            page.connection.send(json.dumps({"type": "pause", "id": number}))
        page.until(lambda: len(page.of("ack")) == 40)
        assert time.monotonic() - begin > 1.8


def test_limits_of_sessions_and_viewers(tmp_path):
    """One session too many is 503, one viewer too many is closed; room is made by ending one."""
    with service(tmp_path, sessions=2, viewers=1) as address, Client(address) as client:
        one, _ = opened(client), opened(client)
        for request in (lambda: opened(client), lambda: client.post(one["links"]["fork"])):
            with pytest.raises(ServiceError, match="2 sessions") as refusal:
                request()
            assert refusal.value.status == 503
        with watching(address, one) as page:
            page.receive()
            with watching(address, one) as other:
                assert closed(other) == CLOSE_FULL
            assert delete(client, one, "wrong") == 403
            assert delete(client, one, one["token"]) == 204
            assert closed(page) == CLOSE_ENDED
        with watching(address, one) as page:
            assert closed(page) == CLOSE_NO_SESSION
        assert opened(client)["id"]


def test_a_session_that_nobody_watches_is_closed_after_a_while(tmp_path):
    """One with a viewer stays."""
    with service(tmp_path, idle=0.5) as address, Client(address) as client:
        lonely, kept = opened(client), opened(client)
        with watching(address, kept) as page:
            page.receive()

            def gone() -> bool:
                try:
                    client.get(lonely["links"]["self"])
                except ServiceError as error:
                    return error.status == 404
                return False

            until(gone)
            assert client.get(kept["links"]["self"])["viewers"] == 1


def test_a_session_reaches_its_limit_and_says_so(tmp_path):
    """The row horizon of the settings; opening beyond it is refused."""
    with service(tmp_path, session_rows=300) as address, Client(address) as client:
        with watching(address, opened(client, t=2)) as page:
            page.until(lambda: any(status["ended"] for status in page.of("status")))
            assert page.end == 300
        with pytest.raises(ServiceError, match="at most 300 rows"):
            opened(client, t=3)


@pytest.mark.parametrize(
    ("fields", "field"),
    [
        ({}, "experiment"),
        ({"experiment": "zhao-2012", "spec": spec_data()}, "experiment"),
        ({"experiment": "zhao-2012", "speed": 0}, "speed"),
        ({"experiment": "zhao-2012", "t": -1}, "t"),
        ({"experiment": "zhao-2012", "set": {"seed": -1}}, "seed"),
        ({"spec": spec_data(observers=[{"label": "a", "kind": "no-such"}])}, "observers[0].kind"),
        ({"experiment": "zhao-2012", "playing": True}, "playing"),
    ],
)
def test_what_is_wrong_with_a_request_is_said_field_by_field(client, fields, field):
    """As a problem document, with the remedy."""
    with pytest.raises(ServiceError) as refusal:
        client.post("/api/sessions", fields)
    assert refusal.value.status == 422
    assert refusal.value.problem["errors"][0]["field"] == field


def test_an_experiment_or_session_that_is_not_there_is_404(client):
    """With the nearest ids of the library."""
    with pytest.raises(ServiceError, match="zhao-2012") as refusal:
        client.post("/api/sessions", {"experiment": "zhao-2011"})
    assert refusal.value.status == 404
    for path in ("", "/data"):
        with pytest.raises(ServiceError, match="no session") as refusal:
            client.get("/api/sessions/nowhere" + path)
        assert refusal.value.status == 404


def test_the_past_is_there_in_every_format(client):
    """A range of it, thinned out; the same numbers in each."""
    session = opened(client, t=2, play=False)
    path = session["links"]["data"] + "?from=0.5&to=1.5&every=10"
    plain = client.get(path)["columns"]
    assert np.allclose(plain["t"], np.arange(0.5, 1.51, 0.1))
    packed = client.get(path + "&format=bdata")["columns"]
    assert np.frombuffer(base64.b64decode(packed["x.x"]["bdata"]), "<f8").tolist() == plain["x.x"]
    _, headers, content = client.request("GET", path + "&format=csv")
    lines = content.decode().splitlines()
    assert lines[0].split(",") == list(plain) and float(lines[1].split(",")[list(plain).index("x.x")]) == plain["x.x"][0]
    assert "attachment" in headers["content-disposition"]
    assert client.request("GET", path + "&format=mat")[2].startswith(b"MATLAB 5.0")
    with pytest.raises(ServiceError):
        client.get(session["links"]["data"] + "?from=2&to=1")


def test_many_sessions_play_side_by_side_while_one_compiles(client, address):
    """Their frames keep coming while an observer is compiled and one session runs as fast as it can."""
    sessions = [opened(client) for _ in range(10)]
    rushing = opened(client, speed=None)
    with watching(address, sessions[0]) as page:
        page.until(lambda: page.end > 100)
        frames = len(page.frames)
        with watching(address, sessions[1]) as other:
            other.receive()
            other.say("add-observer", observer={"label": "ukf", "kind": "joint-ukf"})
        begin = time.monotonic()
        page.until(lambda: time.monotonic() > begin + 1)
        assert len(page.frames) - frames > 20
    assert client.get(rushing["links"]["self"])["row"] > 2000
    for session in (*sessions, rushing):
        assert delete(client, session, session["token"]) == 204
