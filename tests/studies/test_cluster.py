"""Studies on a real Dask cluster of this machine: a scheduler and two workers, as processes of their own."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import polars as pl
import pytest

from tests.studies.study_samples import GAINS, computed, study
from thetascope.runs.specs.refusals import Refusal
from thetascope.studies.conduct import conduct
from thetascope.studies.engines import DaskEngine
from thetascope.studies.kept import Kept

pytest.importorskip("distributed")
STARTS = 60.0
"""Seconds in which a process of the cluster has to be there, on a slow machine."""


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> pl.DataFrame:
    """The table of GAINS, computed by threads."""
    return computed(study(GAINS), tmp_path_factory.mktemp("gains"))


def begun(kind: str, *arguments: str) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", f"distributed.cli.dask_{kind}", *arguments]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@contextmanager
def cluster(folder: Path, workers: int = 2) -> Iterator[tuple[str, subprocess.Popen, list[subprocess.Popen]]]:
    """Yield the address of a scheduler, the scheduler, and its workers, each with one thread and without a nanny."""
    file = folder / "scheduler.json"
    place = ["--scheduler-file", str(file)]
    scheduler = begun("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", *place)
    one = ["--nthreads", "1", "--no-nanny", "--no-dashboard", "--local-directory", str(folder), *place]
    processes: list[subprocess.Popen] = []
    try:
        until = time.monotonic() + STARTS
        while not file.exists():
            assert time.monotonic() < until, "the scheduler does not start"
            time.sleep(0.05)
        processes = [begun("worker", *one) for _ in range(workers)]
        yield json.loads(file.read_text())["address"], scheduler, processes
    finally:
        for process in [*processes, scheduler]:
            process.kill()
            process.wait()


def test_a_cluster_gives_the_same_bits_though_a_worker_is_killed(table: pl.DataFrame, tmp_path: Path):
    """SIGKILL to one of two workers while it computes: nothing is lost, nothing is counted twice."""
    with cluster(tmp_path) as (address, _, workers):
        engine = DaskEngine(address, timeout=STARTS)
        engine._client.wait_for_workers(2, timeout=STARTS)
        kept = Kept(study(GAINS), tmp_path / "study")
        killed: list[int] = []

        def kill(_progress: object) -> None:
            if not killed:
                killed.append(workers[0].pid)
                os.kill(workers[0].pid, signal.SIGKILL)

        try:
            conduct(kept, engine, kill)
        finally:
            engine.close()
    assert killed and kept.table().equals(table)


def test_a_lost_scheduler_ends_the_study_with_what_was_computed(table: pl.DataFrame, tmp_path: Path):
    """The next call, here on this machine, computes only the rest."""
    with cluster(tmp_path, 1) as (address, scheduler, _):
        engine = DaskEngine(address, timeout=5.0)  # and so long it waits for a lost scheduler
        engine._client.wait_for_workers(1, timeout=STARTS)
        kept = Kept(study(GAINS), tmp_path / "study")

        def lose(now) -> None:
            if now.done and scheduler.poll() is None:
                scheduler.kill()
                scheduler.wait()

        try:
            with pytest.raises(Refusal, match="is lost"):
                conduct(kept, engine, lose)
        finally:
            engine.close()
    assert Kept(study(GAINS), tmp_path / "study").runs_done in (64, 44)
    assert computed(study(GAINS), tmp_path / "study").equals(table)


def test_a_scheduler_that_does_not_answer_is_named():
    """The address, the reason, and how to start one."""
    with pytest.raises(Refusal, match="tcp://127.0.0.1:9"):
        DaskEngine("tcp://127.0.0.1:9", timeout=1.0)
