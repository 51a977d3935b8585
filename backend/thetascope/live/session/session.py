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
from thetascope.engine.execution.run_experiment import needed_substeps
from thetascope.engine.execution.stages import Stage, carry
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope.engine.simulation.simulation import Simulation
from thetascope.engine.simulation.step_stability import MOST_SUBSTEPS
from thetascope.live.session import edits, log_events
from thetascope.live.session.gain_moves import check_moves, substeps_at
from thetascope.live.session.history import Past
from thetascope.live.session.live_columns import View
from thetascope.live.session.live_detector import Watch, pinned
from thetascope.live.session.rewind import Returning
from thetascope.live.session.snapshots import Begun, Block, Moment, Moments
from thetascope_schemas import Experiment
from thetascope_schemas.experiment.commands import AddObserver, SetSubsteps
from thetascope_schemas.experiment.faults import Fault
from thetascope_schemas.service.session import (
    AddObserverNow,
    Assumptions,
    Clear,
    Event,
    Inject,
    Reset,
    Seek,
    SetGainNow,
)

_AT_ONCE = 30  # rows


class Session(Returning):
    """One live experiment. ``horizon_rows`` limits how long it may become."""

    leaves_watching = False  # of its rows for faults, to background_checks.py; else they are watched as they come

    def __init__(self, spec: Experiment, horizon_rows: int = 1_000_000):
        prepared = prepare(spec)
        self.spec = spec.with_plant(prepared.plant)
        self.spec = self.spec.model_copy(update={"substeps": self.spec.substeps or 1, "diagnosis": pinned(self.spec)})
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
        self.past, self.log, self._new = Past(), [], []
        self._faults: tuple[tuple[int, tuple[Fault, ...]], ...] = (
            (-1, self.spec.faults),
        )  # as each command left them, with its row
        self._bare: tuple[Experiment, int, Experiment] | None = None  # see _without_commands
        self.ended = False
        self._advances = 1  # since the last change, and one
        self._again = False  # rows are found again that were checked before
        self._moments = Moments()
        self.watch = Watch.over(self.spec, first, self.record)
        self.now = Moment(0, Simulation(first).initial(), 0, View.opening(first, 0), self.watch.begin(), 0)
        self.columns = self.now.view.columns

    # ---- where it stands ---------------------------------------------------------------------------------------------

    @property
    def row(self) -> int:
        """Rows produced so far: the number of the next one."""
        return self.now.row

    @property
    def t(self) -> float:
        return self.now.row * self.record

    @property
    def experiment(self) -> Engine:
        """The engine's experiment as it is now."""
        return self._stages[self.now.stage].experiment

    def rows(self, first: int, last: int) -> np.ndarray:
        """Recorded rows of the present past in the present columns: float32, columns × rows."""
        return self.past.rows(self.columns, first, last)

    def take_events(self) -> list[Event]:
        """Events found by advancing since this was last asked."""
        new, self._new = self._new, []
        return new

    def assumptions(self) -> list[Assumptions]:
        """The checks of every observer's theorem over its last rows."""
        return self.now.view.assumptions(self.experiment)

    # ---- advancing ---------------------------------------------------------------------------------------------------

    def advance(self, rows: int) -> np.ndarray:
        """Advance by up to ``rows`` rows (to where columns change, or the end): what is recorded, columns × rows."""
        return self.finish(self.begin(rows))

    def begin(self, rows: int) -> Begun | None:
        """The first half of advancing: rows are simulated, and the session stays where it is (it may note that it needs more substeps).

        None: there are no more rows.
        """
        self._enter_stage()
        target = min(self.row + rows, self._horizon)
        following = self._stages[self.now.stage + 1 :]
        boundary = min((s.k // self._every for s in following), default=target)
        count = max(0, min(target, max(boundary, self.row + (0 if target == self.row else 1))) - self.row)
        if self.ended or count == 0:
            self.ended = self.ended or self.row >= self._horizon
            return None
        return self._simulated(count)

    def _simulated(self, count: int) -> Begun:
        now, experiment = self.now, self.experiment
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
                return self._simulated(count)
        return Begun(now, count, state, recorded)

    def finish(self, begun: Begun | None) -> np.ndarray:
        """The second half: what is shown of the rows, and what they mean. Where a command came between they are void, and none are given."""
        now, experiment = self.now, self.experiment
        if begun is None or begun.since is not now:
            return np.empty((len(self.columns), 0))
        count, recorded = begun.count, begun.recorded
        self._moments.remember(now)
        view, made = now.view.extended(experiment, recorded)
        data, watched, found = made.data, now.watched, []
        if view.plant_lost:  # time ends with the row that says so
            count = min(count, round(view.plant_lost.time / self.record) - now.row + 1)
            data = data[:, :count]
        else:
            watched, found = self.watch.seen(
                now.watched, experiment, recorded, made.values, count > _AT_ONCE, self.leaves_watching
            )
            found = log_events.new(found, self.log)
        scheduled = log_events.scheduled(self.spec, self.log, now.row, now.row + count, self.record)
        found = [*scheduled, *found, *view.lost_since(now.view, self.record)]
        found.sort(key=lambda e: e.row)
        self.past.append(self.columns, data)
        self.log += found
        self._new += found
        self.now = Moment(now.row + count, begun.state, now.stage, view, watched, len(self.log))
        self.ended = view.plant_lost is not None or self.row >= self._horizon
        if not view.plant_lost and (view.lost or {}) == (now.view.lost or {}):
            self._moments.keep(Block(now.row, recorded, made))
        return data

    @property
    def _substeps(self) -> int:
        return self.experiment.substeps or 1

    def _enter_stage(self) -> None:
        """Pass to the stage that holds from this row on (its observers start here)."""
        k = self.now.row * self._every
        index = self.now.stage
        while index + 1 < len(self._stages) and self._stages[index + 1].k <= k:
            old, new = self._stages[index].experiment, self._stages[index + 1].experiment
            index += 1
            state = carry(self.now.state, old, new)
            view = self.now.view.carried(new, self.now.row)
            self.now = replace(self.now, state=state, stage=index, view=view)
        if self.now.view.columns != self.columns:
            self.columns = self.now.view.columns
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
        with self.attempt():
            events = self._carried_out(command)
        return events, self.epoch != before

    def _carried_out(self, command: object) -> list[Event]:
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
        return [self._noted(log_events.event(command, self.row, self.t, len(faults) - len(self.spec.faults)))]

    def _change(self, command: object) -> None:
        """Take over what a command asks for. Raises SpecError or ValidationError, perhaps half way."""
        self._enter_stage()
        here = self._without_commands()
        if isinstance(command, Inject):
            spec = edits.injected(self.spec, command, self.t)
            here = here.model_copy(update={"faults": spec.faults})
        elif isinstance(command, Clear):
            spec = edits.cleared(self.spec, command, self.t)
            here = here.model_copy(update={"faults": spec.faults})
        else:
            if isinstance(command, SetGainNow):
                check_moves(self.experiment, command)
            spec, here = edits.changed_now(self.spec, command, self.t, here)
        self._adopt(spec, here, self._without_commands())
        if isinstance(command, SetGainNow):
            needed = substeps_at(self.experiment, self._substeps, self.now.state, self.now.view.last_measured)
            if needed > self._substeps:
                self._take_substeps(needed)
        if not isinstance(command, AddObserverNow | SetGainNow):  # others make no observer stiff at once
            self._advances = 0

    def _noted(self, event: Event) -> Event:
        self.log.append(event)
        self.now = replace(self.now, told=len(self.log))
        return event

    def _without_commands(self) -> Experiment:
        """The experiment as it is in the present stage, and without timed commands; found once a stage."""
        known = self._bare
        if known is None or known[0] is not self.spec or known[1] != self.now.stage:
            known = self._bare = self.spec, self.now.stage, edits.without_commands(self.spec, self.t)
        return known[2]

    def _adopt(self, spec: Experiment, here: Experiment, before: Experiment | None) -> None:
        """Take over a spec that differs from this row on: the stages before stay as they are.

        ``here``: the experiment as it is from this row on, without timed commands; ``before``: as it was in the present
        stage, if that is known.
        """
        complete = edits.checked(spec, self.spec)
        self._advances = 1
        k = self.now.row * self._every
        current = self._stages[self.now.stage].experiment
        since = {e.label: e.since for e in current.estimators}
        newest = list(takewhile(lambda c: round(c.at / self.step) >= k, reversed(complete.commands)))
        for command in newest:
            if isinstance(command, AddObserver) and round(command.at / self.step) == k:
                since[command.observer.label] = k
        changed = engine(here, since) if before is None else adapted(here, since, before, current)
        self._stages = [*self._stages[: self.now.stage + 1], Stage(k, changed)]
        if newest and round(newest[0].at / self.step) > k:
            self._stages += [s for s in prepare(complete).stages if s.k > k]
        self.spec = complete
        self._enter_stage()
        self._bare = complete, self.now.stage, here

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
    def attempt(self) -> Iterator[None]:
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
        self.past, self._moments, self.log, self.ended = Past(), Moments(), [], True
        self.now = replace(self.now, view=None, watched=None)

    def become(self, other: "Session") -> None:
        """Stand where another session stands, which is left as it is."""
        self.__dict__.update(other.__dict__)
        self.past, self.log, self._new = Past(other.past.pieces, other.past.start), list(other.log), list(other._new)
        self._stages, self._moments = list(other._stages), other._moments.copy()
