"""Computations in processes: they end at their limits and when nobody waits for them, and clients take turns."""

import gc
import os
import threading
import time
import weakref
from collections.abc import Callable

import numpy as np
import pytest

from tests.runs.workers import tasks
from tests.runs.workers.conftest import TIMEOUT, WIDE, outcome
from thetascope.runs.specs.refusals import Busy
from thetascope.runs.workers import pool
from thetascope.runs.workers.limits import Crashed, Ended, LimitReached, Limits


def alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def test_values_arrays_and_exceptions_come_back_from_a_process_that_is_used_again(start):
    """A worker is kept after a computation, also after one that raised."""
    workers = start()
    first = outcome(workers.call(tasks.process_id))
    assert first != os.getpid()
    assert outcome(workers.call(tasks.add, 2, 3)) == 5
    array = outcome(workers.call(tasks.zeros, 100_000))
    np.testing.assert_array_equal(array, np.ones(100_000))
    array[0] = 2  # it can be written
    assert repr(outcome(workers.call(tasks.fail))) == "ValueError('a wrong value')"
    assert outcome(workers.call(tasks.process_id)) == first


@pytest.mark.parametrize(
    ("limits", "task", "code"),
    [
        (Limits(2.0, 60.0, 1 << 30), (tasks.wait, 60), "work.time-limit"),
        (Limits(60.0, 0.5, 1 << 30), (tasks.spin, 60), "work.cpu-limit"),
        (Limits(60.0, 60.0, 1 << 26), (tasks.zeros, 1 << 24), "work.memory-limit"),
    ],
)
def test_a_computation_ends_at_its_limits(start, limits: Limits, task: tuple, code: str):
    """The refusal names the limit; the next computation is carried out."""
    workers = start(limits)
    refusal = outcome(workers.call(*task))
    assert isinstance(refusal, LimitReached) and refusal.problem.code == code
    assert outcome(workers.call(tasks.add, 1, 1)) == 2


def test_a_worker_that_dies_is_replaced(start):
    """Its clients get an error; the next computation gets another process."""
    workers = start()
    assert isinstance(outcome(workers.call(tasks.die)), Crashed)
    assert outcome(workers.call(tasks.add, 1, 1)) == 2


def test_a_computation_ends_when_the_last_who_waits_for_it_leaves(start):
    """Equal requests wait for one computation. Its process is gone soon after the last of them has left."""
    workers = start()
    pid = outcome(workers.call(tasks.process_id))
    one, two = (workers.call(tasks.wait, 60) for _ in range(2))
    assert one is two and workers.usage() == {"running": 1, "waiting": 0}
    one.leave()
    time.sleep(0.2)
    assert not one.result.done() and alive(pid)
    two.leave()
    assert isinstance(outcome(one), Ended)
    _until(lambda: not alive(pid))
    again = workers.call(tasks.wait, 60)
    assert again is not one
    again.leave()


def test_a_client_with_many_computations_does_not_keep_another_waiting(start):
    """One place of each lane is not for it, and it waits behind the other for those that all may have."""
    workers = start(places=1)
    many = [workers.call(tasks.wait, 60, mark, client="one") for mark in range(5)]
    assert outcome(workers.call(tasks.add, 1, 1, client="two")) == 2
    assert not any(computation.result.done() for computation in many)
    for computation in many:
        computation.leave()


def test_clients_take_turns(start, tmp_path):
    """With one place for both, those of the second client are not behind all of the first."""
    workers = start(places=1, queue=20)
    workers._places = 1
    gate, begun = tmp_path / "gate", tmp_path / "begun"
    first = workers.call(tasks.wait_for, str(gate), client="one")
    waiting = [
        workers.call(tasks.note, str(begun), client, k, client=client) for client in ("one", "two") for k in range(4)
    ]
    gate.touch()
    for computation in (first, *waiting):
        outcome(computation)
    order = begun.read_text().split()
    assert len(order) == 8 and order[:4] in (["one", "two"] * 2, ["two", "one"] * 2)


