"""/api/papers, and numbers measured in runs."""

import pytest

from thetascope.client import ServiceError


def test_papers_are_listed_with_their_equations(client):
    """Four papers; each has its equations as MathML."""
    lines = client.get("/api/papers")["papers"]
    assert [line["id"] for line in lines] == ["zhao-2012", "shen-hu-2015", "reduced-order-mimo", "zhou-tan-2012"]
    for line in lines:
        page = client.get(f"/api/papers/{line['id']}")
        assert page["paper"]["claim"] == line["claim"]
        assert len(page["equations"]) == len(page["paper"]["equations"])
        assert all(text.startswith("<math") for text in page["equations"])


def test_an_unknown_paper_is_refused(client):
    """404 says where the list is."""
    with pytest.raises(ServiceError) as refused:
        client.get("/api/papers/zhao-2011")
    assert refused.value.status == 404 and "/api/papers" in str(refused.value)


def test_numbers_are_measured_in_a_run(client, run):
    """Levels and gains come from the run's columns and spec; what never happens is null."""
    measures = {
        "last": {"kind": "level", "take": "last", "column": "t"},
        "rho": {"kind": "gain", "observer": "adaptive", "gain": "rho"},
        "escape": {"kind": "diverged", "observer": "adaptive"},
    }
    values = client.post(f"/api/runs/{run['id']}/measures", {"measures": measures})["values"]
    assert values == {"last": pytest.approx(run["spec"]["horizon"]), "rho": 4.0, "escape": None}


def test_a_column_that_the_run_lacks_is_refused(client, run):
    """422 names the measure, the column and near names."""
    measures = {"bias": {"kind": "level", "take": "mean", "column": "adaptive.theta.theta9"}}
    with pytest.raises(ServiceError) as refused:
        client.post(f"/api/runs/{run['id']}/measures", {"measures": measures})
    error = refused.value
    assert error.status == 422 and "adaptive.theta.theta9" in str(error) and "adaptive.theta.theta1" in str(error)
