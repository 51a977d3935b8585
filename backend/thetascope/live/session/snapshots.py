"""Snapshots of a session, and the ones that are kept so that it can go back to an earlier row."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from thetascope.engine.estimation.covariance import Spreads
from thetascope.engine.simulation.controlled import Controlled
from thetascope.engine.simulation.experiment import Rows, State
from thetascope.engine.simulation.simulation import Simulation
from thetascope.live.session.live_columns import ColumnBatch, LiveColumns
from thetascope.live.session.live_detector import DetectorProgress, without_windows

_FULL = 6  # full snapshots kept, for dropping rows that nobody has seen
_BATCHES = 2  # of the newest full snapshots, with the columns of the rows after them
_LIGHT = 400  # light snapshots kept, for seeking; when there are more, every second one is dropped
_UNTESTED_ROWS = 256  # rows not yet seen by the detector that a light snapshot may hold


@dataclass(frozen=True)
class LightSnapshot:
    """Where everything is at a row, without the rows that windows need: those are recomputed from an earlier row."""

    row: int
    state: State
    stage: int
    detection: DetectorProgress | None  # None: no detector
    log_length: int  # events in the log
    spreads: Spreads  # S of each observer before the row

    def with_columns(self, columns: LiveColumns) -> "Snapshot":
        """Return the full snapshot."""
        return Snapshot(self.row, self.state, self.stage, columns, self.detection, self.log_length)


@dataclass(frozen=True)
class Snapshot:
    """Where everything is at a row: a value, so that going back is taking an earlier one."""

    row: int
    state: State
    stage: int
    live_columns: LiveColumns
    detection: DetectorProgress | None  # None: no detector
    log_length: int  # events in the log

    def light(self) -> LightSnapshot:
        """Return the snapshot without the rows that windows need."""
        detection = without_windows(self.detection)
        return LightSnapshot(self.row, self.state, self.stage, detection, self.log_length, self.live_columns.spreads)


@dataclass(frozen=True)
class SimulatedRows:
    """`count` rows simulated from a snapshot on, and the state after them. Their columns are not made yet."""

    since: Snapshot
    count: int
    state: State
    recorded: Rows


@dataclass(frozen=True)
class RecordedBatch:
    """The rows from `first` on, where a snapshot is: the recorded states, and the columns computed from them."""

    first: int
    recorded: Rows
    columns: ColumnBatch

    def before(self, row: int) -> "RecordedBatch":
        """Return the rows before a row."""
        count = row - self.first
        return RecordedBatch(self.first, self.recorded.part(0, count), self.columns.head(count))

    def state_at(self, row: int, start: State, simulation: Simulation | Controlled) -> State:
        """Return the state at a row of the batch, or just after it; `start`: the state at its first row."""
        count = row - self.first
        known = simulation.state_at(start, self.recorded, count) if count < len(self.recorded.index) else None
        return known or simulation.advance(start, count * simulation.experiment.every)[0]


@dataclass(frozen=True)
class Snapshots:
    """The newest snapshots in full, older ones light and thinned out: memory does not grow with the session."""

    full: tuple[Snapshot, ...] = ()
    light: tuple[LightSnapshot, ...] = ()
    batches: tuple[RecordedBatch, ...] = ()

    def add(self, snapshot: Snapshot) -> "Snapshots":
        """Return these snapshots and one more."""
        light = self.light
        few = snapshot.detection is None or snapshot.detection.rows <= _UNTESTED_ROWS
        if not light or (few and snapshot.row > light[-1].row):
            light = (*light, snapshot.light())
            if len(light) > _LIGHT:
                light = light[:1] + light[1::2]
        return Snapshots((*self.full, snapshot)[-_FULL:], light, self.batches)

    def add_batch(self, batch: RecordedBatch) -> "Snapshots":
        """Return these snapshots with the rows after a full one."""
        return replace(self, batches=(*self.batches, batch)[-_BATCHES:])

    def batch(self, first: int, row: int) -> RecordedBatch | None:
        """Return the batch that begins at row `first`, if it is kept and reaches to `row`."""
        batch = next((b for b in reversed(self.batches) if b.first == first), None)
        return batch if batch is not None and first < row <= first + len(batch.recorded.index) else None

    def latest_full(self, row: int) -> Snapshot | None:
        """Return the latest full snapshot at or before a row."""
        return next((s for s in reversed(self.full) if s.row <= row), None)

    def light_before(self, row: int) -> Iterator[LightSnapshot]:
        """Return the light snapshots at or before a row, the latest first."""
        return (s for s in reversed(self.light) if s.row <= row)

    def before(self, row: int) -> "Snapshots":
        """Return these snapshots without those at or after a row (a light one may be at it)."""
        return Snapshots(
            tuple(s for s in self.full if s.row < row),
            tuple(s for s in self.light if s.row <= row),
            tuple(b.before(row) for b in self.batches if b.first < row),
        )
