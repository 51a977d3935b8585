"""Batches: several commands at the same row, all or none, with one answer."""

from tests.live.stage import Stage, kinds, same, staged

FAULT = {"channel": "gain", "shape": "step", "onset": 0, "size": 0.3}
MORE = FAULT | {"size": 0.2}
SECOND = {"label": "other", "kind": "adaptive-kalman"}


def change(fault):
    """The commands that change a fault: the old one is cleared, the new one injected."""
    return [{"type": "clear", "channel": "gain"}, {"type": "inject", "fault": fault}]


def test_a_fault_is_changed_at_one_row_while_time_runs():
    """One answer; the old fault ends at the very row at which the new one begins; the spec run again is the session."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "play")
        await stage.go(0.5)
        await stage.say(page, "inject", fault=FAULT)
        await stage.go(0.5)
        answer = await stage.say(page, "batch", commands=change(MORE))
        await stage.go(0.5)
        old, new = stage.session.spec.faults[-2:]
        assert answer["type"] == "ack" and answer["t"] == old.end == new.onset
        assert (old.size, new.size, new.end) == (0.3, 0.2, None)
        done = [event for event in page.of("event") if event["kind"] in ("clear", "inject")]
        assert kinds(done) == ["inject", "clear", "inject"]
        assert [event["row"] for event in done[1:]] == [answer["row"]] * 2
        same(page.rows(), stage.session.spec, page.texts[0]["columns"])

    staged(scenario)


def test_a_batch_with_a_refused_command_leaves_nothing():
    """The first command of two would have been carried out:
    its fault goes on, nothing is logged, one refusal says where."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "play")
        await stage.go(0.2)
        await stage.say(page, "inject", fault=FAULT)
        await stage.go(0.2)
        before = stage.session.spec
        answer = await stage.say(page, "batch", commands=change(MORE | {"channel": "nowhere"}))
        assert (answer["type"], answer["field"]) == ("refused", "commands[1].fault.channel")
        await stage.go(0.2)
        assert stage.session.spec == before and "clear" not in kinds(page.of("event"))
        assert stage.session.spec.faults[-1].end is None
        same(page.rows(), before, page.texts[0]["columns"])

    staged(scenario)


def test_an_observer_is_started_again_by_one_batch():
    """Removed and added with other gains under its label: at one row, with one change of columns at most."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "add-observer", observer=SECOND)
        await stage.say(page, "play")
        await stage.go(0.3)
        again = [{"type": "remove-observer", "label": "other"}, {"type": "add-observer", "observer": SECOND}]
        answer = await stage.say(page, "batch", commands=again)
        assert answer["type"] == "ack"
        commands = stage.session.spec.commands[-2:]
        assert [c.command for c in commands] == ["remove-observer", "add-observer"]
        assert commands[0].at == commands[1].at == answer["t"]

    staged(scenario)


def test_a_batch_holds_commands_on_the_session_only():
    """The clock, going back and batches within batches are refused when the message is read; so is an empty batch."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        for commands in ([{"type": "play"}], [{"type": "seek", "t": 0}], [{"type": "batch", "commands": []}], []):
            answer = await stage.say(page, "batch", commands=commands)
            assert answer["type"] == "refused" and answer["field"].startswith("commands")

    staged(scenario)
