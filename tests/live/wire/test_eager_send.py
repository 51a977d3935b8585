"""Coroutines that start immediately, and jobs that run one at a time."""

import asyncio

import pytest

from tests.live.stage import apart
from thetascope.live.room.serial_queue import SerialQueue
from thetascope.live.wire.eager_send import send_eagerly


def test_a_coroutine_that_does_not_wait_runs_immediately():
    """Without a task, without another turn of the event loop."""
    done = []

    async def send() -> None:
        done.append(1)

    assert send_eagerly(send()) is None
    assert done == [1]


def test_a_coroutine_that_waits_is_finished_by_another_task():
    """Even over several waits; its error is raised in the task."""

    async def scenario() -> list[str]:
        gates, done = [asyncio.Event(), asyncio.Event()], []

        async def send() -> None:
            for gate in gates:
                await gate.wait()
                done.append("on")
            await asyncio.sleep(0)
            raise ConnectionError

        rest = send_eagerly(send())

        async def finish() -> None:
            await rest

        task = asyncio.create_task(finish())
        for gate in gates:
            await asyncio.sleep(0)
            gate.set()
        with pytest.raises(ConnectionError):
            await task
        return done

    assert apart(scenario()) == ["on", "on"]


def test_cancelling_reaches_a_waiting_coroutine():
    """Its clean-up runs."""

    async def scenario() -> list[str]:
        cleaned = []

        async def send() -> None:
            try:
                await asyncio.Event().wait()
            finally:
                cleaned.append("cleaned")

        rest = send_eagerly(send())

        async def finish() -> None:
            await rest

        task = asyncio.create_task(finish())
        await asyncio.sleep(0)
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
        return cleaned

    assert apart(scenario()) == ["cleaned"]


def test_jobs_take_turns_and_urgent_ones_come_first():
    """While one is in a thread no other runs; a job's callback comes before the next job."""
    held, log = [], []
    queue = SerialQueue(lambda job, then: held.append((job, then)))

    def job(name: str, long: bool = False, urgent: bool = False) -> None:
        queue.submit(lambda: log.append(name), lambda *_: log.append(f"after {name}"), long, urgent)

    job("a", long=True)
    job("b")
    job("c", urgent=True)
    assert log == []
    work, then = held.pop()
    then(work(), None)
    assert log == ["a", "after a", "c", "after c", "b", "after b"]


def test_a_job_that_fails_gives_its_exception_and_the_next_one_runs():
    """No job waits forever."""
    answers = []
    queue = SerialQueue(lambda job, then: None)
    queue.submit(lambda: 1 / 0, lambda value, error: answers.append(type(error)))
    queue.submit(lambda: 7, lambda value, error: answers.append(value))
    assert answers == [ZeroDivisionError, 7]
