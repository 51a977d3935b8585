"""The filter of records against independent computations."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.engine.filtering.rig import FAULTS, TYPICAL, noise, outputs, rates, record_filter, rows
from thetascope.engine.filtering.bundles import Faults, Noise, Path, Rows
from thetascope.engine.filtering.onset_bank import watched
from thetascope.engine.filtering.record_filter import FilterResult, part_of

START = np.array([4.0, 2.2])
SPREAD = np.array([[0.2, 0.05], [0.05, 0.3]])


def start(coloured: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return the prediction for the first row."""
    if not coloured:
        return START, SPREAD
    P = np.diag([0.0, 0.0, *noise(True).s2])
    P[:2, :2] = SPREAD
    return np.concatenate([START, np.zeros(2)]), P


def flow(x: np.ndarray, u: float, theta: np.ndarray, width: float) -> np.ndarray:
    """Return the state after an interval, by SciPy."""
    solution = solve_ivp(lambda t, z: rates(z, u, theta), (0, width), x, rtol=1e-11, atol=1e-12, method="DOP853")
    return solution.y[:, -1]


def slopes(function, x: np.ndarray) -> np.ndarray:
    """Return the Jacobian by central differences."""
    return np.stack([(function(x + e) - function(x - e)) / 2e-5 for e in 1e-5 * np.eye(len(x))], axis=1)


def kalman(data: Rows, noise: Noise, coloured: bool) -> tuple[float, np.ndarray, np.ndarray]:
    """Return −2 log L, and the last prediction, by the textbook's matrix form of the extended Kalman filter."""
    z, P = (a.copy() for a in start(coloured))
    n, na, loss = 2, len(z), 0.0
    none = np.zeros(2)
    for k in range(len(data.t)):
        seen = np.isfinite(data.y[k])
        H = np.zeros((2, na))
        H[:, :n] = slopes(lambda x: outputs(x, none), z[:n])
        if coloured:
            H[:, n:] = np.eye(2)
        expected = outputs(z[:n], none) + (z[n:] if coloured else 0.0)
        H, e, R = H[seen], (data.y[k] - expected)[seen], np.diag(noise.r[seen])
        if seen.any():
            S = H @ P @ H.T + R
            loss += float(np.log(np.linalg.det(S)) + e @ np.linalg.solve(S, e))
            K = P @ H.T @ np.linalg.inv(S)
            z, P = z + K @ e, P - K @ S @ K.T
        A, Q = np.zeros((na, na)), np.zeros((na, na))
        A[:n, :n] = slopes(lambda x, k=k: flow(x, data.u[k, 0], none, data.width[k]), z[:n])
        Q[:n, :n] = np.diag(noise.q * data.width[k])
        if data.extra_at[k] >= 0:
            Q[:n, :n] += data.extra[int(data.extra_at[k])]
        ahead = flow(z[:n], data.u[k, 0], none, data.width[k])
        if coloured:
            a = np.exp(-noise.rate * data.width[k])
            A[n:, n:], Q[n:, n:] = np.diag(a), np.diag(noise.s2 * (1 - a**2))
            ahead = np.concatenate([ahead, a * z[n:]])
        z, P = ahead, A @ P @ A.T + Q
    return loss, z, P


