"""A classroom over HTTP: joining, following and voting, and that a student's token opens a student's own seat only."""

import csv
import io
import json
import time
from contextlib import ExitStack

import numpy as np
import pytest
from websockets.sync.client import ClientConnection

from tests.api.classes import CARD, STEP, Person, close_code, send, student, teacher, until
from tests.api.conftest import service
from tests.api.streams import opened
from tests.live.stage import Frame, decoded
from thetascope.classroom.people.codes import LENGTH, LETTERS
from thetascope_schemas.service.classroom.requests import CLOSE_ELSEWHERE, CLOSE_NO_ROOM, CLOSE_TOKEN


@pytest.fixture
def room(address):
    """Yield the teacher of a room, which is closed afterwards: one client may have a few."""
    opened_room = teacher(address)
    yield opened_room
    opened_room.ask("DELETE", "/room")


def binary(connection: ClientConnection, number: int) -> list[Frame]:
    """Return the next frames of curves; heads between them are passed over."""
    frames: list[Frame] = []
    while len(frames) < number:
        message = connection.recv(60)
        frames += [] if isinstance(message, str) else [decoded(message)]
    return frames


def test_a_class_follows_and_votes(room, address):
    """The step reaches the phones; votes are counted at once and may be changed until the step is run, then marked."""
    ada, bob = student(address, room.code.lower()), student(address, f" {room.code[:3]}-{room.code[3:]} ")
    room.got("POST", "/room/rounds", {"kind": "follow"})
    with ada.stream("/seat/stream") as phone, room.stream("/room/stream") as wall:
        room.got("POST", "/room/lead", STEP)
        shown = until(phone, lambda state: state["round"] and state["round"]["lead"]["card"])
        assert shown["round"]["lead"]["card"]["options"] == CARD["options"] and shown["vote"] is None
        assert ada.got("PUT", "/seat/vote", {"step": STEP["step"], "choice": 0})["vote"] == 0
        ada.got("PUT", "/seat/vote", {"step": STEP["step"], "choice": 1})
        bob.got("PUT", "/seat/vote", {"step": STEP["step"], "choice": 0})
        counted = until(wall, lambda state: state["votes"] == [1, 1])
        assert all(tile["answered"] and tile["choice"] is tile["mark"] is None for tile in counted["tiles"])
        room.got("POST", "/room/lead", STEP | {"phase": "after", "right": [False, True]})
        marked = until(wall, lambda state: state["tiles"][0]["mark"])
        assert [tile["mark"] for tile in marked["tiles"]] == ["right", "wrong"]
        assert [tile["choice"] for tile in marked["tiles"]] == [1, 0]
        assert until(phone, lambda state: state["round"]["lead"]["phase"] == "after")["round"]["lead"]["right"]
    status, refusal = ada.ask("PUT", "/seat/vote", {"step": STEP["step"], "choice": 0})
    assert (status, refusal["code"]) == (409, "classroom.vote-closed")


def test_curves_are_the_chosen_columns_and_no_others(room, address, client):
    """Phones get the rows of the teacher's session in the columns of the strip, also after a new connection."""
    ada, session = student(address, room.code), opened(client, play=True, speed=20)
    room.got("POST", "/room/rounds", {"kind": "follow"})
    lines = [{"column": "y.y", "minus": "kalman.y.y"}, {"column": "y.y", "role": "measured"}]
    room.got("POST", "/room/lead", {"session": session["id"], "strip": {"symbol": "y", "lines": lines}})
    for _ in range(2):
        with ada.stream("/seat/curves") as phone:
            head = until(phone, lambda message: message["strip"])
            frames = binary(phone, 4)
        assert [frame.samples.shape[0] for frame in frames] == [2] * 4 and frames[0].first == head["row"]
        known = {f.first + i: f.samples[:, i] for f in frames for i in range(f.samples.shape[1])}
        table = client.get(f"/api/sessions/{session['id']}/data?columns=y.y,kalman.y.y")
        for row, (residual, measured) in known.items():
            y, estimate = (np.float32(table["columns"][name][row]) for name in ("y.y", "kalman.y.y"))
            assert measured == y and residual == pytest.approx(y - estimate, abs=1e-5)


