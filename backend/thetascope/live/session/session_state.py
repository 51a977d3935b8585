"""Everything that commands and time may change in a session, as one immutable value.

A step of a session is a function from one value to the next (advance.py, changes.py, rewind.py). A command that fails
leaves no trace because the session still has the earlier value; a fork is a second session with the same value.
"""

from dataclasses import dataclass, field, replace

from thetascope.assembly.build.prepare import prepare
from thetascope.engine.execution.stages import Stage
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope.engine.simulation.simulation import Simulation
from thetascope.live.session.history import RowHistory
from thetascope.live.session.live_columns import LiveColumns
from thetascope.live.session.live_detector import LiveDetector, with_fixed_span
from thetascope.live.session.snapshots import Snapshot, Snapshots
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.experiment.faults import Fault
from thetascope_schemas.service.session import Event


@dataclass(frozen=True)
class SessionSetup:
    """The parts of a session that never change.

    Args:
        spec: the experiment at the start.
        stages: its stages.
        horizon: rows that the session may reach.
        detector: the detector of faults.
        step: base step of the simulation, s.
        every: base steps per row; all rows at which the run is examined are shown, whatever `record` is.
    """

    spec: ResolvedExperiment
    stages: tuple[Stage, ...]
    horizon: int
    detector: LiveDetector
    step: float
    every: int

    @classmethod
    def of(cls, spec: ResolvedExperiment, horizon: int) -> "SessionSetup":
        """Return the setup of a session on a spec; `horizon`: rows that it may reach."""
        rows = {"record": spec.evaluate_interval, "evaluate": spec.evaluate_interval}
        spec = spec.model_copy(update={"diagnosis": with_fixed_span(spec), **rows})
        stages = tuple(prepare(spec).stages)
        first = stages[0].experiment
        detector = LiveDetector.create(spec, first, first.every * first.step)
        if first.recorded:
            horizon = min(horizon, first.steps // first.every + 1)
        return cls(spec, stages, horizon, detector, first.step, first.every)

    @property
    def record(self) -> float:
        """Time between rows, s."""
        return self.every * self.step


@dataclass(frozen=True)
class SessionState:
    """A session at one instant.

    Args:
        spec: the experiment with everything done so far.
        stages: the engine's experiments one after another; `current.stage` is the index of the present one.
        faults: the faults as each command left them: (row of the command, faults).
        current: the snapshot at the present row.
        columns: names of the columns at the present row.
        epoch: grows whenever the columns or the past change.
        ended: whether no more rows can follow.
        log: all events so far.
        unreported: events found by advancing that nobody has fetched yet.
        history: the rows recorded so far.
        snapshots: the rows that the session can go back to.
        detects_outside: whether rows are left to somebody else to be tested for faults.
        untimed: the spec of the present stage without timed commands, with the spec and stage it was derived from.
    """

    setup: SessionSetup
    spec: ResolvedExperiment
    stages: tuple[Stage, ...]
    faults: tuple[tuple[int, tuple[Fault, ...]], ...]
    current: Snapshot
    columns: tuple[str, ...]
    epoch: int = 0
    ended: bool = False
    log: tuple[Event, ...] = ()
    unreported: tuple[Event, ...] = ()
    history: RowHistory = field(default_factory=RowHistory)
    snapshots: Snapshots = field(default_factory=Snapshots)
    detects_outside: bool = False
    untimed: tuple[ResolvedExperiment, int, ResolvedExperiment] | None = None

    @classmethod
    def at_start(cls, setup: SessionSetup) -> "SessionState":
        """Return the state of a session before its first row."""
        first = setup.stages[0].experiment
        columns = LiveColumns.opening(first, 0)
        snapshot = Snapshot(0, Simulation(first).initial(), 0, columns, setup.detector.begin(), 0)
        return cls(setup, setup.spec, setup.stages, ((-1, setup.spec.faults),), snapshot, columns.columns)

    @property
    def row(self) -> int:
        """Rows produced so far: the number of the next one."""
        return self.current.row

    @property
    def t(self) -> float:
        """Time of the next row, s."""
        return self.current.row * self.setup.record

    @property
    def experiment(self) -> Engine:
        """The engine's experiment at the present row."""
        return self.stages[self.current.stage].experiment

    def with_log(self, log: tuple[Event, ...]) -> "SessionState":
        """Return the state with another log, which the present snapshot counts."""
        return replace(self, log=log, current=replace(self.current, log_length=len(log)))
