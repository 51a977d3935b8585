"""Plants with tables and names in any script, from the text to every place where names and numbers are shown."""

import copy
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator

from thetascope.assembly.analyses.plant_check import check_plant
from thetascope.engine.observers.registry import kinds
from thetascope.export.csv_format import csv_chunks
from thetascope.export.mat_format import matlab_names
from thetascope.export.selection import select
from thetascope.in_process import run
from thetascope.records.readers.formats import read_table
from thetascope.runs.specs.resolve_spec import with_changes
from thetascope_schemas import Experiment, Plant

CELL: dict[str, Any] = {
    "id": "cell",
    "states": [
        {"name": "soc", "initial": 0.9, "domain": [0, 1]},
        {"name": "v₁", "unit": "V"},
        {"name": "θ", "unit": "K", "initial": 298.0},
    ],
    "inputs": [{"name": "ι", "unit": "A", "default": 2.0}],
    "outputs": [{"name": "u_Ω", "expression": "interp(soc, ocv) - v1 - R*ι"}, {"name": "温度", "expression": "ϑ"}],
    "parameters": [{"name": "R", "value": 0.05}, {"name": "τ", "value": 40.0}, {"name": "κ", "value": 0.05}],
    "tables": [
        {
            "name": "ocv",
            "x": [0, 0.1, 0.25, 0.5, 0.75, 0.9, 1],
            "y": [3.0, 3.4, 3.55, 3.68, 3.9, 4.08, 4.2],
            "method": "cubic",
            "outside": "continue",
        },
        {"name": "heat", "x": [0, 1, 3], "y": [0, 0.05, 0.6]},
    ],
    "dynamics": {"soc": "-ι/9000", "v1": "(0.03*ι - v₁)/τ", "ϑ": "(interp(ι, heat) - κ*(θ - 298))/80"},
    "channels": [
        {"name": "ΔR", "kind": "sensor", "enters": {"u_Ω": "-ι"}, "typical": 0.02},
        {"name": "leak", "kind": "process", "enters": {"soc": "-1/9000"}, "typical": 0.5},
    ],
}
SPEC: dict[str, Any] = {
    "plant": CELL,
    "inputs": {"ι": {"kind": "pulse", "period": 100.0, "width": 50.0, "high": 4.0, "low": 1.0}},
    "faults": [{"channel": "ΔR", "shape": "step", "onset": 100.0, "size": 0.02}],
    "horizon": 200.0,
    "step": 0.25,
    "evaluate": 1.0,
}


def test_a_battery_runs_as_scipy_says():
    """States and the voltage equal those of SciPy's integrator with PchipInterpolator and numpy.interp."""
    result = run(copy.deepcopy(SPEC))
    t, ocv = result.column("t"), PchipInterpolator(CELL["tables"][0]["x"], CELL["tables"][0]["y"])
    x = np.array([0.9, 0.0, 298.0])
    for start in range(0, 200, 50):
        current = 4.0 if start % 100 == 0 else 1.0
        heat = np.interp(current, [0, 1, 3], [0, 0.05, 0.6])

        def rate(_, z, i=current, heat=heat):
            return [-i / 9000, (0.03 * i - z[1]) / 40, (heat - 0.05 * (z[2] - 298)) / 80]

        at = np.arange(start, start + 50.0)
        found = solve_ivp(rate, (start, start + 50), x, t_eval=at, rtol=1e-11, atol=1e-12)
        rows = np.searchsorted(t, at - 1e-9)
        for name, values in zip(("soc", "v1", "θ"), found.y, strict=True):
            np.testing.assert_allclose(result.column(f"x.{name}")[rows], values, rtol=1e-7, atol=1e-9)
        R = 0.05 + 0.02 * (start >= 100)
        voltage = ocv(found.y[0]) - found.y[1] - R * current
        np.testing.assert_allclose(result.column("y.u_Ω")[rows[1:]], voltage[1:], rtol=1e-7)
        x = solve_ivp(rate, (start, start + 50), x, rtol=1e-11, atol=1e-12).y[:, -1]


def test_every_kind_of_observer_runs_on_a_plant_with_tables_or_says_why_not():
    """Those that the check calls possible run to the end with finite estimates; the others give a reason."""
    report = check_plant(Plant.model_validate(CELL))
    assert {entry["kind"] for entry in report["observers"]} == set(kinds())
    possible = [entry["kind"] for entry in report["observers"] if entry["possible"]]
    assert {"adaptive-kalman", "joint-ekf", "joint-ukf", "adaptive-kalman-discrete"} <= set(possible)
    assert all(entry["why"] for entry in report["observers"] if not entry["possible"])
    observers = [{"label": kind, "kind": kind} for kind in possible]
    result = run(SPEC | {"observers": observers})
    for kind in possible:
        estimated = [name for name in result.names if name.startswith((f"{kind}.theta.", f"{kind}.residual."))]
        assert estimated and all(np.isfinite(result.column(name)[-100:]).all() for name in estimated)
        if f"{kind}.theta.ΔR" in estimated:  # at rest it cannot be told from the charge, which integrates
            assert abs(result.column(f"{kind}.theta.ΔR")[-1] - 0.02) < 2e-3


def test_names_in_any_script_reach_every_format():
    """Columns have the names in normal form, in tables, CSV and back, under any spelling; MATLAB's are ASCII."""
    result = run(SPEC | {"observers": [{"label": "ekf", "kind": "joint-ekf"}], "horizon": 10.0})
    table = select(result, ["t", "x.v₁", "x.ϑ", "u.ι", "y.u_Ω", "y.温度", "ekf.theta.ΔR"])
    assert table.names == ("t", "x.v1", "x.θ", "u.ι", "y.u_Ω", "y.温度", "ekf.theta.ΔR")
    columns = {c.name: c for c in read_table("run.csv", b"".join(csv_chunks(table))).columns}
    np.testing.assert_array_equal(columns["ekf.theta.ΔR"].values, table.data[-1])
    assert matlab_names(table.names)[2:] == ["x_theta", "u_iota", "y_u_Omega", "y___", "ekf_theta_DeltaR"]


def test_the_same_plant_in_other_spellings_is_the_same_run():
    """v₁ and v1, ϑ and θ: the hash of a run depends on the normal form of a name, not on its spelling."""
    other = copy.deepcopy(SPEC)
    other["plant"]["states"][1]["name"] = "v1"
    other["plant"]["dynamics"] = {"soc": "-ι/9000", "v1": "(0.03*ι - v1)/τ", "θ": CELL["dynamics"]["ϑ"]}
    spec = Experiment.model_validate(SPEC)
    assert spec.spec_hash() == Experiment.model_validate(other).spec_hash()
    assert with_changes(spec, {"parameters.τ": 3.0, "faults.ΔR.size": 0.1, "initial.ϑ": 300.0}).initial == {"θ": 300.0}


def test_a_plant_without_tables_has_the_hash_that_it_had():
    """Tables are part of the hash only where a plant has some."""
    plant = {k: v for k, v in CELL.items() if k != "tables"}
    assert b"tables" in Experiment.model_validate(SPEC).canonical()
    assert b"tables" not in Experiment.model_validate(SPEC | {"plant": plant}).canonical()
