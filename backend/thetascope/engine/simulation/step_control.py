"""The choice of substeps by the local error, point by point along a run.

A point is a base step at which the error of the next base step is measured. The choice there depends on the state at
the point, on the choices before it and on inputs up to the end of that base step, never on where a call of `advance`
began or ended. So a live session and the run that is saved from it choose alike.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

MOST_SUBSTEPS = 64  # of explicit steps; more, and implicit steps are taken
MOST_PARTS = 600  # of a base step that is divided unequally
MOST_EVENTS = 8  # that are located in a base step
_EVENTS = 1000.0  # that are located in a run, where they follow one another closely,
_EVENTS_EVERY = 64  # and base steps for one more: locating one takes as long as thousands of steps
FAR = 8  # base steps: events that follow one another more closely act at the ends of steps for a while
SHORTEST_PART = 2.0**-18  # of a base step
PART_SUBSTEPS = 2  # of each part
_CALM = 8  # points in a row that need fewer substeps before there are fewer
_PATIENCE = 4096  # most base steps before substeps that reach no tolerance are chosen anew
_FEWER = 8  # substeps become fewer by this factor or more, because each change takes time
_SAFETY = 1.2
_RECENT = 4  # base steps whose states are kept
OPENING = 64  # base steps with more points, at the beginning and after a command
INTERVAL = 64  # base steps between points elsewhere, at least
_AFTER_BREAK = np.array([0, 1, 2, 4, 8, 16, 32])  # base steps after a discontinuity that are points
LOOK_BACK = OPENING + 50  # base steps before a span whose discontinuities decide about its points
_OPENING_POINTS = np.concatenate([np.arange(32), np.arange(32, OPENING + 1, 4)])
_AFTER_CHOICE = np.array([1, 2, 3, 4, 6, 8, 11, 15, 20, 26])  # the same after a choice of several substeps


Steps = tuple[int, bool, tuple[float, ...]]
"""Steps of a base step: substeps, whether they are implicit, and where the base step is divided before that."""


@dataclass(frozen=True)
class Control:
    """The control of the step as part of a simulation's state.

    Attributes:
        origin: base step at which the run, or the stage of the last command, began.
        substeps, implicit: of each base step from here on.
        inner: where each base step is divided into parts, between 0 and 1; each part has ``substeps``.
        calm, wish: points in a row that needed fewer substeps, and the largest number that one of them needed.
        waits, patience: base step before which substeps are not chosen anew, because none reached the tolerance, and
            base steps to wait the next time.
        chosen: base step at which the present steps were chosen.
        credit, credited: events that may be located, as of a base step.
        lost: labels whose states leave the finite numbers whatever the steps; they are no longer measured.
        at: the last point.
        plant: error of the plant's states (n,) at that point, propagated from the beginning.
        observers: errors of the observers over the last base steps at that point, relative to their scales.
        plant_step, observers_step: errors that the base step from that point adds, (n,) and relative.
        sizes: largest size so far of each state, by observer's label; "" is the plant.
        growth: how deviations of the plant's states grew since that point (n, n), where the plant is not linear.
        recent, largest: the plant's states at the last base steps, at most four (steps, n), and their largest sizes so
            far (n,); for a plant that is not linear.
    """

    origin: int = 0
    substeps: int = 1
    implicit: bool = False
    inner: tuple[float, ...] = ()
    chosen: int = -1
    calm: int = 0
    wish: int = 1
    waits: int = 0
    patience: int = 1
    credit: float = _EVENTS
    credited: int = 0
    lost: frozenset[str] = frozenset()
    at: int = 0
    plant: np.ndarray = field(default_factory=lambda: np.zeros(0))
    observers: float = 0.0
    plant_step: np.ndarray = field(default_factory=lambda: np.zeros(0))
    observers_step: float = 0.0
    sizes: Mapping[str, np.ndarray] = field(default_factory=dict)
    growth: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    recent: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    largest: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def restarted(self, k: int) -> "Control":
        """Return the control from a command on, which may change how stiff the equations are."""
        started = self.with_steps(k, 1, False, ())
        return replace(started, origin=k, waits=0, patience=1, lost=frozenset(), recent=self.recent[:0])

    def after(self, states: np.ndarray) -> "Control":
        """Return the control after base steps that begin at the plant's states (steps, n)."""
        if len(states) == 0 or states.shape[1] != len(self.largest):
            return self
        sizes = np.where(np.isfinite(states), np.abs(states), 0.0).max(axis=0)
        return replace(
            self, recent=np.vstack([self.recent, states[-_RECENT:]])[-_RECENT:], largest=np.maximum(self.largest, sizes)
        )

    @property
    def steps(self) -> "Steps":
        """Return substeps, implicit and inner."""
        return self.substeps, self.implicit, self.inner

    def credit_at(self, k: int) -> float:
        """Return how many events may be located from base step k on."""
        return min(_EVENTS, self.credit + (k - self.credited) / _EVENTS_EVERY)

    def with_steps(self, k: int, substeps: int, implicit: bool, inner: tuple[float, ...]) -> "Control":
        """Return the control with other steps from base step k on."""
        return replace(self, chosen=k, substeps=substeps, implicit=implicit, inner=inner, calm=0, wish=1)


