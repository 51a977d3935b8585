"""The empirical observability Gramian, against the analytic one and on plants with known results."""

import tracemalloc

import numpy as np
import pytest
from scipy.linalg import expm

from tests.engine.plants import engine, oscillator
from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.observability.empirical_gramian import Empirical, _result, empirical
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope.engine.simulation.simulation import Simulation
from thetascope_schemas import Experiment


def of_library(name: str, **changes) -> Engine:
    """Return an experiment of the library without its observers, as an engine object."""
    spec = library.experiment(name).model_dump(mode="json") | {"observers": [], "figures": []} | changes
    return prepare(library.resolve(Experiment.model_validate(spec))).engine


def constant(value: float) -> dict:
    return {"kind": "constant", "value": value}


def test_the_gramian_of_a_linear_plant_is_the_analytic_one():
    """Σ Aₖᵀ Cᵀ C Aₖ / σ² over the rows of a window, with the fault as a further, constant state."""
    plant = oscillator(
        states=[{"name": "x1", "initial": 1.0, "scale": 1.0}, {"name": "x2", "initial": 0.5, "scale": 0.5}],
        dynamics={"x1": "x2", "x2": "-k*x1 - d*x2 + u"},
        channels=[{"name": "force", "kind": "actuator", "enters": {"x2": "1"}, "typical": 0.3}],
    )
    found = empirical(
        engine(plant=plant, faults=[], observers=[], noise={"y": {"std": 0.01, "sample_time": 0.05}}), 2.0
    )
    A = np.array([[0, 1, 0], [-4, -0.3, 1], [0, 0, 0]])
    rows = np.array([expm(A * k * 0.05)[0] for k in range(40)]) * [1.0, 0.5, 0.3] / 0.01
    true = rows.T @ rows
    assert found.names == ("x.x1", "x.x2", "theta.force")
    assert np.abs(found.gramian - true).max() < 1e-6 * np.abs(true).max()
    assert found.singular == pytest.approx(np.tile(np.linalg.svd(rows, compute_uv=False), (len(found.t), 1)), rel=1e-6)
    assert set(found.rank) == {3}


def test_friction_and_load_are_confounded_at_constant_speed():
    """Only load + speed · friction is visible: rank 3 of 4 with the two states."""
    e = of_library("dc-motor", inputs={"voltage": constant(12)}, faults=[])
    found = empirical(e, 2.0, unknown=("x.current", "x.speed", "theta.load_torque", "theta.friction_increase"))
    assert set(found.rank[1:]) == {3}
    load, friction = found.direction[-1][2:]
    speed = list(Simulation(e).spans(e.steps))[-1][1].plant[-1, 1]
    assert load * 0.05 == pytest.approx(-friction * 0.0002 * speed, rel=1e-3)  # equal and opposite torques
    assert np.isinf(found.condition[1:]).all()


def test_equal_known_signals_reduce_the_rank():
    """Zhao's plant: rank 5 of 5 with the paper's φ, 4 with φ1 = φ2 = 1."""
    assert set(empirical(of_library("zhao-2012"), 2.0, 4).rank) == {5}
    still = of_library("zhao-2012", signals={"phi1": constant(1), "phi2": constant(1)})
    assert set(empirical(still, 2.0, 4).rank) == {4}


def test_the_sandwich_is_observable_while_operators_move():
    """Zhou & Tan along a run: rank 4 of (x11, x12, x21, x22) while operators move, 2 while all hold."""
    steps = {
        "kind": "steps",
        "times": [3.0, 5.0],
        "values": [0.0, 5.0, 4.9],
    }  # a little back, so that none is at its edge
    e = of_library("zhou-tan-2012", inputs={"u": steps})
    found = empirical(e, 0.4, 41, unknown=("x.x11", "x.x12", "x.x21", "x.x22"))
    plant = np.concatenate([rows.plant for _, rows in Simulation(e).spans(e.steps + 1)])
    z = plant[:, [i for i, s in enumerate(e.plant.states) if s.startswith("x.z")]]
    begins = np.rint(found.t / e.step).astype(int)
    moved = np.array([np.ptp(z[k : k + 10], axis=0).max() > 1e-3 for k in begins])
    holding = (found.t < 2.6) | (found.t > 5.5)
    assert moved.any()
    assert not moved[holding].any()
    assert set(found.rank[moved]) == {4}
    assert set(found.rank[holding]) == {2}


def test_windows_of_a_diverged_plant_have_no_rank():
    """Windows in which the plant is not finite are reported."""
    plant = oscillator(dynamics={"x1": "x1^2 + 1", "x2": "-x2"}, channels=[])
    found = empirical(engine(plant=plant, faults=[], observers=[], horizon=5.0), 0.5)
    assert found.rank[-1] == -1
    assert np.isnan(found.singular[-1]).all()


@pytest.mark.parametrize(
    ("language", "sentence"),
    [
        ("en", "rank 4 to 5 of 5 over 2 s, condition 1.5e+02 to 1.5e+02; least visible, from 10 s on: +1 a, 3 times"),
        ("zh", "2 s 内的秩为 4 至 5（共 5），条件数 1.5e+02 至 1.5e+02；从 10 s 起最不明显的是 +1 a，高出噪声 3 倍"),
    ],
)
def test_the_gramian_is_worded_in_every_language(language, sentence):
    """Ranks, condition numbers and the least visible combination are one sentence."""
    singular = np.array([[900.0, 40.0, 30.0, 20.0, 6.0], [450.0, 40.0, 30.0, 20.0, 3.0]])
    found = Empirical(
        window=2.0,
        names=("x.a", "x.b", "x.c", "x.d", "theta.e"),
        t=np.array([0.0, 10.0]),
        gramian=np.zeros((2, 5, 5)),
        singular=singular,
        rank=np.array([5, 4]),
        condition=np.array([150.0, np.inf]),
        direction=np.array([[1.0, 0, 0, 0, 0], [1.0, 0, 0, 0, 0]]),
    )
    assert found.text.text(language).startswith(sentence)


def test_many_rows_take_memory_in_proportion():
    """The factor of the decomposition that nobody needs would be rows × rows: 130 MB here, 80 GB for 100 000 rows."""
    S = np.random.default_rng(0).standard_normal((1, 4000, 3))
    tracemalloc.start()
    found = _result(S, 1.0, ("a", "b", "c"), np.zeros(1))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 20 * S.nbytes and found.rank.tolist() == [3]
