"""The observers of sandwich systems (Zhou & Tan 2012): the paper's plant, one with unequal slopes, invalid texts."""

import copy

import numpy as np
import pytest

from tests.reference import zhou_tan
from tests.simulate import simulate
from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.errors import SpecError
from thetascope.engine.observers.forms.sandwich_parts import memory_names
from thetascope_schemas import Experiment

LINEAR = ("x11", "x12", "x21", "x22")
K = np.array([0.0, 0.0, 0.1, 0.1])
START = np.array([5.0, 0.2, 0.5, 0.02])

OTHER = {
    "id": "other",
    "time": {"kind": "discrete", "period": 0.01},
    # memory first and L2 before L1: the parts are found by what feeds what, not by their order
    "states": [{"name": n, "scale": 1} for n in ("before", "q1", "q2", "q3", "x21", "x22", "x11", "x12")],
    "inputs": [{"name": "u"}],
    "parameters": [{"name": "gap", "value": 0.03}, {"name": "b", "value": 0.4}],
    "definitions": [
        {"name": "rate", "expression": "x12 - before"},
        {"name": "r1", "expression": "backlash(x12, rate, q1, 1.2, 1.0, gap, 0.02)"},
        {"name": "r2", "expression": "backlash(x12, rate, q2, 1.0, 1.1, 0.02, 0.025)"},
    ],
    "outputs": [{"name": "y", "expression": "x22", "scale": 1}],
    "dynamics": {
        "before": "x12",
        "q1": "r1",
        "q2": "r2",
        "q3": "backlash(x12, rate, q3, 0.9, 0.9, 0.01, 0.01)",
        "x11": "0.7*x11 + 0.05*x12 + 0.3*u",
        "x12": "0.04*x11 + 0.5*x12",
        "x21": "0.75*x21 - 0.02*x22 + b*(0.5*r1 + 0.8*r2 + 0.3*backlash(x12, rate, q3, 0.9, 0.9, 0.01, 0.01))",
        "x22": "0.05*x21 + 0.85*x22",
    },
}


def wave(amplitude, steps=1000):
    """Return u(k) as the reference uses it."""
    return amplitude * np.sin(2 * np.pi * 0.01 * np.arange(steps))


def paper(id="zhou-tan-2012", **changes):
    return simulate(library.resolve(Experiment.model_validate(library.experiment(id).model_dump() | changes)))


def linear_states(run, label):
    prefix = f"{label}." if label else ""
    return np.stack([run.column(f"{prefix}x.{s}") for s in LINEAR], axis=1)


def other(plant=OTHER, kind="sandwich-nonsmooth", amplitude=2.0, **observer):
    config = {
        "label": "o",
        "kind": kind,
        "gains": {"K": [0.1, 0.1, 0.0, 0.0]},
        "initial": {"x11": 1.0, "x12": 0.2, "x21": 0.5, "x22": 0.1},
    } | observer
    spec = {
        "plant": plant,
        "horizon": 10.0,
        "step": 0.01,
        "observers": [config],
        "inputs": {"u": {"kind": "sine", "amplitude": amplitude, "frequency": 1.0}},
    }
    return prepare(library.resolve(Experiment.model_validate(spec)))


def check(run, name, i=0):
    return next(c for c in run.observers[i].checks if str(c.name) == name)


def test_the_papers_numbers():
    """u = 5 sin: RMSE of x21, x22 for k > 200 below 1e-5, conventional .2888 and .01382; settled from k = 29 and 31."""
    run = paper()
    error = linear_states(run, "") - linear_states(run, "nonsmooth")
    usual = linear_states(run, "") - linear_states(run, "conventional")
    assert np.sqrt((error[201:, 2:] ** 2).mean(axis=0)).max() < 1e-5
    assert np.sqrt((usual[201:, 2:] ** 2).mean(axis=0)) == pytest.approx([0.2888, 0.01382], rel=1e-3)
    last = [np.flatnonzero(np.abs(error[:, i]) >= within)[-1] for i, within in ((2, 0.01), (3, 0.001))]
    assert last == [28, 30]


