"""/api/runs/{id}/data, /figures and /report."""

import base64
import csv
import io
import json
import re

import numpy as np
import pytest
from scipy.io import loadmat

from thetascope.client import ServiceError


def test_the_columns_have_the_documented_order(client, run):
    """The order is t, inputs, known signals, states, faults, outputs, then the observer's columns."""
    names = list(client.data(run["id"]))
    assert names[0] == "t"
    first = [name.split(".")[0] for name in names]
    order = ["t", "u", "signal", "x", "theta", "y", "adaptive"]
    assert [part for i, part in enumerate(first) if part not in first[:i]] == order
    assert [name for name in names if name.startswith("adaptive.theta.")] == [
        f"adaptive.theta.theta{i}" for i in (1, 2, 3)
    ]


def test_csv_json_and_mat_contain_the_same_numbers_bit_for_bit(client, run):
    """Each file is read by a reader of another program."""
    base = run["links"]["data"]
    exact = client.data(run["id"])
    text = client.request("GET", f"{base}?format=csv")[2].decode()
    head, *rows = csv.reader(io.StringIO(text))
    assert head == list(exact)
    assert np.array_equal(np.array(rows, dtype=float).T, np.array(list(exact.values())), equal_nan=True)
    plain = client.get(f"{base}?format=json")
    assert plain["rows"] == 501 and plain["columns"]["x.x1"] == exact["x.x1"].tolist()
    matlab = loadmat(io.BytesIO(client.request("GET", f"{base}?format=mat")[2]))
    assert np.array_equal(matlab["adaptive_theta_theta1"].ravel(), exact["adaptive.theta.theta1"])


def test_a_part_of_the_data_can_be_requested(client, run):
    """A range of times, columns with patterns, every n-th row, or a number of points."""
    found = client.data(run["id"], ["t", "theta.*"], start=1, end=2)
    assert list(found) == ["t", "theta.theta1", "theta.theta2", "theta.theta3"]
    assert (found["t"][0], found["t"][-1], len(found["t"])) == (1, 2, 101)
    fewer = client.get(f"{run['links']['data']}?format=json&columns=t&points=10")
    assert fewer["rows"] <= 10 and fewer["columns"]["t"][0] == 0


def test_data_that_the_browser_has_is_not_sent_again(client, run):
    """A result never changes, so its ETag is its id."""
    status, headers, _ = client.request("GET", run["links"]["data"])
    assert status == 200 and headers["content-disposition"].endswith('.csv"')
    client._connection.request("GET", run["links"]["data"], headers={"If-None-Match": headers["etag"]})
    answer = client._connection.getresponse()
    assert (answer.status, answer.read()) == (304, b"")


def test_the_comparison_is_in_the_summary_and_separate_as_json_and_csv(client, run):
    """All three have the same numbers; each line of the CSV names observer, measure and subject."""
    alone = client.get(run["links"]["comparison"])
    assert alone == run["summary"]["comparison"]
    row, detector = alone["observers"]
    assert detector["label"] == "detector" and detector["rmse"] == {}
    assert alone["windows"] == [{"start": 0.0, "end": 5.0}]
    data = client.data(run["id"])
    error = data["adaptive.theta.theta3"] - data["theta.theta3"]
    assert row["rmse"]["theta.theta3"] == [pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-12)]
    assert row["peak"]["theta.theta3"] == [np.abs(error).max()]
    assert 0.1 < row["cost"] < 1e5
    _, headers, content = client.request("GET", run["links"]["comparison"] + "?format=csv")
    assert headers["content-type"].startswith("text/csv") and headers["content-disposition"].endswith(
        '-comparison.csv"'
    )
    lines = {(line["measure"], line["of"]): line for line in csv.DictReader(io.StringIO(content.decode()))}
    assert float(lines["rmse", "theta.theta3"]["value"]) == row["rmse"]["theta.theta3"][0]
    assert lines["rmse", "x.x2"]["unit"] == "1/s" and lines["rmse", "x.x2"]["until"] == "5"


def test_each_listed_figure_is_plotlys_json_with_packed_arrays(client, run):
    """The experiment's own figures come first; arrays decode to finite numbers of the run."""
    figures = client.get(run["links"]["figures"])["figures"]
    own = [figure["name"] for figure in run["spec"]["figures"]]
    assert [figure["name"] for figure in figures][: len(own)] == own
    for entry in figures:
        figure = client.get(entry["href"])
        assert figure["data"] and figure["layout"]
        packed = figure["data"][0]["x"]
        t = np.frombuffer(base64.b64decode(packed["bdata"]), packed["dtype"])
        assert np.isfinite(t).all() and t.size > 2


def test_an_unknown_figure_is_refused_with_suggestions(client, run):
    """404 names the nearest figure."""
    name = client.get(run["links"]["figures"])["figures"][0]["name"]
    with pytest.raises(ServiceError, match=name) as refusal:
        client.figure(run["id"], name[:-1] + "_")
    assert refusal.value.status == 404


