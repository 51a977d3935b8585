"""The reduced-order observer (17): the paper's plant, another with blocks of 3 and 2, and normal forms."""

import numpy as np
import pytest

from tests.engine.observers.normal_form_cases import STATES, carts, carts_pace, carts_spec
from tests.reference import reduced_order
from tests.simulate import simulate
from thetascope import library
from thetascope.engine.errors import SpecError
from thetascope.engine.model.plant_model import Model
from thetascope.engine.observers.forms.normal_form import normal_form
from thetascope_schemas import Experiment, Plant


def paper(**changes):
    return simulate(library.resolve(library.experiment("reduced-order-mimo").model_copy(update=changes)))


def errors(run, label="reduced"):
    """Return e2 and e4 with e = x̂ − x, as in the paper."""
    return np.stack([run.column(f"{label}.x.{s}") - run.column(f"x.{s}") for s in ("x2", "x4")], axis=1)


def with_gain(H, **initial):
    """Return the paper's experiment with another H and other initial estimates, for the reduced observer alone."""
    spec = library.experiment("reduced-order-mimo")
    first = spec.observers[0].model_copy(update={"gains": {"H": H}, "initial": {"x2": -2.0, "x4": 3.5} | initial})
    return simulate(library.resolve(spec.model_copy(update={"observers": (first,), "figures": ()})))


@pytest.mark.parametrize(
    ("time", "expected"), [(0.0, (-2.0, 3.0)), (0.5, (-0.0555, 0.0849)), (1.0, (-0.00824, 0.001155))]
)
def test_the_papers_errors_at_three_times(time, expected):
    """(e2, e4) agree with an independent computation to 1 %."""
    run = paper()
    assert errors(run)[round(time / 0.001)] == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize(
    ("H", "initial"), [([5.0, 8.0], {}), ([9.0, 6.0], {"x2": 1.0, "x4": -1.0}), ([20.0, 20.0], {"x2": 0.5})]
)
def test_the_errors_follow_their_exact_equation(H, initial):
    """e2' = −(H1 − 1) e2 + 2 x4 e4 + e4², e4' = −(H2 − 1) e4 + e2 sin t, integrated by DOP853 along the plant."""
    run = with_gain(H, **initial)
    start = {"x2": -2.0, "x4": 3.5} | initial
    exact = reduced_order.paper_errors(run.column("t"), H, (start["x2"] - 0.0, start["x4"] - 0.5))
    assert errors(run) == pytest.approx(exact, abs=1e-8)


def test_measured_states_are_not_estimated():
    """x̂1 and x̂3 are the measurements, whatever the initial estimates are."""
    run = with_gain([5.0, 8.0], x1=7.0, x3=-4.0)
    assert np.array_equal(run.column("reduced.x.x1"), run.column("y.y1"))
    assert np.array_equal(run.column("reduced.x.x3"), run.column("y.y2"))
    assert errors(run)[0] == pytest.approx((-2.0, 3.0))


def test_the_divergence_of_the_plant_is_reported():
    """The plant itself escapes at t ≈ 2.515 s, and the result has the time."""
    run = paper(horizon=3.0)
    assert run.diverged is not None and run.diverged.time == pytest.approx(2.515, abs=0.01)
    assert np.isnan(run.column("x.x1")[-1]) and np.isfinite(run.column("x.x1")[2400])


def test_some_gains_never_converge():
    """Convergence is local: with H = (2, 2) the observer diverges before the plant does, although Ã − HC̃ is stable."""
    run = with_gain([2.0, 2.0])
    report = run.observers[0]
    assert {str(c.name): c.verdict for c in report.checks}["Ã − HC̃ stable"] == "holds"
    assert report.diverged is not None or np.abs(errors(run)[-1]).max() > 1.0


def test_blocks_of_other_sizes():
    """Vector relative degree (3, 2), time-varying, with definitions and a parameter, against DOP853."""
    run = carts("reduced-order", {"H": [12.0, 36.0, 6.0]})
    exact = reduced_order.dop853(
        reduced_order.CARTS, reduced_order.carts_scenario(), ((12.0, 36.0), (6.0,)), xhat0=_carts_start(run)
    )
    ours = np.stack([run.column(f"o.x.{s}") for s in STATES], axis=1)
    assert ours == pytest.approx(exact["xhat"], abs=1e-7)
    assert run.observers[0].facts["relative degree"] == [3, 2]
    assert ours[-1] == pytest.approx(np.array([run.column(f"x.{s}")[-1] for s in STATES]), abs=1e-3)


