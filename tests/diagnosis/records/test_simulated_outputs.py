"""The simulation that is drawn beside the readings: its times, its values, and a model that does not fit."""

import numpy as np

from tests.diagnosis.records.rigs import TANK, since, tank
from thetascope.assembly.analyses.record_diagnosis import diagnose_recording
from thetascope_schemas.experiment.measurement import RecordSettings


def test_the_simulation_follows_the_readings_until_a_fault_moves_them() -> None:
    """From the healthy stretch's first row on: within the noise before a sensor's offset, off by it afterwards."""
    recording = tank({"offset": since(300, 1.0)})
    settings = RecordSettings.model_validate({"healthy": {"begin": 50.0, "end": 280.0}, "fit": "never"})
    diagnosis = diagnose_recording(TANK, recording, settings)
    assert diagnosis.simulated is not None
    t, values = np.array(diagnosis.simulated.t), np.array(diagnosis.simulated.outputs["y"], dtype=float)
    assert t[0] == 50.0 and len(t) == len(values) and (np.diff(t) > 0).all()
    errors = np.interp(t, recording.t, recording.y[:, 0]) - values
    before, after = errors[t < 299], errors[t > 301]
    assert abs(before.mean()) < 0.03 and before.std() < 0.08
    assert abs(after.mean() - 1.0) < 0.05


def test_a_long_record_is_thinned() -> None:
    """No more points than a picture shows, the first row among them."""
    recording = tank(rows=2000)
    diagnosis = diagnose_recording(TANK, recording, RecordSettings.model_validate({"fit": "never"}))
    assert diagnosis.simulated is not None
    assert len(diagnosis.simulated.t) <= 800 and diagnosis.simulated.t[0] == recording.t[0]
