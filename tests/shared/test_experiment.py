"""Refusals of experiments, and the hash."""

import copy
import json
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from thetascope.messages import words
from thetascope_schemas import Experiment, Plant, ResolvedExperiment, field_errors

Change = Callable[[dict[str, Any]], object]


def read(data: dict[str, Any]) -> Experiment:
    return Experiment.model_validate(data)


def refusal(data: dict[str, Any]) -> tuple[str, str]:
    """Return field and remedy of the only error in `data`."""
    with pytest.raises(ValidationError) as caught:
        read(data)
    (error,) = field_errors(caught.value.errors(), data, words())
    return error.field, error.remedy


def fault(index: int, **values: Any) -> Change:
    return lambda e: e["faults"][index].update(values)


TABLE = {"channel": "theta1", "shape": "table", "onset": 1}
REFUSED: list[tuple[str, str, Change]] = [
    ("parameters.b", "a", lambda e: e.update(parameters={"b": 1})),
    ("parameters.a", "[0, 10]", lambda e: e.update(parameters={"a": 11})),
    ("initial.x3", "x1", lambda e: e.update(initial={"x3": 1})),
    ("inputs.v", "u", lambda e: e.update(inputs={"v": {"kind": "constant", "value": 1}})),
    ("inputs.u.values", "values[0] holds before", lambda e: e["inputs"]["u"].update(values=[0, 1])),
    ("inputs.u.times", "sort", lambda e: e["inputs"]["u"].update(times=[2, 1])),
    ("inputs.u.times", "sort", lambda e: e["inputs"]["u"].update(times=[1, 1])),
    ("signals.psi", "phi", lambda e: e.update(signals={"psi": {"kind": "constant", "value": 1}})),
    ("noise.z", "y", lambda e: e.update(noise={"z": {"std": 1}})),
    ("noise.y.std", "at least 0", lambda e: e["noise"]["y"].update(std=-1)),
    ("noise.y.sample_time", "shorten", lambda e: e["noise"]["y"].update(sample_time=1e-8)),
    ("faults[0].channel", "theta1", fault(0, channel="theta3")),
    ("faults[1].output", "y", fault(1, output="x1")),
    ("faults[0].end", "above 3", fault(0, end=3)),
    ("faults[0].onset", "at least 0", fault(0, onset=-1)),
    ("faults[1].delay", "above 0", fault(1, delay=0)),
    ("faults[0].duration", "give this field", fault(0, shape="ramp")),
    ("faults[0]", "did you mean step", fault(0, shape="stp")),
    (
        "faults[0].times",
        "count from the onset",
        lambda e: e.update(faults=[TABLE | {"times": [-1], "values": [0]}]),
    ),
    ("faults[0].values", "one value per time", lambda e: e.update(faults=[TABLE | {"times": [0, 1], "values": [0]}])),
    ("faults", "at most 200", lambda e: e.update(faults=e["faults"] * 101)),
    ("horizon", "above 0", lambda e: e.update(horizon=0)),
    ("step", "step ≤ 10", lambda e: e.update(step=11)),
    ("step", "at least 5e-07", lambda e: e.update(step=1e-7)),
    ("record", "0.02", lambda e: e.update(record=0.015)),
    ("record", "record ≤ 10", lambda e: e.update(record=20)),
    ("evaluate", "0.02", lambda e: e.update(evaluate=0.015)),
    ("evaluate", "evaluate ≤ 10", lambda e: e.update(evaluate=20)),
    ("measurement.period", "above 0", lambda e: e.update(measurement={"mode": "sampled", "period": 0})),
    ("measurement", "sampled", lambda e: e.update(measurement={"mode": "sample"})),
    ("seed", "at least 0", lambda e: e.update(seed=-1)),
    ("seed", "whole number", lambda e: e.update(seed=1.5)),
    ("observers", "at most 12", lambda e: e.update(observers=[{"label": f"o{i}", "kind": "k"} for i in range(13)])),
    ("observers[1].label", "each name once", lambda e: e.update(observers=[{"label": "o", "kind": "k"}] * 2)),
    ("observers[0].gains.R[1]", "without quotes", lambda e: e["observers"][0]["gains"].update(R=[1, "2"])),
    ("observers[0].gains.lambda", "without quotes", lambda e: e["observers"][0]["gains"].update({"lambda": True})),
    ("plant", "match", lambda e: e.update(plant="No Such Plant")),
    ("plant", "fields", lambda e: e.update(plant=5)),
    ("plant.states[0].inital", "initial", lambda e: e["plant"]["states"][0].update(inital=1)),
]


@pytest.mark.parametrize(("field", "remedy", "change"), REFUSED)
def test_invalid_experiments_are_refused(experiment: dict[str, Any], field: str, remedy: str, change: Change) -> None:
    """The error names the field as the sender wrote it, and the remedy."""
    change(experiment)
    found = refusal(experiment)
    assert found[0] == field
    assert remedy in found[1]


