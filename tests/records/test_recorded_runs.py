"""Observers on records: the columns of the run that was recorded, and prediction where readings are missing."""

import re

import numpy as np
import pytest

from tests.records.recorded_runs import changed, exported, on_record, simulated
from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.errors import SpecError
from thetascope.engine.model.result import Result
from thetascope_schemas import Experiment, Plant

ROWS = 120
CLASSICAL = ["proportional-integral", "extended-state", "sliding-mode", "unknown-input", "drem"]
PLANTS = {
    "dts200": (1.0, ["joint-ekf", "adaptive-kalman", *CLASSICAL]),
    "zhao-contois": (0.05, ["zhao-adaptive", "joint-ukf", "adaptive-kalman-discrete", "high-gain"]),
    "shen-hu-2015": (0.01, ["linear-adaptive", "nonsmooth-adaptive"]),
    "dc-motor": (0.001, ["full-order", "reduced-order"]),
    "level-loop": (0.5, ["joint-ekf", "adaptive-kalman"]),
    "friction-motor": (0.01, ["joint-ekf", "adaptive-kalman-discrete"]),
    "zhou-tan-2012": (None, ["sandwich-nonsmooth"]),
}


@pytest.fixture(scope="module")
def tank() -> tuple[Result, bytes]:
    """Return a run of three tanks, and its record."""
    run = simulated(library.plant("dts200"), 1.0, ROWS, ["joint-ekf", "adaptive-kalman"])
    return run, exported(run)


@pytest.mark.parametrize("name", PLANTS)
def test_a_record_of_a_run_gives_its_columns_bit_for_bit(name):
    """Every column of an observer on the record of a run is that of the run: y is held over base steps in both.

    Columns that judge an observer by the truth are missing in a record, as the truth is.
    """
    step, kinds = PLANTS[name]
    plant = library.plant(name)
    plant = plant.without_controllers
    step = plant.time.period if plant.time.kind == "discrete" else step
    assert step is not None
    run = simulated(plant, step, ROWS, kinds)
    record = on_record(plant, exported(run), step, ROWS, kinds)
    judged = re.compile(r"\.(V|V1|V2|true\.\w+)$")
    known = [n for n in run.names if not n.startswith(("x.", "theta.")) and not judged.search(n)]
    assert list(record.names) == known
    differ = [n for n in known if not np.array_equal(run.column(n), record.column(n), equal_nan=True)]
    assert differ == []


def test_the_steps_of_a_record_follow_the_accuracy_of_the_observers(tank):
    """Without given substeps, estimates agree with those of 64 within the tolerance of observers."""
    plant = library.plant("dts200")
    fine, free = (on_record(plant, tank[1], 1.0, ROWS, ["adaptive-kalman"], substeps=n) for n in (64, None))
    assert free.substeps > 1 and free.accuracy is not None
    for state in plant.names("states"):
        a, b = (r.column(f"adaptive-kalman.x.{state}") for r in (fine, free))
        assert np.abs(a - b).max() < 1e-4 * np.abs(a).max()


def test_shifted_times_and_another_order_of_columns_change_nothing(tank):
    """Times from an epoch on, and columns in another order, give the same columns."""
    run, data = tank
    head, *lines = data.decode().strip().split("\n")
    cells = [line.split(",") for line in (head, *lines)]
    for row in cells[1:]:
        row[0] = str(1.7e9 + float(row[0]))
    turned = "\n".join(",".join(row[::-1]) for row in cells).encode()
    record = on_record(library.plant("dts200"), turned, 1.0, ROWS, ["joint-ekf"])
    assert np.array_equal(run.column("joint-ekf.theta.pump1"), record.column("joint-ekf.theta.pump1"))


@pytest.fixture(scope="module")
def level() -> tuple[Plant, bytes]:
    """Return a tank with two sensors, and its record."""
    plant = library.plant("level-loop").without_controllers
    return plant, exported(simulated(plant, 0.5, ROWS, ["joint-ekf"]))


