"""The references themselves: against the known numbers of the four papers, each other, and theory."""

from itertools import pairwise

import numpy as np
import pytest

from . import integration, reduced_order, shen_hu, zhao, zhou_tan
from .integration import Scenario, derivative, pulse


def settled(t: np.ndarray, error: np.ndarray, bound: float) -> float:
    """Return the first recorded time from which |error| stays below the bound."""
    return float(t[np.flatnonzero(np.abs(error) >= bound)[-1] + 1])


# --- integration ------------------------------------------------------------------------------------------------------


def test_one_sided_limits_make_a_switched_integral_exact():
    """A switched linear system, integrated by both methods, meets its closed form to rounding and to 4th order."""
    scenario = Scenario(2.0, 0.5, [pulse(0, 1, 1.0, 0.3, start=0.2)])
    exact = np.exp(-(2 - 0.5)) - np.exp(-(2 - 0.2)) + np.exp(-(2 - 1.5)) - np.exp(-(2 - 1.2))
    errors = []
    for solver, options in ((integration.dop853, {}), (integration.rk4, {"h": 0.1}), (integration.rk4, {"h": 0.05})):
        x = solver(lambda t, x, inside: scenario.at(t, inside)[0] - x, np.zeros(1), scenario, **options)
        errors.append(abs(x[-1, 0] - exact))
    assert errors[0] < 1e-12
    assert 13 < errors[1] / errors[2] < 19


def test_sampled_measurement_holds_y_between_samples():
    """An observer o' = y sees the sampled staircase of y = x = t, not y itself."""
    scenario = Scenario(1.0, 0.25, sample=0.25)
    for solver in (integration.dop853, integration.rk4):
        out = integration.simulate(
            lambda t, x, u, s, th: np.ones(1),
            lambda t, x, u, s, th: x,
            [0.0],
            scenario,
            lambda t, o, u, s, y: y,
            [0.0],
            solver,
        )
        np.testing.assert_allclose(out["o"][:, 0], [0, 0, 0.0625, 0.1875, 0.375], atol=1e-12)


# --- Zhao, Li, Li 2012 ------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def paper_run() -> dict:
    """The noise-free run of section 4, 100 s; a looser tolerance than the default, within 2e-7 of it, for speed."""
    return zhao.dop853(scenario=zhao.paper_scenario(record=0.025), rtol=1e-7, atol=1e-10)


def test_zhao_injection_is_the_papers_and_stable_for_any_n():
    """(7)-(8) give the printed S and k0 for n = 2, and A0 - k0 c0 is stable for n = 1..6."""
    S, k0 = zhao.injection(2)
    np.testing.assert_allclose(S, [[1, -1], [-1, 2]], atol=1e-12)
    np.testing.assert_allclose(k0, [1, 0.5], atol=1e-12)
    for n in range(1, 7):
        A0, c0 = zhao.chain(n)
        assert np.linalg.eigvals(A0 - np.outer(zhao.injection(n)[1], c0)).real.max() < 0


def test_zhao_estimates_are_the_faults_in_the_three_windows(paper_run):
    """Means of theta_hat to 1e-6 and state RMSE to 1e-7 on [30, 40], [55, 70], [90, 100] s."""
    t = paper_run["t"]
    expected = {(30, 40): (0, 0, 0.02), (55, 70): (0.01, 0, 0.02), (90, 100): (0.01, 0.015, 0.02)}
    for (start, end), theta in expected.items():
        window = (t >= start) & (t < end)
        np.testing.assert_allclose(paper_run["thetahat"][window].mean(axis=0), theta, atol=1e-6)
        rmse = np.sqrt(np.mean((paper_run["xhat"] - paper_run["x"])[window] ** 2, axis=0))
        assert rmse.max() < 1e-7


@pytest.mark.parametrize(
    ("channel", "onset", "end", "size", "time"),
    [(2, 20, 40, 0.02, 0.75), (0, 40, 70, 0.01, 2.35), (1, 70, 100, 0.015, 1.84)],
)
def test_zhao_settling_times(paper_run, channel, onset, end, size, time):
    """Within 10 % of the new value after 0.75, 2.35, 1.84 s."""
    after = (paper_run["t"] >= onset) & (paper_run["t"] < end)
    error = (paper_run["thetahat"] - paper_run["theta"])[after, channel]
    assert settled(paper_run["t"][after], error, 0.1 * size) - onset == pytest.approx(time, abs=0.05)


