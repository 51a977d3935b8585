"""The observers of Shen & Hu 2015: the paper's example, a chain of three states, the matching condition."""

import numpy as np
import pytest

from tests.reference import shen_hu
from tests.simulate import simulate
from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.errors import SpecError
from thetascope.engine.observers.forms.matching_condition import find_P, lyapunov_margin, matched_gains
from thetascope_schemas import Experiment

CHAIN = {
    "id": "chain",
    "states": [{"name": "x1", "initial": 0.5}, {"name": "x2", "initial": -0.5}, {"name": "x3", "initial": 1.0}],
    "signals": [{"name": "w1"}, {"name": "w2"}],
    "parameters": [{"name": "b", "value": 4.0}],
    "outputs": [{"name": "y", "expression": "x1"}],
    "dynamics": {
        "x1": "x2 - 0.5*x1",
        "x2": "x3 - 0.5*x2 + 0.2*sin(x1)",
        "x3": "-0.5*x3 + 0.2*cos(x2)",
    },
    "channels": [
        {"name": "theta1", "kind": "process", "enters": {"x1": "w1", "x2": "b*w1", "x3": "3.75*w1"}},
        {"name": "theta2", "kind": "process", "enters": {"x1": "w2", "x2": "b*w2", "x3": "3.75*w2"}},
    ],
}
ZERO = {"x1": 0.0, "x2": 0.0, "x3": 0.0}


def chain(kind="nonsmooth-adaptive", plant=CHAIN, horizon=20.0, faults=True, **observer):
    """Return the reference's CHAIN as an experiment."""
    return Experiment.model_validate(
        {
            "plant": plant,
            "signals": {
                "w1": {"kind": "expression", "text": "sin(t) - cos(t)"},
                "w2": {"kind": "expression", "text": "cos(2.3*t)"},
            },
            "faults": [
                {"channel": "theta1", "shape": "step", "onset": 0.0, "size": 0.8},
                {"channel": "theta2", "shape": "step", "onset": 0.0, "size": -0.5},
            ][: len(plant["channels"]) if faults else 0],
            "horizon": horizon,
            "evaluate": 0.01,
            "observers": [{"label": "o", "kind": kind, "initial": ZERO} | observer],
        }
    )


def paper(id="shen-hu-2015-noise-free", **changes):
    return simulate(library.resolve(library.experiment(id).model_copy(update=changes)))


def errors(run, label):
    return [run.column(f"x.{s}") - run.column(f"{label}.x.{s}") for s in ("x1", "x2")] + [
        run.column("theta.theta") - run.column(f"{label}.theta.theta")
    ]


def settled(run, error, within):
    """Return the time after which |error| stays below ``within``."""
    outside = np.flatnonzero(np.abs(error) >= within)
    return run.column("t")[outside[-1] + 1]


def estimates(run, states, channels):
    return np.stack(
        [run.column(f"o.{c}") for c in (*(f"x.{s}" for s in states), *(f"theta.{c}" for c in channels))], axis=1
    )


def verdicts(run, i=0):
    return {str(c.name): c.verdict for c in run.observers[i].checks}


@pytest.mark.parametrize(("label", "times"), [("nonsmooth", (4.82, 5.26, 5.23)), ("linear", (5.92, 6.82, 6.53))])
def test_the_papers_example_settles_when_an_independent_computation_does(label, times):
    """Noise-free, |e1|, |e2| and |θ̃| stay below 1e-2 from these times on (± 0.1 s)."""
    run = paper(horizon=40.0)
    found = [settled(run, e, 1e-2) for e in errors(run, label)]
    assert found == pytest.approx(times, abs=0.05)


def test_near_zero_the_linear_observers_overtake_the_nonsmooth_one():
    """Below 1e-3 the nonsmooth error is algebraic: 1e-4 is reached far later than by either linear observer."""
    run = paper()
    times = {o.label: settled(run, errors(run, o.label)[2], 1e-4) for o in run.observers}
    assert times["nonsmooth"] > times["linear"] + 5 and times["nonsmooth"] > times["linear-fair"] + 5


def test_the_linear_observers_agree_with_dop853():
    """Both baselines follow an independent integration at tight tolerance to 1e-9."""
    run = paper(horizon=10.0, evaluate=0.01)
    for label, gains in (("linear", shen_hu.PAPER_GAINS.linear()), ("linear-fair", shen_hu.PAPER_GAINS.linear_fair())):
        exact = shen_hu.dop853(scenario=shen_hu.paper_scenario(horizon=10.0), gains=gains)
        assert run.column(f"{label}.x.x2") == pytest.approx(exact["xhat"][:, 1], abs=1e-9)
        assert run.column(f"{label}.theta.theta") == pytest.approx(exact["thetahat"][:, 0], abs=1e-9)