@pytest.mark.parametrize("kind", ["joint-ekf", "joint-ukf", "adaptive-kalman", "adaptive-kalman-discrete"])
def test_observers_predict_where_readings_are_missing(level, kind):
    """In a gap the standard deviation that a filter claims grows, ŷ goes on by itself, and y has no value."""
    plant, data = level
    gap = changed(data, lambda rows: [[*r[:2], "", ""] if 40 <= i < 60 else r for i, r in enumerate(rows)])
    whole, run = (on_record(plant, d, 0.5, ROWS, [kind]) for d in (data, gap))
    assert np.isnan(run.column("y.y")[42:60]).all() and np.isfinite(run.column("y.y")[61:]).all()
    own, usual = (r.column(f"{kind}.claimed.level_bias") for r in (run, whole))
    assert own[59] > own[41] and own[59] > 1.01 * usual[59]
    assert np.isfinite(run.column(f"{kind}.y.y")).all()
    assert np.allclose(run.column(f"{kind}.x.h")[:40], whole.column(f"{kind}.x.h")[:40], rtol=1e-9)


@pytest.mark.parametrize("kind", ["joint-ekf", "adaptive-kalman"])
def test_in_a_gap_the_estimate_follows_the_model(level, kind):
    """From the last reading on, x̂ is the solution of the plant's equations with the estimated faults."""
    plant, data = level
    gap = changed(data, lambda rows: [[*r[:2], "", ""] if 40 <= i < 60 else r for i, r in enumerate(rows)])
    run = on_record(plant, gap, 0.5, ROWS, [kind])
    first, last = 42, 59
    theta = {n: run.column(f"{kind}.theta.{n}")[first:last] for n in plant.names("channels")}
    assert all(np.ptp(column) < 1e-6 * (1 + abs(column[0])) for column in theta.values())
    values = {p.name: p.value for p in plant.parameters} | {n: float(c[0]) for n, c in theta.items()}
    assert np.allclose(
        run.column(f"{kind}.x.h")[first:last], solution(plant, values, run, kind, first, last), rtol=1e-5
    )


def solution(plant: Plant, values: dict, run: Result, kind: str, first: int, last: int) -> np.ndarray:
    """Return the level by scipy's Radau, from the estimate in the first row on."""
    from scipy.integrate import solve_ivp

    terms = [f"({plant.dynamics['h']})"]
    terms += [f"({c.enters['h']})*({values[c.name]!r})" for c in plant.channels if "h" in c.enters]
    t, q = run.column("t"), run.column("u.q")
    names = {"sqrt": np.sqrt, "max": max, "min": min, "abs": abs}

    def slope(at: float, h: np.ndarray) -> list[float]:
        known = values | {"q": q[np.searchsorted(t, at, side="right") - 1], "h": float(h[0])} | names
        for definition in plant.definitions:
            known[definition.name] = eval(definition.expression, {}, known)
        return [eval("+".join(terms), {}, known)]

    start = run.column(f"{kind}.x.h")[first]
    return solve_ivp(
        slope, (t[first], t[last - 1]), [start], "Radau", t[first:last], rtol=1e-9, atol=1e-9, max_step=0.25
    ).y[0]


def test_one_missing_output_does_not_stop_the_others(level):
    """Where one output is missing, the filter still corrects with the other one."""
    plant, data = level
    lost = changed(data, lambda rows: [[*r[:2], "", r[3]] if i >= 20 else r for i, r in enumerate(rows)])
    run = on_record(plant, lost, 0.5, ROWS, ["joint-ekf"])
    error = run.column("joint-ekf.y.w") - run.column("y.w")
    assert np.abs(error[20:]).max() < 0.2 and np.isnan(run.column("y.y")[22:]).all()


