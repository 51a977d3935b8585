"""What was changed in a run, relative to the library's experiment."""

import pytest

from thetascope import library
from thetascope.runs.results.run_facts import facts_of_run, library_base
from thetascope.runs.specs.resolve_spec import library_experiment, resolved, with_changes
from thetascope.runs.specs.spec_changes import differing, numbers, spec_changes


def told(base: str, **changes: object) -> list[tuple[str, str, object, object]]:
    """Return path, label in English, from and to of the changes of a library experiment."""
    spec = library_experiment(base)
    facts = facts_of_run(with_changes(spec, {path.replace("__", "."): to for path, to in changes.items()}))
    return [(c["path"], c["label"]["code"], c["from"], c["to"]) for c in facts.changes]


@pytest.mark.parametrize("id", sorted(library.experiments()))
def test_an_experiment_of_the_library_has_no_changes(id):
    """Also with its plant in full, as a live session saves it."""
    spec = library_experiment(id)
    assert spec_changes(spec, spec) == [] and spec_changes(spec, resolved(spec)) == []
    assert library_base(resolved(spec)) is spec


def test_changed_settings_have_their_old_and_new_values():
    """Numbers by path; the order is that of the experiment's fields."""
    changes = {"observers__adaptive__gains__lambda": 8, "seed": 3, "noise__y__std": 0.002, "faults__theta3__size": 0.03}
    assert sorted(told("zhao-2012", **changes)) == [
        ("faults.theta3.size", "change.field", 0.02, 0.03),
        ("noise.y.std", "change.noise", 0.001, 0.002),
        ("observers.adaptive.gains.lambda", "change.symbol", 4, 8),
        ("seed", "change.seed", 1, 3),
    ]


def test_added_and_removed_items_have_one_entry_each():
    """A fault that is new, an observer that is left out, a signal of another kind."""
    base = library_experiment("zhao-2012-observers")
    first, *rest = base.observers
    fault = {"output": "y", "shape": "freeze", "onset": 5.0}
    spec = base.model_validate(
        base.model_dump()
        | {"observers": [o.model_dump() for o in rest], "faults": [*base.model_dump()["faults"], fault]}
    )
    assert [(c["path"], c["from"] is None, c["to"] is None) for c in spec_changes(base, spec)] == [
        ("faults.y", True, False),
        (f"observers.{first.label}", False, True),
    ]


def test_settings_that_differ_among_runs_are_told_from_the_equal_ones():
    """Values of each run in order; everything else is counted as equal."""
    base = library_experiment("zhao-2012")
    runs = [base, *(with_changes(base, {"seed": seed, "parameters.a4": 0.11}) for seed in (2, 3))]
    rows, same = differing(runs)
    assert [(row["path"], row["values"]) for row in rows] == [
        ("parameters.a4", [None, 0.11, 0.11]),
        ("seed", [1, 2, 3]),
    ]
    assert same > 20
    assert differing([base, base])[0] == []


def test_numbers_of_a_run_are_found_by_the_name_of_a_gain():
    """A gain of several observers has several values."""
    assert numbers(library_experiment("zhao-2012"))["lambda"] == [4]
    assert len(numbers(library_experiment("zhao-2012-observers"))["gamma0"]) >= 1