def test_a_page_that_comes_back_is_where_it_was(room, address):
    """A seat without a page is asleep on the wall and keeps its place and its vote."""
    ada = student(address, room.code)
    room.got("POST", "/room/rounds", {"kind": "follow"})
    room.got("POST", "/room/lead", STEP)
    with room.stream("/room/stream") as wall:
        with ada.stream("/seat/stream") as phone:
            until(phone, lambda state: state["round"])
            ada.got("PUT", "/seat/vote", {"step": STEP["step"], "choice": 1})
            until(wall, lambda state: state["tiles"][0]["answered"])
        assert until(wall, lambda state: state["tiles"][0]["asleep"])["tiles"][0]["answered"]
        with ada.stream("/seat/stream") as phone:
            back = until(phone, lambda state: True)
            assert back["vote"] == 1 and back["round"]["lead"]["step"] == STEP["step"]
            until(wall, lambda state: not state["tiles"][0]["asleep"])


def test_a_students_token_is_no_teachers(room, address):
    """It opens no wall, no room, no round, nobody else's seat; a teacher's token is no seat."""
    ada = student(address, room.code)
    posing = Person(address, "X-Teacher-Token", ada.token)
    for method, path, body in (
        ("GET", "/room", None),
        ("GET", "/room/wall", None),
        ("GET", "/room/results", None),
        ("DELETE", "/room", None),
        ("DELETE", "/room/students/0", None),
        ("POST", "/room/rounds", {"kind": "follow"}),
        ("POST", "/room/lead", STEP),
    ):
        assert posing.ask(method, path, body)[0] == 404
        assert Person(address, "X-Teacher-Token", "").ask(method, path, body)[0] == 404
    with posing.stream("/room/stream") as wall:
        assert close_code(wall) == CLOSE_TOKEN
    seat = Person(address, "X-Seat-Token", room.token)
    assert seat.ask("GET", "/seat")[0] == 404
    for path in ("/seat/stream", "/seat/curves"):
        with seat.stream(path) as phone:
            assert close_code(phone) == CLOSE_TOKEN


def test_a_phone_learns_nothing_of_others(room, address):
    """Neither names nor votes nor what is right before the step was run."""
    ada, bob = student(address, room.code), student(address, room.code)
    bob.got("PUT", "/seat/name", {"name": "Bartholomew"})
    room.got("POST", "/room/rounds", {"kind": "follow"})
    room.got("POST", "/room/lead", STEP | {"right": [False, True]})
    bob.got("PUT", "/seat/vote", {"step": STEP["step"], "choice": 1})
    seat = ada.got("GET", "/seat")
    assert "Bartholomew" not in json.dumps(seat) and seat["round"]["lead"]["right"] == []
    assert seat.keys() == {"type", "code", "animal", "name", "students", "round", "vote", "answer", "outcome", "rank"}


@pytest.mark.parametrize(
    ("name", "shown"),
    [
        ("<img src=x onerror=alert(1)>", "<img src=x onerror=alert"),
        ("=HYPERLINK(1)", "=HYPERLINK(1)"),
        ("  Ada \u202e\u2066 L\u0000\u200b.\n", "Ada L."),
        ("a" + "\u0301" * 100, "\u00e1\u0301\u0301"),
        ("\u200b\u202e", None),
        ("x" * 200, "x" * 24),
        ("小明", "小明"),
    ],
)
def test_names_are_one_harmless_line(room, address, name, shown):
    """No control or invisible characters, no stacks of accents, a length; in the CSV no formula."""
    ada = student(address, room.code)
    assert ada.got("PUT", "/seat/name", {"name": name})["name"] == shown
    room.got("POST", "/room/rounds", {"kind": "follow"})
    room.got("POST", "/room/lead", STEP)
    table = list(csv.DictReader(io.StringIO(room.got("GET", "/room/results"))))
    assert [row["question"] for row in table] == [STEP["step"]] and table[0]["answer"] == ""
    assert not table[0]["name"].startswith("=") and "\n" not in table[0]["name"]


def test_codes_cannot_be_guessed_quickly(tmp_path):
    """Wrong ones are answered later and later, a crowd of them is refused; a right one is not delayed by them."""
    with service(tmp_path) as address:
        room = teacher(address)
        assert len(room.code) == LENGTH and set(room.code) <= set(LETTERS) and not set(LETTERS) & set("IOQLUV01")
        wrong = "AAAAAA" if room.code != "AAAAAA" else "BBBBBB"
        for text in (wrong, "", "AAAAA", "ÄÖÜÄÖÜ", "AAAAAA\u0000", "' OR 1=1"):
            status, refusal = send(address, "POST", "/api/classroom/join", {"code": text})
            assert (status, refusal["code"]) == (404, "classroom.no-code")
        assert send(address, "POST", "/api/classroom/join", {"code": "A" * 100})[0] == 422
        assert student(address, room.code).got("GET", "/seat")["students"] == 1


