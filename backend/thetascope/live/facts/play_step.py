"""Play a step of a lesson in sessions of its own: once for each thing that a student can do."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from thetascope import library
from thetascope.live.facts.session_facts import FactsMemory, facts_of
from thetascope.live.facts.step_measures import judge
from thetascope.live.session.session import Session
from thetascope.runs.results.measures import Readings
from thetascope_schemas.service.learning.course import CourseLesson, CourseStep
from thetascope_schemas.service.learning.judged import Judged
from thetascope_schemas.service.learning.played import Played, PlayedCurve, PlayedDeed
from thetascope_schemas.service.session import Batch, SetGainNow

_ROWS = 200_000
"""Rows of one session at most."""
_SHOWN = 400
"""Times of the curves."""
_CUTS = 80
"""Times at which it is asked whether an answer would be right if the step ended there."""


@dataclass(frozen=True)
class Deed:
    """What a student does before the step runs: commands, a value of the dial, or a drawn curve."""

    commands: tuple = ()
    dial: float | None = None
    sketch: tuple[float, ...] | None = None


def deeds_of(step: CourseStep) -> Iterator[Deed]:
    """Yield what students do; of a dial and a sketch first what is wrong, then the solution."""
    if step.dial is not None:
        for value in (step.dial.value, step.dial.solution):
            observer, gain = step.dial.observer, step.dial.gain
            if observer is None or gain is None:
                yield Deed(dial=value)
            else:
                yield Deed((SetGainNow(id=0, observer=observer, gain=gain, value=value),), dial=value)
    elif step.sketch is not None:
        yield Deed(sketch=(step.sketch.value,) * len(step.sketch.solution))
        yield Deed(sketch=step.sketch.solution)
    elif step.choices:
        yield from (Deed(choice.do) for choice in step.choices)
    else:
        yield Deed()


class Seat:
    """The session of a student who has come to a step, and all rows that it has shown."""

    def __init__(self, lesson: CourseLesson, place: int) -> None:
        starts = [step.start for step in lesson.steps[: place + 1] if step.start is not None]
        self.session = Session(library.resolve(lesson.experiments[starts[-1].experiment]), _ROWS)
        self.step = lesson.steps[place]
        self.pieces: list[tuple[tuple[str, ...], np.ndarray]] = []
        self.run(starts[-1].t + self.session.record)  # the row at that time, too

    def run(self, seconds: float) -> None:
        """Let time pass, until the session ends at most."""
        rows = round(seconds / self.session.record)
        while rows > 0:
            data = self.session.advance(rows)
            if not data.shape[1]:
                return
            self.pieces.append((self.session.columns, data))
            rows -= data.shape[1]

    def column(self, name: str) -> np.ndarray:
        """Return a column of all rows; NaN where there was none."""
        parts = [
            data[columns.index(name)] if name in columns else np.full(data.shape[1], np.nan)
            for columns, data in self.pieces
        ]
        return np.concatenate(parts) if parts else np.empty(0)

    @property
    def t(self) -> np.ndarray:
        """Return the times of all rows."""
        return np.arange(sum(data.shape[1] for _, data in self.pieces)) * self.session.record

    def readings(self, deed: Deed) -> Readings:
        """Do what the student does, run the step, and return what its measures read."""
        mark = max(0, self.session.row - 1) * self.session.record
        commands = (*deed.commands, *(self.step.run.do if self.step.run else ()))
        if commands:
            self.session.handle(Batch(id=0, commands=commands))
        seconds = self.step.run.seconds if self.step.run else 0.0
        self.run(seconds)
        facts = facts_of(self.session, self.session.row, FactsMemory(self.session.record))
        return Readings(
            t=self.t,
            read=self.column,
            mark=mark,
            alarms=facts.alarms,
            diverged={e.subject: e.t for e in self.session.log if e.kind == "diverged" and e.subject},
            gains={one.label: dict(one.gains) for one in facts.observers},
            dial=deed.dial,
            sketch=deed.sketch,
            seconds=seconds,
        )


def judged_deeds(lesson: CourseLesson, place: int) -> tuple[Judged, ...]:
    """Return the judgement of a step for each thing that a student can do; none for one that runs nothing."""
    step = lesson.steps[place]
    if step.run is None:
        return ()
    return tuple(judge(step, Seat(lesson, place).readings(deed)) for deed in deeds_of(step))


def play_step(lesson: CourseLesson, place: int) -> Played:
    """Return how a step goes: judgements, since when they hold, and the curves after what meets its conditions."""
    step = lesson.steps[place]
    seats = [(Seat(lesson, place), deed) for deed in deeds_of(step)]
    played = [(seat, seat.readings(deed)) for seat, deed in seats]
    deeds = tuple(_judged(step, readings) for _, readings in played) if step.run is not None else ()
    seat, readings = next((one for one, deed in zip(played, deeds, strict=False) if deed.judged.met), played[-1])
    t, curves = _curves(seat, readings)
    return Played(mark=readings.mark, deeds=deeds, t=t, curves=curves, columns=seat.session.columns)


def _judged(step: CourseStep, readings: Readings) -> PlayedDeed:
    last = judge(step, readings)
    since: list[float | None] = [None] * len(last.right)
    met: float | None = None
    holding, met_holds = list(last.right), last.met
    for cut in np.linspace(readings.mark + readings.seconds, readings.mark, _CUTS):
        then = judge(step, _until(readings, float(cut)))
        for place, right in enumerate(then.right):
            holding[place] = holding[place] and right
            if holding[place]:
                since[place] = float(cut)
        met_holds = met_holds and then.met
        met = float(cut) if met_holds else met
    return PlayedDeed(judged=last, since=tuple(since), met_since=met)


def _until(readings: Readings, end: float) -> Readings:
    """Return the same readings as they would be if the step ended earlier."""
    rows = int(np.searchsorted(readings.t, end + 1e-6))
    return replace(
        readings,
        t=readings.t[:rows],
        read=lambda name: readings.read(name)[:rows],
        alarms=tuple(alarm for alarm in readings.alarms if alarm.t <= end),
        diverged={label: t for label, t in readings.diverged.items() if t <= end},
    )


def _curves(seat: Seat, readings: Readings) -> tuple[tuple[float, ...], tuple[PlayedCurve, ...]]:
    """Return the curves of the step's strips as its page shows them: from before its beginning to its end."""
    first = int(np.searchsorted(readings.t, readings.mark - 2 * readings.seconds - 1e-6))
    places = np.unique(np.linspace(first, max(first, readings.t.size - 1), _SHOWN).round().astype(int))
    places = places[places < readings.t.size]
    known = seat.session.columns
    labels = [one.label for one in seat.session.spec.observers]
    curves = []
    for strip in seat.step.show.strips:
        for label, columns in _sources(strip, labels):
            if not all(name in known for name in columns):
                continue
            values = seat.column(columns[0])[places]
            if len(columns) == 2:
                values = values - seat.column(columns[1])[places]
            shown = tuple(float(f"{value:.5g}") if np.isfinite(value) else None for value in values)
            curves.append(PlayedCurve(strip=strip, label=label, values=shown))
    return tuple(float(f"{one:.6g}") for one in readings.t[places]), tuple(curves)


def _sources(strip: str, labels: list[str]) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Yield the curves of a strip: whose, and its column, or the two columns whose difference it is."""
    kind, _, name = strip.partition(".")
    if kind == "residual":
        yield from ((label, (f"y.{name}", f"{label}.y.{name}")) for label in labels)
        return
    yield "", (strip,)
    yield from ((label, (f"{label}.{strip}",)) for label in labels)
