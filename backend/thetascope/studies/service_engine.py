"""Blocks of a study in the service's worker processes, in turn with everybody else's computations."""

import time
from concurrent.futures import Future
from functools import partial
from weakref import ref

from thetascope.runs.specs.refusals import Busy
from thetascope.runs.workers.child import Reporter
from thetascope.runs.workers.computation import Computation
from thetascope.runs.workers.limits import Limits
from thetascope.runs.workers.pool import Workers
from thetascope.studies.block import compute

_PATIENCE = 0.5
"""Seconds until a block is offered again for which the client's queue had no room."""


def compute_block(reporter: Reporter, document: bytes, first: int, last: int) -> bytes:
    """Carry out a block in a worker."""
    return compute(document, first, last)


class ServiceEngine:
    """The service's workers, for one client: its other computations take turns with the study's."""

    def __init__(self, workers: Workers, places: int, client: str, limits: Limits) -> None:
        self._workers, self._places, self._client, self._limits = workers, places, client, limits
        self._begun: set[Computation] = set()
        self._closed = False

    @property
    def workers(self) -> int:
        """Return how many computations of one client run at the same time."""
        return self._places

    def submit(self, document: bytes, first: int, last: int) -> "Future[bytes]":
        """Queue a block; wait where the client's queue has no room. Raises Busy when the service stops."""
        while True:
            try:
                computation = self._workers.submit(
                    compute_block, document, first, last, client=self._client, limits=self._limits, long=True
                )
            except Busy as busy:
                if self._closed or busy.problem.code != "work.queue-full":
                    raise
                time.sleep(_PATIENCE)
                continue
            self._begun.add(computation)
            computation.result.add_done_callback(partial(self._ended, ref(computation)))
            return computation.result

    def _ended(self, ended: "ref[Computation]", _result: object) -> None:
        computation = ended()
        if computation is not None:
            self._begun.discard(computation)

    def renew(self) -> None:
        """Do nothing: the service replaces its workers itself."""

    def explained(self, error: Exception, runs: tuple[int, int]) -> Exception:
        """Return the error, which the workers have put in words."""
        return error

    def close(self) -> None:
        """End the blocks that are under way."""
        self._closed = True
        for computation in list(self._begun):
            computation.cancel()
