"""Changing a spec by path: `--set` and the REST interface's `set`."""

import pytest

from tests.runs.samples import spec
from thetascope.runs.specs.overrides import parse_assignment
from thetascope.runs.specs.refusals import InvalidSpec
from thetascope.runs.specs.resolve_spec import with_changes

BASE = spec(
    observers=[
        {"label": "first", "kind": "adaptive-kalman"},
        {"label": "second", "kind": "joint-ekf", "gains": {"q": 1}},
    ],
    faults=[
        {"channel": "gain", "shape": "step", "onset": 0.5, "size": 0.2},
        {"output": "y", "shape": "stuck", "onset": 0.6, "value": 1},
        {"channel": "gain", "shape": "drift", "onset": 0.7, "rate": 1},
    ],
)


@pytest.mark.parametrize(
    ("path", "value", "read"),
    [
        ("seed", 3, lambda s: s.seed),
        ("noise.y.std", 0, lambda s: s.noise["y"].std),
        ("noise.y", {"std": 2, "sample_time": 0.5}, lambda s: s.noise["y"].model_dump()),
        ("faults.0.size", 0.03, lambda s: s.faults[0].size),
        ("faults[2].rate", 0.03, lambda s: s.faults[2].rate),
        ("faults.y.value", 7, lambda s: s.faults[1].value),
        ("observers.second.gains.q", 8, lambda s: s.observers[1].gains["q"]),
        ("observers.first.gains.rho", 8, lambda s: s.observers[0].gains["rho"]),
        ("observers.first.gains.K", [1, 2], lambda s: list(s.observers[0].gains["K"])),
        ("parameters.a", 2, lambda s: s.parameters["a"]),
        ("plant.parameters.a.value", 2, lambda s: s.plant.parameters[0].value),
        ("plant.dynamics.x", "-x", lambda s: s.plant.dynamics["x"]),
        ("inputs.u.frequency", 5, lambda s: s.inputs["u"].frequency),
        ("inputs.u", 0.5, lambda s: s.inputs["u"].value),
        ("measurement", {"mode": "sampled", "period": 0.1}, lambda s: s.measurement.model_dump()),
        ("record", None, lambda s: s.record),
    ],
)
def test_a_path_reaches_the_value_it_names(path, value, read):
    """By key, index, label, output or name; keys of maps may be new."""
    assert read(with_changes(BASE, {path: value})) == value


def test_several_changes_apply_in_order():
    """A later change applies to the result of an earlier one: a signal of another kind, then one of its fields."""
    changes = {"inputs.u": {"kind": "pulse", "period": 1, "width": 0.5}, "inputs.u.high": 3, "faults": [], "seed": 9}
    changed = with_changes(BASE, changes)
    assert (changed.inputs["u"].high, changed.faults, changed.seed) == (3, (), 9)


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("sed", r"the spec has no field 'sed'.*did you mean seed"),
        ("noise.y.sdt", r"noise\.y has no field 'sdt'.*did you mean std"),
        ("observers.frist.gains.rho", r"no entry of observers is called 'frist'.*did you mean first"),
        ("faults.9.size", r"faults has 3 entries, 0 to 2"),
        ("faults.gain.size", r"several entries of faults are called 'gain'.*faults\.0 or faults\.2"),
        ("seed.x", r"seed is 0, which has no parts"),
        ("faults.0.size.x", r"faults\.0\.size is 0\.2, which has no parts"),
        ("a..b", r"not a path"),
        ("", r"not a path"),
        (".".join("a" * 300), r"not a path"),
    ],
)
def test_an_unknown_path_is_refused_with_its_part_and_the_known_names(path, words):
    """The remedy leads to a valid path."""
    with pytest.raises(InvalidSpec, match=words):
        with_changes(BASE, {path: 1})


def test_a_value_of_the_wrong_type_is_refused_by_the_schema_at_its_path():
    """Changes pass the same checks as specs."""
    with pytest.raises(InvalidSpec) as refusal:
        with_changes(BASE, {"faults.0.size": "large"})
    assert refusal.value.errors[0].field == "faults[0].size"


def test_the_text_of_a_library_plant_cannot_be_changed_through_its_id():
    """The remedy names a possible way."""
    with pytest.raises(InvalidSpec, match=r"given by its id.*parameters\.NAME"):
        with_changes(BASE.model_copy(update={"plant": "contois"}), {"plant.parameters.a.value": 1})


@pytest.mark.parametrize(
    ("text", "pair"),
    [
        ("seed=3", ("seed", 3)),
        ("a.b=1e-3", ("a.b", 0.001)),
        ("a=[1, 2]", ("a", [1, 2])),
        ("a=null", ("a", None)),
        ("plant=contois", ("plant", "contois")),
        ("plant.dynamics.x=-a*x == 1", ("plant.dynamics.x", "-a*x == 1")),
        ('a="3"', ("a", "3")),
        ("a=", ("a", "")),
    ],
)
def test_values_on_the_command_line_are_json_if_valid(text, pair):
    """Anything else is text."""
    assert parse_assignment(text) == pair


@pytest.mark.parametrize("text", ["seed", "=3", " = 3"])
def test_an_assignment_without_path_or_sign_is_refused(text):
    """With an example of a correct one."""
    with pytest.raises(InvalidSpec, match="path=value"):
        parse_assignment(text)
