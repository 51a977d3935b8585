"""Computations of classrooms in worker processes, a few at a time."""

import asyncio
import logging
from functools import partial
from typing import TYPE_CHECKING

from thetascope.runs.workers.limits import Limits
from thetascope.runs.workers.pool import Workers

if TYPE_CHECKING:
    from thetascope.classroom.faults.challenge_jobs import ClassRecord, Material

log = logging.getLogger(__name__)

_AT_ONCE = 2
_LONGEST = Limits(600.0, 300.0, 2 * 1024**3)
"""Of the material for one fault, before the reveal: it has the lowest priority, and takes seconds on a machine that is
not busy."""


class Computing:
    """Computes for all rooms.

    The modules that compute import the engine, so they are imported with the first round.
    """

    def __init__(self, workers: Workers) -> None:
        self._workers = workers
        self._records, self._early, self._materials = (asyncio.Semaphore(_AT_ONCE) for _ in range(3))

    async def record(self, key: str, setup: str) -> "ClassRecord":
        """Return the record of a key."""
        from thetascope.classroom.faults.challenge_jobs import record_of

        async with self._records:
            call = partial(self._workers.call, record_of, key, setup, client="classroom", trusted=True)
            return await asyncio.wrap_future((await asyncio.to_thread(call)).result)

    async def material(self, key: str, setup: str, awaited: asyncio.Event) -> "Material":
        """Return the truth of a key, and what the detector says.

        It is computed when a processor has nothing else to do. Once `awaited` is set a class waits for it: what is
        not there by then, or could not be computed, is computed with the priority of others.
        """
        early = asyncio.create_task(self._early_material(key, setup))
        reveal = asyncio.create_task(awaited.wait())
        try:
            await asyncio.wait({early, reveal}, return_when=asyncio.FIRST_COMPLETED)
            if early.done() and early.exception() is None:
                return early.result()
            if early.done():
                log.info("what a class needs for its grades is computed again at the reveal: %s", early.exception())
                await reveal
            early.cancel()
            return await self._material(key, setup)
        finally:
            early.cancel()
            reveal.cancel()

    async def _early_material(self, key: str, setup: str) -> "Material":
        from thetascope.classroom.faults.challenge_jobs import early_material_of

        async with self._early:
            submit = partial(
                self._workers.submit, early_material_of, key, setup, client="classroom", limits=_LONGEST, long=True
            )
            computation = await asyncio.to_thread(submit)
            try:
                return await asyncio.wrap_future(computation.result)
            except asyncio.CancelledError:
                computation.leave()
                raise

    async def _material(self, key: str, setup: str) -> "Material":
        from thetascope.classroom.faults.challenge_jobs import material_of

        async with self._materials:
            call = partial(self._workers.call, material_of, key, setup, client="classroom", trusted=True)
            return await asyncio.wrap_future((await asyncio.to_thread(call)).result)
