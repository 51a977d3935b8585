"""Lists of runs in the store: filter, order, groups, notes of owners, removal that can be undone."""

import time

import pytest

from tests.store.samples import made_record, made_result
from thetascope.runs.notebook.search_text import parse_search
from thetascope.store import Database, NotebookStore, RunFacts, RunQuery, RunStore, backup, restore


@pytest.fixture
def database(place):
    opened = Database(place)
    yield opened
    opened.close()


@pytest.fixture
def notebook(database):
    """Return the notebook of a store with four runs: a, b of zhao, c of tanks, d without facts."""
    runs = RunStore(database, 10**9)
    facts = {
        "a": RunFacts("zhao", "run", 0.3, 1.0, 0, "zhao adaptive", {"lambda": [4.0]}),
        "b": RunFacts("zhao", "session", 0.1, None, 2, "zhao adaptive 100%", {"lambda": [8.0, 2.0]}),
        "c": RunFacts("tanks", "record", None, 2.0, None, "rig-7.csv", {}),
        "d": None,
    }
    for created, (id, one) in enumerate(facts.items(), start=1):
        runs.put(made_record(id, float(created), facts=one))
    return NotebookStore(database)


def ids(notebook: NotebookStore, owner: str = "ann", **query: object) -> str:
    return "".join(line.record.id for line in notebook.page(owner, RunQuery(**query))[0])


def test_runs_are_filtered_sorted_and_paged(notebook):
    """Runs without a value are last in both directions; wildcards of SQL are ordinary characters."""
    assert ids(notebook) == "dcba" and ids(notebook, limit=2, offset=1) == "cb"
    assert ids(notebook, order="rmse", descending=False) == "badc" and ids(notebook, order="rmse") == "abdc"
    assert ids(notebook, order="delay") == "cadb" and ids(notebook, order="false_alarms") == "badc"
    assert ids(notebook, kind="session") == "b" and ids(notebook, experiment="zhao") == "ba"
    assert ids(notebook, words=("ZHAO",)) == "ba" and ids(notebook, words=("0%",)) == "b"
    assert ids(notebook, words=("_",)) == "" and ids(notebook, words=("zhao", "rig")) == ""
    assert ids(notebook, since=3.0) == "dc" and ids(notebook, pinned=True) == ""
    assert ids(notebook, group="experiment") == "dcba" and ids(notebook, group="experiment", order="rmse") == "dcab"


def test_conditions_are_on_settings_and_measures(notebook):
    """One of several values suffices; a page begins after the filter."""
    for text, expected in {"lambda > 2": "ba", "λ < 3": "b", "alarms = 0": "a", "lambda>1 rmse<0.2": "b"}.items():
        assert ids(notebook, conditions=parse_search(text)[1]) == expected
    assert ids(notebook, conditions=parse_search("lambda > 2")[1], offset=1) == "a"


def test_notes_of_a_comparison_go_with_its_runs(database, notebook):
    """They do not depend on the order of the runs, are the owner's own, and end when one of the runs is erased."""
    notebook.note_comparison(["b", "a"], "ann", "of two")
    notebook.note_comparison(["a", "b", "c"], "ann", "of three")
    assert (
        notebook.comparison_notes(["a", "b"], "ann") == "of two" and notebook.comparison_notes(["a", "b"], "eve") == ""
    )
    RunStore(database, 10**9).remove("c")
    assert notebook.erase(time.time() + 1) == 1
    assert notebook.comparison_notes(["a", "b", "c"], "ann") == "" != notebook.comparison_notes(["b", "a"], "ann")


def test_counts_are_those_of_the_list_and_of_the_filter(notebook):
    """A run without facts counts as a run of no experiment."""
    counts = notebook.page("ann", RunQuery(kind="run", group="experiment", limit=1))[1]
    assert (counts.all, counts.pinned, counts.kinds) == (4, 0, {"run": 2, "session": 1, "record": 1})
    assert counts.found == {"": 1, "zhao": 1}
    assert notebook.without_facts() == ["d"]


