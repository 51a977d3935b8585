"""The library's kernels are compiled in advance beside the service, once, and never outlive it."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.runs.samples import spec
from thetascope import library
from thetascope.engine.compiler import cache
from thetascope.server import prewarm

#: A service that dies without a chance to end anything, right after starting the process or a second later.
SERVICE = (
    "import sys, time; from thetascope.server import prewarm; print(prewarm.begin().pid, flush=True); time.sleep(60)"
)


def test_a_finished_preparation_is_not_repeated(tmp_path, monkeypatch):
    """Each experiment is opened, a failing one is skipped; the next start is after a change of engine or library."""
    monkeypatch.setattr(cache, "folder", lambda: tmp_path)
    failing = spec(observers=[{"label": "a", "kind": "kalman", "gains": {"r": -1}}])
    monkeypatch.setattr(
        library, "experiments", lambda: {"failing": failing, "good": spec(noise={"y": {"std": 0.0123}})}
    )
    monkeypatch.setattr(library, "mysteries", dict)
    monkeypatch.setattr(prewarm, "_LATER", 0.0)
    monkeypatch.setattr(prewarm.os, "nice", lambda by: None)
    prewarm.prepare()
    assert {path.name for path in tmp_path.iterdir()} >= {"warmed", "calibration"}
    assert prewarm.begin() is None
    monkeypatch.setattr(library, "digest", lambda: "another")
    process = prewarm.begin()
    assert process is not None
    prewarm.end(process)
    assert process.poll() is not None


def test_a_service_that_stops_ends_the_process():
    """It terminates and awaits it; without a process it does nothing."""
    process = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])
    prewarm.end(process)
    assert process.poll() is not None
    prewarm.end(None)


def test_a_preparation_that_finishes_beside_the_service_exits_cleanly():
    """The thread that waits for the service does not abort the interpreter when it ends."""
    quick = "from thetascope.server import prewarm; prewarm.prepare = lambda: None; prewarm.main()"
    with subprocess.Popen([sys.executable, "-c", quick], stdin=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.wait(60) == 0
        assert process.stderr.read() == b""


@pytest.mark.skipif(os.name != "posix", reason="sends SIGKILL")
@pytest.mark.parametrize("seconds", [0.0, 1.0])
def test_a_service_that_is_killed_leaves_no_process_behind(tmp_path, seconds: float):
    """Not even if it is killed before the process has started."""
    environment = os.environ | {"THETASCOPE_CACHE": str(tmp_path)}
    service = subprocess.Popen([sys.executable, "-c", SERVICE], stdout=subprocess.PIPE, env=environment)
    child = int(service.stdout.readline())
    time.sleep(seconds)
    service.kill()
    service.wait()
    try:
        for _ in range(300):
            if not running(child):
                break
            time.sleep(0.1)
        assert not running(child)
    finally:
        if running(child):
            os.kill(child, signal.SIGKILL)


def running(pid: int) -> bool:
    """Return whether a process exists and is not a zombie."""
    if sys.platform == "linux":  # a bare Debian has no ps
        stat = Path(f"/proc/{pid}/stat")
        return stat.exists() and stat.read_text().rpartition(")")[2].split()[0] != "Z"
    answer = subprocess.run(["ps", "-o", "stat=", "-p", str(pid)], capture_output=True, text=True, check=False)
    return answer.stdout.strip()[:1] not in ("", "Z")