@pytest.mark.parametrize("gains", [shen_hu.PAPER_GAINS, shen_hu.Gains((4.0, 5.0), 0.5, 0.7, 20.0)])
def test_the_nonsmooth_observer_agrees_with_dop853_off_its_corner(gains):
    """The slope of ⌊e⌉^α is unbounded at 0, which costs digits at each sign change of e1; also for other gains."""
    config = {"K": list(gains.K), "rho": gains.rho, "alpha": gains.alpha, "lambda": gains.lam, "e0": 1.0}
    first = library.experiment("shen-hu-2015-noise-free").observers[0].model_copy(update={"gains": config})
    run = paper(horizon=10.0, evaluate=0.01, observers=(first,), figures=())
    exact = shen_hu.dop853(scenario=shen_hu.paper_scenario(horizon=10.0), gains=gains)
    assert run.column("nonsmooth.x.x2") == pytest.approx(exact["xhat"][:, 1], abs=3e-5)
    assert run.column("nonsmooth.theta.theta") == pytest.approx(exact["thetahat"][:, 0], abs=3e-5)


def test_with_noise_the_run_is_the_reference_with_the_same_noise():
    """With the noise of our run, a plain RK4 of (11)–(12) gives our estimates."""
    run = paper("shen-hu-2015", horizon=5.0, evaluate=0.01)
    noise = run.column("y.y") - run.column("x.x1")
    assert noise.std() == pytest.approx(0.1, rel=0.1)
    scenario = shen_hu.paper_scenario(horizon=5.0, noise=(tuple(noise), 0.01))
    exact = shen_hu.rk4(scenario=scenario, h=1e-3)
    assert run.column("nonsmooth.theta.theta") == pytest.approx(exact["thetahat"][:, 0], abs=1e-7)


def test_a_chain_of_three_states_and_two_parameters():
    """(11)–(12) for n = 3, p = 2, the direction depending on a parameter of the plant, against DOP853."""
    gains = shen_hu.CHAIN_GAINS
    config = {"K": list(gains.K), "rho": gains.rho, "alpha": gains.alpha, "lambda": gains.lam, "e0": 1.0}
    run = simulate(library.resolve(chain(gains=config)))
    exact = shen_hu.dop853(shen_hu.CHAIN, shen_hu.chain_scenario(), gains)
    expected = np.hstack([exact["xhat"], exact["thetahat"]])
    assert estimates(run, ZERO, ("theta1", "theta2")) == pytest.approx(expected, abs=1e-5)
    assert run.column("o.theta.theta1")[-1] == pytest.approx(0.8, abs=1e-2)
    found = verdicts(run)
    assert found["matching condition"] == found["Lyapunov inequality"] == found["1 − 1/n < α < 1"] == "holds"


def test_the_linear_baseline_on_the_chain():
    """The same with ρ = 0, to 1e-8."""
    gains = shen_hu.CHAIN_GAINS
    run = simulate(library.resolve(chain("linear-adaptive", gains={"K": list(gains.K), "lambda": gains.lam})))
    exact = shen_hu.dop853(shen_hu.CHAIN, shen_hu.chain_scenario(), gains.linear())
    assert estimates(run, ZERO, ("theta1", "theta2")) == pytest.approx(
        np.hstack([exact["xhat"], exact["thetahat"]]), abs=1e-8
    )


def test_the_option_uses_the_printed_equations():
    """Section 3 as printed: no 0.1 sin, exponent 2α − 1 twice, ρ² for ρ k2."""
    run = paper("shen-hu-2015-as-printed", horizon=6.0, evaluate=0.01)
    h, s, rows = 1e-3, np.array([1.0, -1.0, 0.0, 0.0, 0.0]), []

    def rhs(t, s):
        x1, x2, a, b, th = s
        w, e = np.sin(t) - np.cos(t), x1 - a
        power = np.sign(e) * abs(e) ** 0.7
        return np.array(
            [
                x2 + 0.1 * np.sin(x1 * x2) + w,
                w,
                b + 3 * e + 3 * 0.8 * power + w * th,
                w * th + 2 * e + 0.8**2 * power,
                10 * w * e,
            ]
        )

    for k in range(6001):
        if k % 10 == 0:
            rows.append(s)
        t = k * h
        k1 = rhs(t, s)
        k2 = rhs(t + h / 2, s + h / 2 * k1)
        k3 = rhs(t + h / 2, s + h / 2 * k2)
        s = s + h / 6 * (k1 + 2 * k2 + 2 * k3 + rhs(t + h, s + h * k3))
    assert run.column("as-printed.theta.theta") == pytest.approx(np.array(rows)[:, 4], abs=1e-7)
    assert run.column("as-printed.x.x2") == pytest.approx(np.array(rows)[:, 3], abs=1e-7)


