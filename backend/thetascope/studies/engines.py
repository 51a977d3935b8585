"""What computes blocks: processes of this machine, its threads, this thread, or a Dask cluster."""

import contextlib
import logging
import os
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from dataclasses import dataclass
from importlib import import_module
from multiprocessing import get_context, parent_process
from typing import Any, Protocol

from thetascope.messages import Message
from thetascope.process_settings import use_one_thread
from thetascope.runs.results.engine_version import engine_version
from thetascope.runs.specs.refusals import Refusal
from thetascope.studies.block import compute

ATTEMPTS = 3
"""How often a block is begun whose worker dies."""
log = logging.getLogger(__name__)


class Engine(Protocol):
    """Something to which blocks are given."""

    @property
    def workers(self) -> int:
        """How many blocks are computed at the same time."""
        ...

    def submit(self, document: bytes, first: int, last: int) -> "Future[bytes]":
        """Begin to compute runs [first, last)."""
        ...

    def renew(self) -> None:
        """Start the workers anew after one has died. Raises Refusal where nobody can."""
        ...

    def explained(self, error: Exception, runs: tuple[int, int]) -> Exception:
        """Return the reason why runs [first, last) failed, or the error itself where that is the program's own."""
        ...

    def close(self) -> None:
        """End the workers, at once."""
        ...


class LocalEngine:
    """Processes or threads of this machine. Kernels run without the interpreter's lock; the rest needs processes."""

    def __init__(self, workers: int, threads: bool = False) -> None:
        self._workers, self._threads = workers, threads
        self._pool = self._started()

    @property
    def workers(self) -> int:
        """Return the number of processes or threads."""
        return self._workers

    def _started(self) -> Executor:
        if self._threads:
            return ThreadPoolExecutor(self._workers)
        return ProcessPoolExecutor(self._workers, mp_context=get_context("spawn"), initializer=_begin)

    def submit(self, document: bytes, first: int, last: int) -> "Future[bytes]":
        """Begin to compute runs."""
        return self._pool.submit(compute, document, first, last)

    def renew(self) -> None:
        """Start new processes."""
        self.close()
        self._pool = self._started()

    def explained(self, error: Exception, runs: tuple[int, int]) -> Exception:
        """Return the error: a process that dies is begun again."""
        return error

    def close(self) -> None:
        """End the workers; what they compute is lost."""
        pool = self._pool
        processes = list((getattr(pool, "_processes", None) or {}).values())
        pool.shutdown(wait=False, cancel_futures=True)
        for process in processes:
            with contextlib.suppress(Exception):
                process.terminate()


class DaskEngine:
    """A Dask cluster, by the address of its scheduler. Its workers must run the same version of the program."""

    def __init__(self, address: str, timeout: float = 10.0) -> None:
        try:
            distributed: Any = import_module("distributed")
        except ModuleNotFoundError:
            raise Refusal(Message("study.dask", address=address)) from None
        try:
            self._client = distributed.Client(address, timeout=timeout, set_as_default=False)
        except (OSError, ValueError) as error:
            raise Refusal(Message("study.scheduler", address=address, reason=str(error)[:200])) from None
        self._address = address
        self._check_versions()
        self._pool = self._client.get_executor(pure=False, retries=ATTEMPTS - 1)

    @property
    def workers(self) -> int:
        """Return the number of threads of the cluster, at least one: workers may join later. Raises Refusal."""
        try:
            return max(1, sum(self._client.nthreads().values()))
        except (OSError, TimeoutError):
            raise self._lost() from None

    def _lost(self) -> Refusal:
        return Refusal(Message("study.scheduler-lost", address=self._address))

    def _check_versions(self) -> None:
        """Refuse workers whose rows could have other bits."""
        mine = version()
        for worker, theirs in self._client.run(version).items():
            if theirs != mine:
                raise Refusal(Message("study.worker-version", worker=worker, theirs=theirs, mine=mine))

    def submit(self, document: bytes, first: int, last: int) -> "Future[bytes]":
        """Begin to compute runs."""
        if self._client.status != "running":
            raise self._lost()
        return self._pool.submit(compute, document, first, last)

    def renew(self) -> None:
        """Refuse to go on: the cluster starts its workers itself, and the scheduler is lost."""
        raise self._lost()

    def explained(self, error: Exception, runs: tuple[int, int]) -> Exception:
        """Return the reason in words where workers died again and again, or the scheduler is lost."""
        if type(error).__name__ == "KilledWorker":
            return died(runs)
        if isinstance(error, OSError) or self._client.status != "running":
            return self._lost()
        return error

    def close(self) -> None:
        """Leave the cluster; its scheduler drops what was not computed."""
        with contextlib.suppress(Exception):
            self._pool.shutdown(wait=False)
        with contextlib.suppress(Exception):
            self._client.close(timeout=2)


def died(runs: tuple[int, int]) -> Refusal:
    """Return the refusal of runs [first, last) whose worker has died ATTEMPTS times."""
    return Refusal(Message("study.workers-died", first=runs[0], last=runs[1] - 1, n=ATTEMPTS))


def version() -> str:
    """Return what decides about the bits of a row: the hash of the engine's source."""
    return engine_version()


def _begin() -> None:
    """Prepare a process; it ends when its parent does, even by force, because nothing else would end it."""
    use_one_thread()
    parent = parent_process()

    def follow() -> None:
        if parent is not None:
            parent.join()
            os._exit(1)

    threading.Thread(target=follow, daemon=True).start()


@dataclass(frozen=True)
class Done:
    """A block and its bytes."""

    block: int
    data: bytes


def computed(
    engine: Engine,
    document: bytes,
    blocks: Iterator[int],
    span: Callable[[int], tuple[int, int]],
    cancelled: Callable[[], bool] = lambda: False,
) -> Iterator[Done]:
    """Yield blocks as they are computed; at most two for each worker are under way, so that memory stays flat.

    A block whose worker died is begun again, ATTEMPTS times in all.

    Raises:
        Refusal: a block cannot be computed, or the scheduler is lost.
    """
    under_way: dict[Future[bytes], int] = {}
    again: list[int] = []
    failures: dict[int, int] = {}

    def fill() -> None:
        while len(under_way) < 2 * engine.workers:
            block = again.pop() if again else next(blocks, None)
            if block is None:
                return
            under_way[engine.submit(document, *span(block))] = block

    def begin_again(block: int) -> None:
        failures[block] = failures.get(block, 0) + 1
        if failures[block] >= ATTEMPTS:
            raise died(span(block))
        again.append(block)

    fill()
    while under_way and not cancelled():
        ready, _ = wait(under_way, timeout=0.2, return_when=FIRST_COMPLETED)
        broken = False
        for future in ready:
            block = under_way.pop(future)
            try:
                data = future.result()
            except (BrokenExecutor, CancelledError) as error:
                log.warning("Block %d is begun again: %s", block, error)
                begin_again(block)
                broken = True
            except Exception as error:
                raise engine.explained(error, span(block)) from error
            else:
                yield Done(block, data)
        if broken:
            for future, block in under_way.items():  # they belong to the same dead pool
                future.cancel()
                again.append(block)
            under_way.clear()
            engine.renew()
        if not cancelled():
            fill()
