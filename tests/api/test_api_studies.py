"""/api/studies: begin, follow, cancel, go on, remove; what is computed from the runs; attacks."""

import io
import os
import signal
import time
from pathlib import Path

import polars as pl
import pytest

from tests.api.conftest import process
from tests.studies.study_samples import GAINS, computed, study
from thetascope.client import Client, ServiceError

SMALL = GAINS | {"seeds": 2, "measures": ["rmse", "settling"]}
"""24 runs in one block."""


def until_done(client: Client, state: dict, seconds: float = 120) -> dict:
    """Return a study once its computation has ended."""
    until = time.monotonic() + seconds
    while state["status"] == "running":
        assert time.monotonic() < until, state
        time.sleep(0.05)
        state = client.get(state["links"]["self"])
    return state


def got(client: Client, path: str) -> bytes:
    """Return the bytes of an answer."""
    return client.request("GET", path)[2]


@pytest.fixture(scope="session")
def done(address: str) -> dict:
    """A study that is done."""
    with Client(address, timeout=120) as client:
        return until_done(client, client.post("/api/studies", SMALL))


def test_a_study_has_the_table_of_the_command_line(client: Client, done: dict, tmp_path: Path):
    """The same bits, as CSV and Parquet; its id is the hash of the spec, and posting it again computes nothing."""
    assert (done["status"], done["runs"], done["done"], done["points"], done["refused"]) == ("done", 24, 24, 6, 0)
    expected = computed(study(SMALL), tmp_path)
    assert pl.read_parquet(io.BytesIO(got(client, f"/api/studies/{done['id']}/table.parquet"))).equals(expected)
    csv = got(client, f"/api/studies/{done['id']}/table.csv")
    assert pl.read_csv(io.BytesIO(csv), schema=expected.schema).equals(expected)
    assert got(client, f"/api/studies/{done['id']}/table.tex").count(rb"\\") == 7
    again = client.post("/api/studies", SMALL | {"title": "The same under another name"})
    assert again["id"] == done["id"] and until_done(client, again)["done"] == 24
    assert done["id"] in [one["id"] for one in client.get("/api/studies")["studies"]]


def test_a_run_of_a_study_opens_with_the_same_numbers(client: Client, done: dict):
    """Its experiment, posted to /api/runs, has the id and the errors of the table."""
    table = pl.read_parquet(io.BytesIO(got(client, f"/api/studies/{done['id']}/table.parquet")))
    row = table.row(7, named=True)
    run = client.post("/api/runs?wait=60", client.get(f"/api/studies/{done['id']}/runs/7"))
    assert run["id"] == row["id"]
    (observer,) = run["summary"]["observers"]
    assert observer["rmse"]["x1"] == pytest.approx(row["rmse.adaptive.x.x1"], rel=1e-12)


def test_summaries_are_those_of_the_table(client: Client, done: dict):
    """Medians by factor, points, sensitivity, Pareto; no detector, so no ROC."""
    base = f"/api/studies/{done['id']}"
    table = pl.read_parquet(io.BytesIO(got(client, f"{base}/table.parquet")))
    measure = "rmse.adaptive.theta.theta3"
    curves = client.get(f"{base}/curves?measure={measure}&against=rho&curve=noise")["points"]
    assert len(curves) == 6
    for point in curves:
        here = (pl.col("rho") == point["value"]) & (pl.col("noise") == point["curve"]) & pl.col("faulty")
        mine = table.filter(here)[measure]
        assert point["spread"]["median"] == pytest.approx(mine.median(), rel=1e-12) and point["spread"]["n"] == 2
    points = client.get(f"{base}/points?measure={measure}&measure=rmse.adaptive.x.x1")
    assert points["measures"] == [measure, "rmse.adaptive.x.x1"] and len(points["points"]) == 6
    assert points["points"][3]["values"] == {"rho": 4.0, "noise": 0.001}
    factors = client.get(f"{base}/sensitivity?measure={measure}")["factors"]
    assert {one["factor"] for one in factors} == {"rho", "noise"}
    front = client.get(f"{base}/pareto?a={measure}&b=rmse.adaptive.x.x1")["points"]
    assert len(front) == 6 and any(one["best"] for one in front)
    with pytest.raises(ServiceError) as refused:
        client.get(f"{base}/roc?against=noise")
    assert refused.value.status == 422 and "detector" in str(refused.value)


