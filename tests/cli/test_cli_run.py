"""`thetascope run`: from an experiment to numbers."""

import csv
import io
import json
import signal
import subprocess
import sys

import numpy as np
import pytest
import yaml
from scipy.io import loadmat

from tests.cli.conftest import ROOT
from tests.runs.samples import long_data, spec_data
from thetascope.cli.terminal import Progress, table
from thetascope.cli.words import Words


def columns(path) -> dict[str, np.ndarray]:
    """Return a CSV file by column name."""
    head, *rows = csv.reader(path.open())
    return dict(zip(head, np.array(rows, dtype=float).T, strict=True))


def test_the_csv_meets_the_targets_of_the_paper(call, tmp_path):
    """Means to 1e-6 and states to 1e-7 from `thetascope run zhao-2012-noise-free --out a.csv` (READING.md §1)."""
    assert call("run", "zhao-2012-noise-free", "--out", "a.csv")[0] == 0
    found = columns(tmp_path / "a.csv")
    for (start, end), truth in {
        (30, 40): (0, 0, 0.02),
        (55, 70): (0.01, 0, 0.02),
        (90, 100): (0.01, 0.015, 0.02),
    }.items():
        window = (found["t"] >= start) & (found["t"] < end)
        means = [found[f"adaptive.theta.theta{i}"][window].mean() for i in (1, 2, 3)]
        assert means == pytest.approx(truth, abs=1e-6)
        for state in ("x1", "x2"):
            error = (found[f"adaptive.x.{state}"] - found[f"x.{state}"])[window]
            assert np.sqrt(np.mean(error**2)) <= 1e-7


def test_one_run_writes_every_format_with_the_same_numbers(call, tmp_path):
    """CSV, JSON, MATLAB and a report in one call."""
    outputs = [part for name in ("a.csv", "a.json", "a.mat", "a.html") for part in ("--out", name)]
    code, shown, _ = call("run", "shen-hu-2015", "--set", "horizon=2", *outputs)
    assert code == 0 and "nonsmooth" in shown
    exact = columns(tmp_path / "a.csv")
    plain = json.loads((tmp_path / "a.json").read_text())["columns"]
    assert plain["x.x1"] == exact["x.x1"].tolist()
    assert np.array_equal(loadmat(tmp_path / "a.mat")["nonsmooth_theta_theta"].ravel(), exact["nonsmooth.theta.theta"])
    html = (tmp_path / "a.html").read_text()
    assert "thetascope run shen-hu-2015 --set horizon=2 --out a.html" in html


def test_the_same_command_again_writes_the_same_file_from_the_store(call, tmp_path, monkeypatch):
    """Byte for byte, and without the engine, which is removed in between."""
    assert call("run", "shen-hu-2015", "--set", "horizon=2", "--out", "a.csv")[0] == 0
    monkeypatch.setattr("thetascope.assembly.prepare", None)
    assert call("run", "shen-hu-2015", "--set", "horizon=2", "--out", "b.csv")[0] == 0
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()


def test_a_file_in_yaml_or_json_runs_and_a_change_by_path_takes_effect(call, tmp_path):
    """`--set` changes the file's values; without noise the measurement equals the output."""
    (tmp_path / "e.json").write_text(json.dumps(spec_data()))
    assert call("run", "e.json", "--set", "noise.y.std=0", "--set", "seed=3", "--out", "a.csv", "--quiet") == (
        0,
        "",
        "",
    )
    found = columns(tmp_path / "a.csv")
    assert np.array_equal(found["y.y"], found["x.x"])
    (tmp_path / "e.yaml").write_text("experiment: shen-hu-2015\nset:\n  horizon: 1\n  step: 1e-3\n")
    assert call("run", "e.yaml", "--no-store")[0] == 0


def test_the_table_has_truth_estimate_and_settling_of_each_fault(call, tmp_path):
    """A reader sees whether the observer works."""
    faults = [{"channel": "gain", "shape": "step", "onset": 2, "size": 0.2}]
    (tmp_path / "e.json").write_text(json.dumps(spec_data(horizon=20, faults=faults)))
    code, shown, _ = call("run", "e.json")
    head, row = [line.split("  ") for line in shown.splitlines() if line.startswith(("OBSERVER", "kalman"))][:2]
    cells = dict(zip([h.strip() for h in head if h], [c.strip() for c in row if c], strict=True))
    assert code == 0 and cells["FAULT"] == "gain" and cells["TRUE"] == "0.2"
    assert float(cells["ESTIMATE"]) == pytest.approx(0.2, abs=0.02)
    assert cells["SETTLED"].endswith(" s")


