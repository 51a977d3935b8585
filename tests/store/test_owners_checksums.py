"""Owners, names, tags, notes and shares of records that were damaged: noticed, and nobody gains a run by them."""

from contextlib import closing

import pytest

from tests.store.samples import made_record
from thetascope.access.principal import Principal
from thetascope.runs.jobs.ownership import others, share_of
from thetascope.runs.specs.refusals import NotOwner
from thetascope.store import (
    Damaged,
    Database,
    NotebookStore,
    RecordStore,
    RunStore,
    Share,
    StoreError,
    record_id,
    verify,
)

ANN, BOB, EVE = (Principal(name, name) for name in ("ann", "bob", "eve"))
DATA = b"t,y\n0,1\n"
RECORD = record_id(DATA)


@pytest.fixture
def database(place):
    with closing(Database(place)) as opened:
        runs = RunStore(opened, 10**9)
        for id in ("r1", "r2"):
            runs.put(made_record(id))
            runs.own(id, ["ann", "bob"])
        yield opened


def change(database, sql):
    with database.writing() as connection:
        assert connection.exec_driver_sql(sql).rowcount == 1


def defects(database):
    return sorted(defect.code for defect in verify(database).defects)


@pytest.mark.parametrize("name", ["eve", "anm", ""])
def test_a_damaged_owner_is_one_that_nobody_matches(database, name):
    """Also if the damaged name is that of another client: it gains nothing. The other owner keeps one share of two."""
    change(database, f"UPDATE owners SET owner = '{name}' WHERE run = 'r1' AND owner = 'ann'")
    owners = RunStore(database, 10**9).owners("r1")
    for client in (ANN, EVE, Principal("x", name)):
        with pytest.raises(NotOwner):
            share_of(owners, client)
    assert share_of(owners, BOB) == "bob"
    assert others(owners, BOB)  # so the run is not erased when bob removes it
    assert defects(database) == ["store.defect.owner"]


@pytest.mark.parametrize(
    "damage",
    ["owner = 'anm'", "owner = 'eve'", "run = 'r9'", "run = 'q2'"],
)
def test_a_damaged_owner_is_restored_at_the_next_start(database, damage):
    """Run and owner for which the checksum fits are those that were written, as long as they are known elsewhere."""
    change(database, f"UPDATE owners SET {damage} WHERE run = 'r1' AND owner = 'ann'")
    NotebookStore(database).mend()
    assert RunStore(database, 10**9).owners("r1") == {"ann", "bob"}
    assert RunStore(database, 10**9).owners("r2") == {"ann", "bob"}
    assert defects(database) == []


def test_an_owner_that_cannot_be_restored_returns_by_asking_again(database):
    """The checksum itself is damaged, in every row of the run; the unknown owner is not written as one."""
    with database.writing() as connection:
        connection.exec_driver_sql("UPDATE owners SET checksum = 'x' WHERE run = 'r1'")
    store = RunStore(database, 10**9)
    NotebookStore(database).mend()
    (unknown,) = store.owners("r1")
    assert unknown not in ("ann", "bob")
    store.own("r1", {unknown, "ann"})
    assert store.owners("r1") == {unknown, "ann"}
    store.own("r1", ["bob"])
    assert store.owners("r1") == {"ann", "bob"} and defects(database) == []


@pytest.mark.parametrize("damage", ["name = 'anders'", 'tags = \'["lab", "x"]\'', "checksum = NULL"])
def test_a_damaged_name_is_not_shown_and_can_be_given_again(database, damage):
    """The run is in the list without name and tags, which are in no count; removing and restoring does not hide it."""
    notebook = NotebookStore(database)
    for id in ("r1", "r2"):
        notebook.note(id, "ann", f"name of {id}", ("lab",))
    change(database, f"UPDATE run_notes SET {damage} WHERE run = 'r1'")
    notebook.give_up("r1", "ann", 2e9)
    notebook.give_up("r1", "ann", None)
    line, other = (notebook.line("ann", id) for id in ("r1", "r2"))
    assert (line.name, line.tags, line.note_damaged) == ("", (), True)
    assert (other.name, other.tags, other.note_damaged) == ("name of r2", ("lab",), False)
    assert defects(database) == ["store.defect.note"]
    notebook.note("r1", "ann", tags=("new",))
    line = notebook.line("ann", "r1")
    assert (line.name, line.tags, line.note_damaged) == ("", ("new",), False) and defects(database) == []


@pytest.mark.parametrize("damage", ["text = 'gain 9'", "owner = 'eve'", "runs = 'r1,r3'"])
def test_damaged_notes_on_a_comparison_are_not_served(database, damage):
    """Not to their owner, nor to the client or for the runs that the damage names."""
    notebook = NotebookStore(database)
    notebook.note_comparison(["r2", "r1"], "ann", "gain 8")
    assert notebook.comparison_notes(["r1", "r2"], "ann") == "gain 8"
    change(database, f"UPDATE comparison_notes SET {damage}")
    for ids, owner in ((["r1", "r2"], "ann"), (["r1", "r2"], "eve"), (["r1", "r3"], "ann")):
        try:
            assert notebook.comparison_notes(ids, owner) == ""
        except StoreError as error:
            assert isinstance(error, Damaged)
    assert defects(database) == ["store.defect.comparison-note"]
    notebook.note_comparison(["r1", "r2"], "ann", "gain 8 again")
    assert notebook.comparison_notes(["r1", "r2"], "ann") == "gain 8 again"


@pytest.mark.parametrize(
    ("damage", "owner"),
    [("owner = 'eve'", None), ("record = 'f'", None), ("name = 'b.csv'", "ann"), ("mapping = '{}'", "ann")],
)
def test_a_damaged_share_of_a_record_gives_nobody_the_record(database, damage, owner):
    """A damaged owner is nobody. A share that is damaged elsewhere keeps its owner, without name, plant and mapping."""
    records = RecordStore(database)
    records.put(DATA, Share(RECORD, "ann", "a.csv", '"dts200"', '{"time": "t"}', 5))
    assert [line.name for line in records.page(("ann",), 9)] == ["a.csv"]
    change(database, f"UPDATE record_shares SET {damage}")
    for share in records.shares(RECORD):
        assert share.owner == owner or (owner is None and share.owner not in ("ann", "eve"))
        assert (share.name, share.plant, share.mapping) == ("", None, None)
    assert records.page(("eve",), 9) == [] and len(records.page(("ann",), 9)) == (owner is not None)
    assert defects(database) == ["store.defect.share"]
    records.put_share(Share(RECORD, "ann", "c.csv", None, None, 6.0))
    assert [line.name for line in records.page(("ann",), 9)] == ["c.csv"]