def test_zhao_errors_decay_at_the_known_rate(paper_run):
    """|theta error| decreases like exp(-1.19 t) after the fault at 40 s, evaluated once per period."""
    whole = np.isin(np.round(paper_run["t"], 6), np.arange(44.0, 59.0))
    error = np.linalg.norm((paper_run["thetahat"] - paper_run["theta"])[whole], axis=1)
    assert np.polyfit(paper_run["t"][whole], np.log(error), 1)[0] == pytest.approx(-1.19, abs=0.03)


def test_zhao_rk4_agrees_with_dop853():
    """From x_hat = 0 RK4 at 1 ms stays within 1e-7 of DOP853; from inside the physical domain it is of 4th order."""
    scenario = zhao.paper_scenario(1.0, 0.05)
    fine, coarse = zhao.dop853(scenario=scenario), zhao.rk4(scenario=scenario)
    for name in ("x", "xhat", "thetahat"):
        np.testing.assert_allclose(coarse[name], fine[name], atol=1e-7)
    inside = zhao.Gains(xhat0=(0.08, 0.02))  # never saturated: the kinks of the saturated f would cost the order
    exact = zhao.dop853(scenario=scenario, gains=inside)["o"]
    errors = [np.abs(zhao.rk4(scenario=scenario, gains=inside, h=h)["o"] - exact).max() for h in (0.025, 0.0125)]
    assert 12 < errors[0] / errors[1] < 20


@pytest.mark.parametrize(("window", "rho", "level"), [(1.0, 4.0, 1.3e-3), (2.0, 4.0, 2.6e-3), (1.0, 32.0, 6e-5)])
def test_zhao_excitation(window, rho, level):
    """Smallest eigenvalue of the Gramian (36): 0.0013 for 1 s, 0.0026 for 2 s, and it decreases as rho increases."""
    gramian = zhao.excitation(zhao.PAPER, zhao.paper_scenario(6.0, 0.25), rho, window, rtol=1e-8)
    assert gramian[8:].min() == pytest.approx(level, rel=0.03)


def test_zhao_high_gain_observer_converges_without_faults_and_not_with_them():
    """(9) reaches the states before the first fault at 20 s and is off by the order of the fault after it."""
    run = zhao.dop853(scenario=zhao.paper_scenario(25.0, 0.1), kind="high-gain", rtol=1e-8)
    error = np.abs(run["xhat"] - run["x"]).max(axis=1)
    assert error[199] < 1e-8 and error[210:].max() > 0.005


def test_contois_coordinates():
    """(43) under the change of coordinates is (44) without faults, and the change inverts."""
    rng = np.random.default_rng(1)
    for a in ((1.0, 1.0, 1.0, 0.1), (1.3, 0.7, 0.9, 0.2)):
        plant = zhao.contois(*a)
        xbar, u = rng.uniform(0.05, 0.5, 2), 0.08
        x = zhao.from_physical(xbar, *a[:2])
        moved = derivative(lambda w, a=a: zhao.from_physical(w, *a[:2]), xbar) @ zhao.contois_physical(xbar, u, *a)
        np.testing.assert_allclose(moved, [x[1] + plant.f(x, [u])[0], plant.f(x, [u])[1]], rtol=1e-7)
        np.testing.assert_allclose(zhao.to_physical(x, *a[:2]), xbar, rtol=1e-12)
        physical = zhao.contois(*a, physical=True).Phi(x, [u], np.array([1.0, 0, 0]))[:, 0]
        change = derivative(lambda w, a=a: zhao.from_physical(w, *a[:2]), xbar)
        np.testing.assert_allclose(physical, change[:, 0], rtol=1e-7)


def test_pendulum_observer_converges_and_rk4_agrees():
    """On another plant, n = 3, all three faults are found; RK4 at 2 ms agrees with DOP853."""
    fine = zhao.dop853(zhao.PENDULUM, zhao.pendulum_scenario(16, 0.1), zhao.PENDULUM_GAINS, rtol=1e-9, atol=1e-11)
    error = np.abs(fine["thetahat"] - fine["theta"])
    assert np.all(error[-1] < [0.02, 0.015, 2e-4])
    short = zhao.rk4(zhao.PENDULUM, zhao.pendulum_scenario(2, 0.1), zhao.PENDULUM_GAINS, h=2e-3)
    np.testing.assert_allclose(short["thetahat"], fine["thetahat"][:21], atol=1e-6)


