"""The states of a room: every sequence of events stays in the table, and what viewers see follows from the state."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.live.stage import Stage, staged
from thetascope.live.room.room_state import HELD, TRANSITIONS, IllegalTransition, RoomMachine, State, Transition
from thetascope.messages import Message
from thetascope_schemas.service.session import CLOSE_ENDED

OBSERVED = ("playing", "stepping", "moving", "running", "ended", "held", "asleep", "closed")


def observed(machine: RoomMachine) -> tuple[bool, ...]:
    """Return all answers of the machine to the room's parts."""
    return tuple(getattr(machine, name) for name in OBSERVED)


def in_state(state: State) -> RoomMachine:
    machine = RoomMachine()
    machine.state = state
    return machine


@given(st.lists(st.sampled_from(Transition), max_size=60))
def test_no_sequence_of_events_leaves_the_table(transitions):
    """A transition of the table leads to its state; any other raises and changes nothing;
    answers depend on the state only."""
    machine = RoomMachine()
    for transition in transitions:
        before = machine.state
        if machine.allows(transition):
            machine.fire(transition)
            assert machine.state is TRANSITIONS[before][transition]
        else:
            with pytest.raises(IllegalTransition, match=f"{transition.name} .* {before.name}"):
                machine.fire(transition)
            assert machine.state is before
        assert observed(machine) == observed(in_state(machine.state))


def test_every_state_is_reached_from_paused():
    """The table has no state that a room cannot be in."""
    reached, border = {State.PAUSED}, [State.PAUSED]
    while border:
        following = set(TRANSITIONS[border.pop()].values()) - reached
        reached |= following
        border += following
    assert reached == set(State) == set(TRANSITIONS)


@pytest.mark.parametrize("state", State)
def test_the_answers_of_a_state_agree_with_one_another(state):
    """Rows move if and only if the room plays or steps; they are shown unless it is held or asleep; closed is final."""
    machine = in_state(state)
    assert machine.moving == (machine.playing or machine.stepping)
    assert machine.running == (machine.moving and not machine.held and not machine.asleep)
    assert not (machine.ended and machine.moving)
    assert machine.closed == (TRANSITIONS[state] == {})
    assert machine.closed or machine.allows(Transition.CLOSE)


@pytest.mark.parametrize("state", sorted(HELD, key=lambda state: state.value))
def test_a_held_room_continues_as_it_would_be_without_the_long_command(state):
    """Whatever viewers do while a long command is carried out, its end leads to the state of the same name."""
    assert TRANSITIONS[state][Transition.RELEASE].name == state.name.removeprefix("HELD_")
    for transition in (Transition.PLAY, Transition.PAUSE, Transition.STEP, Transition.REACH, Transition.END):
        free = TRANSITIONS[TRANSITIONS[state][Transition.RELEASE]].get(transition)
        held = TRANSITIONS[state].get(transition)
        assert (held and held.name) == (free and f"HELD_{free.name}")


def test_a_room_without_viewers_falls_asleep_and_wakes():
    """After a minute no row follows; a later viewer sees it continue from there."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "play")
        await stage.go(1.0)
        stage.room.leave(page.viewer)
        await stage.go(70.0)
        assert stage.room.machine.state is State.ASLEEP and stage.room.status().playing
        shown = stage.room.shown
        await stage.go(100.0)
        assert stage.room.shown == shown
        await stage.connect()
        await stage.go(1.0)
        assert stage.room.machine.state is State.PLAYING and 95 <= stage.room.shown - shown <= 105

    staged(scenario)


def test_a_closed_room_does_nothing_more():
    """Commands that were on their way, and rows that were being computed, are dropped without an error."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "play")
        await stage.go(0.5)
        stage.room.close(CLOSE_ENDED, Message("session.close.ended"))
        for text in ('{"type": "pause", "id": 90}', '{"type": "clear", "id": 91}', '{"type": "reset", "id": 92}'):
            stage.room.commands.receive(page.viewer, text, 1000)
        stage.room.prefetch_rows()
        assert stage.room.tick(2.0) is None and stage.room.machine.state is State.CLOSED

    staged(scenario)
