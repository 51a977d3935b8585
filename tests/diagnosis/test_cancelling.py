"""A run may be cancelled while it is diagnosed."""

from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.compiler import cache
from thetascope.engine.errors import Cancelled
from thetascope_schemas import Experiment


def asked_in(name: str, stop) -> int:
    """Return how often a run asks whether it is cancelled after its simulation."""
    spec = library.experiment(name).model_dump(mode="json") | {"seed": 7_301, "diagnosis": {"false_alarms": 0.0123}}
    prepared = prepare(library.resolve(Experiment.model_validate(spec)))
    asked, done = 0, []

    def cancelled() -> bool:
        nonlocal asked
        asked += bool(done)
        return bool(done) and stop(asked)

    try:
        prepared.run(lambda p: done.append(p) if p >= 1.0 else None, cancelled)
    except Cancelled:
        return -asked
    return asked


def test_a_run_is_cancelled_during_calibration_and_diagnosis(tmp_path, monkeypatch):
    """It asks before every longer step of the diagnosis, and ends when the answer is yes."""
    monkeypatch.setattr(cache, "folder", lambda: tmp_path)
    assert asked_in("dc-motor", lambda asked: asked == 3) == -3  # simulating thresholds, which are not kept
    whole = asked_in("dc-motor", lambda asked: False)
    watching = asked_in("dc-motor", lambda asked: False)  # thresholds are on disk now
    assert whole > watching > 10
    assert asked_in("dc-motor", lambda asked: asked == watching // 2) == -(watching // 2)
