"""Values built from results: a client has one thread at a time, and few large answers in memory."""

import asyncio
import threading
from collections.abc import Callable

import pytest
from starlette.requests import ClientDisconnect
from starlette.responses import Response

from thetascope.api.http import answers
from thetascope.api.routes import run_results
from thetascope.api.routes.notebook import run_lines
from thetascope.messages import Message
from thetascope.runs.workers.limits import LimitReached


class Asked:
    """A request of a client, which goes away when it is told to."""

    def __init__(self, client: str) -> None:
        self.client, self.leaves, self.scope = client, asyncio.Event(), {}

    async def receive(self) -> dict[str, str]:
        await self.leaves.wait()
        return {"type": "http.disconnect"}


@pytest.fixture(autouse=True)
def clients(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let requests name their clients."""
    monkeypatch.setattr(answers, "client_of", lambda request: request.client)


class Slow:
    """Work that takes until it is released; counts how often it is done at a time."""

    def __init__(self) -> None:
        self.lock, self.present, self.most, self.done = threading.Lock(), 0, 0, 0
        self.release, self.begun = threading.Event(), threading.Semaphore(0)

    def __call__(self) -> bytes:
        with self.lock:
            self.present += 1
            self.most = max(self.most, self.present)
        self.begun.release()
        assert self.release.wait(60)
        with self.lock:
            self.present -= 1
            self.done += 1
        return b"1"

    async def begins(self) -> None:
        assert await asyncio.to_thread(self.begun.acquire, timeout=60)


async def settled(condition: Callable[[], bool]) -> None:
    """Let other tasks go on until a condition holds."""
    async with asyncio.timeout(60):
        while not condition():
            await asyncio.sleep(0.01)


def test_a_client_that_asks_for_everything_leaves_threads_to_others():
    """Forty requests, and downloads in pieces: one value or piece at a time. Another client is answered meanwhile."""
    slow = Slow()

    async def download() -> int:
        return len([piece async for piece in answers.pieces_in_turn(Asked("greedy"), iter([slow] * 3))])

    async def attack() -> None:
        greedy = [asyncio.create_task(answers.in_turn(Asked("greedy"), slow)) for _ in range(20)]
        greedy += [asyncio.create_task(download()) for _ in range(20)]
        await slow.begins()
        assert await asyncio.wait_for(answers.in_turn(Asked("other"), lambda: "answered"), 60) == "answered"
        slow.release.set()
        await asyncio.gather(*greedy)

    asyncio.run(attack())
    assert slow.most == 1 and slow.done >= 20
    assert "greedy" not in answers._turns, "nothing is kept of clients that have gone"


def test_work_for_a_client_that_has_gone_is_not_begun():
    """Of twenty requests whose client leaves, only the one that has begun is finished, and its turn ends with it."""
    slow = Slow()

    async def attack() -> None:
        asked = [Asked("fleeting") for _ in range(20)]
        tasks = [asyncio.create_task(answers.in_turn(one, slow)) for one in asked]
        await slow.begins()
        for one in asked:
            one.leaves.set()
        await settled(lambda: all(task.done() for task in tasks))
        assert {type(task.exception()) for task in tasks} == {ClientDisconnect}
        slow.release.set()
        assert await answers.in_turn(Asked("fleeting"), lambda: "next") == "next"

    asyncio.run(attack())
    assert slow.done == 1


def test_a_list_of_runs_is_made_in_turn(monkeypatch: pytest.MonkeyPatch):
    """A search reads every run; eight at the same time would take the processor time of others."""
    calls = []

    async def in_turn(request: Asked, work: object) -> str:
        calls.append(request.client)
        return "listed"

    monkeypatch.setattr(run_lines, "in_turn", in_turn)
    monkeypatch.setattr(run_lines, "principal_of", lambda scope: scope)

    async def ask() -> object:
        return await run_lines.list_runs(Asked("one"), None, "en", q="seed > 3")

    assert asyncio.run(ask()) == "listed" and calls == ["one"]


@pytest.mark.parametrize("limit", [None, LimitReached(Message("work.memory-limit", limit=1))])
def test_a_report_asks_a_worker_for_what_may_take_long(monkeypatch: pytest.MonkeyPatch, limit: LimitReached | None):
    """The observability of a run is computed in no thread of the service; at a limit the report is made without it."""
    calls = []

    async def computed(*given: object) -> str:
        calls.append(given[2:])
        if limit is not None:
            raise limit
        return "seen"

    monkeypatch.setattr(run_results, "computed", computed)
    monkeypatch.setattr(run_results, "observed", lambda finished: ("function", finished))

    async def ask() -> object:
        return await run_results._observability(Asked("one"), None, "finished")

    assert asyncio.run(ask()) == (None if limit else "seen")
    assert calls == [("function", "finished")]


def test_a_client_that_reads_nothing_has_two_large_answers_in_memory():
    """The third is made when one was sent, or could not be. What fails, and what is small, keeps no place."""
    made = []

    async def answer() -> Response:
        made.append(1)
        return answers.in_pieces(b"x" * 10, {}, "text/html")

    async def fails() -> Response:
        raise ValueError

    async def small() -> Response:
        return Response(status_code=304)

    async def attack() -> None:
        for _ in range(3):
            assert (await answers.kept_until_sent(Asked("slow"), small)).status_code == 304
            with pytest.raises(ValueError):
                await answers.kept_until_sent(Asked("slow"), fails)
        first = [await answers.kept_until_sent(Asked("slow"), answer) for _ in range(2)]
        leaving = Asked("slow")
        waiting = [asyncio.create_task(answers.kept_until_sent(one, answer)) for one in (leaving, Asked("slow"))]
        await answers.kept_until_sent(Asked("other"), answer)
        leaving.leaves.set()
        await settled(waiting[0].done)
        assert isinstance(waiting[0].exception(), ClientDisconnect)
        assert not waiting[1].done() and len(made) == 3

        async def broken(message: object) -> None:
            raise OSError

        with pytest.raises(BaseException):  # noqa: B017 - an error, or a group of them
            await first[0]({"type": "http"}, Asked("slow").receive, broken)
        assert (await asyncio.wait_for(waiting[1], 60)).status_code == 200 and len(made) == 4

    asyncio.run(attack())
