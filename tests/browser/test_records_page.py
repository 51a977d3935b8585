"""The page of records: a file, a plant, and what the file shows."""

import numpy as np

from backend import library
from backend.assembly import prepare
from shared import Experiment


def record(path, name: str = "friction-motor") -> None:
    """A run's measurement as a CSV file, its columns by their bare names, its clock not at zero."""
    changes = {"observers": [], "figures": [], "diagnosis": {"enabled": False}, "seed": 5}
    run = prepare(Experiment.model_validate(library.experiment(name).model_dump() | changes)).run()
    columns = {n.partition(".")[2] or n: run.column(n) for n in run.names if n == "t" or n.startswith(("u.", "signal.", "y."))}
    columns["t"] = columns["t"] + 100
    np.savetxt(path, np.stack(list(columns.values()), axis=1), delimiter=",", header=",".join(columns), comments="", fmt="%.9g")


def test_a_file_is_diagnosed(page, tmp_path):
    """The fault is named with its size and its onset on the record's own clock, marked in every output; no error, nothing foreign."""
    record(tmp_path / "motor.csv")
    opened = page("/records/")
    opened.wait_for_selector(".names code")
    opened.select_option("#plant", "friction-motor")
    opened.wait_for_selector(".names code:text-is('torque')")
    opened.set_input_files("#file", tmp_path / "motor.csv")
    opened.click("button.run")
    row = opened.wait_for_selector(".found tbody tr").inner_text().split("\t")
    assert "friction" in row[0] and row[1].lstrip().startswith("+") and 109 < float(row[2]) < 111 and row[-1] == "still on"
    assert opened.locator(".course").count() == 2 and opened.locator(".course line").count() == 2
    assert opened.watch.errors == [] and opened.watch.foreign == []


def test_a_simulated_record_and_mistakes(page, tmp_path):
    """Without a file one is asked for, a run can be taken in its place, and a file that does not fit is refused with the remedy."""
    opened = page("/records/")
    opened.wait_for_selector(".names code")
    opened.click("button.run")
    opened.wait_for_selector(".buttons [role=status]:has-text('Choose a file')")
    opened.select_option("#plant", "dts200")
    opened.click("button:text-is('No record at hand: simulate one')")
    opened.wait_for_selector(".buttons [role=status]:has-text('dts200')", timeout=60_000)
    opened.click("button.run")
    opened.wait_for_selector(".found tbody tr:nth-child(4)", timeout=60_000)
    record(tmp_path / "motor.csv")
    opened.set_input_files("#file", tmp_path / "motor.csv")
    opened.click("button.run")
    assert "y1" in opened.wait_for_selector(".problem").inner_text()
