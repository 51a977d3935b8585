"""`thetascope hysteresis`: from a record to the text of a plant that behaves as the recorded one."""

import numpy as np
import pytest
import yaml

from tests.simulate import simulate
from thetascope import library
from thetascope.cli.main import main
from thetascope_schemas import Experiment, Plant


@pytest.fixture(scope="module")
def record(tmp_path_factory):
    """Write x12 and v of the paper's plant as a CSV file; return its path and the run."""
    run = simulate(library.resolve(library.experiment("zhou-tan-2012")))
    path = tmp_path_factory.mktemp("hysteresis") / "rig.csv"
    rows = np.column_stack([run.column(name) for name in ("t", "x.x12", "nonsmooth.true.v")])
    np.savetxt(path, rows, delimiter=",", header="t,x12,force", comments="", fmt="%.15g")
    return path, run


def test_the_written_operators_replace_those_of_the_plant(record, tmp_path, capsys):
    """The fit is printed; its text, put into the plant in place of its operators, gives the recorded states."""
    path, run = record
    out = tmp_path / "operators.yaml"
    assert main(["hysteresis", str(path), "--input", "x12", "--output", "force", "--out", str(out)]) == 0
    printed = capsys.readouterr().out
    assert "threshold" in printed and printed.count("0.0") >= 7
    parts = yaml.safe_load(out.read_text(encoding="utf-8"))
    plant = library.plant("zhou-tan-2012").model_dump(mode="json", exclude_none=True)
    memory = {state["name"] for state in plant["states"]} - {"x11", "x12", "x21", "x22"}
    plant["states"] = [s for s in plant["states"] if s["name"] not in memory] + parts["states"]
    plant["dynamics"] = {n: e for n, e in plant["dynamics"].items() if n not in memory} | parts["dynamics"]
    plant |= {"id": "identified", "definitions": parts["definitions"]}
    spec = library.experiment("zhou-tan-2012").model_dump() | {"plant": Plant.model_validate(plant), "figures": []}
    ours = simulate(library.resolve(Experiment.model_validate(spec)))
    for state in ("x21", "x22"):
        np.testing.assert_allclose(ours.column(f"x.{state}"), run.column(f"x.{state}"), atol=1e-8)
        error = ours.column(f"nonsmooth.x.{state}") - ours.column(f"x.{state}")
        assert np.abs(error[500:]).max() < 1e-9, "the observer takes the identified plant"


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (["--input", "x13", "--output", "force"], "did you mean x12"),
        (["--input", "x12", "--output", "force", "--thresholds", "wide"], "positive numbers"),
        (["--input", "x12", "--output", "force", "--thresholds", "9"], "smaller thresholds"),
    ],
)
def test_mistakes_are_named_with_their_remedy(record, capsys, more, words):
    """A column that is not there, thresholds that are none, and those that the record does not reach."""
    assert main(["hysteresis", str(record[0]), *more]) == 1
    assert words in capsys.readouterr().err
