"""Controllers of a plant: refusals that name the field, the value and the remedy, and laws that work together."""

from copy import deepcopy
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from tests.engine.loops import experiment, level
from tests.simulate import simulate
from thetascope.assembly.build.prepare import prepare
from thetascope.engine.errors import SpecError
from thetascope.messages import words
from thetascope_schemas import Experiment, field_errors

WRONG: dict[str, tuple[dict[str, Any], str, str]] = {
    # changes of the controller; the field; a word of the remedy
    "a name of a state": (
        {"states": [{"name": "h"}], "dynamics": {"h": "0"}},
        "states[0].name",
        "rename",
    ),
    "a name of a reference": ({"definitions": [{"name": "r", "expression": "1"}]}, "definitions[0].name", "rename"),
    "a state without an equation": ({"dynamics": {}}, "dynamics", "dynamics.e"),
    "an equation without a state": ({"dynamics": {"e": "0", "f": "1"}}, "dynamics.f", "e"),
    "an unknown input": ({"outputs": [{"input": "p", "expression": "1"}]}, "outputs[0].input.p", "q"),
    "an input set twice": (
        {"outputs": [{"input": "q", "expression": "1"}, {"input": "q", "expression": "2"}]},
        "outputs[1].input",
        "one controller",
    ),
    "an unknown limit": (
        {"outputs": [{"input": "q", "expression": "1", "saturation": [0, "qmax"]}]},
        "outputs[0].saturation.qmax",
        "Kp",
    ),
    "limits in the wrong order": (
        {"outputs": [{"input": "q", "expression": "1", "saturation": [2, 0]}]},
        "outputs[0].saturation",
        "[low, high]",
    ),
    "a period that is no multiple of the step": ({"period": 0.013}, "period", "0.01"),
}
READS: dict[str, tuple[str, str, str]] = {
    "a true state": ("Kp*(r - h)", "outputs.0", "y"),
    "an unknown reference": ("Kp*(rr - y)", "outputs.0", "r"),
    "an unknown function": ("limit(r - y)", "outputs.0", ""),
}


def changed(**changes: Any) -> dict:
    """Return the level with another controller."""
    plant = deepcopy(level())
    plant["controllers"][0] |= changes
    return plant


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_controller_is_refused(case: str):
    """The field is named, and the remedy says which names or values are right."""
    changes, field, remedy = WRONG[case]
    data = {"plant": changed(**changes), "horizon": 60, "step": 0.01}
    with pytest.raises(ValidationError) as refusal:
        Experiment.model_validate(data)
    first = field_errors(refusal.value.errors(include_url=False), data, words())[0]
    assert first.field == f"plant.controllers[0].{field}" and first.value is not None and remedy in first.remedy


@pytest.mark.parametrize("case", READS)
def test_a_law_reads_measured_outputs_and_references_only(case: str):
    """A true state, a name that nobody declares and an unknown function are refused at their place."""
    law, field, remedy = READS[case]
    with pytest.raises(SpecError) as refusal:
        prepare(experiment(changed(outputs=[{"input": "q", "expression": law}])))
    assert f"controllers.0.{field}" in refusal.value.field and remedy in str(refusal.value.remedy)


def test_an_algebraic_loop_is_refused_with_its_path():
    """An output that depends on the input directly needs a sampled controller, or a state in between."""
    through = level(outputs=[{"name": "y", "expression": "h + 0.1*q"}])
    with pytest.raises(SpecError) as refusal:
        prepare(experiment(through))
    assert refusal.value.field == "controllers.0.outputs.0.expression"
    assert "q → y → q" in str(refusal.value.problem) and "period" in str(refusal.value.remedy)
    sampled = level(0.1, outputs=through["outputs"])
    run = simulate(experiment(sampled))
    np.testing.assert_allclose(run.column("y.y"), run.column("x.h") + 0.1 * run.column("u.q"), rtol=1e-12)


