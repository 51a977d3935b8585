"""A room with a clock that the test controls, and connections that store the received messages."""

import asyncio
import json
import struct
from collections.abc import Callable, Coroutine
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from tests.runs.samples import spec
from thetascope import library
from thetascope.assembly import prepare
from thetascope.diagnosis.yield_points import run_to_end
from thetascope.live.room.room import Room
from thetascope.live.room.room_parts import RoomServices
from thetascope.live.room.serial_queue import Callback, Job, outcome
from thetascope.live.session.session import Session
from thetascope.live.wire.viewer import Viewer
from thetascope.runs.workers.limits import Ended
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.service.session import HEADER, Event

HEAD = struct.calcsize(HEADER)


@dataclass
class Frame:
    """A binary frame, read back."""

    sequence: int
    epoch: int
    first: int
    samples: np.ndarray  # columns × rows

    @property
    def end(self) -> int:
        return self.first + self.samples.shape[1]


def decoded(data: bytes) -> Frame:
    sequence, epoch, first, count, columns = struct.unpack(HEADER, data[:HEAD])
    samples = np.frombuffer(data[HEAD:], "<f4").reshape(columns, count)
    return Frame(sequence, epoch, first, samples)


@dataclass
class Connection:
    """A client's end. While `open` is cleared it reads nothing."""

    texts: list[dict] = field(default_factory=list)
    frames: list[Frame] = field(default_factory=list)
    order: list[str] = field(default_factory=list)
    open: asyncio.Event = field(default_factory=asyncio.Event)
    viewer: Viewer | None = None

    async def text(self, text: str) -> None:
        await self.open.wait()
        self.texts.append(json.loads(text))
        self.order.append(self.texts[-1]["type"])

    async def samples(self, data: bytes) -> None:
        await self.open.wait()
        self.frames.append(decoded(data))
        self.order.append("frame")

    def of(self, kind: str) -> list[dict]:
        """Return the messages of a type."""
        return [text for text in self.texts if text["type"] == kind]

    def rows_at(self, row: int) -> np.ndarray:
        """Return the values of a row, as they were sent last."""
        frame = next(f for f in reversed(self.frames) if f.first <= row < f.end)
        return frame.samples[:, row - frame.first]

    def rows(self) -> np.ndarray:
        """Return the rows of a page: later rows replace earlier ones."""
        known: dict[int, np.ndarray] = {}
        for frame in self.frames:
            known |= {frame.first + i: frame.samples[:, i] for i in range(frame.samples.shape[1])}
        assert sorted(known) == list(range(len(known))), "there is a gap"
        return np.array([known[row] for row in sorted(known)]).T


class Stage:
    """A session on the first-order plant, rows of 10 ms; `go` lets time pass in frames. While it is `busy` rooms
    compute ahead when two more frames have gone out: time for commands to come between."""

    def __init__(
        self,
        limit: int = 100_000,
        backlog: int = 1 << 20,
        viewers: int = 3,
        past: int = 1 << 24,
        busy: bool = False,
        **changes: object,
    ) -> None:
        self.now = 0.0
        self.rehearsal: object = None
        self.rehearsed: list[object] = []
        self.at: float | None = None
        self.session = Session(library.resolve(spec(**({"evaluate": 0.01} | changes))), limit)
        self.session.advance(1)
        services = RoomServices(
            clock=lambda: self.now,
            background=self._background,
            workshop=self._background,
            rehearse=self._rehearse,
            wake=self._wake,
            request_prefetch=self._feed,
            request_detection=self._watch,
            may_check=lambda: True,
            viewers=viewers,
            backlog=backlog,
            past=lambda: past,
        )
        self.room = Room("room", "token", self.session, services)
        self._busy, self.needs_prefetch = busy, False
        self._tasks: list[asyncio.Task] = []
        self._number = self._ticks = 0

    def _feed(self, room: Room, _: bool) -> None:
        """Compute ahead: immediately, or during `go` if the stage is busy."""
        self.needs_prefetch = True
        if not self._busy:
            room.prefetch_rows()

    def _watch(self, room: Room) -> None:
        while (waiting := room.detection_job()) is not None:
            steps, then = waiting
            then(*outcome(partial(run_to_end, steps)))

    def _background(self, job: Job, then: Callback) -> None:
        then(*outcome(job))

    def _rehearse(self, spec: object, command: object, client: str, then: Callback) -> Callable[[], None]:
        """Rehearse a command without a worker: `rehearsal` is its error; with ... it ends when it is left."""
        self.rehearsed.append(command)
        if self.rehearsal is ...:
            return lambda: then(None, Ended())
        then(None, self.rehearsal)
        return lambda: None

    def _wake(self, room: Room, at: float) -> None:
        self.at = at

    async def connect(
        self, control: bool = True, after: int | None = None, is_open: bool = True, language: str = "en"
    ) -> Connection:
        connection = Connection()
        if is_open:
            connection.open.set()
        viewer = Viewer(connection.text, connection.samples, control, asyncio.get_running_loop(), language)
        connection.viewer = viewer
        self.room.join(viewer, after)
        self._tasks.append(asyncio.create_task(viewer.run(self.room)))
        await settle()
        return connection

    async def say(self, connection: Connection, type: str, **fields: object) -> dict:
        """Send a command and return its answer."""
        self._number += 1
        message = json.dumps({"type": type, "id": self._number, **fields})
        self.room.commands.receive(connection.viewer, message, 100_000)
        await settle()
        answers = [t for t in connection.texts if t["type"] in ("ack", "refused") and t["id"] == self._number]
        assert len(answers) == 1, "one answer each"
        return answers[0]

    async def go(self, seconds: float) -> None:
        """Let time pass."""
        end = self.now + seconds
        while self.at is not None and self.at <= end:
            self.now = max(self.now, self.at)
            at, self.at = self.at, None
            self._ticks += 1
            if self._busy and self.needs_prefetch and self._ticks % 3 == 0:
                self.needs_prefetch = False
                self.room.prefetch_rows()
            following = self.room.tick(at)
            if following is not None:
                self.at = following if self.at is None else min(self.at, following)
            await settle()
        self.now = end

    async def stop(self) -> None:
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)


async def settle() -> None:
    """Let the connections' tasks run until they wait."""
    for _ in range(12):
        await asyncio.sleep(0)


def apart(coroutine: Coroutine) -> object:
    """Run a coroutine in a separate thread: the browser tests leave an event loop running in this one."""
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(asyncio.run, coroutine).result()


def staged(scenario, **options: object) -> None:
    """Run a scenario on a stage."""

    async def run() -> None:
        stage = Stage(**options)
        try:
            await scenario(stage)
        finally:
            await stage.stop()

    apart(run())


def kinds(events: list[dict] | list[Event]) -> list[str]:
    return [event["kind"] if isinstance(event, dict) else event.kind for event in events]


def expected(given: Experiment, columns: list[str], rows: int) -> np.ndarray:
    """Return the samples of an ordinary run of a spec, as they are sent."""
    run = prepare(library.resolve(given.model_copy(update={"horizon": (rows - 1) * 0.01, "evaluate": 0.01}))).run()
    return np.array([run.column(name) for name in columns]).astype("<f4")


def same(sent: np.ndarray, given: Experiment, columns: list[str]) -> None:
    """Fail unless every column of the run was sent bit for bit."""
    run = expected(given, columns, sent.shape[1])
    differ = [name for name, mine, other in zip(columns, sent, run, strict=True) if mine.tobytes() != other.tobytes()]
    assert differ == []