@pytest.mark.parametrize("coloured", [False, True])
def test_filter_agrees_with_the_matrix_form(coloured: bool) -> None:
    """−2 log L, prediction and covariance are those of the matrix form with SciPy's integration: unequal intervals,
    missing cells, coloured noise."""
    data = rows(40, steps=20.0)
    result = record_filter().filter(data, noise(coloured), *start(coloured))
    loss, z, P = kalman(data, noise(coloured), coloured)
    np.testing.assert_allclose(result.loss, loss, rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(result.z, z, rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(result.P, P, rtol=1e-5, atol=1e-8)


@pytest.mark.parametrize("coloured", [False, True])
def test_blocks_do_not_change_a_bit(coloured: bool) -> None:
    """Filtering in blocks and scanning in blocks gives the bits of one call."""
    data, filter_, level = rows(60), record_filter(), noise(coloured)
    whole = filter_.filter(data, level, *start(coloured))
    used = np.ones(4)
    bank = filter_.new_bank(1, coloured)
    together = filter_.scan(data, level, whole.path, bank, 0, 1.0, used, np.nan_to_num(whole.path.nu)[None])
    z, P = start(coloured)
    bank, loss, largest = filter_.new_bank(1, coloured), 0.0, []
    for begin, end in pairwise((0, 7, 33, 60)):
        part = part_of(data, begin, end)
        result = filter_.filter(part, level, z, P)
        alarms = filter_.scan(part, level, result.path, bank, begin, 1.0, used, np.nan_to_num(result.path.nu)[None])
        largest.append(alarms.largest)
        z, P, loss = result.z, result.P, loss + result.loss
    assert np.array_equal(z, whole.z)
    assert np.array_equal(P, whole.P)
    assert np.array_equal(np.concatenate(largest), together.largest)
    np.testing.assert_allclose(loss, whole.loss, rtol=1e-13)


@pytest.mark.parametrize("coloured", [False, True])
def test_a_frozen_linearisation_repeats_the_filter(coloured: bool) -> None:
    """On its own linearisation the filter gives the same −2 log L."""
    data, filter_ = rows(50), record_filter()
    result = filter_.filter(data, noise(coloured), *start(coloured))
    again = filter_.filter(data, noise(coloured), *start(coloured), path=result.path, frozen=True)
    np.testing.assert_allclose(again.loss, result.loss, rtol=1e-12)


def undisturbed(count: int) -> Rows:
    """Return rows whose readings are those of the plant: all innovations are zero, and Ω is an exact derivative."""
    data = rows(count)
    return replace(data, y=record_filter().simulate(data, START)[1])


def _course(data: Rows, onset: float) -> tuple[np.ndarray, np.ndarray]:
    interval = np.clip((data.t + data.width - onset) / data.width, 0, 1)
    return interval, (data.t >= onset).astype(float)


@pytest.mark.parametrize("channel", [0, 1])
def test_responses_are_derivatives_of_the_innovations(channel: int) -> None:
    """Ω of a small fault is the change of the innovations of a filter that knows the fault."""
    data, filter_ = undisturbed(50), record_filter()
    result = filter_.filter(data, noise(True), *start(True))
    interval, row = _course(data, 11.3)
    omega = filter_.responses(data, noise(True), result.path, np.array([channel]), interval[None], row[None])[0]
    size = 1e-6 * TYPICAL[channel]
    theta = [np.zeros((50, 2)) for _ in range(2)]
    theta[0][:, channel], theta[1][:, channel] = size * interval, size * row
    known = filter_.filter(data, noise(True), *start(True), faults=Faults(*theta))
    # a filter that knows a fault that is not there errs by −Ω
    changed = -np.nan_to_num(known.path.nu - result.path.nu) / 1e-6
    np.testing.assert_allclose(omega, changed, rtol=1e-4, atol=1e-5 * np.abs(omega).max())


def test_parameters_are_directions_like_faults() -> None:
    """The response to a parameter is the derivative of the innovations by it."""
    data = undisturbed(40)
    filter_ = record_filter(("p.k",), np.array([0.3]))
    result = filter_.filter(data, noise(False), *start(False))
    ones = np.ones((1, 40))
    omega = filter_.responses(data, noise(False), result.path, np.array([0]), ones, ones)[0]
    other = filter_.with_parameters(np.array([0.3 * (1 + 1e-6), 0.2])).filter(data, noise(False), *start(False))
    changed = -np.nan_to_num(other.path.nu - result.path.nu) / 1e-6
    np.testing.assert_allclose(omega, changed, rtol=1e-4, atol=1e-5 * np.abs(omega).max())


def _brute(filter_, data: Rows, result: FilterResult, k0: int, end: int, level: Noise) -> np.ndarray:
    """Return g of the steps and ramps that begin with row k0, at row `end`."""
    since = np.maximum(data.t - data.t[k0], 0.0)
    ramp = np.where(data.t >= data.t[k0], since + data.width / 2, 0.0)
    step = (np.arange(len(data.t)) >= k0).astype(float)
    courses = [(step, step), (ramp, since * step)]
    nu = np.nan_to_num(result.path.nu)[: end + 1]
    g = []
    for interval, row in courses:
        for c in range(2):
            omega = filter_.responses(data, level, result.path, np.array([c]), interval[None], row[None])[0, : end + 1]
            energy = float(np.sum(omega**2))
            g.append(float(np.sum(omega * nu)) ** 2 / energy if energy > 1e-12 else 0.0)
    return np.array(g)


@pytest.mark.parametrize("coloured", [False, True])
def test_the_bank_finds_the_largest_ratio_of_its_onsets(coloured: bool) -> None:
    """In every row the bank's statistic is the largest one of all watched onsets, computed one by one."""
    data, filter_, level = rows(40), record_filter(), noise(coloured)
    result = filter_.filter(data, level, *start(coloured))
    bank = filter_.new_bank(1, coloured)
    alarms = filter_.scan(data, level, result.path, bank, 0, 1.0, np.ones(4), np.nan_to_num(result.path.nu)[None])
    for end in (0, 5, 18, 39):
        onsets = [k0 for k0 in range(end + 1) if all(watched(k0, age) for age in range(1, end - k0 + 1))]
        best = max(_brute(filter_, data, result, k0, end, level).max() for k0 in onsets)
        np.testing.assert_allclose(alarms.largest[end, 0], best, rtol=1e-9, atol=1e-12)


def test_few_onsets_are_watched() -> None:
    """About two onsets for each doubling of the age remain, for any length of a record."""
    kept = [k0 for k0 in range(20_000) if all(watched(k0, 2**j) for j in range(15) if 2**j <= 20_000 - k0)]
    assert len(kept) < 96
    assert all(later < 20_000 - 0.4 * (20_000 - earlier) or later > 19_990 for earlier, later in pairwise(kept))


def test_without_faults_the_statistic_is_chi_squared() -> None:
    """With white innovations a²/b of one column has the distribution of χ² with one degree of freedom."""
    data, filter_ = rows(30), record_filter()
    result = filter_.filter(data, noise(False), *start(False))
    nu = np.random.default_rng(3).standard_normal((4000, 30, 2))
    nu[:, np.isnan(result.path.nu)] = 0.0
    interval, row = _course(data, 0.0)
    omega = filter_.responses(data, noise(False), result.path, np.array([0]), interval[None], row[None])[0]
    g = np.sum(omega * nu, axis=(1, 2)) ** 2 / np.sum(omega**2)
    assert abs(np.mean(g) - 1.0) < 0.1
    assert abs(np.mean(g > 3.841) - 0.05) < 0.012


def test_simulation_agrees_with_scipy() -> None:
    """The open-loop simulation is SciPy's."""
    data = rows(25)
    x, y = record_filter().simulate(data, START)
    at = START
    for k in range(24):
        at = flow(at, data.u[k, 0], np.zeros(2), data.width[k])
        np.testing.assert_allclose(x[k + 1], at, rtol=1e-7)
    np.testing.assert_allclose(y[-1], outputs(x[-1], np.zeros(2)), rtol=1e-12)


def test_the_paths_fields_are_those_of_the_loops() -> None:
    """A new path has every array that the loops write."""
    path = record_filter().new_path(3, True)
    assert {name: getattr(path, name).shape for name in ("F", "J", "K")} == {
        "F": (3, 2, 2),
        "J": (3, 2, len(FAULTS)),
        "K": (3, 2, 4),
    }
    assert set(Path.shapes()) == set(vars(path)) - {"addresses"}


def test_the_stiff_method_has_order_two_and_its_tangents() -> None:
    """ROS2 converges to SciPy's flow with the square of the step, and F and G to the derivatives of the flow."""
    filter_, x = record_filter(), np.array([[4.0, 2.2]])
    width, u = 1.7, np.array([[0.55]])
    exact, errors = flow(x[0], 0.55, np.zeros(2), width), []
    slope = slopes(lambda z: flow(z, 0.55, np.zeros(2), width), x[0])
    for steps in (-4.0, -8.0, -16.0):
        missing = np.full((1, 2), np.nan)
        widths, none = (np.array([a]) for a in (width, -1.0))
        one = Rows(np.zeros(1), widths, np.array([steps]), u, u, missing, none, np.zeros((0, 2, 2)))
        result = filter_.filter(one, noise(False), x[0], SPREAD)
        errors.append([np.abs(result.z - exact).max(), np.abs(result.path.F[0] - slope).max()])
    ratios = np.array(errors[:-1]) / np.array(errors[1:])
    assert ((ratios > 3) & (ratios < 5.5)).all(), ratios