def test_each_owner_has_its_names_and_tags(notebook):
    """They are sought by their owner only; changing one leaves the other."""
    notebook.note("a", "ann", name="quick")
    notebook.note("a", "ann", tags=("lab 2", "图 4"))
    line = notebook.line("ann", "a")
    assert (line.name, line.tags) == ("quick", ("lab 2", "图 4")) and notebook.line("bob", "a").name == ""
    assert ids(notebook, tag="lab 2") == "a" == ids(notebook, words=("quick",)) == ids(notebook, words=("图",))
    assert ids(notebook, tag="lab") == "" == ids(notebook, owner="bob", tag="lab 2")
    assert notebook.page("ann", RunQuery())[1].tags == {"lab 2": 1, "图 4": 1}


def test_a_removed_run_comes_back_whole_or_is_erased(database, notebook):
    """Until it is erased its result, pin, owners, facts and notes are kept."""
    runs = RunStore(database, 10**9)
    runs.put_result("a", "e", made_result())
    runs.own("a", {"ann"})
    runs.pin("a", True)
    notebook.note("a", "ann", name="quick")
    before, result = notebook.line("ann", "a"), runs.get_result("a", "e")
    assert runs.remove("a") and not runs.remove("a")
    assert runs.get("a") is None and runs.ids("a") == [] and ids(notebook) == "dcb" and runs.usage()["runs"] == 3
    assert [run.id for run in runs.page()] == ["d", "c", "b"]
    assert notebook.restore("a") and not notebook.restore("a")
    assert notebook.line("ann", "a") == before and runs.get_result("a", "e").data.tobytes() == result.data.tobytes()
    runs.remove("a")
    assert notebook.erase(time.time() - 60) == 0 and notebook.erase(time.time() + 1) == 1
    assert not notebook.restore("a") and runs.owners("a") == frozenset() and not runs.has_result("a", "e")


def test_a_run_that_is_asked_for_again_is_new(database, notebook):
    """Nothing of the removed one is left; a run that was not removed stays."""
    runs = RunStore(database, 10**9)
    notebook.note("a", "ann", name="quick")
    runs.remove("a")
    runs.erase_removed("a")
    runs.erase_removed("b")
    runs.put(made_record("a", 9.0, facts=RunFacts("zhao")))
    assert notebook.line("ann", "a").name == "" and ids(notebook) == "adcb"


def test_a_share_that_was_given_up_is_out_of_one_list(database, notebook):
    """It is there again when its owner asks for the run again."""
    notebook.give_up("a", "ann", 5.0)
    assert ids(notebook) == "dcb" and ids(notebook, owner="bob") == "dcba" and notebook.given_up("a", "ann")
    RunStore(database, 10**9).own("a", {"ann"})
    assert ids(notebook) == "dcba" and not notebook.given_up("a", "ann")


def test_kind_and_curve_stay_when_facts_are_written_again(database, notebook):
    """The saved session's mark, and the curve, which only the result gives."""
    notebook.set_kind("a", "session")
    notebook.put_facts({"a": RunFacts("zhao", "run", shown={"curve": {"channel": "f"}})})
    notebook.put_facts({"a": RunFacts("zhao", "run", 0.2, shown={"state": "x"})})
    facts = notebook.line("ann", "a").facts
    assert (facts.kind, facts.rmse, facts.shown) == ("session", 0.2, {"curve": {"channel": "f"}, "state": "x"})


def test_a_backup_has_facts_and_notes(notebook, place, tmp_path):
    """Restored into another store, the list is the same."""
    notebook.note("a", "ann", name="quick", tags=("x",))
    backup(place, tmp_path / "copy.sqlite")
    restore(tmp_path / "other.sqlite", tmp_path / "copy.sqlite")
    other = Database(tmp_path / "other.sqlite")
    assert NotebookStore(other).page("ann", RunQuery()) == notebook.page("ann", RunQuery())
    other.close()
