"""A room with viewers, on real sessions, with a clock that the test controls."""

import json

import numpy as np
import pytest

from tests.live.stage import Stage, kinds, same, staged
from thetascope.live.session.session import Session
from thetascope.runs.workers.limits import Limits, time_limit

FAULT = {"channel": "gain", "shape": "step", "onset": 0, "size": 0.3}
SECOND = {"label": "other", "kind": "adaptive-kalman"}


def test_the_frames_of_a_session_are_the_rows_of_a_run():
    """Hello first, then every row once, thirty frames a second, with the numbers of an ordinary run."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "play")
        await stage.go(3.0)
        hello = page.texts[0]
        assert hello["type"] == "hello" and hello["row"] == 1 and hello["role"] == "control"
        rows = page.rows()
        assert 295 <= rows.shape[1] <= 302
        assert 85 <= len(page.frames) <= 95
        sequences = [frame.sequence for frame in page.frames[1:]]
        assert sequences == list(range(1, len(sequences) + 1))
        same(rows, stage.session.spec, hello["columns"])

    staged(scenario)


@pytest.mark.parametrize("busy", [False, True])
def test_commands_act_at_the_shown_row_and_in_the_next_frame(busy):
    """However far was computed ahead: the answer names the next row, the next frame has it, and the past is a run's."""
    halves = []

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "play")
        commands = [
            ("inject", {"fault": FAULT}),
            ("set-signal", {"name": "u", "signal": {"kind": "constant", "value": 2}}),
            ("set-noise", {"output": "y", "std": 0.01}),
            ("clear", {}),
        ]
        for kind, fields in commands:
            await stage.go(0.7)
            for _ in range(60 if busy else 0):
                if not stage.room.prefetcher.halfway:
                    await stage.go(0.035)
            before = page.rows().shape[1]
            halves.append(stage.room.prefetcher.halfway)
            ack = await stage.say(page, kind, **fields)
            assert (ack["type"], ack["row"]) == ("ack", before)
            assert before < page.rows().shape[1] <= before + 4, "a row that shows it is there"
        await stage.go(0.5)
        same(page.rows(), stage.session.spec, page.texts[0]["columns"])
        assert len(page.of("spec")) == 4 and page.of("spec")[-1]["spec"]["faults"][1]["end"] is not None
        assert halves == 4 * [busy]

    staged(scenario, busy=busy)


def test_a_refused_command_changes_nothing():
    """The numbers are those without it."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "play")
        await stage.go(0.5)
        before = stage.session.spec
        for kind, fields in [
            ("inject", {"fault": FAULT | {"channel": "nowhere"}}),
            ("set-gain", {"observer": "x", "gain": "y", "value": 1}),
            ("remove-observer", {"label": "x"}),
            ("add-observer", {"observer": {"label": "b", "kind": "no-such"}}),
        ]:
            answer = await stage.say(page, kind, **fields)
            assert answer["type"] == "refused" and answer["problem"] and answer["remedy"]
            await stage.go(0.1)
        assert stage.session.spec == before and page.of("spec") == []
        same(page.rows(), before, page.texts[0]["columns"])

    staged(scenario)


def test_dragging_a_slider_does_not_make_time_go_faster():
    """Fifty commands in one second, each answered with its row, and simulated time is one second."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "play")
        for _ in range(50):
            await stage.go(0.02)
            await stage.say(page, "set-noise", output="y", std=0.01)
        assert abs(page.rows().shape[1] - 101) <= 2

    staged(scenario)


def test_events_come_when_their_row_is_shown_not_when_it_is_computed():
    """A fault of the spec at 0.5 s: viewers that join earlier get its event then, later ones find it in the log."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "play")
        await stage.go(0.4)
        assert stage.session.row > 60, "computed ahead"
        early = await stage.connect()
        assert "fault-begins" not in kinds(page.of("event")) + kinds(early.texts[0]["log"])
        await stage.go(0.2)
        late = await stage.connect()
        assert kinds(page.of("event")).count("fault-begins") == kinds(early.of("event")).count("fault-begins") == 1
        assert kinds(late.texts[0]["log"])[0] == "fault-begins"  # its alarm may follow
        await stage.go(0.2)
        assert "fault-begins" not in kinds(late.of("event"))

    staged(scenario)


def test_observers_are_added_and_removed_with_their_columns():
    """Each time in a new epoch with the new columns; the spec run again is the session."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "play")
        await stage.go(0.5)
        await stage.say(page, "add-observer", observer=SECOND)
        await stage.go(0.5)
        columns = page.of("columns")[0]
        assert columns["epoch"] == 1 and any(name.startswith("other.") for name in columns["columns"])
        assert {frame.samples.shape[0] for frame in page.frames if frame.epoch == 1} == {len(columns["columns"])}
        assert page.order.index("columns") < page.order.index("spec")
        new = await stage.connect()
        same(new.rows(), stage.session.spec, columns["columns"])
        await stage.say(page, "remove-observer", label="other")
        await stage.go(0.2)
        assert page.of("columns")[1]["columns"] == page.texts[0]["columns"] and page.frames[-1].epoch == 2

    staged(scenario)


