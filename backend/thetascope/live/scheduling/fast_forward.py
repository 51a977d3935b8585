"""Advance new sessions to the time at which they open, a piece at a time.

All of them share one thread, in which they take turns. So Python's lock is left to everybody else now and then, and a
session that nobody waits for any more ends with its piece.
"""

import asyncio
import ctypes
import sys
from collections import Counter, defaultdict
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from time import perf_counter, thread_time
from typing import TYPE_CHECKING

from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope.runs.specs.refusals import Busy

if TYPE_CHECKING:
    from thetascope.live.session.session import Session

_PIECE = 0.02
"""Seconds of one piece, about."""
_LOOK, _PATIENCE = 0.005, 0.2
"""Seconds between two looks whether another client waits for a session, and the most that a piece waits for that."""
_REST = 0.5
"""Rest after a piece, as a share of its time, so that requests get Python's lock."""
_FIRST, _MOST = 256, 4096
"""Rows of the first piece, and of the largest."""


class FastForward:
    """The thread, and the turns in it: one session of a client at a time. Methods are called on the event loop.

    Args:
        seconds: the time in s that opening a session may take, for its refusal.
        busy: whether others compute, too; then it rests after each piece as long as that took, otherwise half as long.
        opening: returns the number of sessions that each client opens, those in this thread included.
        count: is called with a client and the processor time in s that a piece took.
    """

    def __init__(
        self,
        seconds: float,
        busy: Callable[[], bool],
        opening: Callable[[], Counter[str]],
        count: Callable[[str, float], None],
    ) -> None:
        self._seconds, self._busy, self._opening, self._count = seconds, busy, opening, count
        self._advancing: Counter[str] = Counter()
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="forward")
        self._turns: defaultdict[str, asyncio.Lock] = defaultdict(asyncio.Lock)
        self._stopped = False

    async def advance(self, session: "Session", rows: int, past: int, client: str, until: float) -> None:
        """Advance a session to a number of rows; it keeps `past` bytes of samples, and is given up at time `until`.

        Raises:
            SpecError: it takes too long.
            Busy: the service stops.
        """
        if session.row >= rows:
            return
        turn = self._turns[client]
        self._advancing[client] += 1
        try:
            async with turn:
                await self._pieces(session, rows, past, client, until)
        finally:
            self._advancing[client] -= 1
            self._advancing += Counter()  # drops clients with none
            if not turn.locked():
                self._turns.pop(client, None)
            if not self._stopped:
                self._thread.submit(return_memory)

    def stop(self) -> None:
        """End after the present piece."""
        self._stopped = True
        self._thread.shutdown(wait=False, cancel_futures=True)

    async def _pieces(self, session: "Session", rows: int, past: int, client: str, until: float) -> None:
        clock, count = asyncio.get_running_loop().time, _FIRST
        while session.row < rows and not session.ended:
            if clock() > until:
                record = session.record
                problem = Message("session.open.too-slow", seconds=self._seconds, reached=session.row * record)
                raise SpecError("t", (rows - 1) * record, problem)
            await self._give_way(client)
            count = await self._piece(session, min(count, rows - session.row), past, client)

    async def _give_way(self, client: str) -> None:
        """Wait while a session of another client is being opened, for a limited time: opening needs Python's lock."""
        for _ in range(round(_PATIENCE / _LOOK)):
            if not any(name != client for name in self._opening() - self._advancing):
                return
            await asyncio.sleep(_LOOK)

    async def _piece(self, session: "Session", rows: int, past: int, client: str) -> int:
        """Advance by one piece; return the rows of the next one."""
        from thetascope.live.room.prefetch_plan import compute

        if self._stopped:
            raise Busy(Message("work.stopping"))
        loop = asyncio.get_running_loop()
        seconds, used = await loop.run_in_executor(self._thread, _timed, compute, session, rows, past)
        self._count(client, used)
        await asyncio.sleep(seconds if self._busy() else _REST * seconds)
        return max(1, min(_MOST, 4 * rows, round(rows * _PIECE / max(seconds, 1e-6))))


def return_memory() -> None:
    """Return freed memory to the operating system, which C libraries keep for a long time."""
    trim = getattr(_libc(), "malloc_trim", None)
    if trim is not None:
        trim(0)


@cache
def _libc() -> ctypes.CDLL | None:
    return ctypes.CDLL(None) if sys.platform == "linux" else None


def _timed(compute, session: "Session", rows: int, past: int) -> tuple[float, float]:
    """Compute rows and return the seconds that it took, and those of processor time."""
    begin, used = perf_counter(), thread_time()
    compute(session, rows, past)
    return perf_counter() - begin, thread_time() - used
