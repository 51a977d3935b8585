"""The workers: which computation runs when, in which process, and when it is ended.

A computation begins in the quick lane. One that takes longer than a moment continues in the slow lane with a low
priority, or waits for a place there and begins again: whoever asks for something short never waits for it. In both
lanes clients take turns, and none may have all places.
"""

import logging
import signal
import time
from collections import Counter, OrderedDict
from collections.abc import Callable
from dataclasses import replace
from threading import Lock, Thread, current_thread
from typing import Any

from thetascope.messages import Message
from thetascope.runs.specs.refusals import Busy
from thetascope.runs.workers.computation import Computation, Report, packed
from thetascope.runs.workers.last_minute import LastMinute
from thetascope.runs.workers.limits import Crashed, Ended, LimitReached, Limits, cpu_limit, memory_limit, time_limit
from thetascope.runs.workers.process import Gone, WorkerProcess
from thetascope.runs.workers.shares import Shares
from thetascope.runs.workers.turns import Turns

log = logging.getLogger(__name__)

MOMENT = 2.0
"""Seconds of processor time after which a computation leaves the quick lane."""
_GIVE_WAY = ((MOMENT, 10), (8.0, 19))
"""Nice values, by the seconds of processor time that a computation has used: the longer, the more it gives way."""
_LOOK = 0.05
"""Seconds between two looks at a computation: at its limits, and whether it was cancelled."""
_PATIENCE = 6
"""How many times the time limit a trusted computation may take."""
_KEPT = 0.125
"""A worker that has grown by more than this share of the memory limit is replaced after its computation."""
_NEAR = 0.5
"""A worker that crashed with more than this share of its memory in use lacked memory: LLVM does not say so."""
_XCPU = getattr(signal, "SIGXCPU", None)


class _Lane:
    def __init__(self) -> None:
        self.waiting: Turns[Computation] = Turns()
        self.active: Counter[str] = Counter()

    def may_take(self, client: str, places: int, most: int) -> bool:
        return self.active.total() < places and self.active[client] < most


