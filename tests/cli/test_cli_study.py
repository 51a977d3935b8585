"""`thetascope study`: the table, the files, and that a study which is killed goes on."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import polars as pl
import pytest

from tests.studies.study_samples import GAINS, computed, study
from thetascope.cli.main import main


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """GAINS as a file; YAML reads JSON."""
    path = tmp_path / "gains.yaml"
    path.write_text(json.dumps(GAINS))
    return path


def test_a_study_prints_a_row_for_each_point_and_writes_all_runs(file: Path, capsys: pytest.CaptureFixture[str]):
    """CSV and Parquet hold every run, LaTeX every point; the folder holds the study."""
    outs = [file.with_suffix(s) for s in (".csv", ".parquet", ".tex")]
    assert main(["study", str(file), "--threads", "--quiet", *(f"--out={out}" for out in outs)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split()[:3] == ["rho", "noise", "runs"] and len(lines) == 1 + 6 + 1
    table = pl.read_parquet(outs[1])
    assert table.equals(pl.read_csv(outs[0], schema=table.schema)) and len(table) == 108
    assert outs[2].read_text().count(r"\\") == 7
    assert main(["study", str(file.with_suffix(".study")), "--quiet", "--measure", "settling.adaptive.theta3"]) == 0
    assert "settling.adaptive.theta3" in capsys.readouterr().out


def test_a_killed_study_goes_on_with_the_same_bits(file: Path):
    """SIGKILL to the command after its first block; its processes end too; the second call completes the table."""
    script = "import sys; from thetascope.cli.main import main; sys.exit(main(sys.argv[1:]))"
    command = [sys.executable, "-c", script, "study", str(file), "--workers", "1", "--quiet"]
    blocks = file.with_suffix(".study") / "blocks"
    first = subprocess.Popen(command, stdout=subprocess.DEVNULL, start_new_session=True)
    until = time.monotonic() + 120
    while not (blocks.is_dir() and any(p.suffix == ".parquet" for p in blocks.iterdir())):
        assert time.monotonic() < until and first.poll() is None, "no block was written"
        time.sleep(0.01)
    first.send_signal(signal.SIGKILL)
    first.wait()
    while _alive(first.pid):
        assert time.monotonic() < until, "a worker outlives the command"
        time.sleep(0.05)
    kept = {p.name for p in blocks.iterdir() if p.suffix == ".parquet"}
    assert subprocess.run(command, stdout=subprocess.DEVNULL, timeout=300).returncode == 0
    after = {p.name for p in blocks.iterdir() if p.suffix == ".parquet"}
    assert kept <= after and len(after) == 2
    again = computed(study(GAINS), file.parent / "again")
    assert pl.concat([pl.read_parquet(blocks / n) for n in sorted(after)], how="diagonal").equals(again)


def _alive(group: int) -> bool:
    """Return whether a process of a group is left."""
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("experiment: zhao-2013", "zhao-2012"),
        ("experiment: zhao-2012\nseeds: 0", "seeds"),
        ("experiment: zhao-2012\nvary: [{kind: list, path: noise.y.stdd, values: [1]}]", "stdd"),
        ("seeds: 2", "experiment"),
    ],
)
def test_a_wrong_study_is_refused_by_name(text: str, expected: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Exit code 1, the field and the remedy."""
    path = tmp_path / "wrong.yaml"
    path.write_text(text)
    assert main(["study", str(path), "--quiet"]) == 1
    assert expected in capsys.readouterr().err
