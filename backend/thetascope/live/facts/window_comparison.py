"""The observers of a session compared over the window that a page shows.
Rows are copied in turn with other jobs, then measured apart."""

import math
from dataclasses import asdict

import numpy as np
from starlette.concurrency import run_in_threadpool

from thetascope.diagnosis.evaluation.metrics import event_times
from thetascope.diagnosis.evaluation.verdicts import fault_ids
from thetascope.diagnosis.evaluation.window_comparison import Samples, settling_of_step, window_figures
from thetascope.live.facts.shown_session import RecordedSession
from thetascope_schemas.experiment.faults import Fault
from thetascope_schemas.service.comparison import ObserverInWindow, StepFound, WindowComparison

MOST_ROWS = 200_000
"""Rows of a window, or after a fault, that are looked at."""


async def window_comparison(
    room: RecordedSession, start: float | None, end: float | None, state: str | None, channel: str | None
) -> WindowComparison:
    """Return the figures of all observers from `start` to `end` (s); without them, of the whole session so far.

    state, channel: the state whose error and the fault channel whose estimate are measured; by default the first ones.
    """
    spec, record, shown, columns = room.session.spec, room.session.record, room.shown, room.broadcast.columns
    state = state or spec.plant.names("states")[0]
    channel = channel or next(iter(spec.plant.names("channels")), None)
    last = shown if end is None else max(0, min(shown, math.floor(end / record + 1e-6) + 1))
    first = 0 if start is None else math.ceil(start / record - 1e-6)
    first = min(last, max(first, room.oldest, last - MOST_ROWS))
    labels = [observer.label for observer in room.facts.current.observers]
    fault = _newest(spec.faults, channel, (last - 1) * record)
    names = [f"{label}.x.{state}" for label in labels] + [f"x.{state}"]
    if channel is not None:
        names += [f"theta.{channel}", *(f"{label}.theta.{channel}" for label in labels)]
    names = [name for name in names if name in columns]
    window = _samples(names, first, await room.past_rows(tuple(names), first, last), record)
    after = None
    if fault is not None:
        begin = max(room.oldest, math.ceil(fault.onset / record - 1e-6) - 1)
        following = min((t for t in event_times(spec.faults) if t > fault.onset), default=math.inf)
        until = min(shown, begin + MOST_ROWS, shown if math.isinf(following) else math.ceil(following / record - 1e-6))
        after = _samples(names, begin, await room.past_rows(tuple(names), begin, until), record)

    def figures() -> list[ObserverInWindow]:
        answer = []
        for label in labels:
            made = asdict(window_figures(window, label, state, channel))
            if fault is not None and after is not None and channel is not None:
                made["settled"], made["outcome"] = settling_of_step(after, label, channel, fault, spec.faults)
            answer.append(ObserverInWindow(**made))
        return answer

    return WindowComparison(
        t=room.t,
        state=state,
        channel=channel,
        fault=_found(room, fault),
        observers=tuple(await run_in_threadpool(figures)),
    )


def _newest(faults: tuple[Fault, ...], channel: str | None, t: float) -> Fault | None:
    """Return the newest fault of a channel that began by a time in s."""
    mine = [f for f in faults if f.site == ("channel", channel) and f.onset <= t]
    return mine[-1] if mine else None


def _samples(names: list[str], first: int, rows: np.ndarray, record: float) -> Samples:
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
