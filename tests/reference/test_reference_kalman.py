"""The reference filters against each other and theory, the reference models against published numbers."""

import numpy as np
import pytest
from scipy.linalg import eigvals

from . import integration, kalman, motor, tanks
from .integration import Scenario, constant, derivative, pulse, steps

LINEAR = motor.dc_motor(("gain", "speed"), motor.Parameters(Tc=0.0))  # without Coulomb friction: linear in (x, theta)


def motor_scenario(horizon: float, record: float, noise: tuple = ()) -> Scenario:
    """Voltage and load switch; gain loss of 20 % from 0.2 s, speed bias of 3 rad/s from 0.4 s."""
    theta = [steps([0.2], [0, -0.2]), steps([0.4], [0, 3.0])]
    return Scenario(horizon, record, [pulse(4, 8, 0.5, 0.25)], [pulse(0, 0.02, 0.8, 0.4)], theta, noise)


def motor_gains(lam: float) -> kalman.Gains:
    return kalman.Gains(
        np.diag([1e-3, 1e-2]), np.diag([1e-2, 1e-1]), np.eye(2), np.diag([1.0, 4.0]), lam, np.zeros(2), np.zeros(2)
    )


def test_discrete_adaptive_filter_without_forgetting_is_the_joint_kalman_filter():
    """On a linear plant the separated filter (lam = 1), joint EKF and joint UKF agree (Friedland)."""
    scenario = motor_scenario(0.5, 0.005)
    noise = np.random.default_rng(4).normal(0, 0.1, (101, 2))
    y = kalman.measurements(LINEAR, scenario)["y"] + noise
    separate = kalman.adaptive_discrete(LINEAR, scenario, y, motor_gains(1.0))
    for other in (kalman.joint_ekf, kalman.joint_ukf):
        joint = other(LINEAR, scenario, y, motor_gains(1.0))
        np.testing.assert_allclose(joint["xhat"], separate["xhat"], rtol=1e-6, atol=1e-6)
        np.testing.assert_allclose(joint["thetahat"], separate["thetahat"], rtol=1e-6, atol=1e-6)
        np.testing.assert_allclose(joint["P"][:, 2:, 2:], separate["S"], rtol=1e-6, atol=1e-8)


def test_continuous_adaptive_observer_without_forgetting_is_the_joint_kalman_filter():
    """The same in continuous time (lam = 0): joint Kalman-Bucy filter, one Riccati equation of size n + p."""
    scenario, gains, model = motor_scenario(0.5, 0.05), motor_gains(0.0), LINEAR
    R_inv, Q = np.linalg.inv(gains.R), np.zeros((4, 4))
    Q[:2, :2] = gains.Q

    def bucy(t, o, u, s, y):
        x, theta, P = o[:2], o[2:4], o[4:].reshape(4, 4)
        F = np.vstack([np.hstack([model.A(t, x, u, s, theta), model.Phi(t, x, u, s)]), np.zeros((2, 4))])
        H = np.hstack([model.C(t, x, u, s, theta), model.Psi(t, x, u, s)])
        K = P @ H.T @ R_inv
        drift = np.concatenate([model.rate(t, x, u, s, theta), np.zeros(2)])
        return np.concatenate(
            [drift + K @ (y - model.output(t, x, u, s, theta)), (F @ P + P @ F.T + Q - K @ H @ P).ravel()]
        )

    start = np.block([[gains.P0, np.zeros((2, 2))], [np.zeros((2, 2)), gains.S0]])
    o0 = np.concatenate([np.zeros(4), start.ravel()])
    joint = integration.simulate(model.rate, model.output, model.x0, scenario, bucy, o0, rtol=1e-10)["o"]
    separate = kalman.continuous(model, scenario, gains, rtol=1e-10)
    np.testing.assert_allclose(separate["xhat"], joint[:, :2], atol=1e-6)
    np.testing.assert_allclose(separate["thetahat"], joint[:, 2:4], atol=1e-6)
    np.testing.assert_allclose(separate["Gamma"], joint[:, 4:].reshape(-1, 4, 4)[:, 2:, 2:], atol=1e-6)


@pytest.mark.parametrize("alpha", [1.0, 0.5])
def test_unscented_update_is_exact_for_a_quadratic_output(alpha):
    """For y = x^2 and x ~ N(m, P), beta = 2 gives mean m^2 + P, variance 4 m^2 P + 2 P^2, covariance 2 m P."""
    none = np.zeros((1, 0))
    model = kalman.Model(
        1,
        0,
        1,
        lambda t, x, u, s: 0 * x,
        lambda t, x, u, s: none,
        lambda t, x, u, s: x**2,
        lambda t, x, u, s: none,
        lambda t, x, u, s, theta: np.zeros((1, 1)),
        lambda t, x, u, s, theta: 2 * x[None],
    )
    m, P, R, y = 1.2, 0.3, 0.05, 2.0
    gains = kalman.Gains(
        np.zeros((1, 1)), np.array([[R]]), np.array([[P]]), np.zeros((0, 0)), 1.0, np.array([m]), np.zeros(0)
    )
    found = kalman.joint_ukf(model, Scenario(1.0, 1.0), np.full((2, 1), y), gains, alpha=alpha)
    K = 2 * m * P / (4 * m**2 * P + 2 * P**2 + R)
    assert found["xhat"][1, 0] == pytest.approx(m + K * (y - m**2 - P), rel=1e-12)
    assert found["P"][1, 0, 0] == pytest.approx(P - K * 2 * m * P, rel=1e-12)