def test_several_observers_are_compared_on_the_screen_and_in_files(call, tmp_path):
    """One line per observer with errors and cost; files contain every measure; a single observer has no such table."""
    pair = [{"label": label, "kind": "adaptive-kalman"} for label in ("one", "two")]
    (tmp_path / "e.json").write_text(json.dumps(spec_data(observers=pair)))
    code, shown, _ = call("run", "e.json", "--comparison", "c.csv", "--comparison", "c.json")
    assert code == 0 and "RMSE x" in shown and "cost in µs per simulated second" in shown
    lines = list(csv.DictReader((tmp_path / "c.csv").open()))
    compared = json.loads((tmp_path / "c.json").read_text())
    assert [row["label"] for row in compared["observers"]] == ["one", "two", "detector"]
    assert compared["observers"][0]["rmse"] == compared["observers"][1]["rmse"]  # the same observer twice
    found = [float(line["value"]) for line in lines if (line["measure"], line["of"]) == ("rmse", "x.x")]
    assert found == 2 * compared["observers"][0]["rmse"]["x.x"]
    assert [w["end"] for w in compared["windows"]] == [0.5, 1.0]


def test_observers_that_diverged_or_estimate_no_fault_are_reported_in_words(call):
    """The table has no cells for them."""
    code, shown, _ = call("run", "zhao-2012-as-printed")
    assert code == 0 and "adaptive diverged at 0.7" in shown and "OBSERVER" not in shown
    _, shown, _ = call("run", "reduced-order-mimo", "--set", "horizon=1")
    assert "reduced estimates states only; rms errors" in shown


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["run", "zhao-2021"], 1, "did you mean zhao-2012"),
        (["run", "none.yaml"], 1, "No such file"),
        (["run", "shen-hu-2015", "--set", "observers.linear.gain.rho=1"], 1, "did you mean gains"),
        (["run", "shen-hu-2015", "--set", "observers.linear.gains.nope=1"], 1, "observers[1].gains.nope"),
        (["run", "shen-hu-2015", "--set", "seed"], 1, "path=value"),
        (["run", "shen-hu-2015", "--set", "horizon=1e9"], 1, "the limit is"),
        (["run", "shen-hu-2015", "--set", "horizon=10000", "--set", "record=0.001"], 1, "THETASCOPE_MAX_RESULT"),
        (["run", "shen-hu-2015", "--out", "a.txt"], 2, "'a.txt' does not end in .csv"),
        (["run", "shen-hu-2015", "--out", "no/a.csv"], 2, "there is no folder"),
        (["run", "shen-hu-2015", "--comparison", "a.html"], 2, "'a.html' does not end in .csv or .json"),
        (["run"], 2, "EXPERIMENT"),
        (["fly"], 2, "invalid choice"),
        ([], 2, "COMMAND"),
    ],
)
def test_errors_have_an_exit_code_and_a_reason_on_stderr(call, arguments, code, words):
    """1 for a refused request, 2 for wrong usage; nothing on stdout, so that pipes stay clean."""
    found, shown, error = call(*arguments)
    assert (found, shown) == (code, "")
    assert words in error


def test_an_error_in_an_experiment_file_is_shown_at_its_position(call, tmp_path):
    """file:line:column, the line, and a mark below; all errors together."""
    (tmp_path / "e.yaml").write_text(
        "plant: shen-hu-2015\nhorizon: 10\nfaults:\n  - {channel: theta, shape: step, onset: soon, size: 1}\n"
        "seed: 1.5\n"
    )
    code, _, error = call("run", "e.yaml")
    assert code == 1
    assert "e.yaml:4:42: faults[0].onset" in error
    assert "e.yaml:5:7: seed" in error
    lines = error.splitlines()
    mark = next(i for i, line in enumerate(lines) if line.strip() == "^")
    assert lines[mark - 1][lines[mark].index("^") :].startswith("soon")


def test_invalid_settings_and_damaged_stores_are_reported(call, tmp_path, monkeypatch):
    """A run does not need a store, so it continues without one."""
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "runs.sqlite").write_text("no database " * 500)
    code, shown, error = call("run", "shen-hu-2015", "--set", "horizon=1")
    assert code == 0 and "OBSERVER" in shown and "the run is not kept" in error and "move the file away" in error
    monkeypatch.setenv("THETASCOPE_MAX_STEPS", "many")
    code, _, error = call("run", "shen-hu-2015")
    assert code == 1 and "THETASCOPE_MAX_STEPS is 'many'" in error


