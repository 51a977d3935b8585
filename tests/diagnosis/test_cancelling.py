"""A run may be cancelled while it is diagnosed."""

from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.compiler import cache
from thetascope.engine.errors import Cancelled
from thetascope_schemas import Experiment


def questions_in(name: str, stop) -> int:
    """Return how often a run asks whether it is cancelled after its simulation."""
    changes = {"seed": 7_301, "diagnosis": {"false_alarms": 0.0123}, "observers": [], "figures": []}
    spec = library.experiment(name).model_dump(mode="json") | changes
    prepared = prepare(library.resolve(Experiment.model_validate(spec)))
    questions, done = 0, []

    def cancelled() -> bool:
        nonlocal questions
        questions += bool(done)
        return bool(done) and stop(questions)

    try:
        prepared.run(lambda p: done.append(p) if p >= 1.0 else None, cancelled)
    except Cancelled:
        return -questions
    return questions


def test_a_run_is_cancelled_during_calibration_and_diagnosis(tmp_path, monkeypatch):
    """It asks before every longer step of the diagnosis, and ends when the answer is yes."""
    monkeypatch.setattr(cache, "folder", lambda: tmp_path)
    assert questions_in("dc-motor", lambda questions: questions == 3) == -3  # simulating thresholds, which are not kept
    whole = questions_in("dc-motor", lambda questions: False)
    watching = questions_in("dc-motor", lambda questions: False)  # thresholds are on disk now
    assert whole > watching > 10
    assert questions_in("dc-motor", lambda questions: questions == watching // 2) == -(watching // 2)
