"""The contents of the store, and the removal of results."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from tests.store.samples import made_record, made_result
from thetascope.messages import Message

SIZE = made_result().data.nbytes


def test_a_result_is_equal_bit_for_bit_after_reopening_the_store(open_store):
    """Numbers, reports, checks and divergence survive; arrays among the facts become lists."""
    kept = made_result()
    open_store().put_result("a", "e", kept)
    found = open_store().get_result("a", "e")
    assert found.data.tobytes() == kept.data.tobytes()
    assert (found.names, found.step, found.substeps, found.notes) == (
        kept.names,
        0.01,
        2,
        (Message("run.substeps", n=2),),
    )
    assert found.observers[0].checks == kept.observers[0].checks
    assert found.observers[0].diverged == kept.observers[0].diverged
    assert found.observers[0].facts == {"K": [1.0, 2.0], "n": 2}


def test_a_result_belongs_to_the_engine_that_computed_it(open_store):
    """Another version of the engine gets no result, rather than numbers that it would not compute."""
    store = open_store()
    store.put_result("a", "old", made_result())
    assert store.get_result("a", "new") is None
    assert not store.has_result("a", "new")
    assert store.has_result("a", "old")


def test_beyond_the_limit_the_least_recently_used_unpinned_result_is_removed(open_store):
    """Its spec stays. Of four results three fit: of the two oldest one is pinned, so the other is removed."""
    store = open_store(limit=3 * (SIZE + 1000))
    for id in ("pinned", "oldest", "middle"):
        store.put(made_record(id))
        store.put_result(id, "e", made_result())
        if id == "pinned":
            assert store.pin(id, True)
    store.put(made_record("newest"))
    store.put_result("newest", "e", made_result())
    assert [id for id in ("pinned", "oldest", "middle", "newest") if store.has_result(id, "e")] == [
        "pinned",
        "middle",
        "newest",
    ]
    assert store.get("oldest").spec == '{"seed": 1}'
    assert store.usage()["bytes"] <= 3 * (SIZE + 1000)


def test_reading_a_result_makes_it_recently_used(open_store, monkeypatch):
    """The older of two survives if it was read since (the time of use is written once per minute, so the clock is
    moved)."""
    store = open_store(limit=2 * (SIZE + 1000))
    now = [1000.0]
    monkeypatch.setattr("thetascope.store.run_store.time.time", lambda: now[0])
    for id in ("a", "b", "c"):
        if id == "c":
            now[0] += 3600
            assert store.get_result("a", "e") is not None
        store.put(made_record(id))
        now[0] += 1
        store.put_result(id, "e", made_result())
    assert [id for id in ("a", "b", "c") if store.has_result(id, "e")] == ["a", "c"]


def test_a_result_larger_than_the_limit_is_not_stored_and_displaces_nothing(open_store):
    """It would empty the store and still not fit."""
    store = open_store(limit=SIZE + 1000)
    store.put_result("small", "e", made_result())
    assert not store.put_result("large", "e", made_result(rows=5000))
    assert store.has_result("small", "e")


def test_a_damaged_size_removes_no_result(open_store):
    """Before something is deleted, sizes are read from the results; the listing goes on with any size."""
    store = open_store(limit=3 * (SIZE + 1000))
    for id in ("a", "b"):
        store.put(made_record(id))
        store.put_result(id, "e", made_result())
    with store._database.writing() as connection:
        connection.exec_driver_sql("UPDATE results SET size = 9000000000000000000")
    assert store.usage()["results"] == 2
    store.put_result("c", "e", made_result())
    assert all(store.has_result(id, "e") for id in "abc") and store.usage()["bytes"] < 3 * (SIZE + 1000)


def test_a_recomputed_run_keeps_its_pin_and_time_of_creation(open_store):
    """It is the same run."""
    store = open_store()
    store.put(made_record("a", created=5.0))
    store.pin("a", True)
    store.put(made_record("a", created=9.0, title="Renamed"))
    found = store.get("a")
    assert (found.created, found.pinned, found.title) == (5.0, True, "Renamed")


def test_runs_are_listed_newest_first_in_pages_without_specs(open_store):
    """A list of thousands of runs stays small."""
    store = open_store()
    for i in range(5):
        store.put(made_record(f"r{i}", created=float(i)))
    assert [run.id for run in store.page(limit=2, offset=1)] == ["r3", "r2"]
    assert store.page()[0].spec == ""


def test_a_deleted_run_is_deleted_with_its_result(open_store):
    """Nothing remains, and deleting it again reports that."""
    store = open_store()
    store.put(made_record("a"))
    store.put_result("a", "e", made_result())
    assert store.delete("a")
    assert store.get("a") is None and store.usage()["results"] == 0
    assert not store.delete("a")


def test_runs_that_were_not_finished_are_found_oldest_first(open_store):
    """With their specs; those that have ended are not among them."""
    store = open_store()
    for id, status, created in (("done", "done", 1.0), ("late", "running", 3.0), ("early", "queued", 2.0)):
        store.put(made_record(id, status=status, created=created))
    unfinished = store.unfinished()
    assert [record.id for record in unfinished] == ["early", "late"]
    assert all(record.spec for record in unfinished)


def test_threads_and_other_processes_write_and_read_concurrently(open_store):
    """Six threads on two connections: every result is present and complete."""
    stores = [open_store(), open_store()]

    def work(i: int) -> bool:
        id = f"r{i}"
        stores[i % 2].put(made_record(id))
        stores[i % 2].put_result(id, "e", made_result(seed=i))
        return np.array_equal(stores[(i + 1) % 2].get_result(id, "e").data, made_result(seed=i).data, equal_nan=True)

    with ThreadPoolExecutor(6) as pool:
        assert all(pool.map(work, range(24)))
    assert stores[0].usage()["runs"] == 24


def test_owners_belong_to_a_run_and_go_with_it(open_store):
    """Each once, over a second server and an update of the run; a run that does not exist has none."""
    store = open_store()
    store.put(made_record("a"))
    store.own("a", {"ann", "ben"})
    store.own("a", {"ben", "eve"})
    store.own("missing", {"ann"})
    store.put(made_record("a"))
    assert open_store().owners("a") == {"ann", "ben", "eve"} and store.owners("missing") == frozenset()
    store.disown("a", "ben")
    assert store.owners("a") == {"ann", "eve"}
    store.delete("a")
    store.put(made_record("a"))
    assert store.owners("a") == frozenset()