# ---- the matching condition ------------------------------------------------------------------------------------------


def test_the_papers_matching_condition_is_exact():
    """P = [[1+b, −b], [−b, b]] with b > 1/8, g = w; (6) as printed fails for every K."""
    P = find_P((3.0, 2.0), (1.0, 1.0))
    b = P[1, 1]
    assert pytest.approx(np.array([[1 + b, -b], [-b, b]]), abs=1e-12) == P and b > 1 / 8
    assert shen_hu.lyapunov_margin(P, (3.0, 2.0)) < 0
    found = verdicts(paper(horizon=1.0))
    assert found["matching condition"] == "holds" and found["inequality (6) as printed"] == "fails"


def test_P_is_found_exactly_where_the_transfer_function_is_strictly_positive_real():
    """Kalman, Yakubovich, Popov: against (1 + ω²) Re G(jω) > 0 on a fine grid, random plants and gains, n = 2, 3, 4."""
    rng, found = np.random.default_rng(1), []
    omega = np.concatenate([[0.0], np.geomspace(1e-3, 1e4, 4000)])
    for _ in range(120):
        n = int(rng.integers(2, 5))
        K, d = np.poly(-rng.uniform(0.2, 3, n))[1:], np.poly(-rng.uniform(-0.1, 3, n - 1))
        G = np.polyval(d, 1j * omega) / np.polyval([1, *K], 1j * omega)
        level = (G.real * (1 + omega**2)).min()
        if abs(level) < 1e-2:
            continue  # too near the border to tell on a grid
        P = find_P(K, d)
        assert (P is not None) == (level > 0)
        found.append(P is not None)
        if P is not None:
            assert P @ d == pytest.approx(np.eye(n)[0], abs=1e-9)
            assert np.linalg.eigvalsh(P)[0] > 0 and lyapunov_margin(P, K) < 0
    assert 20 < sum(found) < len(found) - 20


def strictly_positive_real(K: np.ndarray, d: np.ndarray) -> bool:
    """Return whether N/D is: D stable, and Re N(jω) D(−jω), a polynomial in ω², without a root in ω² ≥ 0."""
    n = len(K)
    if np.roots([1, *K]).real.max() >= 0:
        return False
    product = np.polymul(d * 1j ** np.arange(n - 1, -1, -1), np.conj([1, *K] * 1j ** np.arange(n, -1, -1))).real
    even = product[1::2]
    roots = np.roots(even)
    crossed = (np.abs(roots.imag) < 1e-9 * np.abs(roots)) & (roots.real >= 0)
    return bool(even[0] > 0 and even[-1] > 0 and not crossed.any())


def test_P_is_found_in_any_units_of_time():
    """600 random K and d, n = 2 … 6, rates from 1e-4 to 1e4, complex poles: P exactly where a polynomial says so."""
    rng, found = np.random.default_rng(7), 0
    for _ in range(600):
        n, rate = int(rng.integers(2, 7)), 10 ** rng.uniform(-4, 4)
        turned = 10 ** rng.uniform(-0.7, 0.7) * np.exp(1j * rng.uniform(0, 1.3))
        poles = np.r_[10 ** rng.uniform(-0.7, 0.7, n - 2), turned, np.conj(turned)]
        K, d = np.poly(-poles).real[1:], np.poly(-(10 ** rng.uniform(-1, 1, n - 1)))
        P = find_P(K * rate ** np.arange(1, n + 1), d * rate ** np.arange(n))
        assert (P is not None) == strictly_positive_real(K, d), (K, d)
        if P is not None:
            found += 1
            P *= np.outer(rate ** np.arange(n), rate ** np.arange(n))  # back to the units of K and d
            assert P @ d == pytest.approx(np.eye(n)[0], abs=1e-6)
            assert np.linalg.eigvalsh(P)[0] > 0 and lyapunov_margin(P, K) < 0
    assert 100 < found < 500