def _carts_start(run):
    """Return the initial estimate of the run: measured states from y(0), the others as given."""
    return tuple(float(run.column(f"o.x.{s}")[0]) for s in STATES)


def test_initial_estimates_are_in_the_users_coordinates():
    """x̂2, x̂3 and x̂5 start at the given values; the measured x1 and x4 start at y(0)."""
    assert _carts_start(carts("reduced-order", {}, horizon=0.01)) == pytest.approx((0.5, 0.3, -0.5, -0.3, 0.4))


def test_the_default_gain_is_stable_for_any_blocks():
    """Without gains, Ã − HC̃ has all its eigenvalues at −5 times the plant's rate."""
    run = carts("reduced-order", {}, horizon=1.0)
    check = next(c for c in run.observers[0].checks if str(c.name) == "Ã − HC̃ stable")
    assert check.verdict == "holds" and check.value == pytest.approx(-5 * carts_pace("reduced-order", 1.0), rel=1e-3)


def test_the_decoupling_matrix_is_followed_along_the_run():
    """The reported value is the smallest |det F| = (1 + .2 cos x̂2)(1 + .2 sin t) of the run."""
    run = carts("reduced-order", {"H": [12.0, 36.0, 6.0]})
    check = next(c for c in run.observers[0].checks if str(c.name) == "decoupling matrix nonsingular")
    expected = ((1 + 0.2 * np.cos(run.column("o.x.x2"))) * (1 + 0.2 * np.sin(run.column("t")))).min()
    assert check.verdict == "holds" and check.value == pytest.approx(expected, rel=1e-9)


# ---- finding the normal form -----------------------------------------------------------------------------------------


def model(states, dynamics, outputs, inputs=("u",), **more):
    """Return a model from short forms."""
    plant = {
        "id": "small",
        "states": [s if isinstance(s, dict) else {"name": s} for s in states],
        "inputs": [{"name": u} for u in inputs],
        "outputs": [{"name": f"y{i + 1}", "expression": e} for i, e in enumerate(outputs)],
        "dynamics": dict(zip((s["name"] if isinstance(s, dict) else s for s in states), dynamics, strict=True)),
    }
    return Model(Plant.model_validate(plant | more).model_dump(mode="json"))


def inverse_is_right(form, point):
    """T(T⁻¹(z)) = z at a point."""
    at = form.T.subs(point)
    back = [e.subs(dict(zip(form.z, at, strict=True))).subs(point) for e in form.inverse.values()]
    assert [float(b) for b in back] == pytest.approx([float(point[x]) for x in form.inverse])


def test_two_tanks_are_inverted_through_their_square_roots():
    """z2 is affine in √h1: h1 follows by squaring."""
    tank = [
        {"name": "h1", "initial": 4.0, "domain": [0.0, None]},
        {"name": "h2", "initial": 2.0, "domain": [0.0, None]},
    ]
    m = model(tank, ["u - 0.5*sqrt(h1)", "0.5*sqrt(h1) - 0.4*sqrt(h2)"], ["h2"])
    form = normal_form(m)
    assert form.blocks == (2,)
    inverse_is_right(form, {m.x[0]: 3.0, m.x[1]: 1.5})


def test_outputs_that_mix_states_are_solved_together():
    """y1 = x1 + x2, y2 = x1 − x2 and their derivatives are affine in the states together."""
    m = model(
        ["x1", "x2", "x3", "x4"], ["x3", "x4", "u1 - x1^3", "u2 + t*x3"], ["x1 + x2", "x1 - 2*x2"], inputs=("u1", "u2")
    )
    form = normal_form(m)
    assert form.blocks == (2, 2)
    inverse_is_right(form, dict(zip(m.x, (0.3, -0.7, 1.1, 0.4), strict=True)))


def test_odd_powers_exponentials_and_logarithms_are_inverted():
    """x2³ + exp(x1) and log are inverted one operation at a time."""
    m = model(["x1", "x2", "x3"], ["spow(x2, 3)", "2*exp(x3) - x1", "u"], ["x1"])
    form = normal_form(m)
    assert form.blocks == (3,)
    inverse_is_right(form, dict(zip(m.x, (0.3, 0.7, -0.2), strict=True)))