def test_rows_with_jitter_are_taken_at_their_times():
    """Without noise, rows that come early or late surprise a filter hardly; taken for even ones they do."""
    plant = library.plant("level-loop").without_controllers
    fine = simulated(plant, 0.1, 1200, [], noise={}, faults=[])
    t = np.arange(118.0) + np.r_[0.0, 0.1 * np.random.default_rng(4).integers(-4, 5, 116), 0.0]
    names = ["u.q", "y.y", "y.w"]
    cells = [fine.column(n)[np.rint(t / 0.1).astype(int)].tolist() for n in names]
    noise = {o.name: {"std": 0.01, "sample_time": 1.0} for o in plant.outputs}
    surprise = []
    for times in (t, np.arange(118.0)):
        rows = zip(times.tolist(), *cells, strict=True)
        data = "\n".join([",".join(["t", *names]), *(",".join(map(repr, row)) for row in rows)]).encode()
        nis = on_record(plant, data, 1.0, 118, ["joint-ekf"], noise=noise, substeps=None).column("joint-ekf.nis")
        surprise.append(float(np.delete(nis, np.r_[0, 35:38, 71:74]).mean()))  # without rows beside steps of the input
    assert surprise[0] < 0.1 * surprise[1]


def test_a_record_has_its_diagnosis_in_the_run(tank):
    """A run on a record names the fault that was simulated, as an alarm of its facts, without a verdict on it."""
    from thetascope.runs.results.summary import summarise

    plant = library.plant("dts200")
    run = simulated(plant, 1.0, 600, ["joint-ekf"])
    record = on_record(plant, exported(run), 1.0, 600, ["joint-ekf"], diagnosis={"enabled": True})
    assert record.record is not None and record.diagnosis is None
    fields = {"plant": plant, "horizon": 599.0, "step": 1.0, "truth": {"record": {"id": "0" * 32}}}
    summary = summarise(record, library.resolve(Experiment.model_validate(fields)))
    assert summary.record is not None and summary.facts is not None
    assert [alarm.channel for alarm in summary.facts.alarms] == [plant.channels[0].name]
    assert summary.facts.summary == summary.record.sentence and summary.facts.alarm_verdicts == ()


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("faults", [{"channel": "pump1", "shape": "step", "onset": 5, "size": 0.1}]),
        ("inputs", {"Q1": {"kind": "constant", "value": 1.0}}),
        ("commands", [{"type": "set-noise", "at": 1.0, "output": "y1", "std": 1.0, "sample_time": 1.0}]),
        ("truth", {"record": {"id": "0" * 32}, "deviation": 0.1}),
        ("s1", {"record": {"id": "0" * 32, "fitted": ["s1"]}}),
        ("truth", {"record": {"id": "../rig"}}),
    ],
)
def test_a_recorded_truth_cannot_be_changed(field, value):
    """Faults, inputs, noise and other truths beside a record are refused."""
    fields = {"plant": "dts200", "horizon": 10.0, "step": 1.0, "truth": {"record": {"id": "0" * 32}}}
    with pytest.raises(ValueError, match=field):
        library.resolve(Experiment.model_validate(fields | {"truth" if field == "s1" else field: value}))


def test_a_record_that_was_not_read_is_refused():
    """Without its file an experiment with a record does not run."""
    fields = {"plant": "dts200", "horizon": 10.0, "step": 1.0, "truth": {"record": {"id": "0" * 32}}}
    with pytest.raises(SpecError, match="record"):
        prepare(library.resolve(Experiment.model_validate(fields)))


def test_the_hash_of_a_run_follows_the_record_its_mapping_and_its_settings():
    """Another file, unit or stretch is another run; another name of the file is the same."""

    def hashed(**record: object) -> str:
        truth = {"record": {"id": "0" * 32, **record}}
        return library.resolve(
            Experiment.model_validate({"plant": "dts200", "horizon": 10.0, "truth": truth})
        ).spec_hash()

    columns = {"quantities": {"y1": {"column": "Level", "unit": "m"}}}
    others = [
        {"id": "1" * 32},
        {"mapping": columns},
        {"mapping": {"quantities": {"y1": {"column": "Level", "unit": "mm"}}}},
        {"mapping": {"time": {"column": "t", "unit": "min"}}},
        {"settings": {"healthy": {"begin": 0.0, "end": 5.0}}},
        {"between": "linear"},
    ]
    assert len({hashed(), *(hashed(**other) for other in others)}) == 1 + len(others)
    assert hashed(name="rig-7.csv") == hashed()
