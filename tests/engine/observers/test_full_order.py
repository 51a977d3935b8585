"""The full-order observer in the normal form, against independent integrations on two plants."""

import numpy as np
import pytest

from tests.engine.observers.normal_form_cases import START, STATES, carts, carts_pace
from tests.reference import reduced_order
from tests.simulate import simulate
from thetascope import library


@pytest.mark.parametrize("L", [[20.0, 100.0, 20.0, 100.0], [30.0, 225.0, 16.0, 64.0]])
def test_on_the_papers_plant_it_agrees_with_dop853(L):
    """ẑ' = Aẑ + B[α + Fu] + L(y − Cẑ) for two gains, estimates in the user's coordinates."""
    spec = library.experiment("reduced-order-mimo")
    observer = spec.observers[1].model_copy(update={"gains": {"L": L}})
    run = simulate(library.resolve(spec.model_copy(update={"observers": (observer,), "figures": (), "evaluate": 0.01})))
    exact = reduced_order.dop853(gains=(L[:2], L[2:]), kind="full")
    ours = np.stack([run.column(f"full.x.x{i}") for i in (1, 2, 3, 4)], axis=1)
    assert ours == pytest.approx(exact["xhat"], abs=1e-7)


def test_on_another_plant_it_agrees_with_dop853():
    """Blocks (3, 2), time-varying; the initial estimate of the measured states is also the user's."""
    run = carts("full-order", {"L": [18.0, 108.0, 216.0, 12.0, 36.0]})
    exact = reduced_order.dop853(
        reduced_order.CARTS,
        reduced_order.carts_scenario(),
        ((18.0, 108.0, 216.0), (12.0, 36.0)),
        xhat0=START,
        kind="full",
    )
    ours = np.stack([run.column(f"o.x.{s}") for s in STATES], axis=1)
    assert ours[0] == pytest.approx(START)
    assert ours == pytest.approx(exact["xhat"], abs=1e-7)


def test_the_reduced_order_observer_converges_faster_on_the_papers_plant():
    """In the library's experiment its errors at 1 s are the smaller ones."""
    run = simulate(library.resolve(library.experiment("reduced-order-mimo")))
    at = {
        label: [abs(run.column(f"{label}.x.{s}") - run.column(f"x.{s}"))[1000] for s in ("x2", "x4")]
        for label in ("reduced", "full")
    }
    assert at["reduced"][1] < at["full"][1] and at["full"][1] < 0.05


def test_its_default_gain_is_stable():
    """Without gains A − LC has all its eigenvalues at −10 times the rate of the plant."""
    run = carts("full-order", {}, horizon=0.5)
    check = next(c for c in run.observers[0].checks if str(c.name) == "A − LC stable")
    assert check.verdict == "holds" and check.value == pytest.approx(-10 * carts_pace("full-order", 0.5), rel=1e-3)
