"""Going back to an earlier row: from the newest snapshot before it, the rows up to it are simulated again."""

from dataclasses import replace

from thetascope.engine.errors import SpecError
from thetascope.engine.estimation.covariance import latest
from thetascope.engine.simulation.controlled import simulation_of
from thetascope.engine.simulation.simulation import Simulation
from thetascope.live.session import edits
from thetascope.live.session.advance import advance
from thetascope.live.session.changes import adopt, note
from thetascope.live.session.live_columns import LiveColumns
from thetascope.live.session.session_state import SessionState
from thetascope.live.session.snapshots import LightSnapshot, RecordedBatch, Snapshot
from thetascope.messages import Message
from thetascope_schemas.experiment.base import Text
from thetascope_schemas.service.session import Event, Seek

_OF_COMMANDS = ("inject", "clear", "gain", "signal", "noise", "observer-added", "observer-removed", "rewound", "reset")
"""Kinds of events that belong to commands, which act before the row that they name."""


def row_of(state: SessionState, command: Seek) -> int:
    """Return the row to go back to. Raises SpecError where it has not been reached yet."""
    record = state.setup.record
    if command.t > state.t + 0.5 * record:
        raise SpecError("t", command.t, Message("session.seek.ahead", t=state.t))
    return min(state.row, round(command.t / record))


def seek(state: SessionState, row: int) -> tuple[SessionState, Event]:
    """Return the state at an earlier row, without anything commanded from that row on, and the event for the log."""
    t = row * state.setup.record
    faults = state.faults[:1] + tuple(known for known in state.faults[1:] if known[0] < row)
    spec = edits.truncated_at(state.spec, state.setup.spec, faults[-1][1], t)
    if row < state.row:
        state = return_to(state, row)
    log = tuple(event for event in state.log if event.row < row)
    stages = tuple(s for s in state.stages if s.k < row * state.setup.every) or state.stages[:1]
    current = replace(state.current, stage=min(state.current.stage, len(stages) - 1))
    state = replace(state, faults=faults, unreported=(), stages=stages, current=current).with_log(log)
    state = adopt(state, spec, edits.without_commands(spec, state.t), None)
    message = Text.of(Message("event.rewound", t=t))
    return note(replace(state, epoch=state.epoch + 1), Event(row=row, t=t, kind="rewound", message=message))


def return_to(state: SessionState, row: int) -> SessionState:
    """Return the state at an earlier row, with spec, stages and log as they were:
    rows that nobody has seen are dropped."""
    base = state.snapshots.latest_full(row) or _restored(state, row)
    batch = state.snapshots.batch(base.row, row)
    again = replace(
        state,
        current=base,
        ended=False,
        columns=base.live_columns.columns,
        log=state.log[: base.log_length],
        history=state.history.before(base.row),
        snapshots=state.snapshots.before(row),
    )
    if batch is not None:
        again = _recall(again, batch, row)
    while again.row < row:
        again, _ = advance(again, row - again.row)
    # The rows in between have been reported before: their events are in the log already.
    log = tuple(e for e in state.log if e.row < row or (e.row == row and e.kind in _OF_COMMANDS))
    return replace(
        again,
        history=state.history.before(row),
        unreported=tuple(event for event in state.unreported if event.row < row),
        spec=state.spec,
        stages=state.stages,
    ).with_log(log)


def _recall(state: SessionState, batch: RecordedBatch, row: int) -> SessionState:
    """Return the state at a row of a batch that is kept, without simulating it again."""
    current, experiment, known = state.current, state.experiment, batch.before(row)
    columns = current.live_columns.continued(experiment, known.recorded, latest(known.columns.tables))
    detection, _ = state.setup.detector.observe(
        current.detection, experiment, known.recorded, known.columns.values, False, state.detects_outside
    )
    reached = known.state_at(row, current.state, simulation_of(experiment, remember=True))
    return replace(state, current=Snapshot(row, reached, current.stage, columns, detection, current.log_length))


def _restored(state: SessionState, row: int) -> Snapshot:
    """Return a full snapshot before a row, made from a light one:
    columns need some rows before they are right again."""
    first = state.stages[0].experiment
    start = LightSnapshot(0, Simulation(first).initial(), 0, state.setup.detector.begin(), 0, {})
    for snapshot in (*state.snapshots.light_before(row), start):
        experiment = state.stages[snapshot.stage].experiment
        columns = LiveColumns.resumable(experiment, snapshot.row, row, snapshot.spreads)
        if columns is not None:
            return snapshot.with_columns(columns)
    return start.with_columns(LiveColumns.opening(first, 0))
