"""Owners of runs: equal runs are one run with several owners, of whom none can take it from the others."""

import pytest

from tests.runs.samples import long_spec, spec
from thetascope.access.gate import HOLDER
from thetascope.access.principal import LOCAL, MACHINE, Principal
from thetascope.runs.jobs.job import Job, Snapshot
from thetascope.runs.specs.refusals import NotOwner, Unknown

SECONDS = 120
ANN, BEN, EVE = (Principal(name, f"browser-{name}", HOLDER) for name in ("ann", "ben", "eve"))
SCRIPT = Principal("key 10.0.0.1", HOLDER, HOLDER)


def asked(runs, experiment, *who: Principal | None) -> str:
    """Return the id of a run that these ask for one after another, when it has ended."""
    for by in who:
        run = runs.submit(experiment, by)
        run = run.done.result(SECONDS) if isinstance(run, Job) else run
    return run.id


def restarted(start, runs):
    """Return the manager after the next start, which knows only what the store has."""
    return start()


def same(start, runs):
    return runs


@pytest.fixture(params=[same, restarted])
def later(request):
    """Return a function that goes on with the same manager, or after a restart."""
    return request.param


def test_others_cannot_remove_pin_or_unpin_a_run(start, later):
    """Its owner can, and the machine's owner."""
    runs = start()
    id = asked(runs, spec(), ANN)
    runs.pin(id, True, ANN)
    runs = later(start, runs)
    for change in (
        lambda: runs.remove(id, EVE),
        lambda: runs.pin(id, True, EVE),
        lambda: runs.pin(id, False, EVE),
        lambda: runs.remove(id, SCRIPT),
    ):
        with pytest.raises(NotOwner, match="belongs to another client; "):
            change()
    assert runs.get(id).pinned and not runs.pin(id, False, ANN).pinned
    assert runs.remove(id, ANN)
    with pytest.raises(Unknown):
        runs.get(id)


def test_a_run_goes_with_its_last_owner(start, later):
    """Each removes a share, and can do so once."""
    runs = start()
    id = asked(runs, spec(), ANN, BEN)
    runs = later(start, runs)
    assert not runs.remove(id, BEN) and runs.get(id).status == "done"
    with pytest.raises(NotOwner):
        runs.remove(id, BEN)
    runs = later(start, runs)
    assert runs.remove(id, ANN)
    assert asked(runs, spec(), EVE) == id and runs.remove(id, EVE)


def test_asking_for_the_same_gives_no_power_over_others(start, later):
    """Eve posts Ann's experiment under another title: she removes her share only, and changes neither title nor pin."""
    runs = start()
    id = asked(runs, spec(title="Ann's"), ANN)
    runs.pin(id, True, ANN)
    answer = runs.submit(spec(title="Eve's"), EVE)
    assert isinstance(answer, Snapshot) and answer.spec.title == "Eve's"
    runs = later(start, runs)
    with pytest.raises(NotOwner, match="stays pinned"):
        runs.pin(id, False, EVE)
    assert (runs.get(id).spec.title, runs.get(id).pinned) == ("Ann's", True)
    assert not runs.remove(id, EVE) and runs.get(id).status == "done"


def test_an_active_run_ends_with_its_last_owner(start):
    """Cancelling gives up a share; who has none cannot cancel."""
    runs = start()
    job = runs.submit(long_spec(), ANN)
    assert runs.submit(long_spec(), BEN) is job
    with pytest.raises(NotOwner):
        runs.cancel(job.id, EVE)
    assert runs.cancel(job.id, ANN).active and not job.cancelled
    with pytest.raises(NotOwner):
        runs.cancel(job.id, ANN)
    runs.cancel(job.id, BEN)
    assert job.done.result(SECONDS).status == "cancelled"
    assert runs.remove(job.id, BEN)


def test_the_machines_owner_may_do_everything(start, later):
    """Also with runs of several owners, at once."""
    runs = start()
    id = asked(runs, spec(), ANN, BEN)
    runs.pin(id, True, ANN)
    runs = later(start, runs)
    assert not runs.pin(id, False, LOCAL).pinned and runs.remove(id, LOCAL)
    job = runs.submit(long_spec(), ANN)
    runs.cancel(job.id, LOCAL)
    assert job.done.result(SECONDS).status == "cancelled"


def test_a_run_without_owners_belongs_to_the_machine(start, later):
    """One of the command line or of an earlier version; who asks for it later has a share beside the machine."""
    runs = start()
    id = asked(runs, spec(), None)
    runs = later(start, runs)
    with pytest.raises(NotOwner):
        runs.remove(id, ANN)
    asked(runs, spec(), ANN)
    runs = later(start, runs)
    assert not runs.remove(id, ANN) and runs._owned.of(id) == {MACHINE}


def test_what_scripts_own_by_the_key_is_for_all_who_have_it(start):
    """A browser removes its own share first."""
    runs = start()
    id = asked(runs, spec(), SCRIPT, ANN)
    assert not runs.remove(id, ANN) and runs._owned.of(id) == {HOLDER}
    assert runs.remove(id, BEN)


def test_a_result_that_is_computed_again_keeps_its_owners(start):
    """Reading the data of a dropped result makes nobody an owner."""
    runs = start(store_limit=150_000, memory=1)
    id = asked(runs, spec(), ANN)
    asked(runs, spec(seed=1), BEN)
    again = runs.finished(id)
    if isinstance(again, Job):
        again.done.result(SECONDS)
    assert runs._owned.of(id) == {ANN.owner}


def test_a_damaged_run_that_is_computed_again_keeps_its_owners(start):
    """Eve asks for Ann's run after its row was damaged: she owns a share, no more."""
    runs = start()
    id = asked(runs, spec(), ANN)
    runs = start()
    with runs._store._database.writing() as connection:
        connection.exec_driver_sql("UPDATE runs SET spec = '{}'")
    assert asked(runs, spec(), EVE) == id
    assert runs._owned.of(id) == {ANN.owner, EVE.owner} and not runs.remove(id, EVE)