MODELS = {
    "dts200": (tanks.dts200(tanks.DTS200_CHANNELS), (60.0, 30.0)),
    "quadruple": (tanks.quadruple(tanks.QUADRUPLE_CHANNELS), (3.0, 3.1)),
    "motor": (motor.dc_motor(motor.CHANNELS), (6.0,)),
}


@pytest.mark.parametrize("name", MODELS)
def test_jacobians_of_models_and_of_the_rk4_map(name):
    """A, and the derivatives of the RK4 map over several substeps, agree with differences, with faults present."""
    model, u = MODELS[name]
    rng = np.random.default_rng(5)
    theta, x = 0.1 * rng.normal(size=model.p), np.array(model.x0) + rng.uniform(0.1, 0.5, model.n)
    scenario = Scenario(1.0, 1.0, [constant(v) for v in u], [constant(0.01)], [constant(0.0)] * model.p)
    s = np.array([0.01])
    slope = derivative(lambda w: model.rate(0, w, np.array(u), s, theta), x)
    np.testing.assert_allclose(model.A(0, x, np.array(u), s, theta), slope, rtol=1e-6, atol=1e-6)
    by_x = derivative(lambda w: kalman.flow(model, scenario, 0, 0.01, w, theta, 3)[0], x)
    by_theta = derivative(lambda w: kalman.flow(model, scenario, 0, 0.01, x, w, 3)[0], theta)
    _, exact_x, exact_theta = kalman.flow(model, scenario, 0, 0.01, x, theta, 3)
    np.testing.assert_allclose(exact_x, by_x, rtol=1e-6, atol=1e-7)
    np.testing.assert_allclose(exact_theta, by_theta, rtol=1e-6, atol=1e-7)


def test_quadruple_tank_is_johanssons():
    """Published minimum-phase setting: time constants (62, 90, 23, 30) s, transmission zeros -0.060 and -0.018."""
    model, h, u = tanks.quadruple(()), np.array([12.4, 12.7, 1.8, 1.4]), np.array([3.0, 3.0])
    A, C = model.A(0, h, u, (), ()), model.C(0, h, u, (), ())
    np.testing.assert_allclose(-1 / np.diag(A), [62, 90, 23, 30], atol=1.0)
    B = derivative(lambda v: model.f(0, h, v, ()), u)
    pencil = np.block([[A, B], [C, np.zeros((2, 2))]])
    zeros = eigvals(pencil, np.diag([1.0, 1, 1, 1, 0, 0]))
    finite = np.sort(zeros[np.isfinite(zeros) & (np.abs(zeros) < 1e3)].real)
    np.testing.assert_allclose(finite, [-0.060, -0.018], rtol=0.05)
    steady = tanks.quadruple_steady()
    np.testing.assert_allclose(model.f(0, steady, u, ()), 0, atol=1e-12)


def test_three_tank_equations():
    """Levels (40, 20, 30) cm: the rates and the effect of each fault, from the numbers of the plant."""
    model, x, u = tanks.dts200(("pump1", "leak2", "clog13", "level3")), np.array([40.0, 20, 30]), np.array([41.0, 31.0])
    q13, q32, q20 = 0.46 * 0.5 * np.sqrt(1962 * 10), 0.45 * 0.5 * np.sqrt(1962 * 10), 0.60 * 0.5 * np.sqrt(1962 * 20)
    np.testing.assert_allclose(154 * model.f(0, x, u, ()), [41 - q13, 31 + q32 - q20, q13 - q32], rtol=1e-12)
    effect = [[41, 0, q13, 0], [0, -np.sqrt(1962 * 20), 0, 0], [0, 0, -q13, 0]]
    np.testing.assert_allclose(154 * model.Phi(0, x, u, ()), effect, rtol=1e-12)
    np.testing.assert_array_equal(model.Psi(0, x, u, ()), [[0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 1]])


def test_all_filters_find_the_faults_of_the_three_tank_system():
    """The three filters find a pump fault, a leak and a sensor fault of the three-tank system at once."""
    model = tanks.dts200(("pump1", "leak2", "level3"))
    theta = [constant(-0.2), constant(0.2), constant(1.0)]
    scenario = Scenario(300, 1.0, [pulse(20, 60, 100, 50), pulse(20, 50, 70, 35)], (), theta)
    y, eye = kalman.measurements(model, scenario, rtol=1e-9)["y"], np.eye(3)
    gains = kalman.Gains(0.01 * eye, 0.01 * eye, eye, eye, 0.97, np.array([35.0, 25, 30]), np.zeros(3), 1e-6 * eye)
    found = kalman.adaptive_discrete(model, scenario, y, gains)
    np.testing.assert_allclose(found["thetahat"][-1], [-0.2, 0.2, 1.0], atol=0.01)
    for joint in (kalman.joint_ekf, kalman.joint_ukf):
        found = joint(model, scenario, y, gains)
        np.testing.assert_allclose(found["thetahat"][-1], [-0.2, 0.2, 1.0], atol=0.1)


def test_continuous_adaptive_kalman_finds_faults_of_a_nonlinear_motor():
    """With forgetting, gain loss and speed bias of the motor with Coulomb friction are found; RK4 agrees."""
    model = motor.dc_motor(("gain", "speed"))
    scenario, gains = motor_scenario(3.0, 0.05), motor_gains(6.0)
    fine = kalman.continuous(model, scenario, gains, rtol=1e-8)
    np.testing.assert_allclose(fine["thetahat"][-1], [-0.2, 3.0], atol=2e-3)
    short = kalman.continuous(model, motor_scenario(0.5, 0.05), gains, solver=integration.rk4, h=5e-4)
    np.testing.assert_allclose(short["thetahat"], fine["thetahat"][:11], atol=1e-4)
