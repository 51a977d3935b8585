"""`thetascope bench FOLDER`: known faults of recorded data against findings, hashes checked, nothing hidden."""

import hashlib
import json
from pathlib import Path

import pytest
import yaml

from tests.cli.test_cli_diagnose import recorded, write

FAULT = {"channel": "friction", "onset": 10.0, "size": 9.0}


def sha(name: str) -> str:
    return hashlib.sha256(Path("rig", name).read_bytes()).hexdigest()


def record(name: str, **more) -> dict:
    return {"file": name, "sha256": sha(name), "plant": "friction-motor"} | more


@pytest.fixture
def rig(call) -> Path:
    """Return a folder with a faulty and a healthy record."""
    Path("rig").mkdir()
    write(recorded(call, "friction-motor", "--set", "seed=5"), "rig/faulty.csv")
    write(recorded(call, "friction-motor", "--set", "faults=[]"), "rig/healthy.csv")
    return Path("rig")


def scores(call, rig: Path, *records: dict) -> tuple[str, list[dict]]:
    rig.joinpath("benchmark.yaml").write_text(yaml.safe_dump({"title": "Rig", "records": list(records)}))
    code, shown, _ = call("bench", "rig", "--out", "scores.json", "--out", "scores.md", "--quiet")
    assert code == 0 and Path("scores.md").read_text().startswith("| RECORD |")
    return shown, json.loads(Path("scores.json").read_text())


def test_known_faults_are_scored_and_files_that_cannot_be_are_listed(call, rig):
    """Found within 1 s with intervals that hold; nothing false; other bytes and a missing file stay with the reason."""
    published = [{"method": "CUSUM", "found": True, "delay": 2.5, "source": "somebody, 2001"}]
    shown, rows = scores(
        call,
        rig,
        record("faulty.csv", faults=[FAULT], published=published),
        record("healthy.csv"),
        record("healthy.csv") | {"sha256": "0" * 64},
        record("healthy.csv") | {"file": "absent.csv"},
    )
    faulty, healthy, other, absent = rows
    assert faulty["found"] and 0 < faulty["delay_s"] < 1 and faulty["false"] == 0
    assert faulty["size_held"] and faulty["onset_held"] and faulty["size_error"] < 0.3
    assert "CUSUM 2.5 s ✓ (somebody, 2001)" in shown
    assert healthy["false"] == 0 and healthy["fault"] is None
    assert other["false"] is None and sha("healthy.csv")[:16] in other["note"]
    assert absent["false"] is None and "not in the folder" in absent["note"]


def test_what_is_not_there_is_missed_or_false(call, rig):
    """A fault that the record does not hold is missed; one that is not declared makes its finding false."""
    _, rows = scores(call, rig, record("healthy.csv", faults=[FAULT]), record("faulty.csv"))
    assert rows[0]["found"] is False and rows[0]["delay_s"] is None and rows[0]["false"] == 0
    assert rows[1]["false"] == 1


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"file": "../healthy.csv"}, "records[0].file"),
        ({"plant": "../plant.yaml"}, "records[0].plant"),
        ({"faults": [FAULT | {"channel": "frictoin"}]}, "records[0].faults[0].channel"),
        ({"sha256": "abc"}, "sha256"),
    ],
)
def test_a_wrong_benchmark_is_refused_with_the_field(call, rig, change, problem):
    """Files outside of the folder, channels that the plant lacks, and hashes that are none."""
    whole = {"title": "Rig", "records": [record("healthy.csv") | change]}
    rig.joinpath("benchmark.yaml").write_text(yaml.safe_dump(whole))
    code, _, errors = call("bench", "rig", "--quiet")
    assert code != 0 and problem in errors and "Traceback" not in errors