# --- Shen, Hu 2015 ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("gains", "times"),
    [(shen_hu.PAPER_GAINS, (4.82, 5.26, 5.23)), (shen_hu.PAPER_GAINS.linear(), (5.92, 6.82, 6.53))],
)
def test_shen_hu_settling_times(gains, times):
    """|e1|, |e2|, |theta error| stay below 1e-2 after the known times, nonsmooth and linear; RK4 agrees."""
    fine = shen_hu.dop853(scenario=shen_hu.paper_scenario(20), gains=gains)
    errors = np.hstack([fine["x"] - fine["xhat"], fine["theta"] - fine["thetahat"]])
    for error, time in zip(errors.T, times, strict=True):
        assert settled(fine["t"], error, 1e-2) == pytest.approx(time, abs=0.02)
    coarse = shen_hu.rk4(scenario=shen_hu.paper_scenario(2), gains=gains)
    np.testing.assert_allclose(coarse["o"], fine["o"][:201], atol=2e-6)


def test_shen_hu_nonsmooth_tail_is_algebraic():
    """theta error to the power -3/7 grows linearly in time, theta error ~ t^(-7/3); the linear observer's is gone."""
    scenario, period = shen_hu.paper_scenario(80, 0.05), 2 * np.pi
    ends = {}
    for name, gains in (("nonsmooth", shen_hu.PAPER_GAINS), ("linear", shen_hu.PAPER_GAINS.linear())):
        run = shen_hu.dop853(scenario=scenario, gains=gains, rtol=1e-9)
        error = np.abs(run["theta"] - run["thetahat"])[:, 0]
        starts = np.arange(40.0, 80 - period, period)
        ends[name] = np.array([error[(run["t"] >= a) & (run["t"] < a + period)].max() for a in starts])
    powered = ends["nonsmooth"] ** (-3 / 7)
    assert np.abs(np.polyval(np.polyfit(starts, powered, 1), starts) / powered - 1).max() < 0.01
    assert ends["linear"][-1] < 1e-9
    assert ends["nonsmooth"][-1] > 1e-6


def test_shen_hu_matching_condition():
    """On the paper's plant P needs b > 1/8; the solver finds P there and on the chain, and none where none exists."""
    for b, holds in ((0.12, False), (0.13, True)):
        assert (shen_hu.lyapunov_margin(np.array([[1 + b, -b], [-b, b]]), np.array([3.0, 2.0])) < 0) is holds
    for K, direction in (((3.0, 2.0), (1.0, 1.0)), (shen_hu.CHAIN_GAINS.K, shen_hu.CHAIN.b)):
        P, margin = shen_hu.matching(np.array(K), np.array(direction))
        assert margin > 0 and np.linalg.eigvalsh(P)[0] > 0
        np.testing.assert_allclose(P @ direction, np.eye(len(K))[0], atol=1e-10)
    assert shen_hu.matching(np.array([3.0, 2.0]), np.array([1.0, -1.0]))[1] < 0


def test_shen_hu_chain_converges():
    """On another plant, n = 3 with two parameters, nonsmooth and linear observers converge."""
    for gains in (shen_hu.CHAIN_GAINS, shen_hu.CHAIN_GAINS.linear()):
        run = shen_hu.dop853(shen_hu.CHAIN, shen_hu.chain_scenario(record=0.1), gains, rtol=1e-9)
        assert np.abs(run["xhat"] - run["x"])[-1].max() < 2e-4
        assert np.abs(run["thetahat"] - run["theta"])[-1].max() < 2e-4


# --- reduced order ----------------------------------------------------------------------------------------------------


def test_reduced_order_errors_are_the_exact_ones():
    """(17) on the paper's plant: the known errors at 0, 0.5 and 1 s, and the exact error equations throughout."""
    run = reduced_order.dop853()
    error = (run["xhat"] - run["x"])[:, [1, 3]]
    np.testing.assert_allclose(error[[0, 50, 100]], [(-2, 3), (-0.0555, 0.0849), (-0.00824, 0.001155)], rtol=0.01)
    np.testing.assert_allclose(error, reduced_order.paper_errors(run["t"]), atol=1e-8)
    np.testing.assert_allclose(reduced_order.rk4()["o"], run["o"], atol=1e-8)


def test_normal_forms_are_the_plants():
    """z' computed from the plant's own equations by the chain rule is A z + B (alpha + F u), at random points."""
    rng = np.random.default_rng(2)
    for plant in (reduced_order.PAPER, reduced_order.CARTS):
        x, u, t = rng.uniform(-1, 1, plant.n), rng.uniform(-1, 1, 2), 0.7
        z = plant.to_z(t, x)
        by_t = derivative(lambda w, plant=plant, x=x: plant.to_z(w[0], x), np.array([0.7]))[:, 0]
        moved = by_t + derivative(lambda w, plant=plant: plant.to_z(0.7, w), x) @ plant.f(t, x, u)
        expected = np.append(z[1:], 0.0)
        expected[plant.lasts] = plant.drift(t, z, u)
        np.testing.assert_allclose(moved, expected, atol=1e-7)
        np.testing.assert_allclose(plant.from_z(t, z), x, atol=1e-12)


