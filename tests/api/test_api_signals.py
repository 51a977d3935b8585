"""The curve of a signal over HTTP: the values that a run has, for every shape; requests that ask for too much."""

import math

import pytest

from tests.api.test_api_large_bodies import computations
from tests.live.session.test_input_commands import SHAPES
from thetascope import library
from thetascope.client import ServiceError


@pytest.mark.parametrize("shape", SHAPES, ids=[f"{s['kind']}-{i}" for i, s in enumerate(SHAPES)])
def test_a_curve_is_the_input_of_a_run(client, shape):
    """At the rows of a run between the points of the curve; jumps have both limits."""
    curve = client.post("/api/signals/curve", {"signal": shape, "start": 0, "end": 4, "places": 400})
    assert curve["t"] == sorted(curve["t"]) and (curve["t"][0], curve["t"][-1]) == (0, 4)
    spec = library.experiment("zhao-2012").model_dump(mode="json")
    few = {"observers": [], "faults": [], "figures": [], "horizon": 4, "record": 0.01, "diagnosis": {"enabled": False}}
    run = client.run(spec | few | {"inputs": {"u": shape}})
    columns = client.data(run["id"], columns=["t", "u.u"])
    points = list(zip(curve["t"], curve["values"], strict=True))
    for t, u in list(zip(columns["t"], columns["u.u"], strict=True))[1:-1:7]:
        before = max((p for p in points if p[0] <= t), key=lambda p: p[0])
        after = min((p for p in points if p[0] >= t), key=lambda p: p[0])
        near = [value for at, value in points if abs(at - t) < 1e-6] or [before[1], after[1]]
        assert min(near) - 2e-4 <= u <= max(near) + 2e-4


@pytest.mark.parametrize(
    ("body", "field"),
    [
        ({"signal": SHAPES[0], "start": 3, "end": 3}, "end"),
        ({"signal": SHAPES[0], "start": 0, "end": 1e40}, "end"),
        ({"signal": SHAPES[0], "start": 0, "end": 1, "places": 10**9}, "places"),
        ({"signal": {"kind": "expression", "text": "sin(x)"}, "start": 0, "end": 1}, "signal.text"),
        ({"signal": {"kind": "square", "amplitude": 1, "period": 1, "start": 1e300}, "start": 0, "end": 1}, "start"),
        ({"signal": {"kind": "prbs", "hold": 1, "order": 40}, "start": 0, "end": 1}, "order"),
        ({"signal": {"kind": "noise", "std": -1, "hold": 1}, "start": 0, "end": 1}, "std"),
        ({"signal": {"kind": "sinus"}, "start": 0, "end": 1}, "signal"),
    ],
)
def test_a_curve_that_cannot_be_drawn_is_refused(client, body, field):
    """The error names the field."""
    with pytest.raises(ServiceError) as refusal:
        client.post("/api/signals/curve", body)
    assert field in str(refusal.value)


def test_a_curve_of_many_draws_is_computed_in_a_worker(client, address):
    """It takes a tenth of a second, in which the service would answer nobody else."""
    before = computations(address)
    long = {"signal": {"kind": "prbs", "hold": 1e-12}, "start": 0, "end": 60, "places": 2000}
    client.post("/api/signals/curve", long)
    assert computations(address) == before + 1
    client.post("/api/signals/curve", long | {"signal": {"kind": "prbs", "hold": 0.1}})
    assert computations(address) == before + 1


@pytest.mark.parametrize(
    "shape",
    [
        {"kind": "noise", "std": 1, "hold": 1e-300},
        {"kind": "prbs", "hold": 1e-12},
        {"kind": "pulse", "period": 1e-9, "width": 1e-9, "start": -1e308},
        {"kind": "chirp", "amplitude": 1e308, "f0": 1e308, "f1": 1e308, "duration": 1e-300},
    ],
    ids=lambda shape: shape["kind"],
)
def test_absurd_signals_cost_neither_time_nor_memory(client, shape):
    """Few points, all finite."""
    curve = client.post("/api/signals/curve", {"signal": shape, "start": 0, "end": 1e9, "places": 100})
    assert len(curve["t"]) <= 600 and all(math.isfinite(value) for value in curve["values"])
