"""Runs on uploaded records over HTTP: observers, diagnosis, figures, report, exports, hash, and what is refused."""

import io

import numpy as np
import polars as pl
import pytest
from scipy.io import loadmat

from tests.records.recorded_runs import exported, simulated
from thetascope import library
from thetascope.client import ServiceError

ROWS = 400
BYTES = {"Content-Type": "application/octet-stream"}
BODY = {
    "plant": "level-loop",
    "settings": {"healthy": {"begin": 0.0, "end": 80.0}},
    "observers": [{"label": "ekf", "kind": "joint-ekf"}],
}


@pytest.fixture(scope="module")
def rig() -> bytes:
    """Return the record of a tank whose pump loses flow in the middle."""
    plant = library.plant("level-loop").without_controllers
    return exported(simulated(plant, 0.5, ROWS, [], noise={"y": {"std": 0.05, "sample_time": 0.5}}))


@pytest.fixture
def record(client, rig) -> str:
    """Return the id of that record in the service."""
    status, _, _ = client.request("POST", "/api/records?name=rig.csv&plant=level-loop", rig, BYTES)
    assert status == 201
    return client.get("/api/records")["records"][0]["id"]


def ran(client, record: str, **changes: object) -> dict:
    """Return the run of observers on the record."""
    run = client.post(f"/api/records/{record}/runs?wait=60", BODY | changes)
    return run if run["status"] == "done" else client.wait(run["id"])


def test_observers_run_on_a_record(client, record):
    """The run has the diagnosis of the record, θ̂ with bands near the fault, and no column of a truth."""
    run = ran(client, record)
    diagnosis = client.post(f"/api/records/{record}/diagnosis", {n: BODY[n] for n in ("plant", "settings")})
    assert run["summary"]["record"] == diagnosis
    assert [a["channel"] for a in run["summary"]["facts"]["alarms"]] == ["pump"]
    data = client.data(run["id"])
    assert not [name for name in data if name.startswith(("x.", "theta."))]
    size = diagnosis["faults"][0]["best"]["size"]["value"]
    assert abs(data["ekf.theta.pump"][-1] - size) < 4 * data["ekf.sigma.pump"][-1] + 0.01
    (own,) = run["summary"]["observers"]
    assert own["rmse"] == {} and own["theta"]["pump"]["truth"] is None
    assert own["theta"]["pump"]["estimate"] == data["ekf.theta.pump"][-1]


def test_the_same_request_is_the_same_run(client, record):
    """The run's id is the hash of its spec, which can be posted as it is; other observers are another run."""
    run = ran(client, record)
    assert ran(client, record)["id"] == run["id"] == client.post("/api/runs", run["spec"])["id"]
    other = ran(
        client, record, observers=[{"label": "ekf", "kind": "joint-ekf", "gains": {"q_theta": [0.1, 0.1, 0.1]}}]
    )
    assert other["id"] != run["id"]


def test_a_run_on_a_record_has_figures_a_report_and_exports(client, record):
    """Figures show estimates without a truth; the report has findings and record; all formats hold the same numbers."""
    run = ran(client, record)
    names = [f["name"] for f in client.get(f"/api/runs/{run['id']}/figures")["figures"]]
    assert {"faults", "states", "outputs", "residuals", "inputs"} <= set(names) and "errors" not in names
    for name in names:
        assert client.figure(run["id"], name)["data"]
    shapes = client.figure(run["id"], "faults")["layout"]["shapes"]
    onset = run["summary"]["record"]["faults"][0]["best"]["onset"]["value"]
    assert any(abs(shape.get("x0", -1) - onset) < 1e-9 for shape in shapes)
    report = client.report(run["id"])
    assert "rig.csv" in report and "The model fits" in report
    data = client.data(run["id"])
    for format, read in (("parquet", parquet), ("mat", matlab)):
        content = client.request("GET", f"/api/runs/{run['id']}/data?format={format}")[2]
        columns = read(content)
        assert np.array_equal(columns["ekf.theta.pump"], data["ekf.theta.pump"])
        assert len(columns) == len(data)


def parquet(content: bytes) -> dict[str, np.ndarray]:
    """Return the columns of a Parquet file."""
    return {column.name: column.to_numpy() for column in pl.read_parquet(io.BytesIO(content))}


def matlab(content: bytes) -> dict[str, np.ndarray]:
    """Return the columns of a MATLAB file."""
    file = loadmat(io.BytesIO(content))
    pairs = zip(file["columns"].ravel(), file["variables"].ravel(), strict=True)
    return {str(name[0]): file[str(variable[0])].ravel() for name, variable in pairs}


def test_observers_get_the_fitted_plant(client, rig):
    """Parameters that the diagnosis fits are those of the observers, and the run's diagnosis is that of the plant."""
    plant = library.plant("level-loop").model_dump(mode="json")
    wrong = next(p for p in plant["parameters"] if p["name"] == "A")
    wrong["value"] *= 1.1
    client.request("POST", "/api/records?name=rig.csv", rig, BYTES)
    record = client.get("/api/records")["records"][0]["id"]
    run = ran(client, record, plant=plant)
    fit = run["summary"]["record"]["fit"]
    assert fit["verdict"] == "fits-after-fit" and run["spec"]["truth"]["record"]["fitted"] == ["A"]
    assert run["spec"]["parameters"]["A"] == fit["parameters"][0]["value"] == pytest.approx(154, rel=0.05)


def test_a_run_on_a_record_that_is_gone_keeps_its_result(client, record):
    """Removing the file leaves the run; a new one on it is refused with a remedy."""
    run = ran(client, record)
    client.request("DELETE", f"/api/records/{record}")
    assert client.get(f"/api/runs/{run['id']}")["summary"] == run["summary"]
    spec = run["spec"] | {"seed": 99}
    with pytest.raises(ServiceError, match="no record"):
        client.post("/api/runs", spec)
    with pytest.raises(ServiceError, match="404"):
        ran(client, record)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"observers": [{"label": "ekf", "kind": "joint-efk"}]}, "joint-ekf"),
        ({"settings": {"healthy": {"begin": 500.0, "end": 600.0}}}, "healthy"),
        ({"mapping": {"quantities": {"y": {"column": "Level"}}}}, "Level"),
    ],
)
def test_requests_that_do_not_fit_are_refused(client, record, change, words):
    """Unknown observers and columns and a stretch outside of the record are refused with their names."""
    with pytest.raises(ServiceError, match=words):
        ran(client, record, **change)
