"""A store survives kill -9 while it is written, and a full disk: what was acknowledged is there, and whole."""

import os
import resource
import signal
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import pytest
from sqlalchemy import select

from tests.store.samples import made_record, made_result
from thetascope.store import (
    Database,
    NotebookStore,
    PlantStore,
    RecordStore,
    RunStore,
    Share,
    StoreError,
    TextVersion,
    record_id,
    verify,
)
from thetascope.store.tables import RUN_NOTES

ROOT = Path(__file__).parents[2]
ROUNDS = 6


def write_and_be_killed(place: str) -> None:
    """Write runs in processes that are killed, and print each id after its write; the kill comes at no chosen place."""
    for i in range(ROUNDS):
        receiving, sending = os.pipe()
        child = os.fork()
        if not child:
            store = RunStore(Database(place), 10**9)
            for j in range(10**6):
                store.put(made_record(f"{i}-{j}"))
                store.put_result(f"{i}-{j}", "e", made_result(rows=2000, seed=j))
                os.write(sending, f"{i}-{j}\n".encode())
        os.close(sending)
        with os.fdopen(receiving) as acknowledged:
            for _ in range(3 + i):
                print(acknowledged.readline(), end="", flush=True)
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            print(acknowledged.read(), end="", flush=True)


def write_what_is_typed(place: str) -> None:
    """Write plants, records, names, tags and notes in processes that are killed; print the number of each round."""
    for i in range(ROUNDS):
        receiving, sending = os.pipe()
        child = os.fork()
        if not child:
            database = Database(place)
            notes, plants, records = NotebookStore(database), PlantStore(database), RecordStore(database)
            for j in range(10**6):
                name = f"{i}-{j}"
                plants.put(TextVersion("ann", "tank", 0, name, "yaml", 0, True, f"id: tank\n# {name}\n", float(j)))
                records.put(
                    name.encode() * 500, Share(record_id(name.encode() * 500), "ann", name, None, None, float(j))
                )
                notes.note(name, "ann", name, (name,))
                notes.note_comparison([name, "x"], "ann", name)
                os.write(sending, f"{name}\n".encode())
        os.close(sending)
        with os.fdopen(receiving) as acknowledged:
            for _ in range(2 + i):
                print(acknowledged.readline(), end="", flush=True)
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            print(acknowledged.read(), end="", flush=True)


def write_until_full(place: str) -> None:
    """Write runs until the file has its largest size, and print their ids, then the error; earlier runs are read."""
    store = RunStore(Database(place), 10**9)
    resource.setrlimit(resource.RLIMIT_FSIZE, (3_000_000, 3_000_000))
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    for j in range(10**6):
        try:
            store.put(made_record(f"{j}"))
            store.put_result(f"{j}", "e", made_result(rows=2000, seed=j))
        except StoreError as error:
            print(error.problem.code)
            print(error)
            break
        print(j)
    assert store.get_result("0", "e") is not None and len(store.page()) >= 1
    os._exit(0)  # without closing the store


def in_a_process(function: str, place: str) -> list[str]:
    code = f"import sys; from tests.store.test_crashes import {function} as f; f(sys.argv[1])"
    done = subprocess.run(
        [sys.executable, "-c", code, place], cwd=ROOT, capture_output=True, text=True, timeout=120, check=True
    )
    return done.stdout.splitlines()


def test_a_kill_during_a_write_loses_nothing_that_was_acknowledged(place):
    """Six processes are killed while they write; the store has no defect, and is written on."""
    ids = in_a_process("write_and_be_killed", place)
    assert len(ids) >= sum(3 + i for i in range(ROUNDS))
    with closing(Database(place)) as database:
        store = RunStore(database, 10**9)
        assert verify(database).defects == ()
        for id in ids:
            assert store.get(id) is not None
            assert store.get_result(id, "e").data.tobytes() == made_result(2000, int(id[2:])).data.tobytes()
        store.put(made_record("later"))


def test_a_kill_loses_no_plant_record_or_note(place):
    """Every version, file, name, tag and note that was acknowledged is there after six kills."""
    names = in_a_process("write_what_is_typed", place)
    assert len(names) >= sum(2 + i for i in range(ROUNDS))
    with closing(Database(place)) as database:
        assert verify(database).defects == ()
        notes, plants, records = NotebookStore(database), PlantStore(database), RecordStore(database)
        versions = plants.versions("ann", "tank")
        assert [one.version for one in versions] == list(range(len(versions), 0, -1))
        assert {one.title for one in versions} >= set(names)
        with database.reading() as connection:
            named = {row.run: row.tags for row in connection.execute(select(RUN_NOTES))}
        for name in names:
            assert named[name] == f'["{name}"]' and notes.comparison_notes(["x", name], "ann") == name
            assert records.data(record_id(name.encode() * 500)) == name.encode() * 500


def test_a_full_disk_is_an_error_with_a_remedy_and_damages_nothing(tmp_path):
    """Reading goes on meanwhile; with space again everything that was acknowledged is there."""
    place = tmp_path / "runs.sqlite"
    *ids, code, text = in_a_process("write_until_full", str(place))
    assert code in ("store.disk-full", "store.disk-error") and "free some space" in text and len(ids) > 5
    with closing(Database(place)) as database:
        store = RunStore(database, 10**9)
        assert verify(database).defects == ()
        assert {run.id for run in store.page(1000)} >= set(ids)
        assert all(store.has_result(id, "e") for id in ids)
        store.put_result(ids[0], "e", made_result(rows=5000))


@pytest.mark.parametrize("end", [0.3, 0.6, 0.97])
def test_a_log_that_was_cut_short_loses_its_end_only(tmp_path, end):
    """The machine lost power: of the write-ahead log a part was written."""
    place = tmp_path / "runs.sqlite"
    database = Database(place)
    store = RunStore(database, 10**9)
    for i in range(8):
        store.put(made_record(f"{i}", spec="x" * 5000))
        store.put_result(f"{i}", "e", made_result(rows=1000, seed=i))
    copy = tmp_path / "copy.sqlite"
    copy.write_bytes(place.read_bytes())
    log = Path(f"{place}-wal").read_bytes()
    Path(f"{copy}-wal").write_bytes(log[: int(len(log) * end)])
    database.close()
    with closing(Database(copy)) as database:
        assert verify(database).defects == ()
        ids = [run.id for run in RunStore(database, 10**9).page()]
        results = [id for id in ids if RunStore(database, 10**9).get_result(id, "e") is not None]
        assert ids == [f"{i}" for i in range(len(ids))] and len(ids) + len(results) < 16
        assert results in (ids, ids[:-1])
