"""Values built from results: one client has few threads at a time, whatever it asks for at once; others go on."""

import asyncio
import threading

from thetascope.api.http import answers


def test_a_client_that_asks_for_everything_leaves_threads_to_others(monkeypatch):
    """Forty requests of one client never build more than two values at a time; another client's is built meanwhile."""
    monkeypatch.setattr(answers, "client_of", lambda request: request)
    lock, present, most = threading.Lock(), 0, 0
    release, begun = threading.Event(), threading.Semaphore(0)

    def slow() -> int:
        nonlocal present, most
        with lock:
            present += 1
            most = max(most, present)
        begun.release()
        assert release.wait(60)
        with lock:
            present -= 1
        return 1

    async def attack() -> None:
        greedy = [asyncio.create_task(answers.in_turn("greedy", slow)) for _ in range(40)]
        for _ in range(2):
            assert await asyncio.to_thread(begun.acquire, timeout=60)
        assert await asyncio.wait_for(answers.in_turn("other", lambda: "answered"), 60) == "answered"
        release.set()
        assert sum(await asyncio.gather(*greedy)) == 40

    asyncio.run(attack())
    assert most == 2
    assert "greedy" not in answers._turns, "nothing is kept of clients that have gone"
