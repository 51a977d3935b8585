"""Library experiments with the detector alone, without observers, for tests of decisions."""

import json
from functools import cache

import numpy as np

from thetascope import library
from thetascope.assembly import prepare
from thetascope.assembly.build.diagnosis_settings import calibration_key, detector_settings
from thetascope.diagnosis.monitor.detector import Detector, healthy, prepare_detector
from thetascope.diagnosis.outcome.diagnose_run import advance_over_rows
from thetascope.diagnosis.outcome.findings import alarm
from thetascope.diagnosis.yield_points import run_to_end
from thetascope.engine.execution.run_experiment import spans_of
from thetascope.engine.simulation.batch import with_seed
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope.engine.simulation.simulation import row_values
from thetascope_schemas import Experiment


class Watching:
    """An experiment and its detector; the same seed gives the same rows."""

    def __init__(self, name: str, changes: str):
        spec = library.experiment(name).model_dump(mode="json") | {"observers": [], "figures": []} | json.loads(changes)
        prepared = prepare(library.resolve(Experiment.model_validate(spec)))
        self.spec = prepared.spec
        self.engine: Engine = prepared.stages[0].experiment
        self.made: Detector = run_to_end(
            prepare_detector(self.engine, self.engine.context, detector_settings(self.spec), calibration_key(self.spec))
        )

    def watched(self, seed: int = 1, faults: bool = True):
        """Return the monitor's state after a whole run."""
        experiment = with_seed(self.engine if faults else healthy(self.engine), seed)
        watched = self.made.begin()
        for now, rows in spans_of(experiment):
            watched = run_to_end(advance_over_rows(self.made, watched, now, rows))
        return watched

    def alarms(self, seed: int = 1, faults: bool = True) -> list[dict]:
        found = self.watched(seed, faults).decisions.findings
        return [alarm(f, self.made, 0.95, place) for place, f in enumerate(found)]

    def rows(self, seed: int = 1, faults: bool = True) -> tuple[np.ndarray, np.ndarray]:
        """Return the filter's inputs along a run, and the times."""
        experiment = with_seed(self.engine if faults else healthy(self.engine), seed)
        parts = list(spans_of(experiment))
        tables = [
            self.made.filter.table(rows.index, rows.y, row_values(now, rows.index, rows.plant), now.signals)
            for now, rows in parts
        ]
        return np.concatenate(tables), np.concatenate([rows.index for _, rows in parts]) * experiment.step


@cache
def _watching(name: str, changes: str) -> Watching:
    return Watching(name, changes)


def watching(name: str, faults: list[dict] | None = None, **changes) -> Watching:
    """Return a library experiment with other faults (None: its own) and other changes; built once for all tests."""
    if faults is not None:
        changes["faults"] = faults
    return _watching(name, json.dumps(changes, sort_keys=True))


def step(channel: str, onset: float, size: float, **more) -> dict:
    return {"channel": channel, "shape": "step", "onset": onset, "size": size} | more


def names(alarms: list[dict]) -> list[str]:
    """Return the channel of each finding, or the output of an unexplained one."""
    return [a["channel"] or a["output"].removeprefix("y.") for a in alarms]
