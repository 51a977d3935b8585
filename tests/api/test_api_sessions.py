"""/api/sessions over HTTP and its websocket, on the service as users run it."""

import base64
import time

import numpy as np
import pytest

from tests.api.streams import FAULT, closed, delete, opened, spec_of, watching
from tests.runs.samples import spec_data
from thetascope.client import ServiceError
from thetascope_schemas.service.session import CLOSE_ENDED, CLOSE_ORIGIN, CLOSE_TOKEN


def test_a_session_plays_immediately_and_reports_its_state(client, address):
    """After opening and connecting, rows arrive in real time."""
    session = opened(client)
    with watching(address, session) as page:
        hello = page.receive()
        assert (hello["type"], hello["role"], hello["session"], hello["playing"]) == (
            "hello",
            "control",
            session["id"],
            True,
        )
        page.until(lambda: page.end > 150)
        begin, first = time.monotonic(), page.end
        page.until(lambda: page.end > first + 200)
        assert time.monotonic() - begin > 1.6, "it never goes faster than time does"
        status = client.get(session["links"]["self"])
        assert status["playing"] and status["viewers"] == 1 and abs(status["row"] - page.end) < 30
        assert status["spec"]["observers"][0]["label"] == "kalman" and status["parent"] is None


def test_a_saved_session_is_a_run_with_the_same_numbers(client, address):
    """After faults, a changed input and noise, a rewind and an added observer every column is equal bit for bit."""
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
    control = {"X-Control-Token": session["token"]}
    run = client.post(session["links"]["save"], headers=control)
    data = client.data(run["id"])
    rows = late.rows()
    assert [name for name in columns if data[name].astype("<f4").tobytes() != rows[columns.index(name)].tobytes()] == []
    assert run["spec"]["horizon"] == pytest.approx((row - 1) * 0.01)
    assert client.request("POST", session["links"]["save"], headers=control)[0] == 200, "saved before"


def test_a_library_experiment_opens_at_a_time_and_paused(client, address):
    """As a permalink opens it: the session is at t, has its past, and advances on command."""
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


def test_a_viewer_without_token_is_read_only_and_a_wrong_token_is_refused(client, address):
    """A read-only viewer gets the same rows; the fork has a token of its own."""
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


def test_the_token_is_not_read_from_the_address(client, address):
    """Addresses are written into logs and histories: a token there grants nothing."""
    session = opened(client)
    with watching(address, session, token="", query=f"token={session['token']}") as page:
        assert page.receive()["role"] == "view"


def test_a_fork_begins_at_an_earlier_time_with_the_same_past(client):
    """Its data up to that time equal those of the first session."""
    session = opened(client, t=3, play=False)
    fork = client.post(session["links"]["fork"], {"t": 2})
    assert client.get(fork["links"]["self"])["row"] == 201
    both = [client.get(s["links"]["data"] + "?to=2")["columns"] for s in (session, fork)]
    assert both[0] == both[1] and len(both[0]["t"]) == 201
    with pytest.raises(ServiceError, match="the session is at 3 s"):
        client.post(session["links"]["fork"], {"t": 4})


def test_connections_of_pages_from_other_origins_are_refused(client, address):
    """The Origin of a browser must be the host that it connects to; programs send none."""
    session = opened(client)
    for origin in ("http://[::1", "http://evil.example", "null", address + "0", "http://127.0.0.1"):
        with watching(address, session, origin=origin) as page:
            assert closed(page) == CLOSE_ORIGIN
    with watching(address, session, origin=address) as page:
        assert page.receive()["type"] == "hello"


def test_a_lost_connection_resumes_without_a_gap(client, address):
    """Interrupted while playing, it gets the missing rows by the number of its last frame, and none twice."""
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


def test_a_slow_viewer_does_not_affect_the_others(client, address):
    """At 200 times real time it lags, skips rows or gets large frames; the other viewer gets every row."""
    session = opened(client, speed=200)
    with watching(address, session, max_queue=1) as slow, watching(address, session) as page:
        slow.receive()
        page.until(lambda: page.frames)
        begin = time.monotonic()
        for second in (1, 2, 3):
            before = len(page.frames)
            page.until(lambda end=begin + second: time.monotonic() > end)
            assert len(page.frames) > before + 3, "it is not kept waiting for the slow one's next look"
            slow.receive()
        gaps = [b.first - a.end for a, b in zip(page.frames, page.frames[1:], strict=False)]
        assert set(gaps) == {0}


