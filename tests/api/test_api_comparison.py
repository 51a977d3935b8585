"""The comparison of a live session's observers over a window equals that of the run of its spec."""

import numpy as np
import pytest

from thetascope.client import ServiceError
from thetascope.diagnosis.evaluation.metrics import rmse


def opened(client, t: float):
    """Open a session on the library's first experiment, paused at a time."""
    return client.post("/api/sessions", {"experiment": "zhao-2012", "t": t, "play": False})


def test_window_figures_follow_from_its_rows(client):
    """RMSE of the chosen state equals that of /data; noise is the spread about a line through the last quarter."""
    session = opened(client, 30)
    link = session["links"]["comparison"]
    figures = client.get(f"{link}?from=10&to=20&state=x1&channel=theta3")
    rows = client.get(session["links"]["data"] + "?from=10&to=20")["columns"]
    (row,) = figures["observers"]
    truth, estimate = (np.array(rows[name]) for name in ("x.x1", f"{row['label']}.x.x1"))
    assert row["rmse"] == pytest.approx(rmse(estimate, truth), rel=1e-5)
    t, theta = np.array(rows["t"]), np.array(rows[f"{row['label']}.theta.theta3"])
    late = t >= 17.5 - 1e-9
    rest = theta[late] - np.polyval(np.polyfit(t[late], theta[late], 1), t[late])
    assert row["noise"] == pytest.approx(np.sqrt(np.mean(rest**2)), rel=1e-3)
    assert figures["t"] == pytest.approx(30, abs=0.02) and (figures["state"], figures["channel"]) == ("x1", "theta3")


def test_the_newest_fault_of_the_channel_is_followed_and_found(client):
    """For the θ3 fault at 20 s: settling time within 10 % and the detector's verdict with its delay; none before it."""
    link = opened(client, 30)["links"]["comparison"]
    figures = client.get(f"{link}?from=0&to=30&channel=theta3")
    assert figures["fault"]["id"] == "theta3@20.0"
    (row,) = figures["observers"]
    assert row["outcome"] in ("settled", "too-noisy") and (row["settled"] is None or 0 < row["settled"] < 10)
    assert client.get(f"{link}?from=0&to=15&channel=theta3")["fault"] is None
    assert client.get(f"{link}?channel=theta1&to=30")["fault"] is None


def test_an_empty_window_has_no_figures_and_unknown_names_are_refused(client):
    """An empty window has no figures; for an unknown state the error lists the known ones."""
    link = opened(client, 3)["links"]["comparison"]
    assert client.get(f"{link}?from=5&to=6")["observers"][0]["rmse"] is None
    for query, words in (("state=z", "x1"), ("channel=theta9", "theta1"), ("from=2&to=1", "before it begins")):
        with pytest.raises(ServiceError, match=words):
            client.get(f"{link}?{query}")


def test_the_table_has_every_estimate_with_the_figures_of_its_comparison(client):
    """States first, then faults; each pair of a state and a fault has the numbers that the comparison of it has."""
    link = opened(client, 30)["links"]["comparison"]
    table = client.get(f"{link}/table?from=5&to=28")
    (row,) = table["observers"]
    names = ["x.x1", "x.x2", "theta.theta1", "theta.theta2", "theta.theta3"]
    assert [one["name"] for one in row["estimates"]] == names and table["t"] == pytest.approx(30, abs=0.02)
    estimates = {one["name"]: one for one in row["estimates"]}
    for state, channel in (("x1", "theta3"), ("x2", "theta1")):
        (one,) = client.get(f"{link}?from=5&to=28&state={state}&channel={channel}")["observers"]
        fault = estimates[f"theta.{channel}"]
        assert estimates[f"x.{state}"]["rmse"] == one["rmse"]
        assert {name: fault[name] for name in ("noise", "settled", "outcome")} == {
            name: one[name] for name in ("noise", "settled", "outcome")
        }
    assert estimates["x.x1"]["noise"] is None and estimates["theta.theta3"]["rmse"] > 0


def test_a_table_refuses_a_window_that_ends_before_it_begins(client):
    """The refusal names the field."""
    link = opened(client, 5)["links"]["comparison"]
    with pytest.raises(ServiceError) as refused:
        client.get(f"{link}/table?from=4&to=2")
    assert refused.value.status == 422