def test_a_plant_without_inputs_has_as_many_derivatives_as_states():
    """If no input enters, the chain ends when a derivative adds nothing new (van der Pol)."""
    assert normal_form(model(["x1", "x2"], ["x2", "(1 - x1^2)*x2 - x1"], ["x1"], inputs=())).blocks == (2,)


def test_states_called_like_coordinates_do_not_collide():
    """A plant may have states named z1 and z2."""
    m = model(["z1", "z2"], ["2*z2 + z1", "u"], ["z1"])
    inverse_is_right(normal_form(m), dict(zip(m.x, (0.3, 0.8), strict=True)))


@pytest.mark.parametrize(
    ("plant", "says"),
    [
        (
            {"states": ["x1", "x2"], "dynamics": ["u - x1", "x1 - x2"], "outputs": ["x1"]},
            r"relative degree \(1\) sums to 1",
        ),
        ({"states": ["x1", "x2"], "dynamics": ["x2", "u"], "outputs": ["x1 + u"]}, "enters its output y1 directly"),
        ({"states": ["x1", "x2"], "dynamics": ["x2^2", "u"], "outputs": ["x1"]}, "leaves its sign open"),
        (
            {"states": ["x1", "x2"], "dynamics": ["x2 + sin(x2)", "u"], "outputs": ["x1"]},
            "could not be solved for x: .* x2 is in several places",
        ),
        (
            {
                "states": ["x1", "x2"],
                "dynamics": ["u", "x1"],
                "outputs": ["x2"],
                "time": {"kind": "discrete", "period": 0.1},
            },
            "discrete-time",
        ),
    ],
)
def test_a_plant_without_normal_form_is_refused_with_the_reason(plant, says):
    """SpecError with the reason and a remedy."""
    with pytest.raises(SpecError, match=says) as caught:
        normal_form(model(**plant))
    assert "adaptive-kalman" in str(caught.value.remedy)


def test_an_output_for_every_state_leaves_nothing_to_estimate():
    """If all states are measured, ω is empty and x̂ is the measurement."""
    spec = {
        "plant": {
            "id": "measured",
            "states": [{"name": "x1", "initial": 1.0}],
            "inputs": [{"name": "u"}],
            "outputs": [{"name": "y", "expression": "2*x1"}],
            "dynamics": {"x1": "u - x1"},
        },
        "horizon": 1.0,
        "step": 0.01,
        "observers": [{"label": "o", "kind": "reduced-order"}],
    }
    run = simulate(library.resolve(Experiment.model_validate(spec)))
    assert run.column("o.x.x1") == pytest.approx(run.column("x.x1"), abs=1e-12)


# ---- Remarks 1 and 3 -------------------------------------------------------------------------------------------------


def check(run, code):
    return next(c for c in run.observers[0].checks if c.name.code == code)


def with_poles(kind, poles, **gains):
    """Return a run of an observer of the carts with wished poles: blocks of 2 and 1, or of 3 and 2 for full order."""
    observer = carts_spec(kind, gains).observers[0].model_dump() | {"options": {"poles": poles}}
    return carts(kind, {}, horizon=0.5, observers=[observer])


@pytest.mark.parametrize(
    ("kind", "poles", "blocks"),
    [
        ("reduced-order", "-4, -3, -6", [[-4, -3], [-6]]),
        ("reduced-order", "−3 ± 2j; -5", [[-3 + 2j, -3 - 2j], [-5]]),
        ("full-order", "-9, -8+1i, -8-1i, -7, -7.5", [[-9, -8 + 1j, -8 - 1j], [-7, -7.5]]),
    ],
)
def test_gains_come_from_wished_poles(kind, poles, blocks):
    """Remark 3: the eigenvalues of Ã − HC̃ (A − LC) are the wished ones, block after block."""
    run = with_poles(kind, poles)
    name = "Ã − HC̃ stable" if kind == "reduced-order" else "A − LC stable"
    shown = next(c for c in run.observers[0].checks if str(c.name) == name)
    wished = np.sort_complex([p for block in blocks for p in block])
    found = np.sort_complex([complex(e.replace(" ", "")) for e in shown.text.args["eigenvalues"]])
    np.testing.assert_allclose(found, wished, rtol=2e-3, atol=1e-6)