@pytest.mark.parametrize(
    ("fields", "field"),
    [
        ({}, "experiment"),
        ({"experiment": "zhao-2012", "spec": spec_data()}, "experiment"),
        ({"experiment": "zhao-2012", "speed": 0}, "speed"),
        ({"experiment": "zhao-2012", "t": -1}, "t"),
        ({"experiment": "zhao-2012", "t": 1e308}, "t"),
        ({"experiment": "zhao-2012", "set": {"seed": -1}}, "seed"),
        ({"spec": spec_data(observers=[{"label": "a", "kind": "no-such"}])}, "observers[0].kind"),
        ({"experiment": "zhao-2012", "playing": True}, "playing"),
    ],
)
def test_errors_of_a_request_are_listed_by_field(client, fields, field):
    """As a problem document, with the remedy."""
    with pytest.raises(ServiceError) as refusal:
        client.post("/api/sessions", fields)
    assert refusal.value.status == 422
    assert refusal.value.problem["errors"][0]["field"] == field


@pytest.mark.parametrize("query", ["from=1e308", "from=nan", "to=-inf", "to=inf"])
def test_invalid_times_are_refused(client, query):
    """The error names the field, whatever the number."""
    with pytest.raises(ServiceError) as refusal:
        client.get(opened(client, play=False)["links"]["data"] + f"?{query}")
    assert refusal.value.status == 422 and refusal.value.problem["errors"][0]["field"] == query.partition("=")[0]


def test_an_unknown_experiment_or_session_is_answered_with_404(client):
    """With the nearest ids of the library."""
    with pytest.raises(ServiceError, match="zhao-2012") as refusal:
        client.post("/api/sessions", {"experiment": "zhao-2011"})
    assert refusal.value.status == 404
    for path in ("", "/data"):
        with pytest.raises(ServiceError, match="no session") as refusal:
            client.get("/api/sessions/nowhere" + path)
        assert refusal.value.status == 404


def test_the_past_is_available_in_every_format(client):
    """A range of it, with fewer rows, has the same numbers in each format."""
    session = opened(client, t=2, play=False)
    path = session["links"]["data"] + "?from=0.5&to=1.5&every=10"
    plain = client.get(path)["columns"]
    assert np.allclose(plain["t"], np.arange(0.5, 1.51, 0.1))
    packed = client.get(path + "&format=bdata")["columns"]
    assert np.frombuffer(base64.b64decode(packed["x.x"]["bdata"]), "<f8").tolist() == plain["x.x"]
    _, headers, content = client.request("GET", path + "&format=csv")
    lines = content.decode().splitlines()
    assert (
        lines[0].split(",") == list(plain) and float(lines[1].split(",")[list(plain).index("x.x")]) == plain["x.x"][0]
    )
    assert "attachment" in headers["content-disposition"]
    assert client.request("GET", path + "&format=mat")[2].startswith(b"MATLAB 5.0")
    with pytest.raises(ServiceError):
        client.get(session["links"]["data"] + "?from=2&to=1")


def test_many_sessions_play_while_one_compiles(client, address):
    """Their frames continue while an observer is compiled and one session runs as fast as it can."""
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


@pytest.mark.parametrize(("query", "headers"), [("lang=zh", {}), ("", {"Accept-Language": "zh-CN,zh;q=0.9"})])
def test_a_viewer_states_its_language_on_connecting(client, address, query, headers):
    """With ?lang= or Accept-Language the log, refusals and the reason for closing are Chinese."""
    session = opened(client, play=False)
    with watching(address, session, query=query, additional_headers=headers) as page:
        assert page.say("seek", t=500)["problem"].startswith("会话目前在")
        page.say("inject", fault=FAULT)
        page.until(lambda: page.of("event"))
        assert page.of("event")[-1]["message"]["text"] == "已注入 gain：阶跃，大小 0.3"
        delete(client, session, session["token"])
        assert closed(page, "会话已被结束") == CLOSE_ENDED
