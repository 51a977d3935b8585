"""Runs of one point of a study differ by their seeds only, and are built once: each is as if it were built alone."""

import numpy as np
import pytest

from thetascope import library
from thetascope.assembly import prepare
from thetascope.assembly.build.prepare import prepare_seed
from thetascope.engine.execution.plain_columns import plain_run
from thetascope_schemas import Experiment

WALK = {"channel": "theta1", "shape": "random-walk", "onset": 1.0, "intensity": 0.01, "sample_time": 0.1}
STEP = {"channel": "theta3", "shape": "step", "onset": 1.0, "size": 0.02}
SPECS = {
    "noise": {"experiment": "zhao-2012", "faults": [STEP]},
    "a random fault": {"experiment": "zhao-2012", "faults": [STEP, WALK]},
    "process noise": {"experiment": "zhao-2012", "truth": {"process_noise": {"x1": 0.01}}},
    "parameters of the truth by chance": {"experiment": "zhao-2012", "truth": {"deviation": 0.05}},
    "a closed loop": {"experiment": "loop-sensor"},
}


def spec_of(changes):
    data = library.experiment(changes["experiment"]).model_dump(mode="json", exclude={"figures", "notes"})
    data |= {name: value for name, value in changes.items() if name != "experiment"}
    return library.resolve(Experiment.model_validate(data | {"horizon": 4.0}))


@pytest.mark.parametrize("changes", SPECS.values(), ids=SPECS)
def test_a_run_built_from_another_seed_has_the_numbers_of_one_built_alone(changes):
    """Every column is the same to the last bit, and differs from that of the other seed."""
    spec = spec_of(changes)
    first = prepare(spec)
    other = spec.model_copy(update={"seed": spec.seed + 7})
    built, alone, before = (plain_run(one.engine) for one in (prepare_seed(first, other), prepare(other), first))
    assert built.names == alone.names and np.array_equal(built.data, alone.data, equal_nan=True)
    assert not np.array_equal(built.data, before.data, equal_nan=True)


def test_hashes_of_seeds_are_those_of_the_experiments():
    """`spec_hashes` gives the id of the experiment with each seed."""
    spec = spec_of(SPECS["a random fault"])
    seeds = [0, spec.seed, 12345]
    assert spec.spec_hashes(seeds) == [spec.model_copy(update={"seed": seed}).spec_hash() for seed in seeds]
