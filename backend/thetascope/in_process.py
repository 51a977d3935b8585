"""Runs and diagnoses in the process of the caller, without a service: `from thetascope import diagnose, run`."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic import PrivateAttr

from thetascope.assembly import RecordBytes, carry_out, prepare, record_experiment, with_rows
from thetascope.assembly.analyses.record_diagnosis import columns_as_json
from thetascope.engine.errors import SpecError
from thetascope.engine.model.result import Result
from thetascope.frames import frame_of
from thetascope.progress import Shown, progress_bar
from thetascope.runs.specs.refusals import from_engine, validated
from thetascope.runs.specs.resolve_spec import plant_of, resolved
from thetascope.runs.specs.run_requests import experiment_of
from thetascope.store import record_id
from thetascope_schemas import Experiment, ObserverConfig, Plant
from thetascope_schemas.experiment.measurement import ColumnMapping, RecordSettings
from thetascope_schemas.service.record_diagnosis import RecordDiagnosis


@dataclass(frozen=True)
class RunResult(Result):
    """The result of a run, also as a frame."""

    def frame(self, kind: str = "polars") -> Any:
        """Return all columns as a frame of polars or pandas, which are imported by this call.

        Raises ValueError for another kind, and ImportError where pandas is not installed.
        """
        return frame_of(dict(zip(self.names, self.data, strict=True)), kind)


def run(
    experiment: str | Mapping[str, object] | Experiment,
    changes: Mapping[str, object] | None = None,
    progress: Shown = None,
) -> RunResult:
    """Run an experiment and return its result, with the same numbers as the service and the command line.

    Nothing is stored, and none of the service's limits applies.

    Args:
        experiment: id of a library experiment, an experiment as data (as posted to /api/runs), or an `Experiment`.
        changes: path → new value, for example {"noise.y.std": 0, "observers.adaptive.gains.rho": 8}.
        progress: whether to show a progress bar; None: in a terminal and in a notebook. Or a function that gets the
            share done, from 0 to 1.

    Returns:
        The result: `names` of the columns, `data` of shape (columns, rows), `column(name)` of shape (rows,), `frame()`
        of polars or pandas, and the reports of the observers.

    Raises:
        Unknown: the library has no such experiment.
        InvalidSpec: the experiment is refused; it names the fields, the problems and the remedies.
    """
    spec = resolved(experiment_of(experiment, changes))
    try:
        with progress_bar(progress) as show:
            show(0.0)
            return RunResult(**vars(prepare(spec).run(show)))
    except SpecError as error:
        raise from_engine(error, in_plant=True) from None


class Diagnosed(RecordDiagnosis):
    """The diagnosis of a record, with tables of the kind that the record came in: a frame of pandas or polars, or a
    mapping of names to arrays."""

    _frame: type = PrivateAttr(dict)
    _run: Result | None = PrivateAttr(None)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, RecordDiagnosis) and self.model_dump() == other.model_dump()

    def findings(self) -> Any:
        """Return the faults, one row each: channel, shape, onset, size at the end and rate, with 95 % intervals."""
        rows = [
            {
                "channel": f.best.channel,
                "shape": f.best.shape,
                "onset": f.best.onset.value,
                "onset_low": f.best.onset.low,
                "onset_high": f.best.onset.high,
                "size": f.best.size.value,
                "size_low": f.best.size.low,
                "size_high": f.best.size.high,
                "unit": f.best.unit,
                "rate": f.best.rate,
                "alarm": f.alarm,
                "ended": np.nan if f.ended is None else f.ended,
                "confirmed": f.confirmed,
                "alternatives": ", ".join(a.channel for a in f.alternatives if not a.separable),
            }
            for f in self.faults
        ]
        return self._table({name: [row[name] for row in rows] for name in (rows[0] if rows else {})})

    def outputs(self) -> Any:
        """Return how well the model fits each output, one row each."""
        names = ("output", "unit", "predicted", "simulated", "noise", "bias", "whiteness")
        values = {name: [getattr(o, name) for o in self.fit.outputs] for name in names}
        return self._table(values | {"simulated": [np.nan if v is None else v for v in values["simulated"]]})

    def curves(self) -> Any:
        """Return the innovations along the record in standard deviations: the smallest and largest in each interval."""
        if self.innovations is None:
            return self._table({"t": []})
        columns: dict[str, Any] = {"t": list(self.innovations.t)}
        for name in self.innovations.low:
            for side in ("low", "high"):
                values = getattr(self.innovations, side)[name]
                columns[f"{name}.{side}"] = [np.nan if v is None else v for v in values]
        return self._table(columns)

    def columns(self) -> Any:
        """Return times, inputs, readings and the estimates of the observers, one row for each base step.

        Raises:
            ValueError: no observers were asked for.
        """
        if self._run is None:
            raise ValueError("name observers: diagnose(plant, frame, observers=['joint-ekf'])")
        return self._table({name: self._run.column(name) for name in self._run.names})

    def _table(self, columns: Mapping[str, Any]) -> Any:
        """Return columns as a table of the record's kind."""
        if self._frame is dict:
            return {name: np.asarray(values) for name, values in columns.items()}
        return self._frame(dict(columns))