def points(
    first: int, last: int, control: "Control", breaks: np.ndarray, every: int, rows_only: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """Return the points in [first, last), ascending, and the base steps from each to the next.

    The next point is the one that is known at the point: discontinuities after it may come from later commands.

    Args:
        control: of the step from ``first`` on.
        breaks: times of discontinuities of the inputs, in base steps, from first − LOOK_BACK on.
        every: base steps between recorded rows.
        rows_only: whether all points are to be rows.
    """
    gap, origin = interval(every), control.origin
    regular = np.arange(-(-first // gap) * gap, last, gap)
    parts = [regular]
    if first < origin + OPENING:
        parts.append(_after(np.array([origin]), _OPENING_POINTS, first, last))
    at = np.unique(np.floor(breaks + 1e-6)).astype(np.int64)
    alone = at[np.concatenate([[True], np.diff(at) >= OPENING])] if len(at) else at
    parts.append(_after(alone[alone >= origin], _AFTER_BREAK, first, last))
    if control.substeps > 1:
        parts.append(_after(np.array([control.chosen]), _AFTER_CHOICE, first, last))
    all_points = np.unique(np.concatenate(parts))
    ahead = gap - all_points % gap
    for starts, offsets in (([origin], _OPENING_POINTS), (alone, _AFTER_BREAK), ([control.chosen], _AFTER_CHOICE)):
        for start in starts:
            where = (all_points >= start) & (all_points < start + offsets[-1])
            after = offsets[np.searchsorted(offsets, all_points[where] - start, side="right")] + start
            ahead[where] = np.minimum(ahead[where], after - all_points[where])
    if rows_only:
        rows = all_points % every == 0
        ahead = -(-(all_points + ahead) // every) * every - all_points
        return all_points[rows], ahead[rows]
    return all_points, ahead


def _after(starts: np.ndarray, offsets: np.ndarray, first: int, last: int) -> np.ndarray:
    """Return the base steps at ``offsets`` after ``starts`` that are in [first, last)."""
    steps = (starts[:, None] + offsets).ravel()
    return steps[(steps >= first) & (steps < last)]


def interval(every: int) -> int:
    """Return the distance of points: a multiple of the rows' distance, or a divisor of it, near INTERVAL base steps."""
    if every <= INTERVAL:
        return -(-INTERVAL // every) * every
    divisors = [d for d in range(1, 2 * INTERVAL + 1) if every % d == 0]
    return divisors[-1] if divisors[-1] >= INTERVAL // 2 else INTERVAL


def candidates(control: Control, need: float, solvable: bool) -> list[Steps]:
    """Return steps that may suffice where the present ones do not, the cheapest first.

    ``need``: by how much the present error is too large, for errors of order 4.
    ``solvable``: whether implicit steps can be taken.
    """
    tried: list[Steps] = []
    if not control.implicit:
        least = min(MOST_SUBSTEPS / 2, max(control.substeps, 0.4 * control.substeps * min(need, 1e12) ** 0.25))
        tried += [(1 << j, False, ()) for j in range(1, 7) if 1 << j > least]
    if solvable:
        least = control.substeps if control.implicit and not control.inner else 0
        tried += [(1 << j, True, ()) for j in range(7) if 1 << j > least]
    return tried


def fewer_substeps(substeps: int, need: float) -> int:
    """Return the power of two of substeps with which the error stays within the tolerance, at most as many as now."""
    wanted = max(1.0, _SAFETY * substeps * max(need, 1e-30) ** 0.25)
    return min(substeps, 1 << int(np.ceil(np.log2(wanted))))


def calmed(control: Control, k: int, need: float) -> tuple[Control, bool]:
    """Return the control after a point that needs no more substeps, and whether fewer are to be tried there."""
    if k == control.chosen:
        return control, False
    if control.patience > 1:
        control = replace(control, patience=1)
    if control.inner:
        return control, True
    wish = fewer_substeps(control.substeps, need)
    few = wish == 1 < control.substeps or _FEWER * wish <= control.substeps
    if not few and not control.implicit:
        return (replace(control, calm=0, wish=1) if control.calm else control), False
    calm, wish = control.calm + 1, max(wish, control.wish)
    if calm < _CALM:
        return replace(control, calm=calm, wish=wish), False
    return replace(control, calm=0, wish=wish), True


def fewer(control: Control) -> list[Steps]:
    """Return steps to try in place of the present ones, the cheapest first.

    A step of the implicit method costs about as much as ten explicit ones.
    """
    if control.inner:
        return [(1 << j, False, ()) for j in range(7)] + [(1 << j, True, ()) for j in range(7) if control.implicit]
    if not control.implicit:
        return [(control.wish, False, ())]
    explicit: list[Steps] = [(1 << j, False, ()) for j in range(7) if 1 << j <= 8 * control.substeps]
    return explicit + [(1 << j, True, ()) for j in range(7) if 1 << j < control.substeps]


def waiting(control: Control, k: int) -> Control:
    """Return the control with substeps that reach no tolerance, kept for a while."""
    return replace(control, waits=k + control.patience, patience=min(2 * control.patience, _PATIENCE))