@pytest.mark.parametrize(
    ("poles", "words"),
    [
        ("-4, -3", "2 poles are given, 3 are needed"),
        ("-4, x, -3", "'x' is no pole"),
        ("-4, 3, -3", "3 is not in the left half plane"),
        ("-4, -3±2j", "no conjugate pairs"),
        ("__import__('os')", "is no pole"),
    ],
)
def test_poles_that_cannot_be_are_refused(poles, words):
    """Too few, none, unstable ones, and half a pair in a block; text is read, never evaluated."""
    with pytest.raises(SpecError) as refused:
        with_poles("reduced-order", poles)
    assert refused.value.field.endswith("options.poles") and words in str(refused.value)


def test_poles_and_gains_exclude_each_other():
    """Nobody has to know which of them wins."""
    with pytest.raises(SpecError, match="both given"):
        with_poles("reduced-order", "-4, -3, -6", H=[7.0, 12.0, 6.0])


def slopes_of_the_paper(run):
    """Return ∂(α + F u)/∂(ẑ2, ẑ4) by hand.

    z2' = z2 + sin t x̂2 − (2 + cos t)(x̂4² + …), z4' = z4 + sin t x̂2 + …, x̂2 = (y1 − ẑ2)/(2 + cos t), x̂4 = ẑ4 − y2.
    """
    t, x4 = run.column("t"), run.column("reduced.x.x4")
    scale, made = 2 + np.cos(t), np.empty((len(t), 2, 2))
    made[:, 0, 0], made[:, 0, 1] = 1 - np.sin(t) / scale, -2 * scale * x4
    made[:, 1, 0], made[:, 1, 1] = -np.sin(t) / scale, 1
    return made


def test_the_errors_of_the_paper_begin_at_the_rates_h_minus_1():
    """The first-order equations have the eigenvalues −(H − 1) at the start, where the print has −H."""
    run = paper()
    shown = check(run, "check.error-matrix")
    assert [float(e) for e in shown.text.args["start"]] == pytest.approx([-7, -4], rel=1e-3)
    assert [float(e) for e in shown.text.args["without"]] == pytest.approx([-8, -5], rel=1e-3)
    exact = np.linalg.eigvals(slopes_of_the_paper(run) - np.diag([5.0, 8.0])).real.max(axis=1)
    assert shown.value == pytest.approx(exact.max(), abs=0.02) and shown.verdict == "cannot tell"


def test_the_bound_of_remark_1_is_that_of_its_formula():
    """α = max Re Λ + γ ‖VB̃‖ ‖V⁻¹‖ for H = diag(5, 8): V is the unit matrix, and γ the largest slope of α + F u."""
    run = paper()
    shown = check(run, "check.reduced-rate")
    gamma = np.linalg.norm(slopes_of_the_paper(run), 2, axis=(1, 2)).max()
    assert shown.text.args["gamma"] == pytest.approx(gamma, rel=0.01)
    assert shown.value == pytest.approx(gamma - 5, rel=0.01) and shown.verdict == "fails"
    assert 5 < shown.text.args["rate"] < 8
    growing = check(with_gain([2.0, 2.0]), "check.reduced-rate")
    assert "rate" not in growing.text.args and growing.text.args["ratio"] == pytest.approx(1.03, abs=0.02)


def test_the_bound_holds_where_its_assumptions_do():
    """On a linear plant γ is exact: the measured rate is at least as fast as the bound of Remark 1."""
    plant = {
        "id": "chain",
        "states": [{"name": "x1"}, {"name": "x2", "initial": 1.0}],
        "inputs": [{"name": "u"}],
        "outputs": [{"name": "y", "expression": "x1"}],
        "dynamics": {"x1": "x2", "x2": "u - 0.5*x2"},
    }
    observer = {"label": "o", "kind": "reduced-order", "options": {"poles": "-3"}, "initial": {"x2": 0.0}}
    spec = {"plant": plant, "horizon": 4.0, "step": 0.01, "observers": [observer]}
    run = simulate(library.resolve(Experiment.model_validate(spec)))
    shown = check(run, "check.reduced-rate")
    assert shown.verdict == "holds" and shown.value == pytest.approx(-2.5, rel=1e-6)
    assert shown.text.args["rate"] == pytest.approx(3.5, rel=1e-3)
