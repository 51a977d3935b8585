"""Runs and diagnoses in the process of the caller, without a service: `from thetascope import diagnose, run`."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from thetascope.assembly import prepare
from thetascope.assembly.analyses.record_diagnosis import diagnose_columns
from thetascope.engine.errors import SpecError
from thetascope.engine.model.result import Result
from thetascope.runs.specs.refusals import from_engine, validated
from thetascope.runs.specs.resolve_spec import library_experiment, plant_of, resolved, with_changes
from thetascope.runs.specs.run_requests import parse_request
from thetascope_schemas import Experiment, Plant
from thetascope_schemas.experiment.measurement import ColumnMapping, RecordSettings
from thetascope_schemas.service.record_diagnosis import RecordDiagnosis


def run(experiment: str | Mapping[str, object] | Experiment, changes: Mapping[str, object] | None = None) -> Result:
    """Run an experiment and return its result, with the same numbers as the service and the command line.

    Nothing is stored, and none of the service's limits applies.

    Args:
        experiment: id of a library experiment, an experiment as data (as posted to /api/runs), or an `Experiment`.
        changes: path → new value, for example {"noise.y.std": 0, "observers.adaptive.gains.rho": 8}.

    Returns:
        The result: `names` of the columns, `data` of shape (columns, rows), `column(name)` of shape (rows,), and the
        reports of the observers.

    Raises:
        Unknown: the library has no such experiment.
        InvalidSpec: the experiment is refused; it names the fields, the problems and the remedies.
    """
    if isinstance(experiment, str):
        spec = library_experiment(experiment)
    else:
        spec = experiment if isinstance(experiment, Experiment) else parse_request(dict(experiment))
    try:
        return prepare(resolved(with_changes(spec, changes or {}))).run()
    except SpecError as error:
        raise from_engine(error, in_plant=True) from None


def diagnose(
    plant: str | Mapping[str, object] | Plant,
    frame: Any,
    healthy: tuple[float, float] | None = None,
    mapping: Mapping[str, object] | None = None,
    **settings: object,
) -> RecordDiagnosis:
    """Diagnose recorded data and return whether the model fits, and the faults, as POST /api/diagnosis does.

    Args:
        plant: id of a library plant, a plant as data, or a `Plant`.
        frame: the columns: a mapping of names to arrays, or a frame of pandas or polars.
        healthy: begin and end in s after the first row of a stretch that is known to be healthy; None: it is found.
        mapping: changes of the guessed mapping, in the form of `ColumnMapping`.
        settings: further fields of `RecordSettings`, for example ``false_alarms=0.1`` or ``fit="never"``.

    Raises:
        InvalidSpec: the plant, the columns or the settings are refused.
    """
    chosen = plant_of(plant) if isinstance(plant, str | Plant) else validated(Plant, dict(plant))
    stretch = None if healthy is None else {"begin": healthy[0], "end": healthy[1]}
    asked = validated(RecordSettings, {"healthy": stretch, **settings})
    changes = validated(ColumnMapping, dict(mapping or {}))
    names = list(frame.keys() if isinstance(frame, Mapping) else frame.columns)
    columns = {str(name): np.asarray(frame[name]) for name in names}
    try:
        return diagnose_columns(chosen, columns, asked, changes)
    except SpecError as error:
        raise from_engine(error) from None