@pytest.mark.parametrize("d", [(1, 3), (1, 6), (1, 5, 10), (1, 0.2), (1, 0.7, 1.6), (1, 40, 500, 2000)])
def test_the_gains_are_moved_until_there_is_a_P(d: tuple[float, ...]):
    """Poles at −1, −2 … do not suit every direction; wherever the zeros of d are stable there are some that do."""
    wished = np.poly(-np.arange(1.0, len(d) + 1))[1:]
    K = matched_gains(wished, d)
    assert strictly_positive_real(K, np.array(d, dtype=float)) and find_P(K, d) is not None
    assert (wished == K).all() == strictly_positive_real(wished, np.array(d, dtype=float))


def test_default_gains_satisfy_the_inequality_for_the_direction_of_the_plant():
    """A plant whose faults enter along (1, 6): the default K of both observers has a P, in any unit of time."""
    for rate in (1.0, 1e-3):
        plant = {
            "id": "steep",
            "states": [{"name": "x1", "initial": 0.1}, {"name": "x2", "initial": 0.0}],
            "inputs": [{"name": "u"}],
            "outputs": [{"name": "y", "expression": "x1"}],
            "dynamics": {"x1": "x2", "x2": f"{-2 * rate}*x2 - {rate**2}*x1 + {rate**2}*u"},
            "channels": [{"name": "f", "kind": "process", "enters": {"x1": rate, "x2": 6 * rate**2}}],
        }
        data = {"plant": plant, "horizon": 2 / rate, "step": 0.01 / rate, "record": 0.1 / rate}
        for kind in ("linear-adaptive", "nonsmooth-adaptive"):
            observers = [{"label": "a", "kind": kind}]
            run = simulate(library.resolve(Experiment.model_validate(data | {"observers": observers})))
            found = {str(check.name): check.verdict for check in run.observers[0].checks}
            assert found["Lyapunov inequality"] == "holds" and found["matching condition"] == "holds"


def test_columns_of_different_directions_fail_the_matching_condition():
    """A failed assumption is a warning with its reason; the observer runs."""
    bent = CHAIN | {"channels": [CHAIN["channels"][0], CHAIN["channels"][1] | {"enters": {"x1": "w2", "x2": "w2"}}]}
    run = simulate(library.resolve(chain(plant=bent, horizon=1.0)))
    check = next(c for c in run.observers[0].checks if str(c.name) == "matching condition")
    assert check.verdict == "fails" and "different vectors" in str(check.text)
    assert np.isfinite(run.data).all()


def test_gains_too_small_for_the_direction_fail_the_inequality():
    """For a direction with unstable zeros no K suffices, and the check says so."""
    unstable = CHAIN | {"channels": [CHAIN["channels"][0] | {"enters": {"x1": "w1", "x2": "-b*w1", "x3": "3.75*w1"}}]}
    spec = chain(plant=unstable, horizon=1.0)
    check = next(c for c in simulate(library.resolve(spec)).observers[0].checks if str(c.name) == "Lyapunov inequality")
    assert check.verdict == "fails" and "no K helps" in str(check.text)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"outputs": [{"name": "y", "expression": "x2"}]}, "not a constant multiple of its first state x1"),
        (
            {"outputs": [{"name": "y", "expression": "x1"}, {"name": "z", "expression": "x2"}]},
            "not a constant multiple of its first state",
        ),
        ({"channels": [{"name": "theta1", "kind": "process", "enters": {"x2": "w1"}}]}, "would never move"),
        ({"channels": [{"name": "theta1", "kind": "sensor", "enters": {"y": "1"}}]}, "enters the output"),
        ({"channels": []}, "no fault channel"),
    ],
)
def test_a_plant_that_is_not_of_the_form_is_refused_with_the_reason(change, says):
    """The observer cannot be built, and the error names the obstacle and a remedy."""
    spec = chain(plant=CHAIN | change, faults=False)
    with pytest.raises(SpecError, match=says) as caught:
        prepare(library.resolve(spec))
    assert "adaptive-kalman" in str(caught.value.remedy)


def test_the_printed_example_is_for_two_states():
    """The option form is refused for n = 3."""
    with pytest.raises(SpecError, match="two states"):
        prepare(library.resolve(chain(options={"form": "paper-example"})))
