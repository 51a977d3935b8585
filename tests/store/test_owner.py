"""A store has one owner, the server that runs its queue. Others read it, or store runs that they computed."""

import errno
import os
import signal
import subprocess
import sys

import pytest

from tests.store.samples import made_record, made_result
from thetascope.store import Database, RunStore, StoreError

HOLD = """
import sys
from thetascope.store import Database
database = Database.for_service(sys.argv[1], False)
print("owned", flush=True)
sys.stdin.read()
"""


def test_a_store_has_one_owner_until_it_is_closed(place):
    """The refusal names the process and the ways out."""
    first = Database.for_service(place, False)
    with pytest.raises(StoreError, match=rf"process {os.getpid()} on .*stop that server.*--read-only"):
        Database.for_service(place, False)
    first.own()
    first.close()
    Database.for_service(place, False).close()


def test_the_owner_s_death_frees_the_store(place):
    """By kill -9, which leaves no time to clean up."""
    with subprocess.Popen(
        [sys.executable, "-c", HOLD, place], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as owner:
        assert owner.stdout.readline() == "owned\n"
        with pytest.raises(StoreError, match=f"process {owner.pid} on"):
            Database.for_service(place, False)
        owner.send_signal(signal.SIGKILL)
        owner.wait(30)
        for _ in range(200):  # PostgreSQL notices the closed connection a moment later
            try:
                Database.for_service(place, False).close()
                return
            except StoreError:
                continue
        raise AssertionError("the store is still owned")


def test_a_folder_in_which_files_cannot_be_locked_is_an_error_of_its_own(tmp_path, monkeypatch):
    """Not the claim that another server is running; a network file system without locks is one."""

    def failing(handle: int, operation: int) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr("fcntl.flock", failing)
    with pytest.raises(StoreError, match="No locks available"):
        Database.for_service(tmp_path / "runs.sqlite", False)


def test_others_store_and_read_runs_beside_the_owner(place, open_store):
    """As the command line does."""
    owner = Database.for_service(place, False)
    beside = open_store()
    beside.put(made_record("a"))
    beside.put_result("a", "e", made_result())
    assert RunStore(owner, 10**9).get_result("a", "e") is not None
    owner.close()


def test_a_store_opened_for_reading_is_not_changed(place, open_store):
    """Everything can be read, also while its owner writes; every change is refused with the reason."""
    owner = open_store()
    owner._database.own()
    owner.put(made_record("a", status="running", summary=None))
    owner.put_result("a", "e", made_result())
    reader = RunStore(Database.for_service(place, True), 10**9)
    owner.put(made_record("b"))
    assert {run.id: run.status for run in reader.page()} == {"a": "running", "b": "done"}
    assert reader.get_result("a", "e") is not None and reader.usage()["runs"] == 2
    changes = (
        lambda: reader.put(made_record("c")),
        lambda: reader.put_result("b", "e", made_result()),
        lambda: reader.pin("a", True),
        lambda: reader.delete("a"),
        lambda: reader.own("a", {"me"}),
    )
    for change in changes:
        with pytest.raises(StoreError, match="for reading only.*without --read-only"):
            change()
    reader._database.close()
    assert owner.get("a").status == "running"


def test_nothing_is_created_for_a_reader(tmp_path):
    """A mistyped folder is an error, not an empty store."""
    with pytest.raises(StoreError, match="there is no store"):
        Database.for_service(tmp_path / "missing" / "runs.sqlite", True)
    assert not (tmp_path / "missing").exists()


def test_an_owner_that_lost_its_connection_connects_again_as_the_owner(postgresql):
    """The database was restarted, or an administrator ended the connection. Nobody else owns it meanwhile."""
    database = Database.for_service(postgresql, False)
    store = RunStore(database, 10**9)
    store.put(made_record("a"))
    with Database(postgresql).writing() as connection:
        query = "SELECT pg_terminate_backend(pid) FROM pg_locks WHERE locktype = 'advisory' AND granted"
        connection.exec_driver_sql(query)
    store.put(made_record("b"))
    assert [run.id for run in store.page()] == ["a", "b"]
    with pytest.raises(StoreError, match="belongs to a running server"):
        Database.for_service(postgresql, False)
    database.close()


def test_a_server_that_is_not_there_is_an_error_without_the_password():
    """With the reason and the setting."""
    with pytest.raises(StoreError, match=r"cannot be reached.*THETASCOPE_DATABASE") as error:
        Database("postgresql://someone:secret-word@127.0.0.1:1/runs")
    assert "secret-word" not in str(error.value)


@pytest.mark.parametrize("address", ["mysql://u:secret-word@h/d", "postgresql://u:secret-word@h:port/d", "http://x"])
def test_an_address_of_another_kind_is_refused_without_the_password(address):
    """With the forms that are understood."""
    with pytest.raises(StoreError, match=r"postgresql://USER:PASSWORD@HOST/DATABASE") as error:
        Database(address)
    assert "secret-word" not in str(error.value)
