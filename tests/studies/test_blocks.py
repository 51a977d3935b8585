"""Blocks of runs: the same bits as single runs, whoever computes them and in whatever order."""

import os
import signal
import time
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from tests.studies.study_samples import GAINS, computed, study
from thetascope.assembly import prepare
from thetascope.assembly.build.diagnosis_settings import findings
from thetascope.diagnosis.evaluation.observer_comparison import DETECTOR, compare
from thetascope.runs.specs.refusals import InvalidSpec, Refusal
from thetascope.studies.block import compute
from thetascope.studies.conduct import conduct
from thetascope.studies.engines import LocalEngine
from thetascope.studies.kept import Kept, document_of
from thetascope.studies.plan import at_place, experiment_of_point, place_of

DETECTION = {
    "experiment": "friction-motor",
    "vary": [{"kind": "list", "path": "diagnosis.false_alarms", "values": [0.01, 0.3], "name": "rate"}],
    "seeds": 2,
    "faults": "both",
}


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> pl.DataFrame:
    """The table of GAINS, from two threads."""
    return computed(study(GAINS), tmp_path_factory.mktemp("gains"))


def test_each_run_in_lanes_has_the_numbers_of_the_run_alone(table: pl.DataFrame):
    """Errors and means agree bit for bit with `prepare(...).run()` of the experiment with the id in the table."""
    one = study(GAINS)
    for number in (0, 17, 61, 107):
        row = table.row(number, named=True)
        place = place_of(one, number)
        spec = at_place(experiment_of_point(one, place.point), place).model_copy(update={"substeps": row["substeps"]})
        assert spec.spec_hash() == row["id"] and row["run"] == number and row["faulty"] == (number % 2 == 0)
        result = prepare(spec).run()
        error = result.column("adaptive.theta.theta3") - result.column("theta.theta3")
        assert row["rmse.adaptive.theta.theta3"] == float(np.sqrt(np.mean(np.abs(error) ** 2)))
        assert row["peak.adaptive.x.x1"] == float(np.abs(result.column("adaptive.x.x1") - result.column("x.x1")).max())
        late = result.column("t") >= 3.0 - 1e-6
        assert row["number.end"] == float(np.mean(result.column("adaptive.theta.theta3")[late]))


def test_workers_and_their_number_change_no_bit(table: pl.DataFrame, tmp_path: Path):
    """One thread, and two processes, write the same files; blocks may come in any order."""
    one = study(GAINS)
    assert computed(one, tmp_path / "alone", 1).equals(table)
    assert computed(one, tmp_path / "processes", 2, threads=False).equals(table)
    names = [sorted(p.name for p in (tmp_path / place / "blocks").iterdir()) for place in ("alone", "processes")]
    assert names[0] == names[1]
    document = document_of(one)
    assert compute(document, 64, 108) == (tmp_path / "alone/blocks" / names[0][1]).read_bytes()


def test_measures_of_the_detector_are_those_of_single_runs(tmp_path: Path):
    """Delay, false alarms and faults found agree with the comparison of each run."""
    one = study(DETECTION)
    table = computed(one, tmp_path)
    for row in table.iter_rows(named=True):
        place = place_of(one, row["run"])
        spec = at_place(experiment_of_point(one, place.point), place)
        assert spec.diagnosis.false_alarms == row["rate"]
        result = prepare(spec).run()
        expected = next(r for r in compare(result, spec.faults, findings(result)).rows if r.label == DETECTOR)
        assert row["false.detector"] == expected.false_alarms
        assert row["delay.detector.friction"] == expected.delay
        assert (row["found.detector.friction"] == 1) == (expected.count("found") == 1) or not place.faulty


def test_a_run_that_is_refused_says_why_and_stops_nothing(tmp_path: Path):
    """One gain of three is out of its bounds."""
    vary = [{"kind": "list", "path": "observers.adaptive.gains.rho", "values": [4, -1], "name": "rho"}]
    table = computed(study(GAINS, vary=vary, seeds=2), tmp_path)
    refused = table.filter(pl.col("rho") < 0)
    assert refused["error"].str.contains("rho").all() and refused["rmse.adaptive.x.x1"].null_count() == len(refused)
    assert table.filter(pl.col("rho") > 0)["error"].null_count() == 4


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"vary": [{"kind": "list", "path": "observers.nobody.gains.rho", "values": [1]}]}, "override.item.unknown"),
        ({"vary": [{"kind": "observers", "labels": ["nobody"]}]}, "study.label.unknown"),
        ({"set": {"horizont": 3}}, "override.field.unknown"),
    ],
)
def test_a_study_of_what_does_not_exist_is_refused_at_once(changes: dict, problem: str):
    """A path, an observer."""
    with pytest.raises(InvalidSpec) as refused:
        study(GAINS, **changes)
    assert refused.value.errors[0].code == problem


