"""Units never matter: the same experiment in other units gives the same θ̂, the same bands and the same findings.

A few examples run by default. THETASCOPE_UNITS=3 rewrites every library plant in 3 random systems of units, with every
observer that fits, its default gains and the whole diagnosis, and every experiment of the library with the gains that
it gives; that takes a quarter of an hour.
"""

import os
from collections.abc import Iterator

import numpy as np
import pytest

from tests.engine.plants import oscillator
from tests.units.rescaling import Units, random_units, rescaled
from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.errors import SpecError
from thetascope.engine.model.result import Result
from thetascope.engine.observers.registry import kinds
from thetascope_schemas import ObserverConfig, ResolvedExperiment

TOLERANCE = 1e-6
MANY = int(os.environ.get("THETASCOPE_UNITS", "0"))
PLANTS = (
    "contois-physical",
    "dc-motor",
    "dts200",
    "friction-motor",
    "loop-actuator",
    "loop-sensor",
    "quadruple-tank",
    "reduced-order-mimo",
    "shen-hu-2015",
    "zhao-2012",
    "zhou-tan-2012",
)
CHANNELS = {  # those that the library's observers estimate; with all of them these plants are not identifiable
    "dc-motor": "gain_loss,load_torque,friction_increase,current_bias",
    "dts200": "pump1,pump2,leak1,clog32,level3",
    "quadruple-tank": "pump1,pump2,leak1,level2",
}
NOISE = 1e-9  # of a typical fault: θ̂ that is exactly 0 in one system of units is rounding noise in another
MOST = 12  # observers of one experiment
GENERAL = ("adaptive-kalman", "adaptive-kalman-discrete", "joint-ekf", "joint-ukf")


def batched(items: tuple[str, ...], most: int) -> list[tuple[str, ...]]:
    """Return items in groups of at most `most`."""
    return [items[i : i + most] for i in range(0, len(items), most)]


def plain(spec: ResolvedExperiment, **changes) -> ResolvedExperiment:
    """The experiment without declared scales, observers and figures."""
    data = spec.model_dump(mode="json") | {"observers": [], "figures": [], "commands": []} | changes
    for group in ("states", "outputs"):
        for item in data["plant"][group]:
            item["scale"] = None
    return ResolvedExperiment.model_validate(data)


def with_observers(spec: ResolvedExperiment, candidates: tuple[str, ...], channels: str = "") -> ResolvedExperiment:
    """The experiment with every candidate that fits its plant, with default gains."""
    fitting = []
    for kind in candidates:
        options = {"channels": channels} if channels and kind in GENERAL else {}
        config = ObserverConfig(label=f"o{len(fitting)}", kind=kind, options=options)
        try:
            prepare(spec.model_copy(update={"observers": (config,)}))
        except SpecError:
            continue
        fitting.append(config)
    return spec.model_copy(update={"observers": tuple(fitting)})


def differences(spec: ResolvedExperiment, units: Units) -> list:
    """Everything in which the run in other units differs."""
    return list(compared(spec, units, prepare(spec).run(), prepare(rescaled(spec, units)).run()))


def compared(spec: ResolvedExperiment, units: Units, old: Result, new: Result) -> Iterator[tuple]:
    """Yield the columns of θ̂, its band and x̂, the findings and the verdicts that differ between two runs."""
    typical = {f"theta.{channel.name}": channel.typical for channel in spec.plant.channels}
    for name, before in zip(old.names, old.data, strict=True):
        label, _, rest = name.partition(".")
        if not rest.startswith(("theta.", "sigma.", "x.")):
            continue
        after = new.column(name) / units.of(rest.partition(".")[2])
        finite = np.isfinite(before)
        size = np.abs(before[finite]).max(initial=NOISE / TOLERANCE * typical.get(rest, 0.0))
        if (finite != np.isfinite(after)).any() or np.abs((after - before)[finite]).max(initial=0) > TOLERANCE * size:
            yield name, size, np.abs((after - before)[finite]).max(initial=0)
    for one, other in zip(old.observers, new.observers, strict=True):
        if (one.diverged is None) != (other.diverged is None):
            yield one.label, one.diverged, other.diverged
    if old.diagnosis is None or new.diagnosis is None:
        return
    pairs = zip(
        [old.diagnosis["detector"], *old.diagnosis["observers"]],
        [new.diagnosis["detector"], *new.diagnosis["observers"]],
        strict=True,
    )
    for before, after in pairs:
        one, other = findings(before, Units()), findings(after, units)
        if (
            [f[:3] for f in one] != [f[:3] for f in other]
            or one
            and not np.allclose(*([f[3:] for f in o] for o in (one, other)), rtol=TOLERANCE, atol=0)
        ):
            yield before["observer"], one, other


def findings(report: dict, units: Units) -> list[tuple]:
    """The alarms of a report in the old units."""
    told = []
    for alarm in report["alarms"]:
        size = units.of(alarm["channel"])
        numbers = [alarm[name] / units.time for name in ("t", "onset")]
        numbers += [(alarm[name] or 0.0) / size for name in ("size", "size_from", "size_to")]
        numbers += [alarm["statistic"], alarm["threshold"]]
        told.append((alarm["kind"], alarm["channel"], tuple(alarm["alternatives"]), *numbers))
    return told