class Workers:
    """The worker processes. Methods may be called from any thread.

    Args:
        places: computations of one client at the same time, in each of the two lanes; one more is for others.
        limits: those of a computation that has none of its own.
        queue: computations of one client that may wait.
    """

    def __init__(self, places: int, limits: Limits, queue: int) -> None:
        self._most, self._places = max(1, places), max(1, places) + 1
        self._limits, self._queue = limits, queue
        self._quick, self._slow = _Lane(), _Lane()
        self._shares, self._minute = Shares(), LastMinute()
        self._outcomes = Counter(dict.fromkeys(_OUTCOMES.values(), 0) | {"done": 0, "failed": 0})
        self._idle: list[WorkerProcess] = []
        self._shared: OrderedDict[bytes, Computation] = OrderedDict()
        self._threads: set[Thread] = set()
        self._lock = Lock()
        self._closed = False

    @property
    def limits(self) -> Limits:
        """Return the limits of a computation that has none of its own."""
        return self._limits

    def call(self, function: Callable[..., Any], *args: Any, client: str = "", trusted: bool = False) -> Computation:
        """Submit a function of a module; a request for what is being computed already waits for the same result.

        A trusted one has more time and does not give way: on a busy machine the library's experiments are opened, too.

        Raises Busy if the client has too many computations waiting.
        """
        task = packed(_plain, (function, *args))
        with self._lock:
            known = self._shared.get(task)
            if known is not None and known.join():
                return known
            limits = replace(self._limits, seconds=_PATIENCE * self._limits.seconds) if trusted else self._limits
            computation = Computation(client, task, limits, trusted=trusted)
            self._shared[task] = computation
        computation.result.add_done_callback(lambda _: self._forget(computation))
        self._add(computation)
        return computation

    def submit(
        self,
        task: Callable[..., Any],
        *args: Any,
        client: str = "",
        report: Report = lambda name, value: None,
        limits: Limits | None = None,
        long: bool = False,
    ) -> Computation:
        """Submit a task of a module, which gets the worker's Reporter first. Its time limit begins when it begins."""
        limits = limits or self._limits
        computation = Computation(client, packed(task, args), limits, report, queued=False, long=long)
        self._add(computation)
        return computation

    def warm(self, count: int) -> None:
        """Start workers in advance."""
        for _ in range(count):
            process = self._started()
            with self._lock:
                if not self._closed:
                    self._idle.append(process)
                    continue
            process.end()

    def usage(self) -> dict[str, int]:
        """Return how many computations run and wait."""
        with self._lock:
            lanes = (self._quick, self._slow)
            return {
                "running": sum(lane.active.total() for lane in lanes),
                "waiting": sum(len(lane.waiting) for lane in lanes),
            }

    def over(self, client: str, most: float) -> tuple[float, float]:
        """Return the seconds of processor time of a client within a minute, and those until it is below `most`."""
        with self._lock:
            return self._minute.used(client), self._minute.wait(client, most)

    def outcomes(self) -> dict[str, int]:
        """Return how many computations have ended, by outcome; an exception of the computation itself is done, too."""
        with self._lock:
            return dict(self._outcomes)

    def close(self) -> None:
        """End all computations and processes. Computations that waited or ran fail with Busy."""
        with self._lock:
            self._closed = True
            waiting = [c for lane in (self._quick, self._slow) for c in lane.waiting]
            idle, self._idle = self._idle, []
            threads = list(self._threads)
        for computation in waiting:
            computation.fail(_stopping())
        for process in idle:
            process.end()
        for thread in threads:
            thread.join()

    # ---- turns -------------------------------------------------------------------------------------------------------

    def _add(self, computation: Computation) -> None:
        lane = self._slow if computation.long else self._quick
        with self._lock:
            waiting = sum(c.client == computation.client for c in lane.waiting)
            refusal = _stopping() if self._closed else None
            if waiting >= self._queue and not lane.may_take(computation.client, self._places, self._most):
                refusal = Busy(Message("work.queue-full", n=waiting))
            if refusal is None:
                lane.waiting.add(computation)
                self._dispatch()
        if refusal is not None:
            computation.fail(refusal)
            raise refusal

    def _dispatch(self) -> None:
        """Begin what may begin; the caller has the lock."""
        for lane in (self._quick, self._slow):
            while not self._closed and lane.active.total() < self._places:
                computation = lane.waiting.next(lane.active, self._most)
                if computation is None:
                    break
                lane.active[computation.client] += 1
                thread = Thread(target=self._carry_out, args=(computation, lane), name="worker", daemon=True)
                self._threads.add(thread)
                thread.start()

    def _forget(self, computation: Computation) -> None:
        with self._lock:
            if self._shared.get(computation.task) is computation:
                del self._shared[computation.task]

    # ---- one computation, in a thread of its own ---------------------------------------------------------------------

    def _carry_out(self, computation: Computation, lane: _Lane) -> None:
        turn = _Turn(computation, lane)
        try:
            if computation.cancelled:
                turn.error = Ended()
            elif time.monotonic() > computation.deadline:
                turn.error = Busy(Message("work.not-begun", seconds=computation.limits.seconds))
            else:
                self._run(turn)
        except Exception as error:
            log.exception("A computation could not be carried out")
            turn.error = error
        self._leave(turn)

    def _leave(self, turn: "_Turn") -> None:
        """Free the place of a turn, resolve the result, and keep the process, or end it."""
        computation, process = turn.computation, turn.process
        keep = process is not None and turn.clean and not process.nice
        keep = keep and process is not None and process.grown <= _KEPT * self._limits.memory
        with self._lock:
            if not turn.again:
                self._outcomes[_outcome(turn)] += 1
            turn.lane.active[computation.client] -= 1
            turn.lane.active += Counter()  # drops clients with nothing under way
            if turn.again and self._closed:
                turn.again, turn.error = False, _stopping()
            elif turn.again:
                self._slow.waiting.add(computation)
            keep = keep and not self._closed and len(self._idle) < self._places
            if keep and process is not None:
                self._idle.append(process)
            self._threads.discard(current_thread())
            self._dispatch()
        if turn.error is not None:
            computation.fail(turn.error)
        elif not turn.again:
            computation.succeed(turn.value)
        if process is not None and not keep:
            process.end()

    def _run(self, turn: "_Turn") -> None:
        """Carry out the computation of a turn."""
        computation = turn.computation
        self._begin(turn)
        process, grown = turn.process, 0
        assert process is not None
        begun, counted = process.cpu, 0.0

        def used() -> float:
            """Return the processor time of this turn so far, and count it."""
            nonlocal counted
            seconds = process.cpu - begun
            with self._lock:
                self._shares.add(computation.client, seconds - counted)
                self._minute.add(computation.client, seconds - counted)
            counted = seconds
            return seconds

        computation.begin()
        try:
            while True:
                message = process.receive(_LOOK)
                if message is not None and self._told(turn, *message):
                    return
                turn.error = self._must_end(computation)
                if turn.error is not None:
                    return
                grown = process.grown
                seconds = used()
                if seconds > MOMENT and turn.lane is self._quick and not self._stays(turn):
                    turn.again = True
                    return
                if not computation.trusted:
                    process.give_way(max((nice for since, nice in _GIVE_WAY if seconds > since), default=0))
        except Gone as gone:
            turn.error = _why(gone, computation, grown)
        finally:
            used()

    def _must_end(self, computation: Computation) -> Exception | None:
        """Return why a computation that runs is ended now, or None."""
        if self._closed:
            return _stopping()
        if computation.cancelled:
            return Ended()
        return time_limit(computation.limits) if time.monotonic() > computation.deadline else None

    def _begin(self, turn: "_Turn") -> None:
        """Hand the computation to an idle worker, or to a new one if it has ended, or if the client must give way.

        A worker that gives way does so for the rest of its life, and those that know more are for the others.
        """
        while True:
            with self._lock:
                nice = self._shares.nice(turn.computation.client)
                process = self._idle.pop() if self._idle and not nice else None
            fresh = process is None
            turn.process = process or self._started()
            turn.process.give_way(nice)
            try:
                turn.process.begin(turn.computation.task, turn.computation.limits.cpu)
            except Gone:
                turn.process.end()
                if fresh:
                    raise
            else:
                return

    def _started(self) -> WorkerProcess:
        return WorkerProcess(self._limits.memory)

    def _told(self, turn: "_Turn", kind: str, value: Any) -> bool:
        """Handle a message of the worker; return whether it was the last one."""
        computation = turn.computation
        if kind == "limits":
            computation.extend(value)
        if kind in ("limits", "progress"):
            computation.report(kind, value)
            return False
        turn.clean = kind != "memory"
        if kind == "value":
            turn.value = value
        else:
            turn.error = memory_limit(computation.limits) if kind == "memory" else value
            turn.from_task = kind != "memory"
        return True

    def _stays(self, turn: "_Turn") -> bool:
        """Move a computation that takes long to the slow lane. Return False if it must wait for a place there."""
        client = turn.computation.client
        with self._lock:
            if not self._slow.may_take(client, self._places, self._most):
                return not self._quick.waiting
            turn.lane.active[client] -= 1
            self._slow.active[client] += 1
            turn.lane = self._slow
            self._dispatch()
        return True


