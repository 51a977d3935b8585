"""Snapshots of a session to which it can go back."""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from thetascope.engine.estimation.covariance import Spreads
from thetascope.engine.simulation.experiment import Rows, State
from thetascope.engine.simulation.simulation import Simulation
from thetascope.live.session.live_columns import ColumnBatch, LiveColumns
from thetascope.live.session.live_detector import DetectorProgress, bare

_RECENT = 6  # whole moments kept, for going back over rows that nobody has seen
_BLOCKS = 2  # of them, with the columns of the rows that follow
_WAITING = 256  # rows that may still have to be watched in a bare moment, which keeps them
_KEPT = 400  # bare moments kept, for rewinding; when there are more, every second one goes


@dataclass(frozen=True)
class Snapshot:
    """Where everything stands at a row: a value, so that going back is taking an older one."""

    row: int
    state: State
    stage: int
    view: LiveColumns | None  # None in a bare moment: a view is found again by advancing from an earlier row
    watched: DetectorProgress | None
    told: int  # events in the log
    spreads: Spreads = field(default_factory=dict)  # of a bare moment; else the view has them


@dataclass(frozen=True)
class SimulatedRows:
    """Rows simulated from a moment on, with the state after them; what is shown of them is still to be made."""

    since: Snapshot
    count: int
    state: State
    recorded: Rows


@dataclass(frozen=True)
class Block:
    """The rows from ``first`` on, where a moment is: what was recorded, and what was made of it."""

    first: int
    recorded: Rows
    made: ColumnBatch

    def until(self, row: int) -> "Block":
        """The rows before a row."""
        count = row - self.first
        return Block(self.first, self.recorded.part(0, count), self.made.until(count))

    def state_at(self, row: int, start: State, simulation: Simulation) -> State:
        """The state at a row in the block, or just after it; ``start``: at its beginning."""
        count = row - self.first
        known = simulation.state_at(start, self.recorded, count) if count < len(self.recorded.index) else None
        return known or simulation.advance(start, count * simulation.experiment.every)[0]


class Snapshots:
    """The newest moments whole, older ones bare and thinned out: memory does not grow with the session."""

    def __init__(
        self, recent: Iterator[Snapshot] = (), bare: list[Snapshot] | None = None, blocks: Iterator[Block] = ()
    ):
        self._recent = deque(recent, maxlen=_RECENT)
        self._blocks = deque(blocks, maxlen=_BLOCKS)
        self._bare = list(bare or [])

    def remember(self, moment: Snapshot) -> None:
        self._recent.append(moment)
        light = moment.watched is None or moment.watched.rows <= _WAITING
        if not self._bare or (light and moment.row > self._bare[-1].row):
            spreads = moment.view.spreads if moment.view else moment.spreads
            self._bare.append(replace(moment, view=None, spreads=spreads, watched=bare(moment.watched)))
            if len(self._bare) > _KEPT:
                self._bare = self._bare[:1] + self._bare[1::2]

    def keep(self, block: Block) -> None:
        """Keep the rows that came after a whole moment."""
        self._blocks.append(block)

    def known(self, first: int, row: int) -> Block | None:
        """The block that begins at row ``first``, if it is kept and reaches to ``row``."""
        block = next((b for b in reversed(self._blocks) if b.first == first), None)
        return block if block is not None and first < row <= first + len(block.recorded.index) else None

    def whole(self, row: int) -> Snapshot | None:
        """The latest whole moment at or before a row."""
        return next((m for m in reversed(self._recent) if m.row <= row), None)

    def bare(self, row: int) -> Iterator[Snapshot]:
        """Bare moments at or before a row, the latest first."""
        return (m for m in reversed(self._bare) if m.row <= row)

    def cut(self, row: int) -> None:
        """Forget what came at or after a row."""
        self._recent = deque((m for m in self._recent if m.row < row), maxlen=_RECENT)
        self._bare = [m for m in self._bare if m.row <= row]
        kept = (b.until(row) for b in self._blocks if b.first < row)
        self._blocks = deque(kept, maxlen=_BLOCKS)

    def copy(self) -> "Snapshots":
        return Snapshots(self._recent, self._bare, self._blocks)