def test_the_report_is_one_self_contained_file(client, run):
    """Plotly.js is inside; the content policy forbids requests to the service."""
    _, headers, content = client.request("GET", run["links"]["report"])
    html = content.decode()
    assert html.startswith("<!doctype html>") and len(html) > 3_000_000
    assert not any(f"<{tag}" in html.split("<script", 1)[0] for tag in ("link ", "img "))
    assert "src=" not in html.split("Plotly", 1)[0]
    assert "sandbox" in headers["content-security-policy"]
    assert run["id"] in html
    download = client.request("GET", run["links"]["report"] + "?download=true")[1]
    assert download["content-disposition"].startswith("attachment")


def test_the_paper_targets_are_met_over_rest(client):
    """Noise-free, the means of the estimates on [30,40], [55,70], [90,100] s agree to 1e-6 (READING.md §1)."""
    run = client.run("zhao-2012-noise-free")
    found = client.data(run["id"], ["t", "adaptive.theta.*"])
    t = found.pop("t")
    for (start, end), truth in {
        (30, 40): (0, 0, 0.02),
        (55, 70): (0.01, 0, 0.02),
        (90, 100): (0.01, 0.015, 0.02),
    }.items():
        window = (t >= start) & (t < end)
        means = [column[window].mean() for column in found.values()]
        assert means == pytest.approx(truth, abs=1e-6)


def test_problem_documents_of_parameters_name_the_parameter(client, run):
    """Invalid formats, counts, columns and ranges."""
    for query, field in (
        ("format=xml", "format"),
        ("every=0", "every"),
        ("points=no", "points"),
        ("columns=x.x3", "columns"),
        ("from=3&to=2", "from"),
        ("from=nan", "from"),
        ("to=inf", "to"),
        ("to=-1", "to"),
    ):
        with pytest.raises(ServiceError) as refusal:
            client.get(f"{run['links']['data']}?{query}")
        assert refusal.value.status == 422
        assert refusal.value.problem["errors"][0]["field"] == field
        assert json.dumps(refusal.value.problem["errors"][0]["remedy"]) != '""'


def test_an_observer_added_during_the_run_is_in_report_and_figures(client):
    """A run with an add-observer command, as a live session saves it, has a report and figures with that observer."""
    spec = client.get("/api/experiments/zhao-2012")
    added = {
        "command": "add-observer",
        "at": 1.0,
        "observer": {"label": "late", "kind": "joint-ekf", "gains": {"r": 1e-5}},
    }
    spec |= {"horizon": 4.0, "figures": [], "commands": [added], "diagnosis": {"enabled": False}}
    run = client.run(spec)
    status, _, page = client.request("GET", run["links"]["report"])
    assert status == 200 and "late" in re.findall(r"<h3>.*?</h3>", page.decode())[-1]
    names = [one["name"] for one in client.get(run["links"]["figures"])["figures"]]
    drawn = {name: json.dumps(client.get(f"{run['links']['figures']}/{name}")) for name in names}
    assert "errors" in drawn and "late" in drawn["errors"] and "late" in drawn["faults"]


def test_names_in_any_script_are_columns_and_paths(client):
    """A plant with Greek and Chinese names runs; columns are asked for in any spelling, and changes by path act."""
    plant = {
        "id": "greek",
        "states": [{"name": "ω"}],
        "inputs": [{"name": "力", "default": 1.0}],
        "outputs": [{"name": "y_ω", "expression": "ω"}],
        "parameters": [{"name": "τ₁", "value": 1.0}],
        "dynamics": {"ω": "(力 - ω)/τ1"},
    }
    run = client.post("/api/runs", {"plant": plant, "horizon": 1.0, "step": 0.01, "parameters": {"τ₁": 0.5}})
    columns = client.data(run["id"], ["t", "x.ω", "u.力", "y.y_ω"])
    assert list(columns) == ["t", "x.ω", "u.力", "y.y_ω"]
    np.testing.assert_allclose(columns["x.ω"], 1 - np.exp(-2 * columns["t"]), atol=1e-8)


def test_a_frame_has_the_columns_bit_for_bit(client, run):
    """`Client.frame` returns polars by default, a part where one is asked for, and refuses another kind."""
    exact, frame = client.data(run["id"]), client.frame(run["id"])
    assert frame.columns == list(exact)
    assert all(np.array_equal(frame[name].to_numpy(), exact[name], equal_nan=True) for name in exact)
    assert client.frame(run["id"], columns=["t"], start=1, end=2).shape == (101, 1)
    with pytest.raises(ValueError, match="polars or pandas"):
        client.frame(run["id"], "arrow")


def test_the_client_gets_a_figure_for_a_paper(client, run):
    """`Client.print_figure` returns the bytes of the file."""
    assert client.print_figure(run["id"], "faults", format="tex", panels=[1]).startswith(b"% Faults")


def test_the_notebook_of_a_run_computes_the_same_numbers(client, run, capsys):
    """Its cells run one after another without a service, and its own comparison holds."""
    _, headers, content = client.request("GET", f"{run['links']['self']}/notebook")
    notebook = json.loads(content)
    assert headers["content-disposition"].endswith('.ipynb"') and notebook["nbformat"] == 4
    names: dict = {}
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), names)
    assert "bit for bit: True" in capsys.readouterr().out
    assert names["frame"].columns == list(client.data(run["id"])) and len(names["axes"]) == 3
