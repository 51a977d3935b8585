"""Facts of a run that were damaged are not shown: they are found again from the run."""

from contextlib import closing

import pytest

from tests.store.samples import made_record
from thetascope.store import Database, NotebookStore, RunFacts, RunStore

FACTS = RunFacts("zhao", "run", 0.25, 1.5, 2, "words", {"seed": [1.0]}, [], {"state": "x", "curve": {"channel": "f"}})


@pytest.mark.parametrize(
    "change",
    ["rmse = 0.5", "delay = NULL", "false_alarms = 3", "experiment = 'tanks'", "shown = '{}'", "numbers = '{}'"],
)
def test_a_changed_fact_is_not_served(place, change):
    """The value is one of the right type, as a flipped bit leaves it; the next facts do not keep its curve."""
    with closing(Database(place)) as database:
        runs, notebook = RunStore(database, 10**9), NotebookStore(database)
        for id in ("hit", "other"):
            runs.put(made_record(id, facts=FACTS))
        assert notebook.line("ann", "hit").facts == FACTS
        with database.writing() as connection:
            connection.exec_driver_sql(f"UPDATE run_facts SET {change} WHERE run = 'hit'")
        assert notebook.line("ann", "hit").facts is None and notebook.line("ann", "other").facts == FACTS
        notebook.put_facts({"hit": RunFacts("zhao", "run", 0.25)})
        assert notebook.line("ann", "hit").facts == RunFacts("zhao", "run", 0.25)


def test_a_session_that_is_saved_keeps_its_facts(place):
    """The kind is in no checksum, as it is written later; a measure that is not finite is unknown."""
    with closing(Database(place)) as database:
        runs, notebook = RunStore(database, 10**9), NotebookStore(database)
        runs.put(made_record("a", facts=RunFacts("zhao", "run", float("inf"), float("nan"))))
        notebook.set_kind("a", "session")
        assert notebook.line("ann", "a").facts == RunFacts("zhao", "session")


def test_facts_of_an_earlier_version_get_checksums(tmp_path):
    """The migration adds them; nothing else of the facts changes."""
    path = tmp_path / "runs.sqlite"
    with closing(Database(path)) as database:
        RunStore(database, 10**9).put(made_record("a", facts=FACTS))
        with database.writing() as connection:
            for table in ("run_facts", "owners", "run_notes", "comparison_notes", "record_shares"):
                connection.exec_driver_sql(f"ALTER TABLE {table} DROP COLUMN checksum")
            connection.exec_driver_sql("ALTER TABLE record_shares DROP COLUMN owner_sum")
            connection.exec_driver_sql("DROP TABLE lessons")
            database.backend.set_version(connection, 6)
    with closing(Database(path)) as database:
        assert NotebookStore(database).line("ann", "a").facts == FACTS
