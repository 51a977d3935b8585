"""A live session without any input or output: commands in, rows and events out.

It is the experiment that runs use, advanced a few rows at a time. Everything done to it is part of its `spec` (faults
with their times, timed commands), so an ordinary run of `spec` gives the same numbers bit for bit.
"""

from copy import copy
from dataclasses import replace

import numpy as np

from thetascope.diagnosis.monitor.monitor import MonitorState
from thetascope.engine.errors import SpecError
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope.live.session import advance, changes, log_events, rewind
from thetascope.live.session.history import RowHistory
from thetascope.live.session.live_columns import LiveColumns
from thetascope.live.session.live_detector import DetectorProgress, LiveDetector
from thetascope.live.session.session_state import SessionSetup, SessionState
from thetascope.live.session.snapshots import SimulatedRows, Snapshot, Snapshots
from thetascope.messages import Message
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.experiment.base import Text
from thetascope_schemas.service.session import Assumptions, Batch, Event, NoteCommand, Reset, Seek, SessionCommand


class Session:
    """One live experiment: `state` is all that changes, and each method replaces it by the next value.

    Args:
        spec: the experiment.
        horizon_rows: rows that the session may reach.
    """

    def __init__(self, spec: ResolvedExperiment, horizon_rows: int = 1_000_000) -> None:
        self.state = SessionState.at_start(SessionSetup.of(spec, horizon_rows))

    # ---- the present state -------------------------------------------------------------------------------------------

    @property
    def spec(self) -> ResolvedExperiment:
        """The experiment with everything done so far."""
        return self.state.spec

    @property
    def row(self) -> int:
        """Rows produced so far: the number of the next one."""
        return self.state.row

    @property
    def t(self) -> float:
        """Time of the next row, s."""
        return self.state.t

    @property
    def step(self) -> float:
        """Base step of the simulation, s."""
        return self.state.setup.step

    @property
    def record(self) -> float:
        """Time between rows, s."""
        return self.state.setup.record

    @property
    def experiment(self) -> Engine:
        """The engine's experiment at the present row."""
        return self.state.experiment

    @property
    def detector(self) -> LiveDetector:
        """The detector of faults."""
        return self.state.setup.detector

    @property
    def current(self) -> Snapshot:
        """The snapshot at the present row."""
        return self.state.current

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns at the present row."""
        return self.state.columns

    @property
    def epoch(self) -> int:
        """A number that grows whenever the columns or the past change."""
        return self.state.epoch

    @property
    def ended(self) -> bool:
        """Whether no more rows can follow."""
        return self.state.ended

    @property
    def log(self) -> tuple[Event, ...]:
        """All events so far."""
        return self.state.log

    @property
    def history(self) -> RowHistory:
        """The rows recorded so far."""
        return self.state.history

    def rows(self, first: int, last: int) -> np.ndarray:
        """Return recorded rows first … last − 1 in the present columns: float32, columns × rows."""
        return self.history.rows(self.columns, first, last)

    def new_events(self) -> tuple[Event, ...]:
        """Return the events found by advancing since the last call."""
        events = self.state.unreported
        self.state = replace(self.state, unreported=())
        return events

    def assumptions(self) -> list[Assumptions]:
        """Return the checks of every observer's theorem over its last rows."""
        return self.current.live_columns.assumptions(self.experiment)

    # ---- advancing ---------------------------------------------------------------------------------------------------

    def advance(self, rows: int) -> np.ndarray:
        """Advance by up to `rows` rows (to where columns change, or the end); return them, columns × rows."""
        self.state, data = advance.advance(self.state, rows)
        return data

    def simulate(self, rows: int) -> SimulatedRows | None:
        """Return the first half of advancing: the session stays at its row. None: no more rows can follow."""
        self.state, simulated = advance.simulate(self.state, rows)
        return simulated

    def commit(self, simulated: SimulatedRows | None) -> np.ndarray:
        """Add simulated rows to the session and return them, columns × rows; none if a command came in between."""
        self.state, data = advance.commit(self.state, simulated)
        return data

    def drop_oldest(self, rows: int) -> None:
        """Drop the oldest recorded rows, as long as at least `rows` rows remain."""
        self.state = replace(self.state, history=self.history.drop_oldest(rows))

    def leave_detection(self) -> None:
        """Leave testing rows for faults to `live/room/background_checks.py`; otherwise they are tested as they come."""
        self.state = replace(self.state, detects_outside=True)

    # ---- commands ----------------------------------------------------------------------------------------------------

    def handle(self, command: SessionCommand) -> tuple[list[Event], bool]:
        """Carry out a command at the present row. Play, Pause, Step and Speed concern the clock, not the session.

        Returns:
            the events of the command, and whether the past or the columns changed (a new epoch).

        Raises:
            SpecError, pydantic.ValidationError: the command is refused, and the session is as it was.
        """
        epoch = self.state.epoch
        self.state, events = _after(self.state, command)
        return events, self.state.epoch != epoch

    def drop_unseen_rows(self, row: int) -> None:
        """Drop the rows from `row` on, which were computed ahead and shown to nobody: no new epoch."""
        if row < self.row:
            self.state = rewind.return_to(self.state, row)

    # ---- faults ------------------------------------------------------------------------------------------------------

    def pending_detection(self) -> DetectorProgress | None:
        """Return how far rows have been tested for faults, if some wait; None otherwise."""
        progress = self.current.detection
        return progress if progress is not None and progress.waiting else None

    def add_detection(self, progress: DetectorProgress, after: MonitorState) -> list[Event]:
        """Add the result of testing the rows that waited in `progress`, and return the new alarms.

        Nothing is added if the session has gone back in the meantime.
        """
        detection = self.current.detection
        if detection is None or not detection.continues(progress):
            return []
        alarms = log_events.unlogged(self.detector.events(progress, after), self.log)
        detection = DetectorProgress(after, detection.waiting[len(progress.waiting) :])
        state = replace(self.state, current=replace(self.current, detection=detection))
        self.state = state.with_log((*self.log, *alarms))
        return alarms

    # ---- copies ------------------------------------------------------------------------------------------------------

    def fork(self, row: int | None = None) -> "Session":
        """Return a second session at a row of this one (by default the present one); it goes its own way from there."""
        other = copy(self)
        other.state = replace(self.state, unreported=())
        if row is not None and row < self.row:
            state, _ = rewind.seek(other.state, row)
            other.state = replace(state, log=state.log[:-1])  # for the fork nothing has been rewound
        return other

    def release(self) -> None:
        """Free everything that takes memory; nothing can be done with the session afterwards."""
        current = replace(self.current, live_columns=LiveColumns(self.columns, self.row), detection=None)
        self.state = replace(
            self.state,
            current=current,
            history=RowHistory(),
            snapshots=Snapshots(),
            log=(),
            unreported=(),
            ended=True,
        )


def _after(state: SessionState, command: SessionCommand) -> tuple[SessionState, list[Event]]:
    """Return the state after a command, and the command's events. Raises SpecError or pydantic.ValidationError."""
    if isinstance(command, Batch):
        return _after_batch(state, command)
    if isinstance(command, NoteCommand):
        return changes.annotate(state, command), []
    if isinstance(command, Reset):
        start = SessionState.at_start(state.setup)
        start = replace(start, epoch=state.epoch + 1, detects_outside=state.detects_outside)
        reset = Event(row=0, t=0.0, kind="reset", message=Text.of(Message("event.reset")))
        state, event = changes.note(start, reset)
    elif isinstance(command, Seek):
        state, event = rewind.seek(state, rewind.row_of(state, command))
    else:
        state, event = changes.change(state, command)
    return state, [event]


def _after_batch(state: SessionState, batch: Batch) -> tuple[SessionState, list[Event]]:
    """Return the state after all commands of a batch, and their events. A SpecError names the command's place."""
    events: list[Event] = []
    for place, command in enumerate(batch.commands):
        try:
            state, more = _after(state, command)
        except SpecError as error:
            error.field = f"commands[{place}].{error.field}"
            raise
        events += more
    return state, events