@pytest.mark.parametrize("amplitude", [1.0, 5.0, 8.0])
def test_plant_and_both_observers_are_those_of_the_reference(amplitude):
    """Every row of x, x̂, ẑ and of the zones, for inputs below and above the threshold."""
    run = paper(inputs={"u": {"kind": "sine", "amplitude": amplitude, "frequency": 1.0}})
    exact = zhou_tan.nonsmooth(zhou_tan.PAPER, wave(amplitude), K, START)
    usual = zhou_tan.conventional(zhou_tan.PAPER, wave(amplitude), exact["y"], K, START, 7.0)
    assert linear_states(run, "") == pytest.approx(exact["x"], abs=1e-12)
    assert linear_states(run, "nonsmooth") == pytest.approx(exact["xhat"], abs=1e-12)
    assert linear_states(run, "conventional") == pytest.approx(usual, abs=1e-12)
    zones = np.stack([run.column(f"nonsmooth.zone.{i}") for i in range(1, 8)], axis=1)
    assert np.array_equal(zones, exact["zonehat"])
    assert run.column("nonsmooth.v") == pytest.approx(exact["zhat"].sum(axis=1), abs=1e-12)
    assert run.column("nonsmooth.x.z3m")[1:] == pytest.approx(exact["zhat"][:-1, 2], abs=1e-12)


def test_with_noise_the_observer_is_the_reference_on_the_same_measurement():
    """With the noise of our run, the reference gives our estimates."""
    run = paper(noise={"y": {"std": 0.01, "sample_time": 0.01}}, seed=4)
    noise = run.column("y.y") - run.column("x.x22")
    assert noise.std() == pytest.approx(0.01, rel=0.1)
    exact = zhou_tan.nonsmooth(zhou_tan.PAPER, wave(5), K, START, y_noise=noise)
    assert linear_states(run, "nonsmooth") == pytest.approx(exact["xhat"], abs=1e-12)


def test_an_undriven_plant_keeps_the_initial_error_of_its_operators():
    """u = sin and x̂12(−1) = 0: the error of x21 is permanent, and the check names the operators responsible."""
    run = paper("zhou-tan-2012-undriven")
    exact = zhou_tan.nonsmooth(zhou_tan.PAPER, wave(1), K, START, before_hat=0.0)
    assert linear_states(run, "nonsmooth") == pytest.approx(exact["xhat"], abs=1e-12)
    assert np.abs(run.column("x.x21") - run.column("nonsmooth.x.x21"))[500:].min() > 0.05
    found = check(run, "every operator reaches its linear zones")
    assert found.verdict == "fails" and found.value == 3 and "1, 2, 3, 4 did not" in str(found.text)


def test_as_printed_the_output_of_the_hysteresis_is_zero():
    """B = 0.004107: no operator of the plant leaves its memory zone."""
    run = paper("zhou-tan-2012-as-printed")
    assert np.abs(run.column("x.x12")).max() < 0.01 and not run.column("y.y").any()


def test_theorem_1_on_the_papers_plant():
    """A11, K1 = 0, A22 − K2 C22 (the paper's eigenvalues .8 ± .0316i), all operators driven, rank 4 and 2."""
    run = paper()
    assert {c.verdict for c in run.observers[0].checks} == {"holds"}
    assert check(run, "A22 − K2 C22 inside the unit circle").value == pytest.approx(abs(0.8 + 0.0316228j), rel=1e-6)
    rank = check(run, "observable with an operator active")
    assert rank.value == 4 and "2 with none" in str(rank.text)
    assert check(run, "no hysteresis", 1).verdict == "fails"


def test_a_gain_on_the_front_part_fails_theorem_1():
    """K1 ≠ 0 is not covered by the proof; the run continues."""
    spec = library.experiment("zhou-tan-2012")
    first = spec.observers[0].model_copy(update={"gains": {"K": [0.5, 0.0, 0.1, 0.1]}})
    run = simulate(library.resolve(spec.model_copy(update={"observers": (first,), "figures": ()})))
    assert check(run, "K1 = 0").verdict == "fails" and check(run, "K1 = 0").value == 0.5


