"""Moments of a session to which it can go back."""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, replace

from backend.engine.simulation import State
from backend.live.alarms import Alarms
from backend.live.view import View

_RECENT = 6  # whole moments kept, for going back over rows that nobody has seen
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


class Moments:
    """The newest moments whole, older ones bare and thinned out: memory does not grow with the session."""

    def __init__(self, recent: Iterator[Moment] = (), bare: list[Moment] | None = None):
        self._recent = deque(recent, maxlen=_RECENT)
        self._bare = list(bare or [])

    def remember(self, moment: Moment) -> None:
        self._recent.append(moment)
        if not self._bare or moment.row > self._bare[-1].row:
            self._bare.append(replace(moment, view=None))
            if len(self._bare) > _KEPT:
                self._bare = self._bare[:1] + self._bare[1::2]

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

    def copy(self) -> "Moments":
        return Moments(self._recent, self._bare)
