"""The detector on plants whose fastest rate is far above that of the rows."""

from typing import Any

import pytest

from thetascope import library
from thetascope.assembly import prepare
from thetascope.assembly.build.diagnosis_settings import inspector
from thetascope.engine.estimation.kalman_innovations import HALVINGS, halvings
from thetascope.engine.execution.run_experiment import run
from thetascope_schemas import Experiment

ENZYME: dict[str, Any] = {
    "plant": {
        "id": "enzyme",
        "states": [
            {"name": "S", "initial": 1},
            {"name": "E", "initial": 0.001},
            {"name": "X", "initial": 0},
            {"name": "P", "initial": 0},
        ],
        "inputs": [{"name": "f", "default": 0.02}],
        "outputs": [{"name": "y_S", "expression": "S"}, {"name": "y_P", "expression": "P"}],
        "dynamics": {
            "S": "f - 1e5*E*S + 1e3*X",
            "E": "-1e5*E*S + 1100*X",
            "X": "1e5*E*S - 1100*X",
            "P": "100*X - 0.05*P",
        },
        "channels": [{"name": "fault", "kind": "process", "enters": {"P": "-P"}, "typical": 0.05}],
    },
    "noise": {"y_S": {"std": 0.005, "sample_time": 0.1}, "y_P": {"std": 0.005, "sample_time": 0.1}},
    "horizon": 50,
    "step": 0.1,
}
LAG: dict[str, Any] = {
    "plant": {
        "id": "lag",
        "states": [{"name": "x"}, {"name": "z"}],
        "inputs": [{"name": "u"}],
        "outputs": [{"name": "y", "expression": "x"}],
        "dynamics": {"x": "z - x", "z": "(u - z)/1e-5"},
        "channels": [{"name": "fault", "kind": "sensor", "enters": {"y": 1}, "typical": 0.1}],
    },
    "inputs": {"u": {"kind": "square", "amplitude": 1, "period": 7}},
    "noise": {"y": {"std": 0.01, "sample_time": 0.1}},
    "horizon": 40,
    "step": 0.1,
}


@pytest.mark.parametrize("spec", [ENZYME, LAG], ids=lambda s: s["plant"]["id"])
def test_a_fault_of_a_stiff_plant_is_found(spec: dict[str, Any]) -> None:
    """Rates of 1e5 per second, rows of 0.1 s: the filter stays finite, and names the fault with its size."""
    onset, size = spec["horizon"] / 2, 2 * spec["plant"]["channels"][0]["typical"]
    fault = {"channel": "fault", "shape": "step", "onset": onset, "size": size}
    prepared = prepare(library.resolve(Experiment.model_validate({"id": "stiff", **spec, "faults": [fault]})))
    result = run([*prepared.stages], inspect=inspector(prepared.spec))
    assert result.diagnosis is not None
    alarms = result.diagnosis["detector"]["alarms"]
    assert [a["channel"] for a in alarms] == ["fault"]
    assert alarms[0]["t"] - onset < 0.1 * onset
    assert alarms[0]["size"] == pytest.approx(size, rel=0.1)


def test_slow_plants_keep_their_filter() -> None:
    """The interval is halved twice up to a ratio of 8; beyond it, until the ratio is at most an eighth."""
    assert halvings(0.0, 0.1) == halvings(79.0, 0.1) == halvings(float("inf"), 0.1) == HALVINGS
    assert all(rate * 0.1 / 2 ** halvings(rate, 0.1) <= 1 / 8 for rate in (81.0, 1e3, 1e5, 1e9))