@pytest.mark.parametrize("kind", ["sandwich-nonsmooth", "sandwich-conventional"])
def test_unequal_slopes_and_another_order_of_states(kind):
    """Three operators with m1 ≠ m2, D1 ≠ D2, written as definitions and inline, states shuffled."""
    run = other(kind=kind).run()
    gain, start = np.array([0.0, 0.0, 0.1, 0.1]), np.array([1.0, 0.2, 0.5, 0.1])
    exact = zhou_tan.nonsmooth(zhou_tan.OTHER, wave(2), gain, start)
    expected = exact["xhat"]
    if kind == "sandwich-conventional":
        slope = 0.5 * 1.1 + 0.8 * 1.05 + 0.3 * 0.9
        expected = zhou_tan.conventional(zhou_tan.OTHER, wave(2), exact["y"], gain, start, slope)
    assert linear_states(run, "") == pytest.approx(exact["x"], abs=1e-12)
    assert linear_states(run, "o") == pytest.approx(expected, abs=1e-12)
    facts = run.observers[0].facts
    assert (facts["L1"], facts["L2"]) == (["x11", "x12"], ["x21", "x22"])
    assert facts["memory"] == ["before", "q1", "q2", "q3"]


def test_the_default_gain_follows_the_parts():
    """It is 0 on L1 and 0.1 on L2, in the plant's order of states."""
    given = other().run()
    assert np.array_equal(other(gains={}).run().data, given.data)


def test_the_memory_is_found_without_sympy():
    """The size of K follows from the text alone."""
    assert memory_names(OTHER | {"signals": []}) == ("before", "q1", "q2", "q3")


def spoiled(**dynamics):
    plant = copy.deepcopy(OTHER)
    plant["dynamics"] |= dynamics
    return plant


@pytest.mark.parametrize(
    ("plant", "says"),
    [
        (spoiled(q1="r2"), "q1, is not a state whose next value is that operator"),
        (spoiled(before="x11"), "is not x12 less a state whose next value is x12"),
        (spoiled(x21="0.75*x21 + q1 + r1"), "q1, the memory of an operator, also enters the equation of x21"),
        (spoiled(q1="q1", q2="q2", q3="q3", x21="0.5*x21 + x12"), "no backlash operator"),
    ],
)
def test_a_text_that_is_not_a_sandwich_is_refused_with_the_reason(plant, says):
    """The pattern of memory states is verified; the error states what is wrong and how to write it."""
    with pytest.raises(SpecError, match=says) as caught:
        other(plant=plant)
    assert "backlash(x, x - x_before" in str(caught.value.remedy)


def test_a_gain_of_the_wrong_length_is_refused():
    """K is for the states of L1 and L2, not for the memory."""
    with pytest.raises(SpecError, match="needs 4"):
        other(gains={"K": [0.1] * 8})


# ---- the paper's figure 3, and its conditions 1 and 2 ----------------------------------------------------------------


def test_the_true_output_of_the_hysteresis_is_a_column():
    """Fig. 3: v of seven play operators at the true x12; a record has none. Conditions 1 and 2 are numbers."""
    run = paper()
    x, z, v = run.column("x.x12"), np.zeros(7), []
    width = np.arange(7, 0, -1) / 100
    for value in x:
        z = np.clip(z, value - width, value + width)
        v.append(z.sum())
    np.testing.assert_allclose(run.column("nonsmooth.true.v"), v, atol=1e-12)
    truth = linear_states(run, "")[:, :2]
    error = linear_states(run, "nonsmooth")[0, :2] - truth[0]
    assert check(run, "x1 bounded").value == pytest.approx(np.linalg.norm(truth, axis=1).max())
    assert check(run, "error of x1 at the start bounded").value == pytest.approx(np.linalg.norm(error))


# ---- L1 and L2 of any order ------------------------------------------------------------------------------------------

WIDTHS = (0.05, 0.03, 0.015)


