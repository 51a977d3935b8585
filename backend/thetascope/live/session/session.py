"""A live session without any input or output: commands in, rows and events out.

It is the experiment that runs use, advanced a few rows at a time. Everything done to it stands in ``spec`` (faults with
their times, timed commands), so that ``spec`` run as an ordinary run gives the same numbers bit for bit.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from itertools import takewhile

import numpy as np

from thetascope.assembly.build.experiment_builder import engine
from thetascope.assembly.build.incremental import adapted
from thetascope.assembly.build.prepare import prepare
from thetascope.diagnosis.evaluation.verdicts import fault_ids
from thetascope.engine.errors import SpecError
from thetascope.engine.execution.run_experiment import needed_substeps
from thetascope.engine.execution.stages import Stage, carry
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope.engine.simulation.simulation import Simulation
from thetascope.engine.simulation.step_stability import MOST_SUBSTEPS
from thetascope.live.session import edits, log_events
from thetascope.live.session.gain_moves import check_moves, substeps_at
from thetascope.live.session.history import RowHistory
from thetascope.live.session.live_columns import LiveColumns
from thetascope.live.session.live_detector import LiveDetector, pinned
from thetascope.live.session.rewind import Rewinding
from thetascope.live.session.snapshots import Block, SimulatedRows, Snapshot, Snapshots
from thetascope_schemas import Experiment, ResolvedExperiment
from thetascope_schemas.experiment.commands import AddObserver, SetSubsteps
from thetascope_schemas.experiment.faults import Fault
from thetascope_schemas.service.session import (
    AddObserverNow,
    Assumptions,
    Batch,
    Clear,
    Event,
    Inject,
    Reset,
    Seek,
    SetGainNow,
)

_AT_ONCE = 30  # rows


class Session(Rewinding):
    """One live experiment. ``horizon_rows`` limits how long it may become."""

    detects_outside = False  # of its rows for faults, to background_checks.py; else they are watched as they come

    def __init__(self, spec: ResolvedExperiment, horizon_rows: int = 1_000_000):
        self.spec = spec.model_copy(update={"substeps": spec.substeps or 1, "diagnosis": pinned(spec)})
        self._start = self.spec
        self._horizon = horizon_rows
        self._stand_at_start()

    def _stand_at_start(self, epoch: int = 0) -> None:
        """Stand at t = 0 with the spec as it is."""
        self.epoch = epoch
        self._stages = list(prepare(self.spec).stages)
        first = self._stages[0].experiment
        self.step, self._every = first.step, first.every
        self.record = first.every * first.step
        self.history, self.log, self._new = RowHistory(), [], []
        self._faults: tuple[tuple[int, tuple[Fault, ...]], ...] = (
            (-1, self.spec.faults),
        )  # as each command left them, with its row
        self._bare: tuple[Experiment, int, Experiment] | None = None  # see _without_commands
        self.ended = False
        self._advances = 1  # since the last change, and one
        self._again = False  # rows are found again that were checked before
        self._snapshots = Snapshots()
        self.detector = LiveDetector.create(self.spec, first, self.record)
        self.current = Snapshot(
            0, Simulation(first).initial(), 0, LiveColumns.opening(first, 0), self.detector.begin(), 0
        )
        self.columns = self.current.view.columns

    # ---- where it stands ---------------------------------------------------------------------------------------------

    @property
    def row(self) -> int:
        """Rows produced so far: the number of the next one."""
        return self.current.row

    @property
    def t(self) -> float:
        return self.current.row * self.record

    @property
    def experiment(self) -> Engine:
        """The engine's experiment as it is now."""
        return self._stages[self.current.stage].experiment

    def rows(self, first: int, last: int) -> np.ndarray:
        """Recorded rows of the present past in the present columns: float32, columns × rows."""
        return self.history.rows(self.columns, first, last)

    def new_events(self) -> list[Event]:
        """Events found by advancing since this was last asked."""
        new, self._new = self._new, []
        return new

    def assumptions(self) -> list[Assumptions]:
        """The checks of every observer's theorem over its last rows."""
        return self.current.view.assumptions(self.experiment)

    # ---- advancing ---------------------------------------------------------------------------------------------------

    def advance(self, rows: int) -> np.ndarray:
        """Advance by up to ``rows`` rows (to where columns change, or the end): what is recorded, columns × rows."""
        return self.commit(self.simulate(rows))

    def simulate(self, rows: int) -> SimulatedRows | None:
        """The first half of advancing: rows are simulated, and the session stays where it is (it may note that it needs more substeps).

        None: there are no more rows.
        """
        self._enter_stage()
        target = min(self.row + rows, self._horizon)
        following = self._stages[self.current.stage + 1 :]
        boundary = min((s.k // self._every for s in following), default=target)
        count = max(0, min(target, max(boundary, self.row + (0 if target == self.row else 1))) - self.row)
        if self.ended or count == 0:
            self.ended = self.ended or self.row >= self._horizon
            return None
        return self._simulate(count)

    def _simulate(self, count: int) -> SimulatedRows:
        now, experiment = self.current, self.experiment
        substeps = self._substeps
        state, recorded = Simulation(experiment, substeps, remember=True).advance(now.state, count * self._every)
        # it takes as long as the rest together: often after a change, but not for the few rows that are wanted at once;
        # now and then otherwise
        self._advances += 1
        due = 2 + (count <= _AT_ONCE) <= self._advances <= 5 or self._advances % 16 == 0
        if due and not self._again:
            needed = needed_substeps(experiment, recorded)
            if needed > substeps:
                self._take_substeps(min(MOST_SUBSTEPS, needed))
                return self._simulate(count)
        return SimulatedRows(now, count, state, recorded)

    def commit(self, simulated: SimulatedRows | None) -> np.ndarray:
        """The second half: what is shown of the rows, and what they mean. Where a command came between they are void, and none are given."""
        now, experiment = self.current, self.experiment
        if simulated is None or simulated.since is not now:
            return np.empty((len(self.columns), 0))
        count, recorded = simulated.count, simulated.recorded
        self._snapshots.remember(now)
        view, made = now.view.extended(experiment, recorded)
        data, watched, found = made.data, now.watched, []
        if view.plant_lost:  # time ends with the row that says so
            count = min(count, round(view.plant_lost.time / self.record) - now.row + 1)
            data = data[:, :count]
        else:
            watched, found = self.detector.observe(
                now.watched, experiment, recorded, made.values, count > _AT_ONCE, self.detects_outside
            )
            found = log_events.unseen(found, self.log)
        scheduled = log_events.due_events(self.spec, self.log, now.row, now.row + count, self.record)
        found = [*scheduled, *found, *view.lost_since(now.view, self.record)]
        found.sort(key=lambda e: e.row)
        self.history.append(self.columns, data)
        self.log += found
        self._new += found
        self.current = Snapshot(now.row + count, simulated.state, now.stage, view, watched, len(self.log))
        self.ended = view.plant_lost is not None or self.row >= self._horizon
        if not view.plant_lost and (view.lost or {}) == (now.view.lost or {}):
            self._snapshots.keep(Block(now.row, recorded, made))
        return data

    @property
    def _substeps(self) -> int:
        return self.experiment.substeps or 1

    def _enter_stage(self) -> None:
        """Pass to the stage that holds from this row on (its observers start here)."""
        k = self.current.row * self._every
        index = self.current.stage
        while index + 1 < len(self._stages) and self._stages[index + 1].k <= k:
            old, new = self._stages[index].experiment, self._stages[index + 1].experiment
            index += 1
            state = carry(self.current.state, old, new)
            view = self.current.view.carried(new, self.current.row)
            self.current = replace(self.current, state=state, stage=index, view=view)
        if self.current.view.columns != self.columns:
            self.columns = self.current.view.columns
            self.epoch += 1

    def _take_substeps(self, substeps: int) -> None:
        """From this row on, take more substeps; noted as a timed command, so that a saved run does the same."""
        note = SetSubsteps(at=self.t, substeps=substeps)
        earlier = [c for c in self.spec.commands if c.at <= self.t]
        later = [c for c in self.spec.commands if c.at > self.t]
        before = self._without_commands()
        here = before.model_copy(update={"substeps": substeps})
        self._adopt(self.spec.model_copy(update={"commands": (*earlier, note, *later)}), here, before)

    # ---- commands ----------------------------------------------------------------------------------------------------

    def handle(self, command: object) -> tuple[list[Event], bool]:
        """Carry out a command of shared.session (all but play, pause, step and speed) at the present row.

        Gives what happened, and whether the past or the columns changed (a new epoch). Raises SpecError, or ValidationError
        for a spec that is too much; then nothing has changed.
        """
        before = self.epoch
        with self.transaction():
            events = self._carried_out(command)
        return events, self.epoch != before

    def _carried_out(self, command: object) -> list[Event]:
        if isinstance(command, Batch):
            members = enumerate(command.commands)
            return [event for place, member in members for event in self._carried_out_within(member, place)]
        if isinstance(command, Reset):
            self.spec = self._start
            self._stand_at_start(self.epoch + 1)
            return [self._noted(Event(row=0, t=0.0, kind="reset", text="back to the start"))]
        if isinstance(command, Seek):
            return self._seek(self._row_before(command))
        faults = self.spec.faults
        self._change(command)
        if self.spec.faults is not faults:
            self._faults = (*self._faults, (self.row, self.spec.faults))
        event = log_events.command_event(command, self.row, self.t, len(faults) - len(self.spec.faults))
        if isinstance(command, Inject):
            event = event.model_copy(update={"fault": fault_ids(self.spec.faults)[-1]})
        return [self._noted(event)]

    def _carried_out_within(self, member: object, place: int) -> list[Event]:
        """Carry out one command of a batch; a SpecError names its place."""
        try:
            return self._carried_out(member)
        except SpecError as error:
            error.field = f"commands[{place}].{error.field}"
            raise

    def _change(self, command: object) -> None:
        """Take over what a command asks for. Raises SpecError or ValidationError, perhaps half way."""
        self._enter_stage()
        here = self._without_commands()
        if isinstance(command, Inject):
            spec = edits.with_fault(self.spec, command, self.t)
            here = here.model_copy(update={"faults": spec.faults})
        elif isinstance(command, Clear):
            spec = edits.with_faults_ended(self.spec, command, self.t)
            here = here.model_copy(update={"faults": spec.faults})
        else:
            if isinstance(command, SetGainNow):
                check_moves(self.experiment, command)
            spec, here = edits.with_command(self.spec, command, self.t, here)
        self._adopt(spec, here, self._without_commands())
        if isinstance(command, SetGainNow):
            needed = substeps_at(self.experiment, self._substeps, self.current.state, self.current.view.last_measured)
            if needed > self._substeps:
                self._take_substeps(needed)
        if not isinstance(command, AddObserverNow | SetGainNow):  # others make no observer stiff at once
            self._advances = 0

    def _noted(self, event: Event) -> Event:
        self.log.append(event)
        self.current = replace(self.current, told=len(self.log))
        return event

    def _without_commands(self) -> Experiment:
        """The experiment as it is in the present stage, and without timed commands; found once a stage."""
        known = self._bare
        if known is None or known[0] is not self.spec or known[1] != self.current.stage:
            known = self._bare = self.spec, self.current.stage, edits.without_commands(self.spec, self.t)
        return known[2]

    def _adopt(self, spec: Experiment, here: Experiment, before: Experiment | None) -> None:
        """Take over a spec that differs from this row on: the stages before stay as they are.

        ``here``: the experiment as it is from this row on, without timed commands; ``before``: as it was in the present
        stage, if that is known.
        """
        complete = edits.checked(spec, self.spec)
        self._advances = 1
        k = self.current.row * self._every
        current = self._stages[self.current.stage].experiment
        since = {e.label: e.since for e in current.estimators}
        newest = list(takewhile(lambda c: round(c.at / self.step) >= k, reversed(complete.commands)))
        for command in newest:
            if isinstance(command, AddObserver) and round(command.at / self.step) == k:
                since[command.observer.label] = k
        changed = engine(here, since) if before is None else adapted(here, since, before, current)
        self._stages = [*self._stages[: self.current.stage + 1], Stage(k, changed)]
        if newest and round(newest[0].at / self.step) > k:
            self._stages += [s for s in prepare(complete).stages if s.k > k]
        self.spec = complete
        self._enter_stage()
        self._bare = complete, self.current.stage, here

    # ---- copies -------------------------------------------------------------------------------------------------------

    def fork(self, row: int | None = None) -> "Session":
        """A second session that stands at a row of this one (its present one if not given) and goes its own way."""
        other = self.copied()
        other._new = []
        if row is not None and row < self.row:
            other._seek(row)
            other.log, other._new = other.log[:-1], []  # for the fork it is no going back
        return other

    @contextmanager
    def transaction(self) -> Iterator[None]:
        """Something that leaves no trace in the session if it fails."""
        before = self.copied()
        try:
            yield
        except Exception:
            self.become(before)
            raise

    def copied(self) -> "Session":
        """The same session once more."""
        other = object.__new__(Session)
        other.become(self)
        return other

    def release(self) -> None:
        """Let go of everything that takes memory; nothing can be done with the session any more."""
        self.history, self._snapshots, self.log, self.ended = RowHistory(), Snapshots(), [], True
        self.current = replace(self.current, view=None, watched=None)

    def become(self, other: "Session") -> None:
        """Stand where another session stands, which is left as it is."""
        self.__dict__.update(other.__dict__)
        self.history, self.log, self._new = (
            RowHistory(other.history.pieces, other.history.start),
            list(other.log),
            list(other._new),
        )
        self._stages, self._snapshots = list(other._stages), other._snapshots.copy()