def test_the_size_is_known_before(client: Client):
    """Runs, points and about how long; nothing is begun."""
    size = client.post("/api/studies/size", GAINS | {"seeds": 1000})
    assert (size["runs"], size["points"]) == (12_000, 6) and size["seconds"] > 0
    assert size["id"] not in [one["id"] for one in client.get("/api/studies")["studies"]]


@pytest.mark.parametrize(
    ("path", "field"),
    [
        ("curves?measure=nothing&against=rho", "measure"),
        ("curves?measure=rmse.adaptive.x.x1&against=nothing", "against"),
        ("curves?measure=rmse.adaptive.x.x1&against=rho&curve=run", "curve"),
        ("sensitivity?measure=id", "measure"),
        ("confusion?who=nobody", "who"),
        ("runs/24", "run"),
        ("runs/-1", "run"),
        ("table.xlsx", "kind"),
    ],
)
def test_a_wrong_question_is_refused_by_its_field(client: Client, done: dict, path: str, field: str):
    """422 with the field and what may be asked for."""
    with pytest.raises(ServiceError) as refused:
        client.get(f"/api/studies/{done['id']}/{path}")
    assert refused.value.status == 422
    assert refused.value.problem["errors"][0]["field"] == field


@pytest.mark.parametrize("id", ["0" * 32, "..%5C..", "x", "A" * 32])
def test_an_unknown_study_is_404(client: Client, id: str):
    """Also one whose id would leave the folder."""
    for path in ("", "/table.csv", "/points"):
        with pytest.raises(ServiceError) as refused:
            client.get(f"/api/studies/{id}{path}")
        assert refused.value.status == 404


def test_a_study_that_is_too_large_is_refused_before_anything_is_computed(client: Client):
    """More runs than the service allows, and 1e12."""
    for changes, status in (({"seeds": 1_000_000}, 422), ({"vary": [{**GAINS["vary"][1], "points": 10_000}]}, 422)):
        with pytest.raises(ServiceError) as refused:
            client.post("/api/studies", GAINS | {"seeds": 10**9} | changes)
        assert refused.value.status == status


def test_a_study_goes_on_after_the_service_was_killed(tmp_path: Path):
    """SIGKILL in the middle: the next start completes it with the same bits; cancelled ones stay cancelled."""
    large = GAINS | {"seeds": 60}
    with process(tmp_path) as (running, address):
        client = Client(address)
        state = client.post("/api/studies", large)
        until = time.monotonic() + 120
        while not client.get(state["links"]["self"])["done"]:
            assert time.monotonic() < until
            time.sleep(0.02)
        os.kill(running.pid, signal.SIGKILL)
    with process(tmp_path) as (_, address):
        client = Client(address)
        state = until_done(client, client.get(state["links"]["self"]))
        assert (state["status"], state["done"]) == ("done", 720)
        table = pl.read_parquet(io.BytesIO(got(client, f"/api/studies/{state['id']}/table.parquet")))
        assert table.equals(computed(study(large), tmp_path / "again"))


def test_a_cancelled_study_keeps_its_runs_and_goes_on(tmp_path: Path):
    """Cancel after the first block; the same POST completes it; DELETE removes it."""
    large = GAINS | {"seeds": 60, "measures": ["rmse", "peak", "settling"]}
    with process(tmp_path) as (_, address):
        client = Client(address)
        state = client.post("/api/studies", large)
        until = time.monotonic() + 120
        while not client.get(state["links"]["self"])["done"]:
            assert time.monotonic() < until
            time.sleep(0.02)
        cancelled = client.post(state["links"]["cancel"])
        assert cancelled["status"] in ("cancelled", "done") and cancelled["done"] >= 64
        assert until_done(client, client.post("/api/studies", large))["done"] == 720
        assert client.request("DELETE", state["links"]["self"])[0] == 204
        with pytest.raises(ServiceError) as refused:
            client.get(state["links"]["self"])
        assert refused.value.status == 404
        assert not list((tmp_path / "studies").rglob("*.parquet"))


def test_damaged_facts_give_a_study_to_nobody(tmp_path: Path):
    """A flipped bit in the owner: the study is shown to the machine's owner as cancelled, and its runs are kept."""
    with process(tmp_path) as (_, address):
        client = Client(address)
        state = until_done(client, client.post("/api/studies", SMALL))
    facts = tmp_path / "studies" / state["id"] / "facts.json"
    facts.write_bytes(facts.read_bytes().replace(b'"machine"', b'"machinf"'))
    with process(tmp_path) as (_, address):
        found = Client(address).get(state["links"]["self"])
        assert found["status"] == "cancelled" and found["done"] == 24
