"""How a session goes back to an earlier row: to the newest moment that it remembers before it, and on from there."""

from dataclasses import replace

from thetascope.engine.errors import SpecError
from thetascope.engine.estimation.covariance import latest
from thetascope.engine.simulation.simulation import Simulation
from thetascope.live.session import edits
from thetascope.live.session.live_columns import LiveColumns
from thetascope.live.session.snapshots import Block, Snapshot
from thetascope_schemas.service.session import Event, Seek

_COMMANDED = ("inject", "clear", "gain", "signal", "noise", "observer-added", "observer-removed", "rewound", "reset")


class Rewinding:
    """What a session (session.py, whose state it is) does to stand at an earlier row."""

    def drop_unseen_rows(self, row: int) -> None:
        """Give up rows from ``row`` on that were computed ahead and shown to nobody: no new epoch."""
        if row < self.row:
            self._return_to(row)

    def _row_before(self, command: Seek) -> int:
        """The row to go back to. Raises SpecError where it lies ahead."""
        if command.t > self.t + 0.5 * self.record:
            raise SpecError(
                "t", command.t, f"the session stands at {self.t:g} s", f"give at most {self.t:g}, or let time run"
            )
        return min(self.row, round(command.t / self.record))

    def _seek(self, row: int) -> list[Event]:
        """Back to a row; what was done from it on is given up."""
        t = row * self.record
        self._faults = self._faults[:1] + tuple(known for known in self._faults[1:] if known[0] < row)
        spec = edits.truncated_at(self.spec, self._start, self._faults[-1][1], t)
        if row < self.row:
            self._return_to(row)
        self.log = [e for e in self.log if e.row < row]
        self._new = []
        kept = [s for s in self._stages if s.k < row * self._every] or self._stages[:1]
        self._stages = kept
        self.current = replace(self.current, stage=min(self.current.stage, len(kept) - 1), told=len(self.log))
        self._adopt(spec, edits.without_commands(spec, self.t), None)
        self.epoch += 1
        return [self._noted(Event(row=row, t=t, kind="rewound", text=f"back to {t:g} s"))]

    def _return_to(self, row: int) -> None:
        """Stand at an earlier row with the stages as they are."""
        base = self._snapshots.whole(row) or self._found(row)
        spec, stages = self.spec, self._stages
        log = [e for e in self.log if e.row < row or (e.row == row and e.kind in _COMMANDED)]
        new = [e for e in self._new if e.row < row]
        past, known = self.history.cut(row), self._snapshots.known(base.row, row)
        self.current, self.ended = base, False
        self._snapshots.cut(row)
        self.history, self.log = self.history.cut(base.row), self.log[: base.told]
        self.columns = base.view.columns
        if known is not None:
            self._recall(known, row)
        self._again = True
        while self.row < row:
            self.advance(row - self.row)
        self._again = False
        self.history, self.log = past, log
        self._new = new  # what the rows between have been found to hold is told already
        self.spec, self._stages = spec, stages
        self.current = replace(self.current, told=len(log))

    def _recall(self, known: Block, row: int) -> None:
        """Advance to a row over rows that are known."""
        now, experiment, block = self.current, self.experiment, known.until(row)
        simulation = Simulation(experiment, self._substeps, remember=True)
        view = now.view.continued(experiment, block.recorded, latest(block.made.tables))
        watched, _ = self.detector.observe(
            now.watched, experiment, block.recorded, block.made.values, False, self.detects_outside
        )
        self.current = Snapshot(row, known.state_at(row, now.state, simulation), now.stage, view, watched, now.told)

    def _found(self, row: int) -> Snapshot:
        """A whole moment at or before a row, from the bare ones: views need some rows before they are right again."""
        start = Snapshot(0, Simulation(self._stages[0].experiment).initial(), 0, None, self.detector.begin(), 0)
        for moment in (*self._snapshots.bare(row), start):
            experiment = self._stages[moment.stage].experiment
            begin = LiveColumns.resumable(experiment, moment.row, row, moment.spreads)
            if begin is not None:
                return replace(moment, view=begin)
        return replace(start, view=LiveColumns.opening(self._stages[0].experiment, 0))