def diagnose(
    plant: str | Mapping[str, object] | Plant,
    frame: Any,
    healthy: tuple[float, float] | None = None,
    mapping: Mapping[str, object] | None = None,
    observers: Sequence[str | Mapping[str, object]] = (),
    **settings: object,
) -> Diagnosed:
    """Diagnose recorded data and return whether the model fits, and the faults, as POST /api/diagnosis does.

    With observers, these run on the record, too; `columns()` of the answer has their estimates.

    Args:
        plant: id of a library plant, a plant as data, or a `Plant`.
        frame: the columns: a mapping of names to arrays, or a frame of pandas or polars.
        healthy: begin and end in s after the first row of a stretch that is known to be healthy; None: it is found.
        mapping: changes of the guessed mapping, in the form of `ColumnMapping`.
        observers: kinds of observers, such as "joint-ekf", or observers as data with label, kind and gains.
        settings: further fields of `RecordSettings`, for example ``false_alarms=0.1`` or ``fit="never"``.

    Raises:
        InvalidSpec: the plant, the columns, the observers or the settings are refused.
    """
    chosen = plant_of(plant) if isinstance(plant, str | Plant) else validated(Plant, dict(plant))
    stretch = None if healthy is None else {"begin": healthy[0], "end": healthy[1]}
    asked = validated(RecordSettings, {"healthy": stretch, **settings})
    changes = validated(ColumnMapping, dict(mapping or {}))
    names = list(frame.keys() if isinstance(frame, Mapping) else frame.columns)
    data = columns_as_json({str(name): np.asarray(frame[name]) for name in names})
    try:
        diagnosis, run = _on_record(RecordBytes("record.json", data), chosen, changes, asked, _configs(observers))
    except SpecError as error:
        raise from_engine(error) from None
    answer = Diagnosed.model_validate(diagnosis.model_dump())
    answer._frame, answer._run = dict if isinstance(frame, Mapping) else type(frame), run
    return answer


def _configs(observers: Sequence[str | Mapping[str, object]]) -> list[ObserverConfig]:
    """Return observers in full; a kind alone is its label, too."""
    full = [{"label": one, "kind": one} if isinstance(one, str) else dict(one) for one in observers]
    return [validated(ObserverConfig, one) for one in full]


def _on_record(
    file: RecordBytes, plant: Plant, mapping: ColumnMapping, settings: RecordSettings, observers: list[ObserverConfig]
) -> tuple[RecordDiagnosis, Result | None]:
    """Return the diagnosis of a record, and the run of the observers on it; None without observers."""
    id = record_id(file.data)
    spec, diagnosis = record_experiment(id, file, plant, mapping, settings, observers)
    if not observers:
        return diagnosis, None
    known = RecordBytes(file.name, file.data, diagnosis)
    return diagnosis, carry_out(prepare(with_rows(resolved(spec).with_readings(known))))