def test_a_command_whose_kernels_take_too_long_is_refused():
    """The session has the same rows as without it, and later commands are carried out; simple ones need no worker."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "play")
        await stage.go(0.3)
        stage.rehearsal = time_limit(Limits(20.0, 20.0, 1))
        await stage.say(page, "add-observer", observer=SECOND)
        await stage.go(0.2)
        assert page.of("refused")[0]["code"] == "work.time-limit" and not page.of("columns")
        await stage.say(page, "inject", fault=FAULT)
        await stage.go(0.2)
        assert len(stage.session.spec.faults) == 2
        assert len(stage.rehearsed) == 1
        same(page.rows(), stage.session.spec, page.texts[0]["columns"])

    staged(scenario)


def test_a_command_is_dropped_if_its_viewer_leaves_while_kernels_are_compiled():
    """Commands of other viewers are carried out."""

    async def scenario(stage: Stage) -> None:
        page, other = await stage.connect(), await stage.connect()
        stage.rehearsal = ...
        command = json.dumps({"type": "add-observer", "id": 1, "observer": SECOND})
        stage.room.commands.receive(page.viewer, command, 100_000)
        stage.room.leave(page.viewer)
        assert (await stage.say(other, "inject", fault=FAULT))["type"] == "ack"
        assert len(stage.session.spec.faults) == 2 and not stage.session.spec.commands

    staged(scenario)


def test_going_back_discards_the_rows_after_it():
    """The session continues at the row of the answer, in a new epoch; a paused session stays paused."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "play")
        await stage.go(1.0)
        await stage.say(page, "inject", fault=FAULT)
        await stage.go(1.0)
        answer = await stage.say(page, "seek", t=0.6)
        assert answer["row"] == page.of("rewound")[0]["row"] == 60 and page.of("rewound")[0]["epoch"] == 1
        await stage.go(0.5)
        after = [frame for frame in page.frames if frame.epoch == 1]
        assert after[0].first == 60
        same(page.rows()[:, : after[-1].end], stage.session.spec, page.texts[0]["columns"])
        await stage.say(page, "pause")
        await stage.say(page, "reset")
        assert stage.room.shown == 1 and page.frames[-1].end == 1, "the first row is shown"
        await stage.go(1.0)
        assert stage.room.shown == 1

    staged(scenario)


def test_single_steps_are_shown_immediately():
    """Also while paused, and two of them add up."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "step", rows=5)
        await stage.go(0.1)
        assert stage.room.shown == 6
        await stage.say(page, "step", rows=1000)
        await stage.go(0.5)
        assert stage.room.shown == 1006 == page.rows().shape[1]
        await stage.go(1.0)
        assert stage.room.shown == 1006 and page.of("status")[-1]["playing"] is False

    staged(scenario)


def test_speeds_are_kept_and_reported():
    """Ten times the speed gives ten times the rows; as fast as possible is faster; the rate is reported."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "speed", value=10)
        await stage.say(page, "play")
        await stage.go(3.0)
        assert abs(stage.room.shown - 3000) < 40
        assert abs(page.of("status")[-1]["rate"] - 10) < 0.5
        before = stage.room.shown
        await stage.say(page, "speed", value=None)
        await stage.go(1.0)
        assert stage.room.shown - before > 20_000
        assert all(frame.samples.nbytes <= 256 * 1024 for frame in page.frames)

    staged(scenario)


def test_a_command_that_fails_inside_leaves_the_session_as_it_was(monkeypatch):
    """It is refused, and the rows are those of a run without it."""
    handle = Session.handle

    def broken(session: Session, command: object):
        handle(session, command)
        session.advance(7)
        raise RuntimeError("in the middle of it")

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "play")
        await stage.go(0.5)
        before = stage.session.spec
        monkeypatch.setattr(Session, "handle", broken)
        answer = await stage.say(page, "inject", fault=FAULT)
        assert answer["type"] == "refused" and "inside the program" in answer["problem"]
        monkeypatch.setattr(Session, "handle", handle)
        assert stage.session.spec is before and "inject" not in [event["kind"] for event in page.of("event")]
        await stage.go(0.5)
        assert (await stage.say(page, "inject", fault=FAULT))["type"] == "ack"
        await stage.go(0.5)
        same(page.rows(), stage.session.spec, page.texts[0]["columns"])

    staged(scenario)


def test_a_read_only_viewer_cannot_command():
    """Each of its commands is refused; the session continues."""

    async def scenario(stage: Stage) -> None:
        page, guest = await stage.connect(), await stage.connect(control=False)
        assert guest.texts[0]["role"] == "view"
        await stage.say(page, "play")
        for kind, fields in [("pause", {}), ("inject", {"fault": FAULT}), ("reset", {})]:
            assert "only allows viewing" in (await stage.say(guest, kind, **fields))["problem"]
        await stage.go(1.0)
        np.testing.assert_array_equal(guest.rows(), page.rows())
        assert stage.room.shown > 95

    staged(scenario)


def test_a_spec_with_timed_commands_changes_its_columns():
    """The observer that the spec adds at 0.4 s is present from that row on, in a new epoch."""
    later = {"at": 0.4, "command": "add-observer", "observer": SECOND}

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "play")
        await stage.go(1.0)
        change = page.of("columns")
        assert [c["row"] for c in change] == [40]
        assert [frame.end for frame in page.frames if frame.epoch == 0][-1] == 40
        assert {frame.samples.shape[0] for frame in page.frames if frame.epoch == 1} == {len(change[0]["columns"])}

    staged(scenario, commands=[later])
