"""An experiment adapted to a live command equals one that is built from scratch."""

import random
from dataclasses import fields

import numpy as np
import pytest
from pydantic import TypeAdapter

from thetascope import library
from thetascope.assembly.build.experiment_builder import engine
from thetascope.assembly.build.incremental import adapted
from thetascope.assembly.build.timed_commands import changed
from thetascope.engine.errors import SpecError
from thetascope.engine.inputs.signals import Signal
from thetascope.engine.simulation.simulation import Simulation
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.experiment.commands import (
    AddObserver,
    RemoveObserver,
    SetGain,
    SetNoise,
    SetSignal,
    SetSubsteps,
)
from thetascope_schemas.experiment.faults import Fault

FAULT = TypeAdapter(Fault)
AT = np.linspace(0.0, 3.0, 301)


def complete(id: str, **changes) -> ResolvedExperiment:
    return library.resolve(library.experiment(id).model_copy(update={"figures": (), **changes}))


def with_fault(spec: ResolvedExperiment, fault) -> ResolvedExperiment:
    return spec.model_copy(update={"faults": (*spec.faults, fault)})


CHANGES = [
    lambda spec, draw: changed(spec, SetGain(at=0, observer="adaptive", gain="rho", value=draw.uniform(2, 12))),
    lambda spec, draw: changed(spec, SetGain(at=0, observer="adaptive", gain="gamma0", value=draw.uniform(0.5, 5))),
    lambda spec, draw: changed(spec, SetNoise(at=0, output="y", std=draw.uniform(0, 0.01))),
    lambda spec, draw: changed(spec, SetSubsteps(at=0, substeps=draw.randrange(1, 5))),
    lambda spec, draw: changed(
        spec, SetSignal(at=0, name="u", signal={"kind": "sine", "amplitude": draw.random(), "frequency": 0.4})
    ),
    lambda spec, draw: changed(
        spec, AddObserver(at=0, observer={"label": f"more{draw.randrange(10**6)}", "kind": "adaptive-kalman"})
    ),
    lambda spec, draw: (
        changed(spec, RemoveObserver(at=0, label=spec.observers[-1].label)) if spec.observers[1:] else spec
    ),
    lambda spec, draw: with_fault(
        spec, FAULT.validate_python({"channel": "theta2", "shape": "step", "onset": 1, "size": draw.random()})
    ),
    lambda spec, draw: with_fault(
        spec,
        FAULT.validate_python(
            {
                "output": "y",
                "shape": "outliers",
                "onset": 0.5,
                "probability": 0.2,
                "size": draw.random(),
                "sample_time": 0.01,
            }
        ),
    ),
    lambda spec, draw: spec.model_copy(update={"faults": spec.faults[1:]}),
    lambda spec, draw: spec.model_copy(update={"seed": draw.randrange(100)}),
]


def assert_same_signal(one: Signal, two: Signal) -> None:
    anchor = AT + 1e-7
    assert (one.held, one.level) == (two.held, two.level)
    np.testing.assert_array_equal(one(AT, anchor), two(AT, anchor))
    np.testing.assert_array_equal(one.breaks(0.0, 3.0), two.breaks(0.0, 3.0))


def assert_same(one, two) -> None:
    """Two experiments of the engine, field by field; signals by their values and discontinuities."""
    for field in fields(one):
        a, b = getattr(one, field.name), getattr(two, field.name)
        if field.name == "signals":
            assert list(a) == list(b)
            for name in a:
                assert_same_signal(a[name], b[name])
        elif field.name == "measurement":
            for part in ("outputs", "std", "sample_time", "seed", "faults", "sample_every"):
                assert getattr(a, part) == getattr(b, part)
            for x, y in zip(a.noises, b.noises, strict=True):
                assert_same_signal(x, y)
        elif field.name == "x0":
            np.testing.assert_array_equal(a, b)
        else:
            assert a == b, field.name


@pytest.mark.parametrize("seed", range(4))
def test_an_adapted_experiment_equals_a_new_one(seed):
    """After each of a random series of changes, every part is equal."""
    draw = random.Random(seed)
    spec = complete("zhao-2012")
    made = engine(spec)
    since: dict[str, int] = {}
    for _ in range(12):
        following = draw.choice(CHANGES)(spec, draw)
        since = {o.label: since.get(o.label, draw.randrange(5)) for o in following.observers}
        adapted_now = adapted(following, since, spec, made)
        assert_same(adapted_now, engine(following, since, made.context.healthy))
        spec, made = following, adapted_now


def test_unaffected_parts_are_kept():
    """A changed gain keeps all signals and the measurement,
    a fault on a channel all observers and the other signals."""
    spec = complete("zhao-2012", faults=())
    made = engine(spec)
    gain = adapted(changed(spec, SetGain(at=0, observer="adaptive", gain="rho", value=7.0)), {}, spec, made)
    assert gain.signals == made.signals and gain.measurement is made.measurement
    assert gain.estimators[0].program is made.estimators[0].program
    fault = FAULT.validate_python({"channel": "theta2", "shape": "step", "onset": 1, "size": 0.1})
    faulty = adapted(with_fault(spec, fault), {}, spec, made)
    assert faulty.estimators[0] is made.estimators[0]
    assert {n for n, s in faulty.signals.items() if s is not made.signals[n]} == {"theta.theta2"}


def test_an_invalid_gain_is_refused_as_in_a_new_experiment():
    """The same field, value and remedy."""
    spec = complete("zhao-2012")
    made = engine(spec)
    for gain, value in (("rh", 1.0), ("rho", -1.0), ("rho", (1.0, 2.0))):
        other = changed(spec, SetGain(at=0, observer="adaptive", gain=gain, value=value))
        with pytest.raises(SpecError) as quick:
            adapted(other, {}, spec, made)
        with pytest.raises(SpecError) as anew:
            engine(other, None, made.context.healthy)
        assert vars(quick.value) == vars(anew.value)


@pytest.mark.parametrize("observers", [(), ("adaptive-kalman", "high-gain")])
def test_the_state_follows_from_recorded_rows(observers):
    """The state at a recorded row equals that of a simulation stopped there, including the memory of sensor faults."""
    spec = complete("zhao-2012")
    more = tuple(spec.observers[0].model_validate({"label": k, "kind": k}) for k in observers)
    experiment = engine(spec.model_copy(update={"observers": (*spec.observers, *more)}))
    simulation = Simulation(experiment, remember=True)
    start, _ = simulation.advance(simulation.initial(), 50 * experiment.every)
    _, rows = simulation.advance(start, 40 * experiment.every)
    for r in (0, 1, 17, 39):
        stopped, _ = simulation.advance(start, r * experiment.every) if r else (start, None)
        recorded = simulation.state_at(start, rows, r)
        assert recorded.k == stopped.k
        for a, b in zip(
            (recorded.plant, *recorded.observers, recorded.memory.passed),
            (stopped.plant, *stopped.observers, stopped.memory.passed),
            strict=True,
        ):
            np.testing.assert_array_equal(a, b)