def test_ctrl_c_stops_a_long_run_with_exit_code_130(tmp_path):
    """It ends without a traceback."""
    (tmp_path / "e.json").write_text(json.dumps(long_data()))
    # Where the tests run in the background of a shell, SIGINT is ignored by all that they start.
    code = "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler); "
    code += "from thetascope.cli import main, terminal; terminal._PLAIN_EVERY = 0; sys.exit(main.main())"
    command = [sys.executable, "-c", code, "run", str(tmp_path / "e.json"), "--no-store"]
    process = subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, text=True)
    try:
        assert "%" in process.stderr.readline()  # it runs, and reports its progress
        process.send_signal(signal.SIGINT)
        _, error = process.communicate(timeout=120)
    finally:
        process.kill()
    assert process.returncode == 130
    assert "interrupted" in error and "Traceback" not in error


class Terminal(io.StringIO):
    """A stream that is a terminal."""

    def isatty(self) -> bool:
        return True


def test_the_progress_is_a_bar_on_a_terminal_and_lines_elsewhere(monkeypatch):
    """A log is not filled with carriage returns; short runs print nothing."""
    now = [0.0]
    monkeypatch.setattr("thetascope.cli.terminal.time.monotonic", lambda: now[0])
    terminal, log, quiet = Terminal(), io.StringIO(), Terminal()
    bars = [Progress(Words(), terminal), Progress(Words(), log), Progress(Words(), quiet, quiet=True)]
    for second in range(100):
        now[0] = second / 10
        for bar in bars:
            bar.show(second / 100)
        if second == 2:
            assert terminal.getvalue() == ""
    for bar in bars:
        bar.close()
    assert (
        terminal.getvalue().count("\r") > 50 and "█" in terminal.getvalue() and terminal.getvalue().endswith("\x1b[K")
    )
    assert log.getvalue().splitlines() == ["50%, 5 s left"]
    assert quiet.getvalue() == ""


def test_a_table_aligns_numbers_right_and_words_left():
    """Decimal places of a column are aligned."""
    assert table(["NAME", "N"], [["a", "1"], ["bcd", "-10"]]) == "NAME    N\na       1\nbcd   -10"


PLANT = """
id: lag
states: [{name: x}]
inputs: [{name: u, default: 1}]
outputs: [{name: y, expression: x}]
dynamics: {x: u - x}
"""


def test_an_experiment_names_a_plant_file_beside_it(call, tmp_path):
    """The run is that of the experiment with the plant written out; a mistake is shown in the plant's file."""
    folder = tmp_path / "bench"
    (folder / "plants").mkdir(parents=True)
    plant, experiment = folder / "plants" / "lag.yaml", folder / "step.yaml"
    plant.write_text(PLANT)
    experiment.write_text("plant: plants/lag.yaml\nhorizon: 2\nstep: 0.01\n")
    inline = tmp_path / "inline.json"
    inline.write_text(json.dumps({"plant": yaml.safe_load(PLANT), "horizon": 2, "step": 0.01}))
    runs = [tmp_path / f"{k}.csv" for k in range(2)]
    for file, out in zip((experiment, inline), runs, strict=True):
        code, _, error = call("run", str(file), "--out", str(out), "--quiet")
        assert (code, error) == (0, "")
    assert runs[0].read_bytes() == runs[1].read_bytes()
    plant.write_text(PLANT.replace("default", "defautl"))
    code, _, error = call("run", str(experiment))
    assert code != 0
    assert "lag.yaml:4:" in error and "did you mean default" in error


@pytest.mark.parametrize(
    "name", ["../lag.yaml", "/etc/lag.yaml", "absent.yaml", "C:\\lag.yaml", "link.yaml", "lag.txt/"]
)
def test_a_plant_file_elsewhere_is_not_read(call, tmp_path, name):
    """A path out of the experiment's folder, also by a link, and a file that is absent are refused at their place."""
    (tmp_path / "lag.yaml").write_text(PLANT)
    folder = tmp_path / "bench"
    folder.mkdir()
    (folder / "link.yaml").symlink_to(tmp_path / "lag.yaml")
    (folder / "step.yaml").write_text(f"plant: '{name}'\nhorizon: 2\nstep: 0.01\n")
    code, out, error = call("run", str(folder / "step.yaml"))
    assert code != 0
    assert out == ""
    assert "step.yaml:1:8" in error
