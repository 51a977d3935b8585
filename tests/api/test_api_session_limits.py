"""Limits of /api/sessions: messages, rates, sessions, viewers, idle time and length."""

import json
import random
import time
from collections.abc import Iterator

import pytest

from tests.api.conftest import service, until
from tests.api.streams import closed, delete, opened, spec_of, watching
from tests.live.wire.test_messages import malformed
from thetascope.client import Client, ServiceError
from thetascope_schemas.service.session import CLOSE_ENDED, CLOSE_FULL, CLOSE_NO_SESSION


@pytest.fixture(scope="module")
def short(tmp_path_factory) -> Iterator[tuple[str, Client]]:
    """Yield the address of a service with short messages and sessions, and its client."""
    limits = {"max_message": 20_000, "message_rate": 2000, "session_rows": 300}
    with service(tmp_path_factory.mktemp("short"), **limits) as address, Client(address) as client:
        yield address, client


@pytest.fixture(scope="module")
def few(tmp_path_factory) -> Iterator[tuple[str, Client]]:
    """Yield the address of a service for few sessions, viewers and messages, and its client."""
    limits = {"sessions": 2, "viewers": 1, "message_rate": 10}
    with service(tmp_path_factory.mktemp("few"), **limits) as address, Client(address) as client:
        yield address, client


def test_two_hundred_malformed_messages_are_each_answered_and_change_nothing(short):
    """They are sent together; the session's numbers remain those of its spec."""
    (address, client), draw = short, random.Random(5)
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


def test_a_message_that_is_far_too_large_closes_the_connection(short):
    """A slightly too large one is refused; the session continues without the other viewer."""
    address, client = short
    session = opened(client)
    with watching(address, session) as page:
        page.connection.send(" " * 30_000)
        page.until(lambda: page.of("refused"))
        page.connection.send(" " * 400_000)
        assert closed(page) == 1009
    with watching(address, session) as page:
        assert page.receive()["type"] == "hello"


def test_a_session_ends_at_its_maximum_number_of_rows(short):
    """It reports the end; opening it beyond the limit is refused."""
    address, client = short
    with watching(address, opened(client, t=2)) as page:
        page.until(lambda: any(status["ended"] for status in page.of("status")))
        assert page.end == 300
    with pytest.raises(ServiceError, match="at most 300 rows"):
        opened(client, t=3)


def test_commands_that_come_too_fast_are_read_at_the_allowed_rate(few):
    """None is lost; forty at ten per second, with a burst of twenty, take two seconds."""
    address, client = few
    session = opened(client)
    with watching(address, session) as page:
        begin = time.monotonic()
        for number in range(40):
            page.connection.send(json.dumps({"type": "pause", "id": number}))
        page.until(lambda: len(page.of("ack")) == 40)
        assert time.monotonic() - begin > 1.8
    assert delete(client, session, session["token"]) == 204


def test_limits_of_sessions_and_viewers(few):
    """One session too many is answered with 503, one viewer too many is closed; ending one makes room."""
    address, client = few
    one, two = opened(client), opened(client)
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
    three = opened(client)
    assert three["id"]
    for session in (two, three):
        delete(client, session, session["token"])


def test_a_session_without_viewers_is_closed_after_the_idle_time(tmp_path):
    """A session with a viewer stays open."""
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