@pytest.mark.parametrize(("kind", "gains"), [("reduced", ((12, 36), (6,))), ("full", ((15, 75, 125), (8, 16)))])
def test_carts_observers_converge(kind, gains):
    """Both observers converge on the second MIMO plant, and RK4 agrees with DOP853."""
    args = (reduced_order.CARTS, reduced_order.carts_scenario(5.0, 0.05), gains, (0.5, 1.0, -1.0, -0.3, -1.0))
    fine, coarse = reduced_order.dop853(*args, kind=kind), reduced_order.rk4(*args, kind=kind, h=5e-3)
    assert np.abs(fine["xhat"] - fine["x"])[-1].max() < 1e-6
    np.testing.assert_allclose(coarse["o"], fine["o"], atol=1e-5)


# --- Zhou, Tan 2012 ---------------------------------------------------------------------------------------------------

GAIN, START = np.array([0, 0, 0.1, 0.1]), np.array([5, 0.2, 0.5, 0.02])


def wave(amplitude: float) -> np.ndarray:
    """u(k) = amplitude sin(2 pi k T), T = 0.01 s, N = 1000."""
    return amplitude * np.sin(2 * np.pi * 0.01 * np.arange(1000))


def test_zhou_tan_numbers():
    """u = 5 sin: non-smooth RMSE < 1e-5, conventional 0.2888 and 0.01382, settled from k = 29 and 31."""
    run = zhou_tan.nonsmooth(zhou_tan.PAPER, wave(5), GAIN, START)
    k, error = np.arange(1001), run["x"] - run["xhat"]
    assert np.sqrt(np.mean(error[201:, 2:] ** 2, axis=0)).max() < 1e-5
    assert (settled(k, error[:, 2], 0.01), settled(k, error[:, 3], 0.001)) == (29, 31)
    usual = run["x"] - zhou_tan.conventional(zhou_tan.PAPER, wave(5), run["y"], GAIN, START, 7.0)
    np.testing.assert_allclose(np.sqrt(np.mean(usual[201:, 2:] ** 2, axis=0)), [0.2888, 0.01382], rtol=1e-3)


def test_zhou_tan_needs_every_operator_driven():
    """u = sin leaves the wider operators unmoved; an estimate that once moved them stays wrong."""
    jump = zhou_tan.nonsmooth(zhou_tan.PAPER, wave(1), GAIN, START, before_hat=0.0)
    assert np.abs(jump["x"] - jump["xhat"])[500:, 2].min() > 0.05
    assert np.abs(jump["zone"][:, 0]).max() == 0 < np.abs(jump["zone"][:, 6]).max()
    held = zhou_tan.nonsmooth(zhou_tan.PAPER, wave(1), GAIN, START)  # x_hat_12 only falls from 0.2: none is moved
    assert np.abs(held["x"] - held["xhat"])[500:].max() < 1e-12


def test_zhou_tan_operators_are_play_operators():
    """For equal slopes and a consistent start, (6)-(9) is the play operator max(x - D, min(x + D, z))."""
    D, z, rng = zhou_tan.PAPER.D1, np.zeros(7), np.random.default_rng(3)
    x = np.concatenate([[0.0], np.cumsum(rng.normal(0, 0.03, 300))])
    for before, now in pairwise(x):
        play = np.maximum(now - D, np.minimum(now + D, z))
        z, _ = zhou_tan.operators(zhou_tan.PAPER, now, before, z)
        np.testing.assert_allclose(z, play, atol=1e-15)


def test_zhou_tan_observability_and_other_plant():
    """Rank 4 with one operator active, 2 with none; the observer also converges on a plant with m1 != m2."""
    assert zhou_tan.frozen_rank(zhou_tan.PAPER, np.eye(7)[3]) == 4
    assert zhou_tan.frozen_rank(zhou_tan.PAPER, np.zeros(7)) == 2
    run = zhou_tan.nonsmooth(zhou_tan.OTHER, wave(2), GAIN, np.array([1, 0.2, 0.5, 0.1]))
    assert np.abs(run["x"] - run["xhat"])[300:].max() < 1e-9
    assert all(np.any(run["zone"] == zone) for zone in (zhou_tan.LINEAR_UP, zhou_tan.LINEAR_DOWN, zhou_tan.MEMORY))
