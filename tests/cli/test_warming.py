"""The library's experiments are prepared beside the service, once."""

import subprocess
import sys

from backend import library, warming
from backend.engine import cache
from tests.runs.samples import spec


def test_what_was_prepared_is_not_prepared_again(tmp_path, monkeypatch):
    """Each experiment is opened, one that fails passed over; then there is nothing to begin until engine or library change."""
    monkeypatch.setattr(cache, "folder", lambda: tmp_path)
    failing = spec(observers=[{"label": "a", "kind": "kalman", "gains": {"r": -1}}])
    monkeypatch.setattr(library, "experiments", lambda: {"failing": failing, "good": spec(noise={"y": {"std": 0.0123}})})
    monkeypatch.setattr(warming, "_LATER", 0.0)
    monkeypatch.setattr(warming.os, "nice", lambda by: None)
    monkeypatch.setattr(warming.signal, "signal", lambda *_: None)
    warming.main()
    assert {path.name for path in tmp_path.iterdir()} >= {"warmed", "calibration"}
    assert warming.begin() is None
    monkeypatch.setattr(library, "digest", lambda: "another")
    begun = warming.begin()
    assert begun is not None
    warming.end(begun)
    assert begun.poll() is not None


def test_it_ends_with_the_service():
    """Terminated and waited for; where there is none, nothing happens."""
    process = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])
    warming.end(process)
    assert process.poll() is not None
    warming.end(None)