def test_a_study_in_which_nothing_can_be_measured_ends_after_its_first_block(tmp_path: Path):
    """A column that no run has."""
    wrong = {"end": {"kind": "level", "take": "mean", "column": "adaptive.theta.nothing"}}
    with pytest.raises(Refusal) as refused:
        computed(study(GAINS, numbers=wrong), tmp_path)
    assert "adaptive.theta.nothing" in str(refused.value)


# ---- kept, resumed, damaged ------------------------------------------------------------------------------------------


def test_what_is_kept_is_not_computed_again_and_damage_is(table: pl.DataFrame, tmp_path: Path):
    """A block with a flipped bit counts as missing; the others are left as they are."""
    one = study(GAINS)
    computed(one, tmp_path)
    first, second = sorted((tmp_path / "blocks").iterdir())
    begun = second.stat().st_mtime_ns
    data = bytearray(first.read_bytes())
    data[len(data) // 2] ^= 1
    first.write_bytes(bytes(data))
    (tmp_path / "blocks" / "0000001-0123456789abcdef.parquet.tmp").write_bytes(b"half")
    assert Kept(one, tmp_path).check() == [0]
    assert computed(one, tmp_path).equals(table)
    assert second.stat().st_mtime_ns == begun


def test_a_folder_of_another_study_is_refused(tmp_path: Path):
    """Titles do not matter, seeds do."""
    Kept(study(GAINS), tmp_path)
    Kept(study(GAINS, title="Another title"), tmp_path)
    with pytest.raises(Refusal):
        Kept(study(GAINS, seeds=10), tmp_path)


def test_blocks_of_another_version_are_not_completed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """They can be read, but no row of this version joins them."""
    one = study(GAINS)
    kept = Kept(one, tmp_path)
    kept.check()
    kept.add(0, compute(document_of(one), 0, 64))
    (tmp_path / "version.txt").write_text("0000000000000000")
    assert len(Kept(one, tmp_path).table()) == 64
    with pytest.raises(Refusal, match="another version"):
        Kept(one, tmp_path).check()


def test_a_full_disk_loses_nothing(table: pl.DataFrame, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Writing the second block fails; the next call computes that block only."""
    one = study(GAINS)
    kept = Kept(one, tmp_path)
    whole = kept._files.write
    written: list[str] = []

    def full(name: str, data: bytes) -> None:
        if written:
            raise OSError(28, "No space left on device")
        whole(name, data)
        written.append(name)

    monkeypatch.setattr(kept._files, "write", lambda name, data: full(name, data) if "blocks" in name else None)
    engine = LocalEngine(1, threads=True)
    with pytest.raises(Refusal, match="No space left on device"):
        conduct(kept, engine)
    engine.close()
    assert len(Kept(one, tmp_path).check()) == 1
    assert computed(one, tmp_path).equals(table)


def test_a_killed_worker_costs_only_its_block(table: pl.DataFrame, tmp_path: Path):
    """SIGKILL to a process in the middle; all rows are there once, with the same bits."""
    one = study(GAINS)
    kept = Kept(one, tmp_path)
    engine = LocalEngine(1)
    killed: list[int] = []

    def kill(_progress: object) -> None:
        processes = list((getattr(engine._pool, "_processes", None) or {}).values())
        if processes and not killed:
            killed.append(processes[0].pid)
            os.kill(processes[0].pid, signal.SIGKILL)

    try:
        engine.submit(document_of(one), 0, 1).result()  # the process is there
        conduct(kept, engine, kill)
    finally:
        engine.close()
    assert killed and kept.table().equals(table)


def test_progress_counts_runs_and_cancelling_keeps_them(tmp_path: Path):
    """The first block is kept; nothing more is begun."""
    one = study(GAINS)
    kept = Kept(one, tmp_path)
    seen: list[int] = []
    engine = LocalEngine(1, threads=True)
    conduct(kept, engine, lambda now: seen.append(now.done), lambda: len(seen) > 1)
    engine.close()
    assert seen == [0, 64] and len(Kept(one, tmp_path).table()) == 64


def test_the_table_is_the_same_from_an_address(table: pl.DataFrame):
    """Any place that fsspec knows: here one in memory."""
    fsspec = pytest.importorskip("fsspec")
    place = f"memory://study-{time.time_ns()}"
    assert computed(study(GAINS), place).equals(table)  # type: ignore[arg-type]
    assert fsspec.filesystem("memory").ls(place.removeprefix("memory:/") + "/blocks")
