"""Moments of a session to which it can go back."""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from backend.engine.simulation import State
from backend.live.alarms import Alarms
from backend.live.view import View

_RECENT = 6  # whole moments kept, for going back over rows that nobody has seen
_BLOCKS = 2  # of them, with the columns of the rows that follow
_KEPT = 400  # bare moments kept, for rewinding; when there are more, every second one goes


@dataclass(frozen=True)
class Moment:
    """Where everything stands at a row: a value, so that going back is taking an older one."""

    row: int
    state: State
    stage: int
    view: View | None  # None in a bare moment: a view is found again by advancing from an earlier row
    alarms: Alarms
    told: int  # events in the log


@dataclass(frozen=True)
class Block:
    """The columns of the rows from ``first`` on, where a moment is: columns × rows."""

    first: int
    data: np.ndarray


class Moments:
    """The newest moments whole, older ones bare and thinned out: memory does not grow with the session."""

    def __init__(self, recent: Iterator[Moment] = (), bare: list[Moment] | None = None, blocks: Iterator[Block] = ()):
        self._recent = deque(recent, maxlen=_RECENT)
        self._blocks = deque(blocks, maxlen=_BLOCKS)
        self._bare = list(bare or [])

    def remember(self, moment: Moment) -> None:
        self._recent.append(moment)
        if not self._bare or moment.row > self._bare[-1].row:
            self._bare.append(replace(moment, view=None))
            if len(self._bare) > _KEPT:
                self._bare = self._bare[:1] + self._bare[1::2]

    def keep(self, first: int, data: np.ndarray) -> None:
        """Keep the columns of rows that came after a whole moment."""
        self._blocks.append(Block(first, data))

    def known(self, first: int, row: int) -> np.ndarray | None:
        """The columns of rows first … row − 1, if they are kept and all there."""
        blocks = (b.data for b in reversed(self._blocks) if b.first == first)
        data = next(blocks, None)
        return None if data is None or not first < row <= first + data.shape[1] else data[:, : row - first]

    def whole(self, row: int) -> Moment | None:
        """The latest whole moment at or before a row."""
        return next((m for m in reversed(self._recent) if m.row <= row), None)

    def bare(self, row: int) -> Iterator[Moment]:
        """Bare moments at or before a row, the latest first."""
        return (m for m in reversed(self._bare) if m.row <= row)

    def cut(self, row: int) -> None:
        """Forget what came at or after a row."""
        self._recent = deque((m for m in self._recent if m.row < row), maxlen=_RECENT)
        self._bare = [m for m in self._bare if m.row <= row]
        kept = (Block(b.first, b.data[:, : row - b.first]) for b in self._blocks if b.first < row)
        self._blocks = deque(kept, maxlen=_BLOCKS)

    def copy(self) -> "Moments":
        return Moments(self._recent, self._bare, self._blocks)
