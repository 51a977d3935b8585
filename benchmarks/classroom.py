"""Measure a class: frames of 60 phones beside the wall, the way of a vote to the wall, and the processor time.

    python -m benchmarks classroom

A class follows a session of the teacher, then each student has a record with a hidden fault. Each student has both
connections of a phone. Readers and service share the machine.
"""

import json
import tempfile
import time
from collections.abc import Iterator
from http.client import HTTPConnection
from itertools import pairwise
from pathlib import Path
from threading import Thread
from typing import Any
from urllib.parse import urlsplit

from benchmarks.measure import Figure
from benchmarks.service import service
from benchmarks.watchers import Watchers

STUDENTS = 60
SECONDS = 10.0
VOTES = 30
CARD = {
    "place": 1,
    "of": 4,
    "title": {"en": "A step", "zh": "一步"},
    "ask": {"en": "What will it do?", "zh": "它会怎样?"},
    "options": [{"en": "rise", "zh": "升"}, {"en": "fall", "zh": "降"}],
}
LINES = [{"column": "y.y"}, {"column": "y.y", "minus": "adaptive.y.y"}]
ALIVE = "."
"""What a page says every few seconds: one that is silent is taken for a laptop that sleeps."""
PLAYED = 27
"""Seconds of the round of hidden faults: the motor's 401 rows are played in half of it, at 30 rows a second."""


def figures() -> Iterator[Figure]:
    """Yield frames a second of phones that follow and of those with records of their own, and the latency of votes."""
    with tempfile.TemporaryDirectory(prefix="thetascope-benchmark-") as data, service(Path(data)) as (address, _):
        room = ask(address, "POST", "", {})
        teacher = {"X-Teacher-Token": room["token"]}
        tokens = [ask(address, "POST", "/join", {"code": room["code"]})["token"] for _ in range(STUDENTS)]
        watchers, port = Watchers(), int(urlsplit(address).port or 0)
        wall = watchers.connect(port, "/api/classroom/room/stream", room["token"])
        for token in tokens:
            watchers.connect(port, "/api/classroom/seat/stream", token)
        phones = [watchers.connect(port, "/api/classroom/seat/curves", token) for token in tokens]
        ask(address, "POST", "/room/rounds", {"kind": "follow"}, teacher)
        session = ask(address, "POST", "/api/sessions", {"experiment": "zhao-2012", "play": True})
        lead = {"session": session["id"], "step": "a 1", "card": CARD, "strip": {"symbol": "y", "lines": LINES}}
        ask(address, "POST", "/room/lead", lead, teacher)
        watchers.run(5)
        yield from frames(watchers, phones, f"of {STUDENTS} phones that follow a session")
        yield votes(address, watchers, tokens, wall)
        begin = time.perf_counter()
        ask(address, "POST", "/room/rounds", {"kind": "own", "setup": "motor", "seconds": PLAYED}, teacher)
        for phone in phones:
            phone.clear()
        while not all(len(phone.times) > 1 for phone in phones):
            watchers.say(ALIVE)
            watchers.run(5, lambda: all(len(phone.times) > 1 for phone in phones))
        ready = time.perf_counter() - begin
        yield Figure.of(f"time until {STUDENTS} records of hidden faults play", [ready], unit="s")
        yield from frames(watchers, phones, f"of {STUDENTS} phones, each with a record of its own", 5.0)
        watchers.run(1)
        ask(address, "POST", "/room/reveal", None, teacher)
        graded = until_graded(address, teacher, watchers)
        yield Figure.of(f"time from the reveal until {STUDENTS} outcomes are there", [graded], unit="s")
        watchers.close()


def frames(watchers: Watchers, phones: list, name: str, seconds: float = SECONDS) -> Iterator[Figure]:
    """Yield the frames a second of the phones, and the longest gaps between two."""
    watchers.say(ALIVE)
    for phone in phones:
        phone.clear()
    watchers.run(seconds)
    yield Figure.of(f"frames a second {name}", [len(phone.times) / seconds for phone in phones], unit="1/s")
    gaps = [max((b - a for a, b in pairwise(phone.times)), default=seconds) for phone in phones]
    yield Figure.of(f"longest gap between two frames {name}", gaps, unit="ms")


def votes(address: str, watchers: Watchers, tokens: list[str], wall: Any) -> Figure:
    """Return the time from a vote to the state with it on the wall, while all frames are sent."""
    latencies: list[float] = []
    for token in tokens[:VOTES]:
        before, begin = wall.texts, time.perf_counter()
        body = {"step": "a 1", "choice": 0}
        sender = Thread(target=ask, args=(address, "PUT", "/seat/vote", body, {"X-Seat-Token": token}))
        sender.start()
        watchers.run(5, lambda before=before: wall.texts > before)
        latencies.append(time.perf_counter() - begin)
        sender.join()
        watchers.say(ALIVE)
        watchers.run(0.3)
    return Figure.of("time from a vote to the wall", latencies, unit="ms")


def until_graded(address: str, teacher: dict[str, str], watchers: Watchers) -> float:
    """Return the seconds until every student has an outcome."""
    begin = time.perf_counter()
    while not all(tile["outcome"] for tile in ask(address, "GET", "/room/wall", None, teacher)["tiles"]):
        watchers.say(ALIVE)
        watchers.run(1)
    return time.perf_counter() - begin


def ask(address: str, method: str, path: str, body: Any = None, headers: dict[str, str] | None = None) -> Any:
    """Return the answer of a request to the classroom, or to an address that begins with /api."""
    connection = HTTPConnection(urlsplit(address).netloc, timeout=120)
    whole = path if path.startswith("/api") else f"/api/classroom{path}"
    connection.request(
        method,
        whole,
        None if body is None else json.dumps(body),
        {"Content-Type": "application/json"} | (headers or {}),
    )
    answer = connection.getresponse()
    content = answer.read()
    connection.close()
    if answer.status >= 300:
        raise RuntimeError(f"{method} {whole}: {content.decode()}")
    return json.loads(content) if content else None