def chained(n1: int, n2: int) -> tuple[dict, np.ndarray, np.ndarray]:
    """Return a plant with chains of n1 states before the hysteresis and n2 behind it, and their matrices."""
    A1 = np.diag([0.75 - 0.05 * i for i in range(n1)]) + np.diag([0.08] * (n1 - 1), -1)
    A2 = np.diag([0.8 - 0.04 * i for i in range(n2)]) + np.diag([0.1] * (n2 - 1), -1)
    front, back = [f"a{i}" for i in range(n1)], [f"b{i}" for i in range(n2)]
    last = front[-1]

    def rows(names: list[str], A: np.ndarray, entry: str) -> dict[str, str]:
        texts = {
            n: " + ".join(f"{A[i, j]:.17g}*{m}" for j, m in enumerate(names) if A[i, j]) for i, n in enumerate(names)
        }
        return texts | {names[0]: f"{texts[names[0]]} + {entry}"}

    memories = [f"z{i}m" for i in range(len(WIDTHS))]
    plant = {
        "id": "chains",
        "time": {"kind": "discrete", "period": 0.01},
        "states": [{"name": n, "scale": 1} for n in (*front, *back, "before", *memories)],
        "inputs": [{"name": "u"}],
        "definitions": [
            {"name": f"z{i}", "expression": f"backlash({last}, {last} - before, z{i}m, 1, 1, {w}, {w})"}
            for i, w in enumerate(WIDTHS)
        ]
        + [{"name": "v", "expression": " + ".join(f"z{i}" for i in range(len(WIDTHS)))}],
        "outputs": [{"name": "y", "expression": back[-1], "scale": 1}],
        "dynamics": rows(front, A1, "0.4*u")
        | rows(back, A2, "0.3*v")
        | {"before": last}
        | {m: f"z{i}" for i, m in enumerate(memories)},
    }
    return plant, A1, A2


@pytest.mark.parametrize(("n1", "n2"), [(1, 1), (3, 2), (1, 4), (4, 1)])
def test_chains_of_any_order_are_observed(n1, n2):
    """The observer is (13) written as a loop over matrices, and its errors vanish, as Theorem 1 says."""
    plant, A1, A2 = chained(n1, n2)
    K2 = np.full(n2, 0.1)
    start = {f"a{i}": 0.5 for i in range(n1)} | {f"b{i}": 0.2 for i in range(n2)}
    result = other(plant, gains={"K": [*np.zeros(n1), *K2]}, initial=start, amplitude=3.0).run()
    width = np.array(WIDTHS)
    a, b, z = np.zeros(n1), np.zeros(n2), np.zeros(len(WIDTHS))
    ahat, bhat, zhat = np.full(n1, 0.5), np.full(n2, 0.2), np.zeros(len(WIDTHS))
    before = 0.5
    for k, u in enumerate(wave(3.0, 400)):
        shown = [result.column(f"o.x.{name}")[k] for name in start]
        np.testing.assert_allclose(shown, [*ahat, *bhat], atol=1e-10)
        z = np.clip(z, a[-1] - width, a[-1] + width)
        last = ahat[-1]  # the memories hold at the start, whatever x̂ is: (6)–(8) are no play operator there
        zhat = np.where((last > before) & (last > zhat + width), last - width, zhat)
        zhat = np.where((last < before) & (last < zhat - width), last + width, zhat)
        r, before = b[-1] - bhat[-1], last
        a, b = A1 @ a + np.eye(n1)[0] * 0.4 * u, A2 @ b + np.eye(n2)[0] * 0.3 * z.sum()
        ahat, bhat = A1 @ ahat + np.eye(n1)[0] * 0.4 * u, A2 @ bhat + np.eye(n2)[0] * 0.3 * zhat.sum() + K2 * r
    for name in start:
        error = result.column(f"o.x.{name}") - result.column(f"x.{name}")
        assert np.abs(error[-100:]).max() < 1e-9, name
    assert result.observers[0].facts["L1"] == [f"a{i}" for i in range(n1)]
