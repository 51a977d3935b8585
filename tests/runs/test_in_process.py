"""`from thetascope import run`: experiments in the caller's own process."""

import subprocess
import sys

import numpy as np
import pytest

import thetascope
from thetascope import library
from thetascope.runs.specs.refusals import InvalidSpec, Unknown
from thetascope_schemas import Experiment

SHORT = {"horizon": 2.0, "noise.y.std": 0, "figures": []}


def test_an_id_its_data_and_the_experiment_give_the_same_result():
    """All three forms run the same experiment, with changes by path; columns are read by name."""
    spec = library.experiment("zhao-2012")
    results = [thetascope.run(form, SHORT) for form in ("zhao-2012", spec.model_dump(), spec)]
    result = results[0]
    for other in results[1:]:
        np.testing.assert_array_equal(other.data, result.data)
    t, y = result.column("t"), result.column("y.y")
    assert t.shape == y.shape == (result.data.shape[1],)
    assert t[-1] == 2.0
    assert "adaptive.theta.theta3" in result.names


def test_changes_by_path_change_the_numbers():
    """A gain that is changed by path affects the run."""
    slow, fast = (thetascope.run("zhao-2012", SHORT | {"observers.adaptive.gains.rho": rho}) for rho in (2, 8))
    assert not np.array_equal(slow.column("adaptive.x.x1"), fast.column("adaptive.x.x1"))


def test_refusals_name_the_field():
    """Unknown ids, unknown names and invalid texts of a plant are refused with their position."""
    with pytest.raises(Unknown, match="zhao-2012"):
        thetascope.run("zhao-2021")
    with pytest.raises(InvalidSpec, match="horizon"):
        thetascope.run("zhao-2012", {"horizon": -1})
    plant = library.plant("dc-motor").model_dump()
    plant["dynamics"] = dict.fromkeys(plant["dynamics"], "1 +")
    with pytest.raises(InvalidSpec) as refusal:
        thetascope.run(Experiment.model_validate({"plant": plant, "horizon": 1}))
    assert refusal.value.errors[0].field.startswith("plant.dynamics.")


def test_the_package_imports_nothing_before_it_is_needed():
    """`import thetascope` loads neither NumPy nor SymPy; `Client` and `run` are available."""
    code = (
        "import sys, thetascope; assert not {'numpy', 'sympy', 'pydantic'} & set(sys.modules); "
        "assert callable(thetascope.run) and callable(thetascope.Client); assert 'numpy' in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
    with pytest.raises(AttributeError, match="nothing"):
        _ = thetascope.nothing
