"""What grades need is computed with the lowest priority before the reveal, and with that of others after it."""

import asyncio
from concurrent.futures import Future

import pytest

from thetascope.classroom.faults.challenge_jobs import early_material_of, material_of
from thetascope.classroom.faults.computing import Computing
from thetascope.messages import Message
from thetascope.runs.specs.refusals import OverLimit


class Computation:
    """A computation whose result the test decides."""

    def __init__(self) -> None:
        self.result: Future = Future()
        self.left = False

    def leave(self) -> None:
        self.left = True


class Workers:
    """Note what is asked for, and with which priority."""

    def __init__(self) -> None:
        self.early: list[Computation] = []
        self.now: list[Computation] = []

    def submit(self, task, key, setup, client, limits, long) -> Computation:
        assert task is early_material_of and long
        self.early.append(Computation())
        return self.early[-1]

    def call(self, function, key, setup, client, trusted) -> Computation:
        assert function is material_of and trusted
        self.now.append(Computation())
        self.now[-1].result.set_result(f"material of {key}")
        return self.now[-1]


async def asked(condition) -> None:
    """Wait until a condition holds."""
    async with asyncio.timeout(60):
        while not condition():
            await asyncio.sleep(0.01)


@pytest.mark.parametrize("fails", [False, True], ids=["starves", "fails"])
def test_grades_wait_for_no_computation_that_starves_or_fails(fails: bool):
    """At the reveal it is computed with the priority of others; before it, a failure only waits for the reveal."""

    async def played() -> tuple[str, Workers]:
        workers, reveal = Workers(), asyncio.Event()
        material = asyncio.create_task(Computing(workers).material("k", "motor", reveal))
        await asked(lambda: workers.early)
        if fails:
            workers.early[0].result.set_exception(OverLimit(Message("work.stopping"), 1.0))
        await asyncio.sleep(0.05)
        assert not material.done() and workers.now == []
        reveal.set()
        return await asyncio.wait_for(material, 60), workers

    answer, workers = asyncio.run(played())
    assert answer == "material of k" and len(workers.early) == len(workers.now) == 1
    assert workers.early[0].left is not fails, "a computation that nobody needs is ended"


def test_what_is_there_before_the_reveal_is_used():
    """No second computation."""

    async def played() -> tuple[str, Workers]:
        workers = Workers()
        material = asyncio.create_task(Computing(workers).material("k", "motor", asyncio.Event()))
        await asked(lambda: workers.early)
        workers.early[0].result.set_result("early")
        return await asyncio.wait_for(material, 60), workers

    answer, workers = asyncio.run(played())
    assert answer == "early" and workers.now == []