def test_a_room_is_bounded(room, address):
    """A name, a step and a socket too many are refused or replace the oldest; so are rooms of one client."""
    ada = student(address, room.code)
    assert room.ask("POST", "/room/lead", STEP)[0] == 409
    room.got("POST", "/room/rounds", {"kind": "follow"})
    assert room.ask("POST", "/room/lead", STEP | {"card": CARD | {"options": CARD["options"] * 5}})[0] == 422
    assert ada.ask("PUT", "/seat/vote", {"step": "another", "choice": 0})[0] == 409
    assert ada.ask("PUT", "/seat/vote", {"step": STEP["step"], "choice": 99})[0] == 422
    with ExitStack() as stack:
        phones = [stack.enter_context(ada.stream("/seat/stream")) for _ in range(4)]
        assert close_code(phones[0]) == CLOSE_ELSEWHERE
    rooms = []
    while True:
        status, answer = send(address, "POST", "/api/classroom", {})
        if status != 201:
            break
        rooms.append(Person(address, "X-Teacher-Token", answer["token"]))
    assert (status, answer["code"]) == (429, "classroom.too-many") and len(rooms) < 10
    for other in rooms:
        other.got("DELETE", "/room")


def test_a_closed_room_forgets(address):
    """Pages are told by a code of its own; tokens and code open nothing any more. A student can leave or be removed."""
    room = teacher(address)
    ada, bob, eve = (student(address, room.code) for _ in range(3))
    bob.got("DELETE", "/seat")
    assert bob.ask("GET", "/seat")[0] == 404
    with eve.stream("/seat/stream") as phone:
        room.got("DELETE", f"/room/students/{room.got('GET', '/room/wall')['tiles'][1]['id']}")
        assert close_code(phone) == CLOSE_TOKEN
    with ada.stream("/seat/stream") as phone, room.stream("/room/stream") as wall:
        room.got("DELETE", "/room")
        assert close_code(phone) == close_code(wall) == CLOSE_NO_ROOM
    assert ada.ask("GET", "/seat")[0] == room.ask("GET", "/room")[0] == 404
    assert send(address, "POST", "/api/classroom/join", {"code": room.code})[0] == 404


def test_students_need_no_key_and_get_nothing_else(tmp_path):
    """On a service with a key, a phone joins by the code and sees its seat; runs and sessions stay closed."""
    with service(tmp_path, host="0.0.0.0", key="a-long-secret-key-for-tests") as address:
        assert send(address, "POST", "/api/classroom", {})[0] == 401
        room = teacher(address, {"X-Access-Key": "a-long-secret-key-for-tests"})
        ada = student(address, room.code)
        with ada.stream("/seat/stream") as phone:
            assert until(phone, lambda state: True)["code"] == room.code
        status, page = send(address, "GET", f"/join/{room.code}", headers={"Accept": "text/html"})
        assert status == 200 and "/static/" in page
        for path in ("/api/runs", "/api/sessions/x", "/", "/classroom/", "/api/course"):
            assert send(address, "GET", path, headers={"X-Seat-Token": ada.token})[0] == 401
        assert Person(address, "X-Teacher-Token", room.token).ask("GET", "/room")[0] == 401


def played(room: Person, number: int) -> str:
    """Wait until the records of all students play; return the id of the first student."""
    ids = [tile["id"] for tile in room.got("GET", "/room/wall")["tiles"]]
    assert len(ids) == number
    end = time.monotonic() + 300
    while any(room.ask("GET", f"/room/students/{id}/replay")[0] != 200 for id in ids):
        assert time.monotonic() < end
        time.sleep(0.1)
    return ids[0]


def graded(room: Person) -> dict:
    """Return the wall as soon as every student has an outcome."""
    end = time.monotonic() + 300
    while not all(tile["outcome"] for tile in room.got("GET", "/room/wall")["tiles"]):
        assert time.monotonic() < end
        time.sleep(0.2)
    return room.got("GET", "/room/wall")


ANSWER = {"round": 1, "verdict": "channel", "channel": "gain_loss", "onset": 2.0, "size": 0.1}


