"""`thetascope diagnose` and `thetascope trial`: recorded data, and one experiment with many seeds."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from thetascope import library
from thetascope.assembly import prepare
from thetascope.assembly.analyses.csv_columns import columns_of_csv
from thetascope.assembly.analyses.record_diagnosis import diagnose_recording, recording
from thetascope.engine.errors import SpecError
from thetascope_schemas import Experiment
from thetascope_schemas.experiment.diagnosis import DiagnosisSettings


def recorded(call, experiment: str, *changes: str) -> dict[str, np.ndarray]:
    """Return simulated measurements of a run: t, inputs, known signals and outputs."""
    assert (
        call(
            "run", experiment, "--set", "diagnosis.enabled=false", *changes, "--no-store", "--out", "run.csv", "--quiet"
        )[0]
        == 0
    )
    with open("run.csv", newline="") as file:
        head, *rows = csv.reader(file)
    data = dict(zip(head, np.array(rows, dtype=float).T, strict=True))
    return {n: v for n, v in data.items() if n == "t" or n.startswith(("u.", "signal.", "y."))}


def write(columns: dict[str, np.ndarray], name: str = "rec.csv") -> None:
    lines = [",".join(columns)] + [",".join(f"{v:.9g}" for v in row) for row in zip(*columns.values(), strict=True)]
    with open(name, "w") as file:
        file.write("\n".join(lines) + "\n")


def test_a_record_is_diagnosed_without_declared_noise(call):
    """Friction that rises tenfold at 10 s is identified within 1 s, its size within the interval, the noise to 15 %."""
    write(recorded(call, "friction-motor", "--set", "seed=5"))
    code, shown, _ = call("diagnose", "friction-motor", "rec.csv", "--json", "found.json")
    found = json.loads(Path("found.json").read_text())
    (alarm,) = found["alarms"]
    assert code == 0 and alarm["channel"] == "friction" and "friction" in shown
    assert 10.0 < alarm["t"] < 11.0 and alarm["onset_from"] <= 10.1 and alarm["size_from"] < 9 < alarm["size_to"]
    assert [n["estimated"] for n in found["noise"]] == pytest.approx([0.01, 0.01], rel=0.15)


@pytest.mark.parametrize("name", ["dc-motor", "quadruple-tank", "dts200", "contois-physical"])
def test_records_of_other_plants(name):
    """In runs used as records the noise is estimated to 15 %, every fault is named once, and none without faults."""
    spec = library.experiment(name)
    plant = library.plant(spec.plant)
    for faults in (spec.faults, ()):
        changes = {"faults": faults, "observers": [], "figures": [], "diagnosis": {"enabled": False}, "seed": 3}
        run = prepare(library.resolve(Experiment.model_validate(spec.model_dump() | changes))).run()
        columns = {c: run.column(c) for c in run.names if c == "t" or c.startswith(("u.", "signal.", "y."))}
        found = diagnose_recording(plant, recording(plant, columns), DiagnosisSettings(false_alarms=0.1))
        assert [a.channel for a in found.alarms] == [f.channel for f in faults]
        noise = {n.output.removeprefix("y."): n.estimated for n in found.noise}
        assert noise == pytest.approx({n: spec.noise[n].std for n in noise}, rel=0.15)


def test_a_healthy_record_shows_no_fault(call):
    """The motor without its fault, bare column names, twice the sample period."""
    columns = recorded(call, "friction-motor", "--set", "faults=[]")
    write({n.partition(".")[2] or n: v[::2] for n, v in columns.items()})
    code, shown, _ = call("diagnose", "friction-motor", "rec.csv")
    assert code == 0 and shown.startswith("no fault found")


def test_a_constant_offset_is_learnt(call):
    """A model with a constant error raises an alarm; with learning only later faults do."""
    always = '{"channel": "friction", "shape": "step", "onset": 0, "size": 6}'
    later = '{"channel": "friction", "shape": "step", "onset": 12, "size": 30}'
    write(recorded(call, "friction-motor", "--set", f"faults=[{always}, {later}]"))
    assert "friction" in call("diagnose", "friction-motor", "rec.csv")[1].splitlines()[0]
    code, _, _ = call("diagnose", "friction-motor", "rec.csv", "--learn", "8", "--json", "found.json")
    alarms = json.loads(Path("found.json").read_text())["alarms"]
    assert code == 0 and [a["channel"] for a in alarms] == ["friction"] and 12 < alarms[0]["t"] < 13.5


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda c: c.pop("y.y_speed"), "y_speed: no column holds this output"),
        (lambda c: c.pop("t"), "there is no column of times"),
        (lambda c: c["t"].__setitem__(7, 0.0755), "equally spaced"),
        (lambda c: c["y.y_speed"].__setitem__(3, np.nan), "does not hold a number"),
        (lambda c: c.update({n: v[:50] for n, v in c.items()}), "50 rows, fewer than 200"),
    ],
)
def test_an_unsuitable_record_is_refused_with_the_position(call, spoil, words):
    """Exit code 1 and a sentence that names the column, the row and the remedy."""
    columns = recorded(call, "friction-motor", "--set", "horizon=5")
    spoil(columns)
    write(columns)
    code, _, error = call("diagnose", "friction-motor", "rec.csv")
    assert code == 1 and words in error and "Traceback" not in error


def test_invalid_files_are_refused(call, tmp_path):
    """A cell that is not a number is named with its line; a missing plant or file is reported."""
    (tmp_path / "a.csv").write_text("t,y_speed,y_acceleration\n0,1,1\n1,high,1\n")
    assert "row 3 has “high”" in call("diagnose", "friction-motor", "a.csv")[2]
    assert "cannot be read" in call("diagnose", "friction-motor", "none.csv")[2]
    assert "did you mean" in call("diagnose", "friction-moter", "a.csv")[2]


@pytest.mark.parametrize("row", ["7", "7,8", "7,8,9,10", ",7,8", "7,,9"])
def test_a_row_of_another_length_is_refused_with_its_line(row):
    """One cell is not used for the whole row, and none is filled in."""
    with pytest.raises(SpecError, match="line 3") as caught:
        columns_of_csv(f"t,u,y\n0,1,2\n{row}\n2,3,4")
    assert caught.value.value == row


def test_a_trial_counts_false_and_correct_alarms(call):
    """Five seeds of the friction example: no false alarm, five faults found; the fixed band is evaluated beside it."""
    code, shown, _ = call("trial", "friction-motor", "--seeds", "5", "--lock", "7", "--quiet")
    lines = {line.split("  ")[0]: line.split() for line in shown.splitlines()}
    assert code == 0 and lines["detector"][1:3] == ["0", "(0"] and lines["detector"][7] == "5"
    assert any(name.startswith("ekf: 3σ band of its values") for name in lines)
    assert call("trial", "friction-motor", "--seeds", "0")[0] == 2


def test_a_record_as_spreadsheets_write_it(call):
    """Semicolons, decimal commas and times rounded to milliseconds give the same finding; a missing column is named."""
    columns = recorded(call, "friction-motor", "--set", "seed=5")
    t = columns["t"] * 1.2345678
    rows = zip(np.round(t, 3), *(columns[n] for n in ("u.torque", "y.y_speed", "y.y_acceleration")), strict=True)
    names = ["u.torque", "y.y_speed", "y.y_acceleration"]
    lines = [";".join(["t", *names]), *(";".join(f"{v:.6g}".replace(".", ",") for v in row) for row in rows)]
    found = columns_of_csv("\n".join(lines))
    assert list(found) == ["t", *names] and found[names[-1]] == pytest.approx(columns[names[-1]], rel=1e-5)
    plant = library.plant("friction-motor")
    assert recording(plant, found).period == pytest.approx(0.012345678, rel=1e-4)
    without = {n: v for n, v in found.items() if not n.startswith("u.")}
    note = diagnose_recording(plant, recording(plant, without), DiagnosisSettings()).note
    assert (note.code, note.args) == ("diagnosis.record.defaults", {"names": ["torque"]})


@pytest.mark.parametrize(
    ("changes", "learn", "problem"),
    [
        ({"cell": 1e300}, 0.0, "row 51 holds a number that no sensor can show"),
        ({"cell": float("nan")}, 0.0, "row 51 does not hold a number"),
        ({}, 100.0, "at least a tenth of it"),
        ({}, float("nan"), "at least a tenth of it"),
    ],
)
def test_impossible_records_are_refused(call, changes, learn, problem):
    """Non-finite or implausible numbers, and a learning time that leaves nothing to test."""
    columns = recorded(call, "friction-motor")
    y = next(n for n in columns if n.startswith("y."))
    columns[y] = np.where(np.arange(len(columns[y])) == 50, changes.get("cell", columns[y]), columns[y])
    plant = library.plant("friction-motor")
    with pytest.raises(SpecError, match=problem):
        diagnose_recording(plant, recording(plant, columns), DiagnosisSettings(), learn)
