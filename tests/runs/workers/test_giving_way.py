"""The computations of one client do not slow others down: most of them get processor time that nobody else needs."""

import sys
from concurrent.futures import FIRST_COMPLETED, wait

import pytest

from tests.runs.workers import tasks
from tests.runs.workers.conftest import TIMEOUT, outcome
from thetascope.runs.workers import pool
from thetascope.runs.workers.limits import Limits

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="other systems have no such class of processes")


def test_one_computation_of_a_client_has_full_priority_while_others_are_there(start, tmp_path):
    """Its further ones come after those of others; the other client's has full priority."""
    workers = start(places=3)
    gate = tmp_path / "gate"
    assert outcome(workers.call(tasks.add, 1, 1, client="other")) == 2
    several = [workers.call(tasks.comes_after_others_at, str(gate), mark, client="one") for mark in range(3)]
    workers.note_request("other")
    assert outcome(workers.call(tasks.comes_after_others, client="other")) is False
    gate.touch()
    assert sorted(outcome(computation) for computation in several) == [False, True, True]


def test_a_client_alone_gives_way_to_nobody_until_another_comes(start):
    """Several computations at the same time have full priority; then one of them comes after others."""
    workers = start(places=2)
    alone = [workers.call(tasks.until_it_comes_after_others, 0.3, mark) for mark in range(2)]
    assert [outcome(computation) for computation in alone] == [False, False]
    pair = [workers.call(tasks.until_it_comes_after_others, TIMEOUT, mark) for mark in range(2)]
    workers.note_request("other")  # for example, it opens a session, for which no worker is needed
    done, _ = wait([computation.result for computation in pair], TIMEOUT, FIRST_COMPLETED)
    assert [future.result() for future in done] == [True]
    for computation in pair:
        computation.leave()


def test_what_takes_long_gives_way(start, monkeypatch):
    """After a moment of processor time, and from its begin if it is known to take long."""
    monkeypatch.setattr(pool, "MOMENT", 0.2)
    workers = start()
    workers.note_request("other")
    assert outcome(workers.submit(tasks.run_until_it_gives_way, TIMEOUT, client="one", long=True)) is True
    workers.note_request("other")  # on a busy machine the first has taken longer than a client counts as present
    assert outcome(workers.call(tasks.gives_way_after, 0.3, client="two")) is True


def test_a_client_of_long_computations_gives_way_from_the_begin_and_has_its_own_workers(start):
    """After two of them. Its worker is used again for it, and never for others."""
    workers = start()
    for _ in range(2):
        workers._precedence.note_long("one")
    workers.note_request("other")
    assert outcome(workers.call(tasks.gives_way, client="one")) is True
    workers.note_request("other")
    own = outcome(workers.call(tasks.process_id, client="one"))
    assert outcome(workers.call(tasks.gives_way, client="other")) is False
    assert outcome(workers.call(tasks.process_id, client="other")) != own


def test_those_that_give_way_keep_no_place_that_another_client_waits_for(start):
    """Two clients have all places of the quick lane; the third is served."""
    workers = start(Limits(60.0, 60.0, 1 << 30), places=1)
    for client in ("one", "two"):
        for _ in range(2):
            workers._precedence.note_long(client)
    held = [workers.call(tasks.wait, 60, client, client=client) for client in ("one", "two")]
    assert outcome(workers.call(tasks.add, 1, 1, client="three")) == 2
    assert not any(computation.result.done() for computation in held)
    for computation in held:
        computation.leave()
