"""Computations of classrooms in worker processes, a few at a time."""

import asyncio
from functools import partial
from typing import TYPE_CHECKING

from thetascope.runs.workers.limits import Limits
from thetascope.runs.workers.pool import Workers

if TYPE_CHECKING:
    from thetascope.classroom.faults.challenge_jobs import ClassRecord, Material

_AT_ONCE = 2
_LONGEST = Limits(600.0, 300.0, 2 * 1024**3)
"""Of the material for one fault: it has the lowest priority, and takes seconds on a machine that is not busy."""


class Computing:
    """Computes for all rooms.

    The modules that compute import the engine, so they are imported with the first round.
    """

    def __init__(self, workers: Workers) -> None:
        self._workers = workers
        self._records, self._materials = asyncio.Semaphore(_AT_ONCE), asyncio.Semaphore(_AT_ONCE)

    async def record(self, key: str, setup: str) -> "ClassRecord":
        """Return the record of a key."""
        from thetascope.classroom.faults.challenge_jobs import record_of

        async with self._records:
            call = partial(self._workers.call, record_of, key, setup, client="classroom", trusted=True)
            return await asyncio.wrap_future((await asyncio.to_thread(call)).result)

    async def material(self, key: str, setup: str) -> "Material":
        """Return the truth of a key, and what the detector says."""
        from thetascope.classroom.faults.challenge_jobs import material_of

        async with self._materials:
            submit = partial(
                self._workers.submit, material_of, key, setup, client="classroom", limits=_LONGEST, long=True
            )
            return await asyncio.wrap_future((await asyncio.to_thread(submit)).result)