class _Turn:
    """A computation in a process: its lane now, its outcome, or that it begins again; whether the process is clean,
    and whether the error is the task's own."""

    def __init__(self, computation: Computation, lane: _Lane) -> None:
        self.computation, self.lane = computation, lane
        self.process: WorkerProcess | None = None
        self.value: Any = None
        self.error: Exception | None = None
        self.again, self.clean, self.from_task = False, False, False


_OUTCOMES = {LimitReached: "limit", Ended: "cancelled", Busy: "refused", Crashed: "crashed"}


def _outcome(turn: _Turn) -> str:
    """Return the name of a turn's outcome."""
    if turn.error is None or turn.from_task:
        return "done"
    return next((name for kind, name in _OUTCOMES.items() if isinstance(turn.error, kind)), "failed")


def _plain(_: object, function: Callable[..., Any], *args: Any) -> Any:
    """Carry out a function that reports nothing on its way."""
    return function(*args)


def _why(gone: Gone, computation: Computation, grown: int) -> Exception:
    """Return why a worker ended during a computation."""
    if _XCPU is not None and gone.code == -_XCPU:
        return cpu_limit(computation.limits)
    if grown > _NEAR * computation.limits.memory:
        return memory_limit(computation.limits)
    log.error("A worker ended with code %s", gone.code)
    return Crashed(Message("work.crashed"))


def _stopping() -> Busy:
    return Busy(Message("work.stopping"))
