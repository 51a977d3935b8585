"""Follow a record: scan for alarms, name the fault behind each, go on with it known, revise it as data come.

The rows are scanned in blocks, so that memory does not grow with the record. The prediction before each block is kept:
a revision starts again from the block before the event. An alarm either adds an event or replaces the last one,
whichever explains the rows up to then better.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from thetascope.diagnosis.records.events import FaultEvent, courses
from thetascope.diagnosis.records.naming import Explanation, Stretch, explanations, onsets
from thetascope.engine.filtering.bundles import Faults, Noise, Rows
from thetascope.engine.filtering.record_filter import RecordFilter, part_of

_WAIT = 10  # rows after an alarm before the fault is named, at least
_SLOW = 0.15  # of the time since the last event: later alarms are judged with more data
_BACK = 300  # rows before an event from which hypotheses are tested
_GRID = 30  # onsets
_MOST = 40  # alarms
MANY = 10  # events: with more of them the model does not fit
RISES = (10.0, 40.0, 160.0)  # rows: time constants of exponential rises that are tried


@dataclass(frozen=True)
class Decision:
    """An alarm and its outcome.

    Attributes:
        row, statistic: the first row in which the statistic exceeds the threshold, and its value.
        judged: the row up to which the rows were used.
        revised: whether the last event was replaced; else one was added.
        story: the best explanation of the stretch, which begins at row `first`.
        others: further ones, best first.
    """

    row: int
    statistic: float
    judged: int
    revised: bool
    story: Explanation
    others: tuple[Explanation, ...]
    first: int


@dataclass
class Follower:
    """Everything that following one record needs; `run` returns the events and decisions.

    Attributes:
        filter, noise, data: the filter, its noise, and the rows.
        z, P: the prediction for the first row.
        bounds: (channels, 2), of θ.
        used: (2·channels,), columns of the bank that count.
        threshold: of the statistic.
        own: the plant's own channels; the others are additive faults that it lacks.
        begin: the first row in which an alarm counts.
        progress: is called with the number of rows that are judged.
    """

    filter: RecordFilter
    noise: Noise
    data: Rows
    z: np.ndarray
    P: np.ndarray
    bounds: np.ndarray
    used: np.ndarray
    threshold: float
    own: int
    begin: int = 0
    progress: Callable[[int], None] = lambda row: None
    story: list[FaultEvent] = field(default_factory=list)
    decisions: list[Decision] = field(default_factory=list)
    statistic: np.ndarray = field(default_factory=lambda: np.zeros(0))  # of each row, under the story of its time
    starts: list = field(default_factory=list)  # predictions before blocks, under the present story

    def run(self) -> tuple[list[FaultEvent], list[Decision]]:
        """Return the events in the order of their onsets, and the decisions in the order of their alarms."""
        starts = self.starts = [(0, self.z, self.P)]
        judged = self.begin
        for _ in range(_MOST):
            alarm = self._next_alarm(starts, judged)
            if alarm is None or len(self.story) > MANY:
                break
            decision = self._decide(alarm, starts, judged)
            if decision is None:
                judged = alarm[0] + _WAIT
                continue
            self.decisions.append(decision)
            keep = len(self.story) - decision.revised
            self.story = [*self.story[:keep], decision.story.event]
            judged = decision.judged
            onset = self._row_of(min(e.onset for e in self.story[-2:] or self.story))
            row = max(0, min(onset, self._row_of(self.story[-1].onset)) - _BACK)
            starts = self.starts = [s for s in starts if s[0] <= row] or [(0, self.z, self.P)]
        return self.story, self.decisions

    def settle(self, story: Sequence[FaultEvent]) -> np.ndarray:
        """Take another story, and return the innovations (rows, m) of the whole record under it."""
        self.story, self.starts, innovations = list(story), [(0, self.z, self.P)], []
        for begin, part, result in self.filter.blocks(self.data, self.noise, self.z, self.P, self._faults):
            innovations.append(result.path.nu)
            self.starts.append((begin + len(part.t), result.z, result.P))
        return np.concatenate(innovations)

    def _faults(self, rows: Rows) -> Faults:
        """Return the faults of the present story along rows."""
        return Faults(*courses(self.story, self.filter.p, rows.t, rows.width))

    def _row_of(self, t: float) -> int:
        return int(np.clip(np.searchsorted(self.data.t, t), 0, len(self.data.t) - 1))

    def _next_alarm(self, starts: list, judged: int) -> tuple[int, int, float] | None:
        """Return row, onset row and statistic of the first alarm after `judged`; extend `starts` on the way."""
        coloured = len(self.z) > self.filter.n
        bank = self.filter.new_bank(1, coloured)
        tick = float(np.median(self.data.width))
        row, z, P = starts[-1]
        if not len(self.statistic):
            self.statistic = np.zeros(len(self.data.t))
        rest = part_of(self.data, row, len(self.data.t))
        for begin, part, result in self.filter.blocks(rest, self.noise, z, P, self._faults):
            first, end = row + begin, row + begin + len(part.t)
            nu = np.nan_to_num(result.path.nu)[None]
            alarms = self.filter.scan(part, self.noise, result.path, bank, first, tick, self.used, nu)
            g = alarms.largest[:, 0]
            self.statistic[max(first, judged) : end] = g[max(judged - first, 0) :]
            late = np.flatnonzero((g > self.threshold) & (np.arange(first, end) >= judged))
            if len(late):
                k = int(late[0])
                self.statistic[first + k + 1 : end] = 0.0
                return first + k, int(alarms.onset[k]), float(g[k])
            self.progress(end)
            starts.append((end, result.z, result.P))
        return None

    def _decide(self, alarm: tuple[int, int, float], starts: list, judged: int) -> Decision | None:
        """Return the best explanation of an alarm."""
        row, onset, statistic = alarm
        last = self._row_of(self.story[-1].onset) if self.story else onset
        slow = int(_SLOW * (judged - last)) if self.story else 0
        end = min(len(self.data.t), row + max(_WAIT, row - onset, slow))
        first = max(0, min(onset, last) - _BACK)
        stretch = self._stretch(starts, first, end)
        earliest = max(0, onset - first - (row - onset) - 5)
        if self.story:
            earliest = max(earliest, judged - 3 * _WAIT - first)
        stories = self._explained(stretch, self.story, earliest, onset - first)
        size = len(self.story)
        numbers = np.log(max(stretch.readings, 2))
        ranked = [(s.score + 10.0 * bool(size), s) for s in stories]
        if self.story:
            before = self.story[:-1]
            extra = len(self.story[-1].parameters()) * numbers
            ranked = [(value + extra, s) for value, s in ranked]
            ranked += [(s.score, s) for s in self._explained(stretch, before, max(0, last - first - 40), onset - first)]
        ranked = [pair for pair in ranked if np.isfinite(pair[0])]
        if not ranked:
            return None
        ranked.sort(key=lambda pair: pair[0])
        best = ranked[0][1]
        revised = bool(self.story) and len(best.events) == size
        others = tuple(s for _, s in ranked[1:] if len(s.events) == len(best.events))
        return Decision(row, statistic, end, revised, best, others, first)

    def _explained(self, stretch: Stretch, story: Sequence[FaultEvent], earliest: int, onset: int) -> list[Explanation]:
        rows = onsets(earliest, len(stretch.data.t) - 1, _GRID, [onset])
        taus = [rise * stretch.period for rise in RISES]
        return explanations(stretch, story, rows, taus) if len(rows) else []

    def stretch(self, first: int, end: int) -> Stretch:
        """Return rows first … end − 1, with the prediction for the first of them under the story before it."""
        return self._stretch(self.starts, first, end)

    def _stretch(self, starts: list, first: int, end: int) -> Stretch:
        row, z, P = next(s for s in reversed(starts) if s[0] <= first)
        if row < first:
            before = part_of(self.data, row, first)
            result = self.filter.filter(before, self.noise, z, P, self._faults(before))
            z, P = result.z, result.P
        return Stretch(self.filter, self.noise, part_of(self.data, first, end), z, P, self.bounds, self.own)
