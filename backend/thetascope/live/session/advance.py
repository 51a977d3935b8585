"""Advancing a session in two halves: rows are simulated, then their columns and events are added to its state."""

from dataclasses import replace

import numpy as np

from thetascope.engine.simulation.controlled import simulation_of
from thetascope.live.session import log_events
from thetascope.live.session.changes import enter_stage
from thetascope.live.session.session_state import SessionState
from thetascope.live.session.snapshots import RecordedBatch, SimulatedRows, Snapshot
from thetascope_schemas.service.session import Event

_SMALL = 30  # rows that are wanted immediately, with the answer to a command


def advance(state: SessionState, rows: int) -> tuple[SessionState, np.ndarray]:
    """Return the state after up to `rows` rows (to where columns change, or the end), and the rows, columns × rows."""
    state, simulated = simulate(state, rows)
    return commit(state, simulated)


def simulate(state: SessionState, rows: int) -> tuple[SessionState, SimulatedRows | None]:
    """Simulate rows from the present row on; None where no more can follow.

    The state stays at its row; it may enter the stage that begins there.
    """
    state = enter_stage(state)
    target = min(state.row + rows, state.setup.horizon)
    following = state.stages[state.current.stage + 1 :]
    boundary = min((stage.k // state.setup.every for stage in following), default=target)
    count = max(0, min(target, max(boundary, state.row + (0 if target == state.row else 1))) - state.row)
    if state.ended or count == 0:
        return replace(state, ended=state.ended or state.row >= state.setup.horizon), None
    after, recorded = simulation_of(state.experiment, remember=True).advance(
        state.current.state, count * state.setup.every
    )
    return state, SimulatedRows(state.current, count, after, recorded)


def commit(state: SessionState, simulated: SimulatedRows | None) -> tuple[SessionState, np.ndarray]:
    """Return the state after simulated rows, and the rows, columns × rows.

    Rows that do not continue the present snapshot (a command came in between) are void: none are returned.
    """
    current, setup = state.current, state.setup
    if simulated is None or simulated.since is not current:
        return state, np.empty((len(state.columns), 0))
    count, recorded = simulated.count, simulated.recorded
    columns, batch = current.live_columns.extended(state.experiment, recorded)
    data, detection, alarms = batch.data, current.detection, []
    if columns.plant_lost:  # time ends with the row that says so
        count = min(count, round(columns.plant_lost.time / setup.record) - current.row + 1)
        data = data[:, :count]
    else:
        detection, alarms = setup.detector.observe(
            current.detection, state.experiment, recorded, batch.values, count > _SMALL, state.detects_outside
        )
        alarms = log_events.unlogged(alarms, state.log)
    events = _in_order(state, count, alarms, columns.lost_since(current.live_columns, setup.record))
    snapshots = state.snapshots.add(current)
    if not columns.plant_lost and (columns.lost or {}) == (current.live_columns.lost or {}):
        snapshots = snapshots.add_batch(RecordedBatch(current.row, recorded, batch))
    log = (*state.log, *events)
    after = replace(
        state,
        current=Snapshot(current.row + count, simulated.state, current.stage, columns, detection, len(log)),
        log=log,
        unreported=(*state.unreported, *events),
        history=state.history.append(state.columns, data),
        snapshots=snapshots,
        ended=columns.plant_lost is not None or current.row + count >= setup.horizon,
    )
    return after, data


def _in_order(state: SessionState, count: int, alarms: list[Event], lost: list[Event]) -> tuple[Event, ...]:
    """Return the events of the next `count` rows by row: planned by the spec, alarms, divergences."""
    due = log_events.due_events(state.spec, state.log, state.row, state.row + count, state.setup.record)
    return tuple(sorted([*due, *alarms, *lost], key=lambda event: event.row))
