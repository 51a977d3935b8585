"""One timer for all rooms, on an event loop whose time the test controls."""

import heapq
from collections.abc import Callable
from itertools import count

from thetascope.live.room.playback_clock import FRAME
from thetascope.live.scheduling.scheduler import FEW, MANY, SLOTS, Scheduler, slot


class Timer:
    def __init__(self, at: float) -> None:
        self.at, self.off = at, False

    def when(self) -> float:
        return self.at

    def cancel(self) -> None:
        self.off = True

    def cancelled(self) -> bool:
        return self.off


class Loop:
    """The part of an event loop that a scheduler uses."""

    def __init__(self) -> None:
        self.now, self.wakings = 0.0, 0
        self._order = count()
        self._timers: list[tuple[float, int, Timer, Callable]] = []
        self._soon: list[tuple[Callable, tuple]] = []

    def time(self) -> float:
        return self.now

    def call_at(self, at: float, job: Callable) -> Timer:
        timer = Timer(at)
        heapq.heappush(self._timers, (at, next(self._order), timer, job))
        return timer

    def call_soon(self, job: Callable, *given: object) -> None:
        self._soon.append((job, given))

    def turn(self) -> None:
        """Return the requests made before this turn."""
        waiting, self._soon = self._soon, []
        for job, given in waiting:
            job(*given)

    def go(self, seconds: float) -> None:
        """Let time pass."""
        end = self.now + seconds
        while self._timers and self._timers[0][0] <= end:
            at, _, timer, job = heapq.heappop(self._timers)
            if timer.off:
                continue
            self.now = max(self.now, at)
            self.wakings += 1
            job()
            while self._soon:
                self.turn()
        self.now = end


class Beat:
    """A room that is called each frame."""

    id = "beat"

    def __init__(self, loop: Loop) -> None:
        self.loop, self.times, self.fills = loop, [], 0

    def tick(self, at: float) -> float:
        self.times.append(self.loop.now)
        return at + FRAME

    def prefetch_rows(self) -> None:
        self.fills += 1


def playing(rooms: int) -> tuple[Loop, list[Beat]]:
    loop = Loop()
    scheduler, beats = Scheduler(loop), [Beat(loop) for _ in range(rooms)]
    for i, beat in enumerate(beats):
        scheduler.wake(beat, FRAME * i / rooms)
    loop.go(1.0)
    return loop, beats


def test_every_room_keeps_its_frame_rate():
    """Frames are a frame's time apart, and late by at most a part of it, for any number of rooms."""
    for rooms in (1, FEW // 2, 2 * FEW, MANY, 20 * FEW):
        _, beats = playing(rooms)
        for i, beat in enumerate(beats):
            late = [at - FRAME * (i / rooms + n) for n, at in enumerate(beat.times)]
            assert len(late) >= 29 and min(late) > -1e-9 and max(late) < slot(rooms) + 1e-4
            assert max(late) - min(late) < 1e-4


def test_many_rooms_are_called_together():
    """The loop wakes up once for about fifty frames, and not so rarely that frames come in one heap."""
    for rooms, parts in ((2 * FEW, 1), (100, 1), (MANY, 2), (200, 4), (400, 8), (5000, SLOTS)):
        loop, _ = playing(rooms)
        assert slot(rooms) == FRAME / parts and loop.wakings < 1.2 / slot(rooms)


def test_a_command_on_its_way_is_carried_out_before_a_room_computes_ahead():
    """Two turns of the event loop lie between the decision and the work; one room at a time gets it."""
    loop = Loop()
    scheduler, one, two = Scheduler(loop), Beat(loop), Beat(loop)
    scheduler.wake(one, 0.0)
    scheduler.request_prefetch(one, False)
    scheduler.request_prefetch(two, False)
    scheduler._run()
    loop.turn()
    loop.turn()
    assert one.fills == two.fills == 0
    loop.turn()
    assert (one.fills, two.fills) == (1, 0)
    loop.go(0.1)
    assert (one.fills, two.fills) == (1, 1)


def test_waiting_work_is_done_without_a_frame():
    """A room with half of its rows computed gets the other half immediately, before rooms that have waited longer."""
    loop = Loop()
    scheduler, one, two = Scheduler(loop), Beat(loop), Beat(loop)
    scheduler.request_prefetch(one, False)
    scheduler.request_prefetch(two, True)
    loop.go(0.001)
    assert (one.fills, two.fills) == (0, 1)
    loop.go(0.1)
    assert (one.fills, two.fills) == (1, 1)