@pytest.mark.parametrize("seed", range(2))
def test_estimates_and_bands_are_the_same_in_any_units(seed):
    """An oscillator in units of 1e-12 … 1e12, with offsets of its output and another speed, under seven observers."""
    given = {
        "plant": oscillator(),
        "inputs": {"u": {"kind": "pulse", "low": -1, "high": 1, "period": 4, "width": 2}},
        "faults": [{"channel": "force", "shape": "step", "onset": 3.0, "size": 0.5}],
        "noise": {"y": {"std": 0.01, "sample_time": 0.01}},
        "horizon": 8.0,
        "step": 0.01,
        "diagnosis": {"enabled": False},
    }
    spec = with_observers(
        ResolvedExperiment.model_validate(given),
        (
            *("zhao-adaptive", "adaptive-kalman-discrete", "joint-ekf", "joint-ukf"),
            *("proportional-integral", "extended-state", "drem"),
        ),
    )
    assert len(spec.observers) == 7
    assert differences(spec, random_units(spec, seed)) == []


def test_reconstructed_faults_are_the_same_in_any_units():
    """Two lags in series, whose first is measured, under the observers that need matched faults."""
    given = {
        "plant": {
            "id": "lags",
            "states": [{"name": "a"}, {"name": "b"}],
            "inputs": [{"name": "u"}],
            "outputs": [{"name": "y", "expression": "2*a"}],
            "dynamics": {"a": "b - 3*a", "b": "u - b"},
            "channels": [{"name": "inflow", "kind": "process", "enters": {"a": "0.5"}, "typical": 0.4}],
        },
        "inputs": {"u": {"kind": "pulse", "low": 0, "high": 1, "period": 4, "width": 2}},
        "faults": [{"channel": "inflow", "shape": "step", "onset": 3.0, "size": 0.5}],
        "noise": {"y": {"std": 0.01, "sample_time": 0.01}},
        "horizon": 8.0,
        "step": 0.01,
        "diagnosis": {"enabled": False},
    }
    spec = with_observers(ResolvedExperiment.model_validate(given), ("sliding-mode", "unknown-input"))
    assert len(spec.observers) == 2
    assert differences(spec, random_units(spec, 4)) == []


def test_findings_are_the_same_in_any_units():
    """The detector names the same fault at the same time with the same size, interval and threshold."""
    spec = plain(library.resolve(library.experiment("friction-motor")), horizon=14.0)
    assert prepare(spec).run().diagnosis["detector"]["alarms"]
    assert differences(spec, random_units(spec, 5)) == []


def test_pascals_diverge_no_more_than_bars():
    """A state of 1e6 Pa is not a divergence: the joint EKF finds the fault as it does in bar."""
    plant = {
        "id": "vessel",
        "states": [{"name": "x", "unit": "Pa", "initial": 1e6, "domain": [-5e6, 5e6]}],
        "inputs": [{"name": "u"}],
        "outputs": [{"name": "y", "expression": "x"}],
        "parameters": [{"name": "k", "value": 1e6}],
        "dynamics": {"x": "-x+k*u"},
        "channels": [{"name": "a", "kind": "actuator", "enters": {"x": "k"}, "typical": 0.3}],
    }
    given = {
        "plant": plant,
        "inputs": {"u": {"kind": "pulse", "low": -1, "high": 1, "period": 7, "width": 3.5}},
        "horizon": 20,
        "step": 0.01,
        "evaluate": 0.02,
        "noise": {"y": {"std": 2e4, "sample_time": 0.02}},
        "faults": [{"channel": "a", "shape": "step", "onset": 8, "size": 0.3}],
        "diagnosis": {"enabled": False},
    }
    spec = with_observers(ResolvedExperiment.model_validate(given), ("joint-ekf",))
    run = prepare(spec).run()
    theta, sigma = run.column("o0.theta.a")[-1], run.column("o0.sigma.a")[-1]
    assert abs(theta - 0.3) < 4 * sigma < 0.3
    assert differences(spec, Units({"x": 1e-5, "y": 1e-5, "k": 1e-5})) == []


def test_the_memory_of_an_operator_may_be_in_another_unit():
    """A backlash whose previous input is kept in µm and whose previous output in km is still a sandwich system."""
    spec = plain(library.resolve(library.experiment("zhou-tan-2012")), horizon=1.0, diagnosis={"enabled": False})
    spec = with_observers(spec, ("sandwich-nonsmooth", "sandwich-conventional"))
    assert len(spec.observers) == 2
    assert differences(spec, Units({"x12m": 1e6, "z1m": 1e-3, "z5m": 1e-3})) == []


@pytest.mark.skipif(not MANY, reason="THETASCOPE_UNITS is not set")
@pytest.mark.parametrize("seed", range(MANY))
@pytest.mark.parametrize("name", sorted(library.experiments()))
def test_every_library_experiment_is_the_same_in_any_units(name, seed):
    """The observers of an experiment with the gains that it gives them, converted by their dimensions.

    One form is left out: as printed, Shen & Hu's example adds quantities of unlike units.
    """
    data = library.resolve(library.experiment(name)).model_dump(mode="json") | {"figures": [], "commands": []}
    data["observers"] = [o for o in data["observers"] if o["options"].get("form") != "paper-example"]
    spec = ResolvedExperiment.model_validate(data)
    assert differences(spec, random_units(spec, seed)) == []


@pytest.mark.skipif(not MANY, reason="THETASCOPE_UNITS is not set")
@pytest.mark.parametrize("seed", range(MANY))
@pytest.mark.parametrize("name", PLANTS)
def test_every_library_plant_is_the_same_in_any_units(name, seed):
    """All observers that fit, their defaults, the detector and the tests on θ̂ agree to 1e-6."""
    bare = plain(library.resolve(library.experiment(name)))
    for some in batched(kinds(), MOST):
        spec = with_observers(bare, some, CHANNELS.get(name, ""))
        assert differences(spec, random_units(spec, seed)) == []
