"""Runs are functions of their specs: found, recomputed, cancelled, refused."""

import gc
import json
import time
import weakref
from dataclasses import replace

import numpy as np
import pytest

from tests.runs.samples import PLANT, long_spec, spec
from thetascope.runs.jobs.job import Ended, Job, Snapshot
from thetascope.runs.jobs.manager import RunManager
from thetascope.runs.jobs.store_rows import INTERRUPTED
from thetascope.runs.specs.refusals import Busy, InvalidSpec, NotReady, Unknown
from thetascope_schemas.experiment.experiment import Experiment

SECONDS = 120
ONE = 150_000  # bytes: room for one result of the small experiment (1001 rows of 10 columns), not for two


def completed(runs: RunManager, experiment: Experiment) -> Snapshot:
    """Return the end of a run that is not known yet."""
    job = runs.submit(experiment)
    assert isinstance(job, Job)
    return job.done.result(SECONDS)


def numbers(runs: RunManager, id: str) -> np.ndarray:
    """Return the run's data, recomputed if necessary."""
    found = runs.finished(id)
    if isinstance(found, Job):
        found.done.result(SECONDS)
        found = runs.finished(id)
    return found.result.data


def until(condition) -> None:
    """Wait for another thread."""
    deadline = time.monotonic() + SECONDS
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.005)


def test_the_same_spec_is_answered_from_memory_and_after_a_restart_from_the_store(start):
    """Bit for bit, with the same summary, and without computing."""
    runs = start()
    first = completed(runs, spec())
    data = numbers(runs, first.id).copy()
    again = runs.submit(spec())
    assert isinstance(again, Snapshot) and again == first
    runs = start()
    stored = runs.submit(spec())
    assert isinstance(stored, Snapshot)
    assert (stored.id, stored.status, stored.summary) == (first.id, "done", first.summary)
    assert numbers(runs, first.id).tobytes() == data.tobytes()


def test_a_dropped_result_is_recomputed_with_the_same_numbers(start):
    """The store has room for one result; the spec of the other is kept, which suffices."""
    runs = start(store_limit=ONE, memory=1)
    first = completed(runs, spec())
    data = numbers(runs, first.id).copy()
    for seed in range(1, 4):
        completed(runs, spec(seed=seed))
    runs = start(store_limit=ONE, memory=1)
    assert runs.get(first.id).status == "done"
    assert isinstance(runs.finished(first.id), Job)
    assert numbers(runs, first.id).tobytes() == data.tobytes()


def test_the_end_of_a_run_is_queued_for_the_store_before_it_is_visible(start, monkeypatch):
    """Later pins and deletions come after it, and no "running" is written after it."""
    seen, keep = [], RunManager._keep

    def watched(runs: RunManager, end: Ended) -> None:
        job = runs.job(end.snapshot.id)
        runs.announce(job)
        seen.append((runs.get(end.snapshot.id).active, job.announced))
        keep(runs, end)

    monkeypatch.setattr(RunManager, "_keep", watched)
    runs = start()
    id = completed(runs, spec()).id
    assert runs.pin(id, True).pinned and seen == [(True, False)]
    monkeypatch.undo()
    assert start().get(id).pinned


def test_a_pin_survives_recomputation_and_restart(start):
    """The pin is not lost with the result."""
    runs = start(store_limit=1)
    id = completed(runs, spec()).id
    assert runs.pin(id, True).pinned
    runs = start(store_limit=1)
    assert runs.get(id).pinned
    numbers(runs, id)
    assert runs.get(id).pinned
    assert not runs.pin(id, False).pinned


def test_titles_and_figures_do_not_change_the_id_and_the_newest_are_used(start):
    """Renaming an experiment recomputes nothing."""
    runs = start()
    id = completed(runs, spec(title="Old")).id
    renamed = runs.submit(spec(title="New"))
    assert isinstance(renamed, Snapshot) and renamed.id == id
    assert runs.get(id).spec.title == "New"
    until(lambda: start().get(id).spec.title == "New")  # it is written beside


def test_other_numbers_are_another_run(start):
    """Seed, a gain, the plant's text: each changes the id."""
    runs = start()
    faster = {**PLANT, "dynamics": {"x": "-2*a*x + u"}}
    variants = [spec(), spec(seed=1), spec(plant=faster), spec(noise={})]
    ids = {completed(runs, variant).id for variant in variants}
    assert len(ids) == len(variants)


def test_an_active_spec_is_joined_and_not_started_twice(start):
    """Two clients, one computation."""
    runs = start()
    first, second = runs.submit(long_spec()), runs.submit(long_spec())
    assert first is second
    runs.cancel(first.id)


def test_progress_increases_and_cancelling_stops_the_run(start):
    """Long before its end; then it can be started again."""
    runs = start()
    job = runs.submit(long_spec())
    until(lambda: job.progress > 0.01)
    assert runs.get(job.id).status == "running"
    runs.cancel(job.id)
    assert job.done.result(SECONDS).status == "cancelled" and job.progress < 0.9
    with pytest.raises(NotReady, match="cancelled"):
        runs.finished(job.id)
    assert isinstance(runs.submit(long_spec()), Job)


def test_a_waiting_run_is_cancelled_immediately(start):
    """It need not reach the head of the queue."""
    runs = start(workers=1)
    runs.submit(long_spec(seed=1))
    waiting = runs.submit(long_spec(seed=2))
    assert runs.cancel(waiting.id).status == "cancelled"
    assert waiting.done.result(0).status == "cancelled"


