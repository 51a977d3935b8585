"""Facts of a run for its line in the notebook."""

import numpy as np

from thetascope import library
from thetascope.engine.errors import SpecError
from thetascope.engine.model.result import Result
from thetascope.runs.results.summary import jsonable
from thetascope.runs.specs.spec_changes import numbers, spec_changes
from thetascope.store import RunFacts
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.service.comparison import ComparisonRow
from thetascope_schemas.service.run import ObserverSummary, RunSummary
from thetascope_schemas.texts.local_text import LocalText

POINTS = 48
"""Points of the curve of a line."""
_DIGITS = 4


def facts_of_run(spec: Experiment, summary: RunSummary | None = None, result: Result | None = None) -> RunFacts:
    """Return the facts of a run; without a summary those of its experiment, without a result no curve.

    RMSE (of the first state, over the run), delay and false alarms are those of the first observer that the detector
    tests, else of the first observer.
    """
    base, record = library_base(spec), spec.truth.record
    changes = [] if base is None else spec_changes(base, spec)
    observer, row = _observer(summary)
    rmse = next(iter(observer.rmse.items()), (None, None)) if observer else (None, None)
    shown: dict[str, object] = {"observer": observer.label if observer else None, "state": rmse[0]}
    shown["observers"] = [config.label for config in spec.observer_configs().values()]
    shown["plant"] = spec.plant_id
    if record is not None:
        shown["record"] = record.name or record.id
    if result is not None:
        shown["curve"] = curve(spec, result, observer.label if observer else None)
    return RunFacts(
        experiment="" if base is None else base.id,
        kind="record" if record is not None else "session" if spec.commands else "run",
        rmse=rmse[1],
        delay=row.delay if row else None,
        false_alarms=row.false_alarms if row else None,
        words=_words(spec, changes),
        numbers=numbers(spec),
        changes=changes,
        shown=shown,
    )


def library_base(spec: Experiment) -> Experiment | None:
    """Return the experiment of the library that a run follows: it has its id and its plant."""
    if spec.truth.record is not None:
        return None
    try:
        base = library.experiment(spec.id)
    except SpecError:
        return None
    return base if base.plant_id == spec.plant_id else None


def curve(spec: Experiment, result: Result, label: str | None) -> dict[str, object] | None:
    """Return a fault and its estimate at a few evenly spaced times, or None if the run has no estimate of a fault.

    The fault is the first of the experiment, else the channel whose estimate moves most.
    """
    names = [name for name in result.names if name.startswith(f"{label}.theta.")] if label else []
    channels = [name.removeprefix(f"{label}.theta.") for name in names]
    if not channels:
        return None
    rows = np.linspace(0, result.data.shape[1] - 1, POINTS).round().astype(int)
    faulty = [fault.site.name for fault in sorted(spec.faults, key=lambda one: one.onset)]
    channel = next((name for name in faulty if name in channels), None)
    if channel is None:
        late = result.data.shape[1] // 4  # without the start, in which estimates converge
        moves = {c: _spread(result.column(n)[late:]) for c, n in zip(channels, names, strict=True)}
        channel = max(moves, key=lambda name: moves[name])
    found = {"channel": channel, "estimate": _points(result.column(f"{label}.theta.{channel}")[rows])}
    if f"theta.{channel}" in result.names:
        found["truth"] = _points(result.column(f"theta.{channel}")[rows])
    return found


def _spread(values: np.ndarray) -> float:
    """Return the difference of the largest and the smallest finite value; −1 without any."""
    finite = values[np.isfinite(values)]
    return float(finite.max() - finite.min()) if finite.size else -1.0


def _points(values: np.ndarray) -> list[float | None]:
    return [None if value is None else float(f"{value:.{_DIGITS}g}") for value in jsonable(values)]


def _observer(summary: RunSummary | None) -> tuple[ObserverSummary | None, ComparisonRow | None]:
    """Return the observer whose measures a line shows, and its row of the comparison."""
    if summary is None or not summary.observers:
        return None, None
    rows = {row.label: row for row in summary.comparison.observers} if summary.comparison else {}
    tested = next((one for one in summary.observers if one.label in rows and rows[one.label].faults is not None), None)
    observer = tested or summary.observers[0]
    return observer, rows.get(observer.label)


def _words(spec: Experiment, changes: list[dict[str, object]]) -> str:
    """Return all words by which a run is sought, in lower case."""
    titles = spec.title.texts.values() if isinstance(spec.title, LocalText) else (spec.title,)
    record = spec.truth.record
    observers = [word for config in spec.observer_configs().values() for word in (config.label, config.kind)]
    changed = [str(value) for change in changes for value in (change["path"], change["to"]) if value is not None]
    parts = [spec.id, *titles, spec.plant_id, *observers, *changed, record.name if record is not None else ""]
    return " ".join(part for part in parts if part).lower()
