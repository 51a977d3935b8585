"""The states of a room and every transition between them, in one table.

    paused     time does not advance
    playing    rows become due with the clock
    stepping   rows up to a target are shown as fast as possible, then time stops
    ended      no row can follow: the last row that the session may reach was shown, or the plant has diverged
    asleep     it would play, but nobody has been connected for a minute
    held …     the same while a long command (add-observer, reset, seek) is carried out: no row is shown
    closed     the session is over

The status sent to viewers (`Status.playing`, `Status.ended`) and the permitted actions are functions of the state
alone. Data such as the rows computed ahead, the speed or the time of the last disconnection are no states.
"""

from enum import Enum, auto


class State(Enum):
    """A state of a room; see the module's docstring."""

    PAUSED = auto()
    PLAYING = auto()
    STEPPING = auto()
    ENDED = auto()
    ASLEEP = auto()
    HELD_PAUSED = auto()
    HELD_PLAYING = auto()
    HELD_STEPPING = auto()
    HELD_ENDED = auto()
    HELD_ASLEEP = auto()
    CLOSED = auto()


class Transition(Enum):
    """Something that happens to a room."""

    PLAY = auto()  # a viewer plays
    PAUSE = auto()  # a viewer pauses
    STEP = auto()  # a viewer asks for single rows
    REACH = auto()  # the target of the steps is shown
    END = auto()  # the last row that can follow is shown
    CONTINUE = auto()  # rows can follow again, after going back
    SLEEP = auto()  # nobody has been connected for a minute
    WAKE = auto()  # somebody connects
    HOLD = auto()  # a long command begins
    RELEASE = auto()  # it has been carried out or refused
    CLOSE = auto()  # the session is ended


TRANSITIONS: dict[State, dict[Transition, State]] = {
    State.PAUSED: {
        Transition.PLAY: State.PLAYING,
        Transition.PAUSE: State.PAUSED,
        Transition.STEP: State.STEPPING,
        Transition.END: State.ENDED,
        Transition.HOLD: State.HELD_PAUSED,
        Transition.CLOSE: State.CLOSED,
    },
    State.PLAYING: {
        Transition.PLAY: State.PLAYING,
        Transition.PAUSE: State.PAUSED,
        Transition.STEP: State.STEPPING,
        Transition.END: State.ENDED,
        Transition.SLEEP: State.ASLEEP,
        Transition.HOLD: State.HELD_PLAYING,
        Transition.CLOSE: State.CLOSED,
    },
    State.STEPPING: {
        Transition.PLAY: State.PLAYING,
        Transition.PAUSE: State.PAUSED,
        Transition.STEP: State.STEPPING,
        Transition.REACH: State.PAUSED,
        Transition.END: State.ENDED,
        Transition.HOLD: State.HELD_STEPPING,
        Transition.CLOSE: State.CLOSED,
    },
    State.ENDED: {
        Transition.PAUSE: State.ENDED,
        Transition.CONTINUE: State.PAUSED,
        Transition.HOLD: State.HELD_ENDED,
        Transition.CLOSE: State.CLOSED,
    },
    State.ASLEEP: {
        Transition.WAKE: State.PLAYING,
        Transition.END: State.ENDED,
        Transition.HOLD: State.HELD_ASLEEP,
        Transition.CLOSE: State.CLOSED,
    },
    State.HELD_PAUSED: {
        Transition.PLAY: State.HELD_PLAYING,
        Transition.PAUSE: State.HELD_PAUSED,
        Transition.STEP: State.HELD_STEPPING,
        Transition.END: State.HELD_ENDED,
        Transition.RELEASE: State.PAUSED,
        Transition.CLOSE: State.CLOSED,
    },
    State.HELD_PLAYING: {
        Transition.PLAY: State.HELD_PLAYING,
        Transition.PAUSE: State.HELD_PAUSED,
        Transition.STEP: State.HELD_STEPPING,
        Transition.END: State.HELD_ENDED,
        Transition.RELEASE: State.PLAYING,
        Transition.CLOSE: State.CLOSED,
    },
    State.HELD_STEPPING: {
        Transition.PLAY: State.HELD_PLAYING,
        Transition.PAUSE: State.HELD_PAUSED,
        Transition.STEP: State.HELD_STEPPING,
        Transition.REACH: State.HELD_PAUSED,
        Transition.END: State.HELD_ENDED,
        Transition.RELEASE: State.STEPPING,
        Transition.CLOSE: State.CLOSED,
    },
    State.HELD_ENDED: {
        Transition.PAUSE: State.HELD_ENDED,
        Transition.CONTINUE: State.HELD_PAUSED,
        Transition.RELEASE: State.ENDED,
        Transition.CLOSE: State.CLOSED,
    },
    State.HELD_ASLEEP: {
        Transition.WAKE: State.HELD_PLAYING,
        Transition.END: State.HELD_ENDED,
        Transition.RELEASE: State.ASLEEP,
        Transition.CLOSE: State.CLOSED,
    },
    State.CLOSED: {},
}
"""The state after each transition that a state allows."""

PLAYING = frozenset({State.PLAYING, State.ASLEEP, State.HELD_PLAYING, State.HELD_ASLEEP})
STEPPING = frozenset({State.STEPPING, State.HELD_STEPPING})
ENDED = frozenset({State.ENDED, State.HELD_ENDED})
HELD = frozenset({State.HELD_PAUSED, State.HELD_PLAYING, State.HELD_STEPPING, State.HELD_ENDED, State.HELD_ASLEEP})
ASLEEP = frozenset({State.ASLEEP, State.HELD_ASLEEP})
RUNNING = frozenset({State.PLAYING, State.STEPPING})


class IllegalTransition(RuntimeError):
    """A transition that the state does not allow: an error in the program."""


class RoomMachine:
    """The state of one room. `fire` is the only way to change it."""

    def __init__(self) -> None:
        self.state = State.PAUSED

    def allows(self, transition: Transition) -> bool:
        """Return whether the state has this transition."""
        return transition in TRANSITIONS[self.state]

    def fire(self, transition: Transition) -> None:
        """Go to the next state.

        Raises:
            IllegalTransition: the state does not allow it, and stays.
        """
        following = TRANSITIONS[self.state].get(transition)
        if following is None:
            raise IllegalTransition(f"{transition.name} is not allowed in the state {self.state.name}")
        self.state = following

    @property
    def playing(self) -> bool:
        """Whether time runs, or will run as soon as it can."""
        return self.state in PLAYING

    @property
    def stepping(self) -> bool:
        """Whether rows up to a target are being shown."""
        return self.state in STEPPING

    @property
    def moving(self) -> bool:
        """Whether rows become due: playing or stepping."""
        return self.playing or self.stepping

    @property
    def running(self) -> bool:
        """Whether rows are computed and shown right now."""
        return self.state in RUNNING

    @property
    def ended(self) -> bool:
        """Whether no row can follow."""
        return self.state in ENDED

    @property
    def held(self) -> bool:
        """Whether a long command is being carried out."""
        return self.state in HELD

    @property
    def asleep(self) -> bool:
        """Whether time has stopped because nobody is connected."""
        return self.state in ASLEEP

    @property
    def closed(self) -> bool:
        """Whether the session is over."""
        return self.state is State.CLOSED