def test_a_full_queue_refuses_and_accepts_again_when_there_is_room(start):
    """There is room for one active and one waiting run."""
    runs = start(workers=1, queue=1)
    jobs = [runs.submit(long_spec(seed=seed)) for seed in (1, 2)]
    with pytest.raises(Busy, match="2 runs"):
        runs.submit(spec())
    for job in jobs:
        runs.cancel(job.id)
        job.done.result(SECONDS)
    assert completed(runs, spec()).status == "done"


@pytest.mark.parametrize(
    ("limits", "field", "words"),
    [
        ({"max_steps": 500}, "horizon", r"1,000 steps, and 500 are allowed.*THETASCOPE_MAX_STEPS"),
        ({"max_result": 5000}, "record", r"1,001 rows.*5,000 are allowed.*THETASCOPE_MAX_RESULT"),
    ],
)
def test_a_run_beyond_the_limits_is_refused_before_it_runs(start, limits, field, words):
    """The message has the requested and the permitted number, and the remedy."""
    job = start(**limits).submit(spec())
    with pytest.raises(InvalidSpec, match=words) as refusal:
        job.done.result(SECONDS)
    assert refusal.value.errors[0].field == field
    assert job.status == "queued"


def test_a_run_that_takes_too_long_is_stopped_with_the_reason(start):
    """The time limit applies where the number of steps does not suffice."""
    end = completed(start(max_seconds=0.2), long_spec())
    assert end.status == "failed"
    assert "longer than 0.2 s" in end.problem.detail and "THETASCOPE_MAX_SECONDS" in end.problem.detail


def test_an_invalid_expression_is_refused_with_its_field_in_the_experiment(start):
    """The plant is inline, so its fields are below `plant`."""
    wrong = {**PLANT, "dynamics": {"x": "-a*x + q"}}
    job = start().submit(spec(plant=wrong))
    with pytest.raises(InvalidSpec) as refusal:
        job.done.result(SECONDS)
    assert refusal.value.errors[0].field == "plant.dynamics.x"
    assert "column 8" in refusal.value.errors[0].problem


def test_a_run_that_the_end_of_the_service_cuts_off_is_computed_by_the_next(start):
    """It waits in the store, and its client is refused until the next start. A cancelled one stays cancelled."""
    runs = start()
    job, given_up = runs.submit(long_spec()), runs.submit(long_spec(seed=1))
    runs.announce(job)
    runs.announce(given_up)
    until(lambda: job.status == "running")
    runs.cancel(given_up.id)
    given_up.done.result(SECONDS)
    runs = start()
    with pytest.raises(Busy, match="stopping"):
        job.done.result(SECONDS)
    assert runs.get(job.id).active
    until(lambda: runs.get(job.id).progress > 0)
    runs.cancel(job.id)
    until(lambda: runs.get(job.id).status == "cancelled")
    assert runs.get(given_up.id).status == "cancelled" and runs.queue()[0] == 0


def test_a_run_during_which_two_services_crashed_fails(start):
    """After one crash it is resumed, and has its result; after two it may be the reason, and is not tried again."""
    runs = start()
    ids = [completed(runs, spec(seed=seed)).id for seed in (1, 2)]
    runs = start()
    records = [runs._store.get(id) for id in ids]
    for id, record, error in zip(ids, records, (None, INTERRUPTED.model_dump(mode="json")), strict=True):
        runs._store.delete(id)
        runs._store.put(replace(record, status="running", summary=None, error=error))
    runs.resume()
    until(lambda: runs.get(ids[0]).status == "done")
    assert numbers(runs, ids[0]).shape[0] > 1 and runs.get(ids[0]).problem is None
    assert (runs.get(ids[1]).status, runs.get(ids[1]).problem.code) == ("failed", "run.interrupted")


def test_a_run_that_cannot_be_resumed_fails_and_others_go_on(start):
    """As where a later version has no such plant: the service starts all the same."""
    runs = start()
    lost, kept = (completed(runs, spec(seed=seed)).id for seed in (1, 2))
    runs = start()
    records = {id: runs._store.get(id) for id in (lost, kept)}
    other = json.dumps(json.loads(records[lost].spec) | {"plant": "no-such-plant"})
    for id, record in records.items():
        runs._store.delete(id)
        text = other if id == lost else record.spec
        runs._store.put(replace(record, spec=text, status="queued", summary=None))
    runs = start()
    until(lambda: runs.get(kept).status == "done")
    assert (runs.get(lost).status, runs.get(lost).problem.code) == ("failed", "run.interrupted")


def test_a_removed_run_is_in_neither_memory_nor_store(start):
    """A similar id is suggested for a mistyped one."""
    runs = start()
    kept, removed = completed(runs, spec()).id, completed(runs, spec(seed=1)).id
    runs.remove(removed)
    with pytest.raises(Unknown):
        runs.get(removed)
    with pytest.raises(Unknown, match=kept):
        runs.get(kept[:8] + "0000")


def test_memory_holds_the_latest_results_up_to_its_limit(start):
    """One result fits: the older one is read from the store."""
    runs = start(memory=ONE)
    first = completed(runs, spec())
    second = completed(runs, spec(seed=1))
    assert runs._memory.get(first.id) is None
    assert runs._memory.get(second.id) is not None
    runs.submit(spec(seed=2)).done.result(SECONDS)
    assert numbers(runs, first.id).shape[1] == 1001


def test_a_run_that_was_removed_leaves_nothing_in_memory(start):
    """Also without a search for garbage, which is rare: rows of all runs since the last one would stay."""
    runs = start()
    gc.disable()
    try:
        rows = []
        for seed in (1, 2):
            done = completed(runs, spec(seed=seed))
            rows.append(weakref.ref(runs.finished(done.id).result))
            runs.remove(done.id)
        until(lambda: not any(row() for row in rows))
    finally:
        gc.enable()
