"""Changes of runs that follow no experiment of the library."""

from tests.runs.samples import spec
from tests.store.samples import made_record
from thetascope.runs.notebook.own_changes import with_own_changes
from thetascope.store import Line, RunFacts


def test_a_damaged_run_does_not_take_the_changes_of_the_others():
    """The oldest one cannot be read: the others differ from the next."""
    facts = RunFacts("", shown={"plant": "first-order"})
    lines = [Line(made_record(id, created), facts) for id, created in (("c", 3.0), ("b", 2.0), ("a", 1.0))]
    specs = {"c": spec(seed=7), "b": spec(seed=5)}
    changed = {line.record.id: line.facts for line in with_own_changes(lines, specs.get)}
    assert not changed["a"].compared and not changed["b"].compared
    assert changed["c"].compared and [(one["from"], one["to"]) for one in changed["c"].changes] == [(5, 7)]
