"""The library's experiments are prepared beside the service, once."""

import subprocess
import sys

from tests.runs.samples import spec
from thetascope import library
from thetascope.engine.compiler import cache
from thetascope.server import prewarm


def test_what_was_prepared_is_not_prepared_again(tmp_path, monkeypatch):
    """Each experiment is opened, one that fails passed over; then there is nothing to begin until engine or library change."""
    monkeypatch.setattr(cache, "folder", lambda: tmp_path)
    failing = spec(observers=[{"label": "a", "kind": "kalman", "gains": {"r": -1}}])
    monkeypatch.setattr(
        library, "experiments", lambda: {"failing": failing, "good": spec(noise={"y": {"std": 0.0123}})}
    )
    monkeypatch.setattr(prewarm, "_LATER", 0.0)
    monkeypatch.setattr(prewarm.os, "nice", lambda by: None)
    monkeypatch.setattr(prewarm.signal, "signal", lambda *_: None)
    prewarm.main()
    assert {path.name for path in tmp_path.iterdir()} >= {"warmed", "calibration"}
    assert prewarm.begin() is None
    monkeypatch.setattr(library, "digest", lambda: "another")
    begun = prewarm.begin()
    assert begun is not None
    prewarm.end(begun)
    assert begun.poll() is not None


def test_it_ends_with_the_service():
    """Terminated and waited for; where there is none, nothing happens."""
    process = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])
    prewarm.end(process)
    assert process.poll() is not None
    prewarm.end(None)
