"""`thetascope inspect`, and its options on `thetascope diagnose`."""

import json
import re
from pathlib import Path

import pytest
import yaml

from tests.records.tank import changed, plant, rows, text


@pytest.fixture
def tank(tmp_path) -> str:
    """Write the plant of the leaky tank to a file, and return its name."""
    Path("tank.yaml").write_text(yaml.safe_dump(plant().model_dump(mode="json")))
    return "tank.yaml"


def test_an_inspection_is_printed_and_written(call, tank):
    """Columns with their use and unit, findings with rows, and what was looked for; the same as JSON."""
    Path("rig.csv").write_text(text(changed(range(100, 103), 1, -9999), "t [min],Flow,Level (m),note"[:-5]))
    code, shown, _ = call("inspect", tank, "rig.csv", "--json", "rig.json")
    document = json.loads(Path("rig.json").read_text())
    assert code == 0 and document["ready"] and document["rows"] == 400
    assert "3 readings of -9999 (rows 102–104); taken as missing; the value before is held" in shown
    assert re.search(r"Level \(m\) .* y +m → cm", shown) and "no gaps" in shown
    _, chinese, _ = call("--language", "zh", "inspect", tank, "rig.csv")
    assert "视为缺失" in chinese and "没有间断" in chinese


def test_the_mapping_is_changed_by_options(call, tank):
    """Columns, units, times and periods; a wrong one is refused with the choices."""
    Path("rig.csv").write_text(text([[q, y / 100] for _, q, y in rows()], "a,b"))
    code, shown, _ = call("inspect", tank, "rig.csv")
    assert code == 1 and "give the period from row to row" in shown
    options = ("--map", "q=a", "--map", "y=b", "--unit", "y=m", "--period", "0.5")
    code, shown, _ = call("inspect", tank, "rig.csv", *options, "--json", "rig.json")
    document = json.loads(Path("rig.json").read_text())
    assert code == 0 and document["times"]["period"] == 0.5
    assert {q["name"]: (q["column"], q["factor"]) for q in document["quantities"]} == {"q": ("a", 1), "y": ("b", 100)}
    for wrong, words in (
        (("--map", "q=c"), "a or b"),
        (("--map", "q"), "NAME=VALUE"),
        (("--unit", "y=bar"), "cannot be"),
    ):
        code, _, error = call("inspect", tank, "rig.csv", *options, *wrong)
        assert code == 1 and words in error, error


@pytest.mark.parametrize(
    ("content", "words"),
    [(b"t,q,y\n0,1,2\n7\n1,2,3\n", "line 3 is not a row of 3 numbers"), (b"PAR1....", "not a valid parquet file")],
)
def test_a_file_that_cannot_be_read_is_refused_by_name(call, tank, content, words):
    """The file, the row and the remedy."""
    Path("rig.dat").write_bytes(content)
    for command in ("inspect", "diagnose"):
        code, _, error = call(command, tank, "rig.dat")
        assert code == 1 and error.startswith("thetascope: rig.dat: ") and words in error and ";" in error