@pytest.mark.parametrize("label", ["t", "u", "x", "y", "theta", "signal", "", "1a", "a.b", "a b", "é"])
def test_labels_cannot_be_confused_with_other_columns(experiment: dict[str, Any], label: str) -> None:
    """A label is the first part of its columns, so it is plain and not one of the plant's prefixes."""
    experiment["observers"][0]["label"] = label
    assert refusal(experiment)[0] == "observers[0].label"


@pytest.mark.parametrize(
    ("column", "accepted"),
    [("t", True), ("theta.theta1", True), ("y.y", True), ("adaptive.x.x1", True), ("adaptive.pe", True)]
    + [("x.x3", False), ("other.x.x1", False), ("adaptive.", False), ("theta", False), ("x1", False)],
)
def test_figures_draw_columns_that_exist(experiment: dict[str, Any], column: str, accepted: bool) -> None:
    """A figure of an unknown column is refused if the plant is known."""
    experiment["figures"] = [{"name": "f", "panels": [{"traces": [{"column": "t"}, {"column": "t", "minus": column}]}]}]
    if accepted:
        read(experiment)
    else:
        assert refusal(experiment)[0] == "figures[0].panels[0].traces[1].minus"


def test_a_discrete_plant_runs_at_its_period(experiment: dict[str, Any]) -> None:
    """The step of a discrete plant is its period, nothing else."""
    experiment["plant"]["time"] = {"kind": "discrete", "period": 0.02}
    assert refusal(experiment) == ("step", "step: 0.02")
    experiment["step"] = 0.02
    read(experiment)


def test_a_library_plant_is_checked_by_with_plant(experiment: dict[str, Any]) -> None:
    """With a plant's id names are checked by with_plant, and the hash is that of the inline plant."""
    inline = read(experiment)
    by_id = read(experiment | {"plant": "lag"})
    plant = Plant.model_validate(experiment["plant"])
    assert by_id.with_plant(plant) == inline.with_plant(plant)
    assert by_id.spec_hash() != inline.spec_hash()
    assert by_id.plant_id == inline.plant_id == plant.id
    wrong = read(experiment | {"plant": "lag", "initial": {"x9": 0}})
    with pytest.raises(ValidationError, match="x9"):
        wrong.with_plant(plant)


def test_a_resolved_experiment_is_the_same_data(experiment: dict[str, Any]) -> None:
    """Its JSON and its hash are those of the experiment with the plant inline; it cannot hold an id."""
    inline = read(experiment)
    resolved = inline.with_plant(Plant.model_validate(experiment["plant"]))
    assert type(resolved) is ResolvedExperiment
    assert resolved.model_dump_json() == inline.model_dump_json()
    assert resolved.spec_hash() == inline.spec_hash()
    with pytest.raises(ValidationError, match="plant"):
        ResolvedExperiment.model_validate(experiment | {"plant": "lag"})


@pytest.mark.parametrize(
    ("horizon", "step", "evaluate", "record", "intervals"),
    [
        (100, 0.001, None, None, (0.01, 0.01)),
        (10, 0.01, None, None, (0.01, 0.01)),
        (2, 0.5, None, None, (0.5, 0.5)),
        (100, 0.004, None, None, (0.02, 0.02)),
        (1.5e7, 1.0, None, None, (2e3, 2e3)),
        (10, 0.1, None, 0.3, (0.1, 0.3)),
        (10, 0.1, 0.5, None, (0.5, 0.5)),
        (10, 0.1, 0.5, 0.2, (0.5, 0.2)),
    ],
)
def test_rows_are_examined_at_most_10000_times(
    horizon: float, step: float, evaluate: float | None, record: float | None, intervals: tuple[float, float]
) -> None:
    """Without a value `evaluate` is 1, 2 or 5·10^k steps, whatever `record` is; `record` is then as `evaluate`."""
    spec = Experiment(plant="lag", horizon=horizon, step=step, evaluate=evaluate, record=record)
    assert (spec.evaluate_interval, spec.record_interval) == pytest.approx(intervals, rel=1e-12)
    assert (spec.evaluate_every, spec.record_every) == tuple(round(interval / step) for interval in intervals)


SAME: list[Change] = [
    lambda e: e.update(title="Other", description="d", source="s", errata=["e"], id="other"),
    lambda e: e.update(figures=[{"name": "f", "panels": [{"traces": [{"column": "t"}]}]}]),
    lambda e: e["plant"].update(title="Other", description="d", source="s", id="other"),
    lambda e: e["plant"]["states"][0].update(unit="km", description="d"),
    lambda e: e["plant"]["channels"][0].update(title="t", unit="N", description="d"),
    lambda e: e.update(horizon=10.0, seed=3, record=0.01),
    lambda e: e.update(parameters={"a": 2.0}, initial={"x1": 1.0, "x2": -0.0}),
    lambda e: e.update(signals={"phi": {"kind": "pulse", "period": 1.0, "width": 0.5, "high": 1, "low": -0.0}}),
    lambda e: e["inputs"]["u"].update(values=[0.0, 1.0, -0.0]),
    lambda e: e.update(measurement={"mode": "continuous"}),
    lambda e: e["noise"]["y"].update(sample_time=0.01),
    lambda e: e["faults"][0].update(end=None),
    lambda e: e["plant"].update(time={"kind": "continuous"}),
    lambda e: e["plant"]["dynamics"].update(x1=" -a*x1  +\n w "),
    lambda e: e["plant"].update(dynamics=dict(reversed(e["plant"]["dynamics"].items()))),
    lambda e: e["plant"]["channels"][0].update(enters={"x2": "1", "x1": "phi"}),
    lambda e: e["observers"][0].update(options={}, initial={}, gains={"R": [1.0, 2.0], "lambda": 4.0}),
]

