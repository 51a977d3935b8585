"""Which observers of a session still converge, so that their bands may not hold the truth."""

import math

import numpy as np

from thetascope.diagnosis.evaluation.convergence import converges, looked_at, misses
from thetascope.diagnosis.evaluation.metrics import event_times
from thetascope.live.facts.shown_session import RecordedSession
from thetascope_schemas.experiment.commands import AddObserver, RemoveObserver, SetGain

MOST_ROWS = 20_000


async def observers_converging(room: RecordedSession, last: int) -> dict[str, bool | None]:
    """Return for each observer with a band whether any of its fault estimates converges at row `last` − 1."""
    spec, record, columns = room.session.spec, room.session.record, room.broadcast.columns
    now = max(0, last - 1) * record
    common = [t for t in event_times(spec.faults) if t <= now]
    common += [c.at for c in spec.commands if c.at <= now and not isinstance(c, SetGain | AddObserver | RemoveObserver)]
    answer: dict[str, bool | None] = {}
    for observer in room.facts.current.observers:
        label = observer.label
        channels = [name for name in spec.plant.names("channels") if f"{label}.sigma.{name}" in columns]
        if not channels or observer.diverged is not None:
            continue
        own = [c.at for c in spec.commands if isinstance(c, SetGain) and c.observer == label and c.at <= now]
        begin = looked_at(max([observer.since, *common, *own]), now)
        first = min(last, max(room.oldest, math.ceil(begin / record - 1e-6), last - MOST_ROWS))
        outputs = [name for name in room.facts.current.noise if f"{label}.y.{name}" in columns]
        names = tuple(f"{label}.{kind}.{channel}" for channel in channels for kind in ("theta", "sigma"))
        names += tuple(f"{of}y.{name}" for name in outputs for of in ("", f"{label}."))
        rows = (await room.past_rows(names, first, last)).astype(float)
        t = (first + np.arange(rows.shape[1])) * record
        found = [converges(t, rows[2 * place], rows[2 * place + 1]) for place in range(len(channels))]
        rest = rows[2 * len(channels) :]
        for place, name in enumerate(outputs):
            noise = room.facts.current.noise[name].std
            found.append(misses(rest[2 * place] - rest[2 * place + 1], noise))
        known = [one for one in found if one is not None]
        answer[label] = any(known) if known else None
    return answer
