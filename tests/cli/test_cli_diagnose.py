"""`thetascope diagnose`, `thetascope fit` and `thetascope trial`: recorded data, and one experiment with many seeds."""

import csv
import json
from pathlib import Path

import numpy as np
import polars
import pytest
import yaml

from thetascope import library
from thetascope_schemas import Plant


def recorded(call, experiment: str, *changes: str) -> dict[str, np.ndarray]:
    """Return simulated measurements of a run: t, inputs, known signals and outputs."""
    quiet = ("--set", "diagnosis.enabled=false", *changes, "--no-store", "--out", "run.csv", "--quiet")
    assert call("run", experiment, *quiet)[0] == 0
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
    (fault,) = found["faults"]
    best = fault["best"]
    assert code == 0 and best["channel"] == "friction" and "added friction" in shown
    assert 10.0 < fault["alarm"] < 11.0 and best["onset"]["low"] <= 10.0 <= best["onset"]["high"]
    assert best["size"]["low"] < 9 < best["size"]["high"]
    assert [o["noise"] for o in found["fit"]["outputs"]] == pytest.approx([0.01, 0.01], rel=0.15)


def test_a_healthy_record_shows_no_fault(call):
    """The motor without its fault, bare column names, twice the sample period."""
    columns = recorded(call, "friction-motor", "--set", "faults=[]")
    write({n.partition(".")[2] or n: v[::2] for n, v in columns.items()})
    code, shown, _ = call("diagnose", "friction-motor", "rec.csv")
    assert code == 0 and shown.startswith("No fault in 20 s") and "would have been found" in shown


def test_a_plant_is_fitted_on_the_healthy_stretch(call):
    """The fit finds the true inertia again and writes a plant file; with it a later fault gets its right size."""
    plant = library.plant("friction-motor").model_dump(mode="json", exclude_defaults=True)
    name = plant["parameters"][0]["name"]
    true = plant["parameters"][0]["value"]
    plant["parameters"][0]["value"] = 1.2 * true
    Path("wrong.yaml").write_text(yaml.safe_dump(plant))
    write(recorded(call, "friction-motor", "--set", "seed=5"))
    options = ("--healthy", "0..9", "--parameters", name, "--out", "fitted.yaml")
    code, shown, _ = call("fit", "wrong.yaml", "rec.csv", *options)
    fitted = Plant.model_validate(yaml.safe_load(Path("fitted.yaml").read_text()))
    assert code == 0 and name in shown
    assert fitted.parameters[0].value == pytest.approx(true, rel=0.03)
    call("diagnose", "fitted.yaml", "rec.csv", "--healthy", "0..9", "--fit", "never", "--json", "found.json")
    (fault,) = json.loads(Path("found.json").read_text())["faults"]
    assert fault["best"]["size"]["low"] < 9 < fault["best"]["size"]["high"]


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda c: c.pop("y.y_speed"), "y_speed: no column holds this output"),
        (lambda c: c.pop("t"), "there is no column of times"),
        (lambda c: c.update({n: v[:50] for n, v in c.items()}), "50 rows, fewer than 100"),
    ],
)
def test_an_unsuitable_record_is_refused(call, spoil, words):
    """Exit code 1 and a sentence that names the column and the remedy."""
    columns = recorded(call, "friction-motor", "--set", "horizon=5")
    spoil(columns)
    write(columns)
    code, _, error = call("diagnose", "friction-motor", "rec.csv")
    assert code == 1 and words in error and "Traceback" not in error


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--healthy", "ten"), "BEGIN..END"),
        (("--healthy", "5..2"), "must end after it begins"),
        (("--fit", "inertness"), "no parameter inertness"),
        (("--false-alarms", "0"), "false_alarms"),
    ],
)
def test_options_are_checked(call, options, words):
    """A stretch, a parameter or a rate that cannot be is named, with the remedy."""
    write(recorded(call, "friction-motor", "--set", "horizon=5"))
    code, _, error = call("diagnose", "friction-motor", "rec.csv", *options)
    assert code == 1 and words in error and "Traceback" not in error


def test_invalid_files_are_refused(call, tmp_path):
    """A cell that is not a number is named with its line; a missing plant or file is reported."""
    (tmp_path / "a.csv").write_text("t,y_speed,y_acceleration\n0,1,1\n1,high,1\n")
    assert "row 3 has “high”" in call("diagnose", "friction-motor", "a.csv")[2]
    assert "cannot be read" in call("diagnose", "friction-motor", "none.csv")[2]
    assert "did you mean" in call("diagnose", "friction-moter", "a.csv")[2]


def test_a_trial_counts_false_and_correct_alarms(call):
    """Five seeds of the friction example: no false alarm, five faults found; the fixed band is evaluated beside it."""
    code, shown, _ = call("trial", "friction-motor", "--seeds", "5", "--lock", "7", "--quiet")
    lines = {line.split("  ")[0]: line.split() for line in shown.splitlines()}
    assert code == 0 and lines["detector"][1:3] == ["0", "(0"] and lines["detector"][7] == "5"
    assert any(name.startswith("ekf: 3σ band of its values") for name in lines)
    assert call("trial", "friction-motor", "--seeds", "0")[0] == 2


def test_observers_run_on_a_record_and_are_written(call):
    """The files hold the estimates of the observers; the report names the fault and the command that repeats it."""
    write(recorded(call, "friction-motor", "--set", "seed=5"))
    files = ("--out", "found.html", "--out", "found.csv", "--out", "found.parquet")
    code, _, _ = call("diagnose", "friction-motor", "rec.csv", "--observer", "joint-ekf", *files)
    report = Path("found.html").read_text(encoding="utf-8")
    assert code == 0 and "added friction" in report and "--observer joint-ekf" in report
    with open("found.csv", newline="") as file:
        head, *rows = csv.reader(file)
    table = polars.read_parquet("found.parquet")
    assert table.columns == head and len(rows) == len(table) and "x.speed" not in head
    last = float(rows[-1][head.index("joint-ekf.theta.friction")])
    assert table["joint-ekf.theta.friction"][-1] == last and abs(last - 9) < 1.5
    code, _, error = call("diagnose", "friction-motor", "rec.csv", "--observer", "joint-efk")
    assert code != 0 and "joint-ekf" in error
