"""Every observer that fits a plant runs with its default gains, at any speed and with any slope at rest."""

from collections.abc import Iterable

import numpy as np
import pytest

from tests.units.rescaling import Units, gain_factors, random_units, rescaled
from tests.units.test_units import CHANNELS, GENERAL, MANY, MOST, PLANTS, batched, plain, with_observers
from thetascope import library
from thetascope.assembly import prepare
from thetascope.assembly.build.gain_values import from_parameters
from thetascope.engine.observers.registry import kinds
from thetascope.engine.simulation.experiment import Estimator
from thetascope_schemas import ResolvedExperiment

CONSTANT = ("proportional-integral", "extended-state", "sliding-mode", "unknown-input", "drem")
FAST = ("shen-hu-2015", "zhou-tan-2012", "friction-motor", "reduced-order-mimo")
OF_ALL_FAULTS = {("zhao-adaptive", "delta")}  # one level for faults of unlike units, which enters a check only
MORE = pytest.mark.skipif(not MANY, reason="THETASCOPE_UNITS is not set")


@pytest.mark.parametrize("name", [p if p in FAST else pytest.param(p, marks=MORE) for p in PLANTS])
def test_defaults_convert_as_their_units_say(name):
    """In other units every default gain of every observer that fits is the old one, converted by its dimension."""
    bare = plain(library.resolve(library.experiment(name)))
    for some in batched(kinds(), MOST):
        spec = with_observers(bare, some, CHANNELS.get(name, ""))
        units = random_units(spec, 3)
        pairs = zip(prepare(spec).engine.estimators, prepare(rescaled(spec, units)).engine.estimators, strict=True)
        compare_gains(pairs, units)


def compare_gains(pairs: Iterable[tuple[Estimator, Estimator]], units: Units) -> None:
    """Compare the gains of each observer with those in other units."""
    for old, new in pairs:
        for gain in old.kind.gains:
            before, after = (
                np.asarray(from_parameters(gain.name, gain.shape(e.context), e.parameters)) for e in (old, new)
            )
            expected = before * gain_factors(gain, old.context, units)
            close = np.allclose(after, expected, rtol=1e-8, atol=1e-12 * np.abs(expected).max(initial=0.0))
            assert close or (old.kind.id, gain.name) in OF_ALL_FAULTS, (old.kind.id, gain.name)


@pytest.mark.parametrize(
    ("law", "size", "speed"),
    [
        ("u - x^3", 1.0, 1.0),  # no slope at x = 0
        ("(u - x)/1e-5", 1.0, 1e5),
        ("(u - x)/2e4", 3.5e7, 5e-5),
        pytest.param("u - x*abs(x)", 1.0, 1.0, marks=MORE),
        pytest.param("(u - x)/0.3", 3e-14, 3.0, marks=MORE),
    ],
)
def test_defaults_are_admissible(law, size, speed):
    """No default is refused, nothing diverges, and θ̂ of the general observers ends near the fault."""
    plant = {
        "id": "made",
        "states": [{"name": "x", "domain": [-3 * size, 3 * size]}],
        "inputs": [{"name": "u"}],
        "outputs": [{"name": "y", "expression": "x"}],
        "dynamics": {"x": law},
        "channels": [{"name": "a", "kind": "actuator", "enters": {"x": repr(speed)}, "typical": 0.2 * size}],
    }
    given = {
        "plant": plant,
        "inputs": {"u": {"kind": "sine", "amplitude": size, "frequency": 0.3 * speed}},
        "horizon": 30 / speed,
        "step": 0.02 / speed,
        "noise": {"y": {"std": 0.01 * size, "sample_time": 0.02 / speed}},
        "faults": [{"channel": "a", "shape": "step", "onset": 10 / speed, "size": 0.2 * size}],
        "diagnosis": {"enabled": False},
    }
    spec = with_observers(ResolvedExperiment.model_validate(given), kinds())
    names = {o.kind for o in spec.observers}
    assert names >= {"high-gain", "zhao-adaptive", "linear-adaptive", "nonsmooth-adaptive"}
    assert names >= {
        "adaptive-kalman",
        "adaptive-kalman-discrete",
        "joint-ekf",
        "joint-ukf",
        "reduced-order",
        "full-order",
    }
    assert names >= set(CONSTANT)
    result = prepare(spec).run()
    assert [o.kind for o in result.observers if o.diverged] == []
    for report in result.observers:
        if report.kind in (*GENERAL, *CONSTANT, "zhao-adaptive"):
            late = result.column(f"{report.label}.theta.a")[-len(result.column("t")) // 5 :]
            assert np.mean(late) == pytest.approx(0.2 * size, rel=0.5), report.kind