def test_a_trusted_computation_has_more_time_and_does_not_give_way(start, monkeypatch):
    """On a busy machine the library's experiments are opened, too; what users typed gives way and ends in time."""
    monkeypatch.setattr(pool, "_GIVE_WAY", ((0.3, 15),))
    workers = start()
    assert outcome(workers.call(tasks.niceness_after, 0.6, trusted=True)) < 15
    assert outcome(workers.call(tasks.niceness_after, 0.6, client="two")) >= 15
    short = start(Limits(2.0, 60.0, 1 << 30))
    typed, trusted = short.call(tasks.wait, 4.0), short.call(tasks.wait, 4.1, trusted=True)
    assert outcome(typed).problem.code == "work.time-limit" and outcome(trusted) is None


def test_what_takes_long_makes_room_for_what_is_short(start, monkeypatch):
    """A long computation moves to the slow lane; where that is full it begins again later, and is carried out."""
    monkeypatch.setattr(pool, "MOMENT", 0.1)
    workers = start(places=1)
    long = [workers.call(tasks.spin, 0.5, mark) for mark in range(3)]
    begin = time.monotonic()
    assert outcome(workers.call(tasks.add, 1, 1)) == 2
    assert sum(computation.result.done() for computation in long) < 3, time.monotonic() - begin
    assert [outcome(computation) for computation in long] == [None] * 3


def test_waiting_counts_towards_the_time_limit_but_not_for_runs(start):
    """What was not begun in time is refused as busy; a task with a report of its own has all of its time."""
    workers = start(Limits(3.0, 60.0, 1 << 30))
    workers._places = 1
    first = workers.submit(tasks.wait_in_two_parts, 0.05, 3.3, WIDE)
    waiting, later = workers.call(tasks.add, 1, 1), workers.submit(tasks.wait_in_two_parts, 0, 0, WIDE)
    assert outcome(first) == "done"  # its limits were others after the first part
    assert outcome(waiting).problem.code == "work.not-begun"
    assert outcome(later) == "done"
    slow = workers.submit(tasks.wait_in_two_parts, 60, 0, WIDE)
    assert outcome(slow).problem.code == "work.time-limit"


def test_a_full_queue_is_refused(start):
    """One client's computations that wait are limited."""
    workers = start(queue=2)
    many = [workers.call(tasks.wait, 60, mark, client="one") for mark in range(3)]
    with pytest.raises(Busy):
        workers.call(tasks.wait, 60, 9, client="one")
    assert outcome(workers.call(tasks.add, 1, 1, client="two")) == 2
    for computation in many:
        computation.leave()


def test_closing_ends_everything(start):
    """No computation runs any longer, no process and no thread remains, and all waiting clients get an error."""
    workers = start(places=1)
    pid = outcome(workers.call(tasks.process_id))
    many = [workers.call(tasks.spin, 60, mark) for mark in range(3)]
    workers.close()
    assert all(isinstance(outcome(computation), Busy) for computation in many)
    _until(lambda: not alive(pid))
    assert not [thread for thread in threading.enumerate() if thread.name == "worker"]
    with pytest.raises(Busy):
        workers.call(tasks.add, 1, 1)


def _until(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + TIMEOUT
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def test_a_computation_that_has_ended_keeps_neither_arguments_nor_result(start):
    """Also without a search for garbage, which is rare: an uploaded record is among the arguments."""
    workers = start()
    gc.disable()
    try:
        kept = []
        for function, argument in ((tasks.zeros, 10), (tasks.fail, None)):
            computation = workers.call(function, *([] if argument is None else [argument]))
            computation.result.exception(TIMEOUT)
            kept.append(weakref.ref(computation))
            del computation
        end = time.monotonic() + TIMEOUT
        while any(one() for one in kept):
            assert time.monotonic() < end
            time.sleep(0.01)
    finally:
        gc.enable()