DIFFERENT: list[Change] = [
    lambda e: e.update(seed=4),
    lambda e: e.update(horizon=11),
    lambda e: e.update(step=0.005, record=0.01),
    lambda e: e.update(record=0.02),
    lambda e: e.update(parameters={"a": 2.5}),
    lambda e: e.update(initial={"x2": 1}),
    lambda e: e.update(inputs={}),
    lambda e: e["inputs"]["u"].update(times=[1, 2.0000001]),
    lambda e: e.update(signals={"phi": {"kind": "constant", "value": 1}}),
    lambda e: e["faults"].pop(),
    lambda e: e["faults"].reverse(),
    lambda e: e["faults"][0].update(size=0.1000000001),
    lambda e: e["noise"]["y"].update(std=0.02),
    lambda e: e.update(measurement={"mode": "sampled", "period": 0.1}),
    lambda e: e["observers"][0].update(label="other"),
    lambda e: e["observers"][0].update(kind="joint-ekf"),
    lambda e: e["observers"][0]["gains"].update(R=[2, 1]),
    lambda e: e["observers"][0].update(options={"channels": "theta1"}),
    lambda e: e["observers"][0].update(initial={"x1": 1}),
    lambda e: e["plant"]["dynamics"].update(x1="-a*x1 + w + 0.1"),
    lambda e: e["plant"]["states"].reverse(),
    lambda e: e["plant"]["states"][0].update(domain=[0, None]),
    lambda e: e["plant"]["definitions"][0].update(domain=[0, 2]),
    lambda e: e["plant"]["channels"][0].update(kind="process"),
    lambda e: e["plant"]["channels"][0].update(enters={"x1": "phi", "x2": "2"}),
]


@pytest.mark.parametrize("change", SAME)
def test_the_same_meaning_has_the_same_hash(experiment: dict[str, Any], change: Change) -> None:
    """Prose, explicit defaults, notation of numbers, spaces and key order do not count."""
    before = read(experiment).spec_hash()
    change(experiment)
    assert read(experiment).spec_hash() == before


@pytest.mark.parametrize("change", DIFFERENT)
def test_another_meaning_has_another_hash(experiment: dict[str, Any], change: Change) -> None:
    """Every change that may change a number of the run changes the hash."""
    before = read(experiment).spec_hash()
    change(experiment)
    assert read(experiment).spec_hash() != before


def test_a_gain_called_title_counts(experiment: dict[str, Any]) -> None:
    """Prose is left out by schema, not by key: a user's own name is never mistaken for it."""
    experiment["observers"][0]["gains"]["title"] = 1
    first = read(experiment).spec_hash()
    experiment["observers"][0]["gains"]["title"] = 2
    assert read(experiment).spec_hash() != first


def test_the_hash_is_32_hexadecimal_digits_of_canonical_json(experiment: dict[str, Any]) -> None:
    """The canonical form is JSON with sorted keys and the version of the schemas."""
    spec = read(experiment)
    document = json.loads(spec.canonical())
    assert json.dumps(document, sort_keys=True, separators=(",", ":")).encode() == spec.canonical()
    assert document["schema"] == 1
    assert len(spec.spec_hash()) == 32
    assert int(spec.spec_hash(), 16) >= 0


numbers = st.floats(allow_nan=False, allow_infinity=False) | st.integers(-(2**60), 2**60)


@given(value=numbers, other=numbers, text=st.text(max_size=50))
def test_hashes_survive_json(value: float, other: float, text: str) -> None:
    """A spec read from its JSON has the same hash; two numbers share one only if they are equal."""
    data = {"plant": "lag", "horizon": 1, "initial": {"x1": value}, "description": text}
    spec = read(data)
    assert read(json.loads(spec.model_dump_json())).spec_hash() == spec.spec_hash()
    same = read(data | {"initial": {"x1": other}}).spec_hash() == spec.spec_hash()
    assert same == (float(value) == float(other))


keys = st.text(max_size=8) | st.sampled_from(list(Experiment.model_fields) + list(Plant.model_fields))
leaves = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=10)
junk = st.recursive(leaves, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(keys, inner, max_size=5))


@given(field=st.sampled_from(list(Experiment.model_fields)), value=junk)
def test_any_data_is_an_experiment_or_a_list_of_errors(field: str, value: object) -> None:
    """No other exception is raised, and the errors can be sent."""
    data = copy.deepcopy({"plant": "lag", "horizon": 1.0, field: value})
    try:
        read(data).spec_hash()
    except ValidationError as refused:
        errors = field_errors(refused.errors(), data, words())
        assert errors
        for error in errors:
            assert error.problem
            assert error.remedy
            json.dumps(error.model_dump(), allow_nan=False)
