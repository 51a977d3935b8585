"""The page of records: a file, a plant, and the diagnosis."""

import numpy as np
import pytest

from thetascope import library
from thetascope.assembly import prepare
from thetascope_schemas import Experiment


def record(path, name: str = "friction-motor") -> None:
    """Return a run's measurement as a CSV file with bare column names and a clock that does not start at zero."""
    changes = {"observers": [], "figures": [], "diagnosis": {"enabled": False}, "seed": 5}
    run = prepare(library.resolve(Experiment.model_validate(library.experiment(name).model_dump() | changes))).run()
    columns = {
        n.partition(".")[2] or n: run.column(n) for n in run.names if n == "t" or n.startswith(("u.", "signal.", "y."))
    }
    columns["t"] = columns["t"] + 100
    np.savetxt(
        path, np.stack(list(columns.values()), axis=1), delimiter=",", header=",".join(columns), comments="", fmt="%.9g"
    )


@pytest.mark.parametrize("spreadsheet", [False, True])
def test_a_file_is_diagnosed(page, tmp_path, spreadsheet):
    """The fault is identified with size and onset on the record's clock, and marked in every output; also with
    semicolons."""
    record(tmp_path / "motor.csv")
    if spreadsheet:
        text = (tmp_path / "motor.csv").read_text()
        (tmp_path / "motor.csv").write_text(text.replace(",", ";").replace(".", ","))
    opened = page("/records/")
    opened.wait_for_selector(".names code")
    opened.select_option("#plant", "friction-motor")
    opened.wait_for_selector(".names code:text-is('torque')")
    opened.set_input_files("#file", tmp_path / "motor.csv")
    opened.click("button.run")
    row = opened.wait_for_selector(".found tbody tr").inner_text().split("\t")
    assert (
        "friction" in row[0] and row[1].lstrip().startswith("+") and 109 < float(row[2]) < 111 and row[-1] == "still on"
    )
    assert opened.locator(".course").count() == 2 and opened.locator(".course line").count() == 2
    assert opened.watch.errors == [] and opened.watch.foreign == []


def test_a_simulated_record_and_mistakes(page, tmp_path):
    """A missing file is reported, a simulated record can be used instead, and an unsuitable file is refused with the
    remedy."""
    opened = page("/records/")
    opened.wait_for_selector(".names code")
    opened.click("button.run")
    opened.wait_for_selector(".buttons [role=status]:has-text('Choose a file')")
    opened.select_option("#plant", "dts200")
    opened.click("button:text-is('Simulate a record')")
    opened.wait_for_selector(".buttons [role=status]:has-text('dts200')")
    opened.click("button.run")
    opened.wait_for_selector(".found tbody tr:nth-child(4)")
    record(tmp_path / "motor.csv")
    opened.set_input_files("#file", tmp_path / "motor.csv")
    opened.click("button.run")
    assert "y1" in opened.wait_for_selector(".problem").inner_text()


def test_only_required_columns_are_sent_and_a_change_of_language_keeps_the_result(page, tmp_path):
    """Of a file with 30 more columns only the plant's are sent; file, plant and result stay."""
    record(tmp_path / "motor.csv")
    head, *lines = (tmp_path / "motor.csv").read_text().splitlines()
    more = [f"adaptive.x.{k}" for k in range(30)]
    wide = [",".join([*more, head]), *(",".join(["0.123456789"] * 30 + [line]) for line in lines)]
    (tmp_path / "wide.csv").write_text("\n".join(wide))
    opened = page("/records/")
    opened.wait_for_selector(".names code")
    opened.select_option("#plant", "friction-motor")
    opened.set_input_files("#file", tmp_path / "wide.csv")
    sent = []
    opened.on(
        "request",
        lambda request: sent.append(request.post_data_json) if request.url.endswith("/api/diagnosis") else None,
    )
    opened.click("button.run")
    before = opened.wait_for_selector(".found tbody tr").inner_text().split("\t")
    assert sent[0]["csv"].splitlines()[0].split(",")[0] == "t" and "adaptive" not in sent[0]["csv"]
    opened.click(".top button[lang=zh]")
    opened.wait_for_selector("h1:text-is('记录')")
    after = opened.inner_text(".found tbody tr").split("\t")
    assert after[1:5] == before[1:5] and after[-1] != before[-1]
    assert (
        opened.input_value("#plant") == "friction-motor"
        and opened.evaluate("document.querySelector('#file').files[0].name") == "wide.csv"
    )
    opened.click(".top button[lang=en]")
    opened.wait_for_selector("h1:text-is('Records')")
    assert opened.watch.errors == []