def test_a_controlled_input_has_no_signal():
    """Giving one is refused, and the references are named."""
    data = {"plant": level(), "horizon": 60, "inputs": {"q": {"kind": "constant", "value": 1}}}
    for references, remedy in ((level()["references"], "reference instead: r"), ([], "declare a reference")):
        law = [{"input": "q", "expression": "1 - y"}]
        data["plant"] |= {"references": references, "controllers": [{"name": "p", "outputs": law}]}
        with pytest.raises(ValidationError) as refusal:
            Experiment.model_validate(data)
        error = field_errors(refusal.value.errors(include_url=False), data, words())[0]
        assert error.field == "inputs.q" and remedy in error.remedy


def test_controllers_act_one_after_the_other_at_an_instant():
    """A later controller reads the new state and input of an earlier one, and all states of one move together."""
    plant = level(
        inputs=[{"name": "q", "default": 0.5}, {"name": "p", "default": 0}],
        controllers=[
            {
                "name": "count",
                "period": 0.5,
                "states": [{"name": "a", "initial": 0}, {"name": "b", "initial": 10}],
                "dynamics": {"a": "a + 1", "b": "a"},
                "outputs": [{"input": "q", "expression": "0.5 + 0.01*a"}],
            },
            {"name": "follow", "period": 1.0, "outputs": [{"input": "p", "expression": "100*q + a + p"}]},
        ],
    )
    run = simulate(experiment(plant, inputs={}, horizon=3, evaluate=0.5))
    a, b, q, p = (run.column(n) for n in ("c.a", "c.b", "u.q", "u.p"))
    np.testing.assert_array_equal(a, np.arange(7))  # before the instant of the row
    np.testing.assert_array_equal(b, [10, *range(6)])
    np.testing.assert_allclose(q, 0.5 + 0.01 * np.arange(7))
    expected = 0.0
    for k in range(0, 7, 2):
        expected += 50 + k + k + 1
        assert p[k] == pytest.approx(expected)


def test_continuous_controllers_form_a_cascade():
    """An outer controller's state is the set point of an inner one, in any order of the list; against SciPy."""
    from scipy.integrate import solve_ivp

    inner = {"name": "inner", "outputs": [{"input": "q", "expression": "0.5 + 3*(s - y)", "saturation": ["c", None]}]}
    outer = {"name": "outer", "states": [{"name": "s", "initial": 1}], "dynamics": {"s": "0.4*(r - y) + 0*q"}}
    outer["outputs"] = [{"input": "p", "expression": "s"}]
    inputs = [{"name": "q", "default": 0.5}, {"name": "p", "default": 0}]

    def slope(t: float, z: np.ndarray) -> list[float]:
        return [max(0.5 + 3 * (z[1] - z[0]), 0.5) - 0.5 * np.sqrt(z[0]), 0.4 * (1.3 - z[0])]

    plant, fixed = level(inputs=inputs, controllers=[inner, outer]), {"r": {"kind": "constant", "value": 1.3}}
    run = simulate(experiment(plant, horizon=15, inputs=fixed, substeps=4))
    times = run.column("t")
    solution = solve_ivp(slope, (0, 15), [1, 1], "DOP853", rtol=1e-11, atol=1e-12, t_eval=times, max_step=0.01)
    np.testing.assert_allclose(run.column("x.h"), solution.y[0], atol=2e-6)
    np.testing.assert_allclose(run.column("u.p"), solution.y[1], atol=2e-6)
    assert run.column("u.q").min() >= 0.5


def test_a_plant_without_controllers_keeps_its_hash():
    """Empty controllers and references do not enter the hash of a run."""
    plant = level(controllers=[], references=[])
    bare = {k: v for k, v in plant.items() if k not in ("controllers", "references")}
    assert experiment(plant, inputs={}).spec_hash() == experiment(bare, inputs={}).spec_hash()
    assert experiment(plant, inputs={}).spec_hash() != experiment(level(), inputs={}).spec_hash()
