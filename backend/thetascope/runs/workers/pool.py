"""The workers: which computation runs when, in which process, and when it is ended.

A computation begins in the quick lane. One that takes longer than a moment continues in the slow lane with a low
priority, or waits for a place there and begins again: whoever asks for something short never waits for it. In both
lanes clients take turns, and none may have all places. While another client is there, most of what a client computes
gets only the processor time that nobody else needs.
"""

import logging
import time
from collections import Counter, OrderedDict
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from threading import Lock, Thread, current_thread
from typing import Any
from weakref import ref

from thetascope.messages import Message
from thetascope.runs.specs.refusals import Busy
from thetascope.runs.workers.computation import Computation, Report, packed
from thetascope.runs.workers.last_minute import LastMinute
from thetascope.runs.workers.limits import Ended, Limits, time_limit
from thetascope.runs.workers.precedence import LEFTOVERS, Precedence
from thetascope.runs.workers.process import Gone, WorkerProcess
from thetascope.runs.workers.turn import OUTCOMES, Turn, stopping, why_gone
from thetascope.runs.workers.turns import Lane

log = logging.getLogger(__name__)

MOMENT = 2.0
"""Seconds of processor time after which a computation leaves the quick lane."""
_GIVE_WAY = ((MOMENT, 10), (8.0, 19))
"""Nice values, by the seconds of processor time that a computation has used: the longer, the more it gives way."""
_SHORT, _FURTHER = 0.5, 10
"""Seconds of processor time for which a client's further computations have this nice value while others are there;
then they get what is left. So many clients with a few short ones each do not end each other's."""
_LOOK = 0.05
"""Seconds between two looks at a computation: at its limits, and whether it was cancelled."""
_PATIENCE = 6
"""How many times the time limit a trusted computation may take."""
_KEPT = 0.125
"""A worker that has grown by more than this share of the memory limit is replaced after its computation."""


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
        self._quick, self._slow = Lane(), Lane()
        self._precedence, self._minute = Precedence(), LastMinute()
        self._turns: set[Turn] = set()
        self._outcomes = Counter(dict.fromkeys(OUTCOMES.values(), 0) | {"done": 0, "failed": 0})
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
        # no reference from the result to the computation: it would stay, with its arguments, until a search for garbage
        computation.result.add_done_callback(partial(self._forget, ref(computation)))
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

    def note_request(self, client: str) -> None:
        """Note that a client is there, to whom computations of others give way, although it may not need a worker."""
        with self._lock:
            self._precedence.note_request(client)

    def count(self, client: str, seconds: float) -> None:
        """Count processor time that a client used elsewhere in the service."""
        with self._lock:
            self._minute.add(client, seconds)

    def close(self) -> None:
        """End all computations and processes. Computations that waited or ran fail with Busy."""
        with self._lock:
            self._closed = True
            waiting = [c for lane in (self._quick, self._slow) for c in lane.waiting]
            idle, self._idle = self._idle, []
            threads = list(self._threads)
        for computation in waiting:
            computation.fail(stopping())
        for process in idle:
            process.end()
        for thread in threads:
            thread.join()

    # ---- turns -------------------------------------------------------------------------------------------------------

    def _add(self, computation: Computation) -> None:
        lane = self._slow if computation.long else self._quick
        with self._lock:
            self._precedence.note_request(computation.client)
            waiting = sum(c.client == computation.client for c in lane.waiting)
            refusal = stopping() if self._closed else None
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

    def _forget(self, ended: "ref[Computation]", _result: object) -> None:
        computation = ended()
        with self._lock:
            if computation is not None and self._shared.get(computation.task) is computation:
                del self._shared[computation.task]

    # ---- one computation, in a thread of its own ---------------------------------------------------------------------

    def _carry_out(self, computation: Computation, lane: Lane) -> None:
        turn = Turn(computation, lane)
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
        with self._lock:
            self._threads.discard(current_thread())

    def _leave(self, turn: Turn) -> None:
        """Free the place of a turn, resolve the result, and keep the process, or end it."""
        computation, process = turn.computation, turn.process
        keep = process is not None and turn.clean and process.grown <= _KEPT * self._limits.memory
        with self._lock:
            self._turns.discard(turn)
            if not turn.again:
                self._outcomes[turn.outcome] += 1
            turn.lane.active[computation.client] -= 1
            turn.lane.active += Counter()  # drops clients with nothing under way
            if turn.again and self._closed:
                turn.again, turn.error = False, stopping()
            elif turn.again:
                self._slow.waiting.add(computation)
            keep = keep and process is not None and self._may_keep(process)
            if keep and process is not None:
                self._idle.append(process)
            self._dispatch()
        if turn.error is not None:
            computation.fail(turn.error)
        elif not turn.again:
            computation.succeed(turn.value)
        if process is not None and not keep:
            process.end()
            self._replace()

    def _may_keep(self, process: WorkerProcess) -> bool:
        """Return whether a process may wait for its next computation. Those that give way wait for theirs."""
        return not self._closed and sum(bool(p.nice) == bool(process.nice) for p in self._idle) < self._places

    def _replace(self) -> None:
        """Start a worker, unless one waits that does not give way: whoever comes next need not wait for its start."""
        with self._lock:
            needless = self._closed or any(not process.nice for process in self._idle)
        if not needless:
            self.warm(1)

    def _run(self, turn: Turn) -> None:
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
                self._minute.add(computation.client, seconds - counted)
            counted = seconds
            return seconds

        computation.begin()
        try:
            while True:
                message = process.receive(_LOOK)
                if message is not None and turn.take(*message):
                    return
                turn.error = self._must_end(computation)
                if turn.error is not None:
                    return
                grown = process.grown
                seconds = used()
                if self._give_way(turn, seconds) < LEFTOVERS and seconds <= MOMENT:
                    continue
                if turn.lane is self._quick and not self._stays(turn, seconds > MOMENT):
                    turn.again = True
                    return
        except Gone as gone:
            turn.error = why_gone(gone, computation, grown)
        finally:
            used()

    def _give_way(self, turn: Turn, seconds: float = 0.0) -> int:
        """Return the nice value of a computation after these seconds of processor time, and give it to its process.

        While others are there one short computation of each client has the priority of theirs. Its further ones come
        after those of others, and long ones get what is left.
        """
        computation, process = turn.computation, turn.process
        client = computation.client
        with self._lock:
            self._turns.add(turn)
            if seconds > MOMENT and not computation.took_long:
                computation.took_long = True
                self._precedence.note_long(client)
            if not computation.trusted:
                turn.nice = max(turn.nice, *(nice for since, nice in _GIVE_WAY if seconds > since), 0)
                if self._precedence.others(client):
                    turn.nice = max(turn.nice, self._behind_others(turn, seconds))
        if process is not None and turn.nice > process.nice:
            replace = not process.nice
            process.give_way(turn.nice)
            if replace:
                self._replace()
        return turn.nice

    def _behind_others(self, turn: Turn, seconds: float) -> int:
        """Return the nice value of a computation while another client is there; the caller has the lock."""
        computation, client = turn.computation, turn.computation.client
        if computation.long or computation.took_long or self._precedence.gives_way(client):
            return LEFTOVERS
        if any(t.computation.client == client and t.nice < _FURTHER for t in self._turns - {turn}):
            return LEFTOVERS if seconds > _SHORT else _FURTHER
        return LEFTOVERS if turn.nice >= _FURTHER and seconds > _SHORT else 0

    def _must_end(self, computation: Computation) -> Exception | None:
        """Return why a computation that runs is ended now, or None."""
        if self._closed:
            return stopping()
        if computation.cancelled:
            return Ended()
        return time_limit(computation.limits) if time.monotonic() > computation.deadline else None

    def _begin(self, turn: Turn) -> None:
        """Hand the computation to an idle worker, or to a new one where none is idle or it has ended.

        A worker that gives way does so for the rest of its life: computations that must give way have theirs.
        """
        nice = self._give_way(turn)
        while True:
            with self._lock:
                process = next((p for p in reversed(self._idle) if bool(p.nice) == bool(nice) and p.nice <= nice), None)
                if process is not None:
                    self._idle.remove(process)
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

    def _stays(self, turn: Turn, long: bool) -> bool:
        """Move a computation that takes long, or gives way while others wait, to the slow lane.

        Return False if it must wait for a place there.
        """
        client = turn.computation.client
        with self._lock:
            waiting = any(long or c.client != client for c in self._quick.waiting)
            if not waiting and not long:
                return True
            if not self._slow.may_take(client, self._places, self._most):
                return not waiting
            turn.lane.active[client] -= 1
            self._slow.active[client] += 1
            turn.lane = self._slow
            self._dispatch()
        return True


def _plain(_: object, function: Callable[..., Any], *args: Any) -> Any:
    """Carry out a function that reports nothing on its way."""
    return function(*args)