def test_a_round_of_hidden_faults(address):
    """Records play to each phone; the truth comes with the reveal only, and answers are graded against it."""
    room = teacher(address)
    ada, bob, eve = (student(address, room.code) for _ in range(3))
    room.got("POST", "/room/rounds", {"kind": "own", "setup": "motor", "seconds": 600})
    id = played(room, 3)
    with ada.stream("/seat/stream") as phone, ada.stream("/seat/curves") as curves, room.stream("/room/stream") as wall:
        begun = until(phone, lambda state: state["round"] and state["round"]["left"])["round"]
        head = until(curves, lambda message: message["panels"])
        frames = binary(curves, 3)
        assert frames[0].samples.shape[0] == len(head["panels"]) == 2 and frames[2].end < 8 / head["record"]
        until(wall, lambda state: state["round"]["left"])
        for person in (ada, bob):
            answered = person.got("PUT", "/seat/answer", ANSWER)
            assert answered["answer"]["channel"] == "gain_loss" and answered["outcome"] is answered["rank"] is None
        names = [choice["channel"] for choice in begun["choices"]]
        cannot = {"round": 1, "verdict": "cannot-be-told", "alike": names[1:3]}
        changed = bob.got("PUT", "/seat/answer", cannot)["answer"]
        assert [one["channel"] for one in changed["accused"]] == ["gain_loss"]
        before = json.dumps([ada.got("GET", "/seat"), room.got("GET", "/room/wall")])
        assert 'fault":' not in before and "detector" not in before and '"outcome": null' in before
        seen = room.got("GET", f"/room/students/{id}/replay")
        assert len(seen["values"][0]) < 401 and seen["outcome"] is None
        room.got("POST", "/room/reveal")
        shown = graded(room)
        mine = ada.got("GET", "/seat")["outcome"]
        assert mine == shown["tiles"][0]["outcome"] and mine["points"] >= 0
        truth = mine["fault"]
        found = truth is not None and truth["channel"] == "gain_loss" and mine["told"] is not None
        assert found or mine["right"] is False  # the faults differ each time; one may begin after the answer
        assert shown["tiles"][2]["outcome"]["right"] is None and shown["tiles"][2]["answer"] is None
    assert len(room.got("GET", f"/room/students/{id}/replay")["values"][0]) == 401
    assert ada.ask("PUT", "/seat/answer", ANSWER)[0] == eve.ask("PUT", "/seat/answer", ANSWER)[0] == 409
    table = list(csv.DictReader(io.StringIO(room.got("GET", "/room/results"))))
    assert [row["right"] for row in table] == [str(int(mine["right"])), table[1]["right"], ""]
    assert table[0]["answer"] == "gain_loss" and table[1]["answer"].startswith("cannot be told: ")
    room.got("DELETE", "/room")


def test_wrong_answers_about_hidden_faults_are_refused(room, address):
    """Unknown channels, incomplete answers, those of another round; a plant that cannot be chosen; no token."""
    ada = student(address, room.code)
    assert ada.ask("PUT", "/seat/answer", ANSWER)[0] == room.ask("POST", "/room/reveal")[0] == 409
    assert room.ask("POST", "/room/rounds", {"kind": "own", "setup": "no-such"})[0] == 422
    assert room.ask("POST", "/room/rounds", {"kind": "own", "seconds": 5})[0] == 422
    room.got("POST", "/room/rounds", {"kind": "own", "setup": "motor", "seconds": 600})
    played(room, 1)
    for change, status in (
        ({"channel": "nobody"}, 422),
        ({"channel": None}, 422),
        ({"verdict": "cannot-be-told", "channel": None, "alike": ["gain_loss"]}, 422),
        ({"verdict": "cannot-be-told", "channel": None, "alike": ["gain_loss", "x"]}, 422),
        ({"round": 2}, 409),
        ({"onset": -1}, 422),
    ):
        assert ada.ask("PUT", "/seat/answer", ANSWER | change)[0] == status
    stranger = Person(address, "X-Seat-Token", "x" * 32)
    assert stranger.ask("PUT", "/seat/answer", ANSWER)[0] == 404
    id = room.got("GET", "/room/wall")["tiles"][0]["id"]
    assert Person(address, "X-Teacher-Token", ada.token).ask("GET", f"/room/students/{id}/replay")[0] == 404
