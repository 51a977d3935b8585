"""The detector when samples are lost: a value that is held is not a fault, a stuck sensor still is."""

from tests.engine.plants import spec
from thetascope import library
from thetascope.assembly import prepare
from thetascope_schemas import Experiment


def alarms(**changes) -> list[dict]:
    """Return the detector's alarms in a run of the oscillator that loses six of ten samples."""
    data = spec(
        observers=[],
        faults=[],
        inputs={"u": {"kind": "prbs", "low": -1, "high": 1, "hold": 0.5}},
        horizon=60.0,
        truth={"outputs": {"y": {"period": 0.05, "missing": 0.6}}},
        diagnosis={"false_alarms": 1},
    )
    experiment = Experiment.model_validate(data | changes)
    diagnosis = prepare(library.resolve(experiment)).run().diagnosis
    assert diagnosis is not None
    return diagnosis["detector"]["alarms"]


def test_lost_samples_raise_no_alarm_and_hide_no_fault():
    """Without a fault there is no alarm, with one its channel is named; so does a stuck sensor."""
    assert alarms() == []
    force = alarms(faults=[{"channel": "force", "shape": "step", "onset": 30, "size": 0.5}])
    assert force[-1]["channel"] == "force"
    assert all(alarm["t"] > 30 for alarm in force)
    stuck = alarms(faults=[{"output": "y", "shape": "stuck", "onset": 30, "value": 0.0}])
    assert [alarm["output"] for alarm in stuck if alarm["cleared"] is None] == ["y.y"]
