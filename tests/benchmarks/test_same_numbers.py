"""Every contender of the benchmarks computes the same as the product. No time is asserted."""

import random
import shutil
from pathlib import Path

import numpy as np
import pytest

from benchmarks import __main__ as command
from benchmarks import compilation, kernels, others, service
from benchmarks.measure import Figure, ratios, rounds
from benchmarks.problem import ESTIMATES, HOLD, PLACES, ByHand, engine, kernels_alone, rates, rows, start
from thetascope.engine.compiler.graph import evaluate
from thetascope.engine.simulation.batch import _Lanes, run_batch, with_seed
from thetascope.engine.simulation.simulation import Simulation, joined

needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="the C code needs gcc")


@pytest.fixture(scope="module")
def short():
    """Return two seconds of the problem with a row every 10 ms."""
    return engine(horizon=2.0)


@pytest.fixture(scope="module")
def by_hand() -> ByHand:
    return ByHand.compiled()


def product(e) -> np.ndarray:
    """Return all states after t = 0 as the product records them."""
    ((_, found),) = Simulation(e).spans(e.steps + 1)
    return np.concatenate([found.plant, found.observers[0]], axis=1)[1:]


def test_the_measured_kernels_are_those_of_a_run(short):
    """Their states equal those of the run bit for bit."""
    call, names = kernels_alone(short)
    np.testing.assert_array_equal(call(), product(short))
    assert len(names) == 19 and set(ESTIMATES) <= set(names)


@needs_gcc
def test_the_c_code_solves_the_same_problem(short, by_hand):
    """Every row to 1e-12, over switching inputs and noise."""
    call, names = kernels_alone(short)
    theirs = by_hand.simulate(rows(short), short.steps, short.step, short.every, start(short))
    np.testing.assert_allclose(theirs[:, PLACES], call()[:, [names.index(n) for n in ESTIMATES]], rtol=0, atol=1e-12)


@needs_gcc
def test_the_c_code_draws_noise_of_its_own(short, by_hand):
    """Without noise the runs of a batch are equal; with noise their spread is about that of the product's runs."""
    inputs, state = rows(short), start(short)
    inputs[:, 7] = 0.0
    one = by_hand.simulate(inputs, short.steps, short.step, short.every, state)
    for many in by_hand.batch(inputs, short.step, short.every, state, range(3), 0.0):
        np.testing.assert_array_equal(many, one)
    runs = 1000
    theirs = by_hand.batch(inputs, short.step, short.every, state, range(runs), 0.001)[:, -1, PLACES[4:]]
    ours = run_batch([with_seed(short, i) for i in range(runs)]).observers[0][:, -1, -3:]
    np.testing.assert_allclose(theirs.std(axis=0), ours.std(axis=0), rtol=0.15)
    assert len(np.unique(theirs, axis=0)) == runs


def test_the_python_equations_are_the_products(short):
    """All 19 derivatives agree at random states and inputs."""
    program = joined(short.plant, short.estimators[0].program)
    order = [
        "x.x1",
        "x.x2",
        *(f"Upsilon.{i}.{j}" for i in range(2) for j in range(3)),
        *(f"Gamma.{i}.{j}" for i in range(3) for j in range(i, 3)),
        *ESTIMATES[2:],
    ]
    inputs = ["u.u", *(f"signal.phi{i}" for i in (1, 2, 3)), *(f"theta.theta{i}" for i in (1, 2, 3)), "noise.y.y"]
    rng = np.random.default_rng(5)
    for _ in range(20):
        s, w = rng.uniform(-0.1, 1.0, 19), rng.normal(size=8)
        s[0] += 0.2
        values = short.parameters | short.estimators[0].parameters | {"t": 0.0}
        values |= dict(zip(order, s, strict=True)) | dict(zip(inputs, w, strict=True))
        found = dict(zip(program.states, evaluate(program.graph, list(program.update), values), strict=True))
        np.testing.assert_allclose(rates(s.tolist(), w.tolist()), [found[n] for n in order], rtol=1e-11, atol=1e-12)


@pytest.mark.parametrize("method", ["RK45", "DOP853"])
def test_solve_ivp_solves_the_same_problem(short, method: str):
    """It agrees over 0.3 s, restarted at each jump of inputs and noise."""
    answer = others.by_scipy(rows(short)[:30], start(short), method)
    np.testing.assert_allclose(answer[PLACES], expected(short, 30), rtol=0, atol=others.CLOSE)


def test_python_control_solves_the_same_problem(short):
    """It agrees over 0.3 s, integrated between jumps."""
    pytest.importorskip("control", reason="it is installed by make bench")
    answer = others.by_control(rows(short)[:30], start(short))()
    np.testing.assert_allclose(answer[PLACES], expected(short, 30), rtol=0, atol=others.CLOSE)


def expected(e, pieces: int) -> np.ndarray:
    call, names = kernels_alone(e)
    return call()[pieces * HOLD // e.every - 1, [names.index(n) for n in ESTIMATES]]


def test_a_batch_in_which_everything_differs_shares_no_state():
    """All 19 states are in the lanes."""
    base = engine(horizon=1.0)
    parts = _Lanes([kernels.varied(base, i, 4) for i in range(4)], 0).parts
    assert parts.shared is None and len(parts.lanes.states) == 19


def test_a_new_text_is_not_cached_and_gives_estimates():
    """Two draws differ in every equation, and each is parsed, compiled and run."""
    draw = random.Random(1)
    first, second = (compilation.fresh("zhao-contois", "zhao-adaptive", draw) for _ in range(2))
    assert all(first["plant"]["dynamics"][s] != second["plant"]["dynamics"][s] for s in ("x1", "x2"))
    assert compilation.first_estimate(first) > 0


def test_the_service_benchmark_requests_a_new_run_with_all_figures(tmp_path: Path):
    """One round against a real service: start, run and figures."""
    with service.service(tmp_path) as (address, seconds):
        figure = service.whole(address, count=1)
    assert seconds > 0 and figure.median > 0 and "10 figures" in figure.what


def test_rounds_measure_every_contender_in_every_round():
    """Ratios are computed within each round."""
    seconds = rounds({"a": lambda: None, "b": lambda: sum(range(1000))}, 3)
    assert {k: len(v) for k, v in seconds.items()} == {"a": 3, "b": 3}
    assert ratios({"a": [2.0, 6.0], "b": [1.0, 2.0]}, "a", "b", 0.5) == [1.0, 1.5]


def test_a_benchmark_prints_median_and_range():
    """As a line, and as a row of the table in docs/performance.md."""
    figure = Figure.of("what", [3.0, 1.0, 2.0], "≤ 2.5")
    assert (figure.median, figure.low, figure.high) == (2.0, 1.0, 3.0)
    assert figure.markdown() == "| what | 2 | 1 … 3 | ≤ 2.5 |"
    assert Figure.of("t", [0.0123], unit="ms").range() == "12.3 ms … 12.3 ms"


def test_an_unknown_benchmark_is_refused_by_name(monkeypatch, capsys):
    """The message lists the known ones."""
    monkeypatch.setattr("sys.argv", ["benchmarks", "kernel"])
    with pytest.raises(SystemExit):
        command.main()
    assert f"choose from {', '.join(command.NAMES)}" in capsys.readouterr().err
