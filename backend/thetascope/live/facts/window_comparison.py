"""The observers of a session compared over the window that a page shows.
Rows are copied in turn with other jobs, then measured apart."""

import math
from collections.abc import Sequence
from dataclasses import asdict

import numpy as np
from starlette.concurrency import run_in_threadpool

from thetascope.diagnosis.evaluation.metrics import event_times
from thetascope.diagnosis.evaluation.observer_comparison import error
from thetascope.diagnosis.evaluation.verdicts import fault_ids
from thetascope.diagnosis.evaluation.window_comparison import Samples, late_noise, settling_of_step, window_figures
from thetascope.live.facts.observers_converging import observers_converging
from thetascope.live.facts.shown_session import RecordedSession
from thetascope_schemas.experiment.faults import Fault
from thetascope_schemas.service.comparison import (
    EstimateInWindow,
    ObserverInWindow,
    ObserverTable,
    StepFound,
    WindowComparison,
    WindowTable,
)

MOST_ROWS = 200_000
"""Rows of a window, or after a fault, that are looked at."""
MOST_VALUES = 4_000_000
"""Numbers of a table that are looked at: of many columns, fewer rows."""


async def window_comparison(
    room: RecordedSession, start: float | None, end: float | None, state: str | None, channel: str | None
) -> WindowComparison:
    """Return the figures of all observers from `start` to `end` (s); without them, of the whole session so far.

    state, channel: the state whose error and the fault channel whose estimate are measured; by default the first ones.
    """
    spec, record, columns = room.session.spec, room.session.record, room.broadcast.columns
    state = state or spec.plant.names("states")[0]
    channel = channel or next(iter(spec.plant.names("channels")), None)
    first, last = _rows_between(room, start, end, MOST_ROWS)
    labels = [observer.label for observer in room.facts.current.observers]
    fault = _newest(spec.faults, channel, (last - 1) * record)
    names = [f"{label}.x.{state}" for label in labels] + [f"x.{state}"]
    if channel is not None:
        names += [f"theta.{channel}", *(f"{label}.theta.{channel}" for label in labels)]
    names = [name for name in names if name in columns]
    window = _samples(names, first, await room.past_rows(tuple(names), first, last), record)
    after = None
    if fault is not None:
        after = await _rows_after(room, fault, names, MOST_ROWS)

    moving = await observers_converging(room, last)

    def figures() -> list[ObserverInWindow]:
        answer = []
        for label in labels:
            made = asdict(window_figures(window, label, state, channel))
            if fault is not None and after is not None and channel is not None:
                made["settled"], made["outcome"] = settling_of_step(after, label, channel, fault, spec.faults)
            answer.append(ObserverInWindow(**made, converging=moving.get(label)))
        return answer

    return WindowComparison(
        t=room.t,
        state=state,
        channel=channel,
        fault=_found(room, fault),
        observers=tuple(await run_in_threadpool(figures)),
    )


async def window_table(room: RecordedSession, start: float | None, end: float | None) -> WindowTable:
    """Return the figures of all estimates of all observers from `start` to `end` (s), as `window_comparison` has them
    for one state and one fault."""
    spec, columns, record = room.session.spec, room.broadcast.columns, room.session.record
    labels = [observer.label for observer in room.facts.current.observers]
    true = [f"x.{name}" for name in spec.plant.names("states")]
    true += [f"theta.{name}" for name in spec.plant.names("channels")]
    estimates = {label: [name for name in true if f"{label}.{name}" in columns] for label in labels}
    used = [name for name in true if any(name in own for own in estimates.values())]
    names = [*used, *(f"{label}.{name}" for label, own in estimates.items() for name in own)]
    most = min(MOST_ROWS, MOST_VALUES // max(1, len(names)))
    first, last = _rows_between(room, start, end, most)
    window = _samples(names, first, await room.past_rows(tuple(names), first, last), record)
    following: dict[str, tuple[Fault, Samples]] = {}
    for channel in (name.removeprefix("theta.") for name in used if name.startswith("theta.")):
        if (fault := _newest(spec.faults, channel, (last - 1) * record)) is not None:
            own = [name for name in names if name.endswith(f"theta.{channel}")]
            following[channel] = fault, await _rows_after(room, fault, own, most)

    def estimate(label: str, name: str) -> EstimateInWindow:
        kind, _, subject = name.partition(".")
        rmse = error(window.column(name), window.column(f"{label}.{name}"))[0]
        if kind == "x":
            return EstimateInWindow(name=name, rmse=rmse)
        settled, outcome = None, "unknown"
        if subject in following:
            fault, after = following[subject]
            settled, outcome = settling_of_step(after, label, subject, fault, spec.faults)
        return EstimateInWindow(
            name=name, rmse=rmse, noise=late_noise(window, f"{label}.{name}"), settled=settled, outcome=outcome
        )

    def table() -> tuple[ObserverTable, ...]:
        return tuple(
            ObserverTable(label=label, estimates=tuple(estimate(label, name) for name in own))
            for label, own in estimates.items()
        )

    return WindowTable(t=room.t, observers=await run_in_threadpool(table))


def _rows_between(room: RecordedSession, start: float | None, end: float | None, most: int) -> tuple[int, int]:
    """Return the rows first … last − 1 between two times in s, at most `most` of the newest that are kept."""
    record, shown = room.session.record, room.shown
    last = shown if end is None else max(0, min(shown, math.floor(end / record + 1e-6) + 1))
    first = 0 if start is None else math.ceil(start / record - 1e-6)
    return min(last, max(first, room.oldest, last - most)), last


async def _rows_after(room: RecordedSession, fault: Fault, names: Sequence[str], most: int) -> Samples:
    """Return columns from the row before the onset of a fault to now, or to the next event."""
    record, shown = room.session.record, room.shown
    begin = max(room.oldest, math.ceil(fault.onset / record - 1e-6) - 1)
    following = min((t for t in event_times(room.session.spec.faults) if t > fault.onset), default=math.inf)
    until = min(shown, begin + most, shown if math.isinf(following) else math.ceil(following / record - 1e-6))
    return _samples(names, begin, await room.past_rows(tuple(names), begin, until), record)


def _newest(faults: tuple[Fault, ...], channel: str | None, t: float) -> Fault | None:
    """Return the newest fault of a channel that began by a time in s."""
    mine = [f for f in faults if f.site == ("channel", channel) and f.onset <= t]
    return mine[-1] if mine else None


def _samples(names: Sequence[str], first: int, rows: np.ndarray, record: float) -> Samples:
    """Return rows from number `first` on with their times; `rows` is float32, columns × rows."""
    t = (first + np.arange(rows.shape[1])) * record
    return Samples(("t", *names), np.vstack([t[None], rows.astype(float)]))


def _found(room: RecordedSession, fault: Fault | None) -> StepFound | None:
    """Return whether the detector has found a fault, by the verdicts that the session has sent."""
    if fault is None:
        return None
    spec, facts = room.session.spec, room.facts.current
    id = next(id for id, one in zip(fault_ids(spec.faults), spec.faults, strict=True) if one is fault)
    outcome = next((one for one in facts.fault_outcomes if one.id == id), None)
    return StepFound(id=id, outcome=outcome.outcome if outcome else None, delay=outcome.delay if outcome else None)
