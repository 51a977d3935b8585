"""Sending rows, events and messages to all viewers: rows shown so far, in frames that are encoded once for all."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from pydantic import BaseModel

from thetascope.live.room.prefetch_plan import RowBatch
from thetascope.live.wire.frames import FrameBuffer, FrameNumbers, encode_frame
from thetascope.live.wire.localize import encode
from thetascope.live.wire.outbox import Span
from thetascope.live.wire.viewer import Viewer
from thetascope_schemas.service.session import Columns, Event, Jump, Rewound

MAX_FRAME = 256 * 1024
"""Bytes of samples in one frame."""

_KEPT = 256  # shown rows that are kept for viewers that are slightly late


class Tap(Protocol):
    """Takes the rows of a session that are shown, as they are sent to viewers."""

    def frame(self, data: bytes) -> None:
        """Take a frame: rows that are shown now."""
        ...

    def restarted(self) -> None:
        """Note that columns or past rows have changed."""
        ...

    def closed(self) -> None:
        """Note that the session has ended."""
        ...


class Broadcast:
    """What the viewers of a session are sent.

    Args:
        columns: names of the columns.
        shown: rows that count as shown.
        record: time between rows, s.
        complete: whether no row can follow the computed ones.
    """

    def __init__(self, columns: tuple[str, ...], shown: int, record: float, complete: bool) -> None:
        self.shown, self.record, self.complete = shown, record, complete
        self._set_columns(columns)
        self.epoch = 0
        self.viewers: list[Viewer] = []
        self.taps: list[Tap] = []
        self._numbers = FrameNumbers()
        self._buffer = FrameBuffer(shown, len(columns))
        self._following: RowBatch | None = None  # the first rows after a change of columns that is not shown yet
        self._events: list[Event] = []  # of rows that are computed and not shown yet
        self._latest: tuple[Span, int, bytes] | None = None

    @property
    def end(self) -> int:
        """The row after the last one that can be shown now."""
        return self._buffer.end

    @property
    def left(self) -> int:
        """Rows that are computed and can be shown now."""
        return self._buffer.end - self.shown

    @property
    def blocked(self) -> bool:
        """Whether no rows may be computed before the present ones are shown."""
        return self._following is not None

    @property
    def at_end(self) -> bool:
        """Whether the last row that can follow is shown."""
        return self.complete and self.left == 0 and not self.blocked

    def send(self, message: BaseModel, key: str | None = None) -> None:
        """Send a message to all, each in its language; a keyed one replaces an unsent one with the same key."""
        texts: dict[str, str] = {}
        for viewer in self.viewers:
            if viewer.language not in texts:
                texts[viewer.language] = encode(message, viewer.language)
            viewer.put(texts[viewer.language], key)

    def add(self, batch: RowBatch) -> None:
        """Add computed rows; they are shown when they are due."""
        self.complete = batch.ended
        if not batch.rows.shape[1]:
            return
        self._events += batch.events
        if batch.columns != self.columns:
            self._following = batch
            self._switch()
        else:
            self._buffer.append(batch.rows, self.shown - _KEPT)

    def publish_findings(self, events: Sequence[Event]) -> None:
        """Send alarms: now if their row is shown, else with it."""
        self._events += events
        self._send_events(self.shown)

    def show(self, due: float) -> None:
        """Show rows up to `due` − 1, as far as they are computed and fit into a frame."""
        first = self.shown
        last = int(min(due, self._buffer.end, first + self.most))
        if last > first:
            if self._events:
                self._send_events(last)
            number = self._numbers.add(last)
            data = encode_frame(number, self.epoch, first, self._buffer.rows(first, last))
            self.shown = last
            self._latest = Span(first, last), self.epoch, data
            for viewer in self.viewers:
                viewer.frame(data, first, last)
            for tap in self.taps:
                tap.frame(data)
        if self._following is not None:
            self._switch()

    def restart(self, columns: tuple[str, ...], row: int, complete: bool) -> None:
        """Continue at a row, perhaps with other columns: rows from there on, computed ahead or shown, are void."""
        self._following, self._events, self.complete = None, [], complete
        if row < self.shown or columns != self.columns:
            self._new_epoch(columns, row)
        else:
            self._buffer.clear(row, len(columns))

    def rows_after(self, number: int | None) -> int:
        """Return how many rows a viewer has that received frame `number` last; 0 if that is unknown."""
        return (self._numbers.rows_after(number) or 0) if number is not None else 0

    # ---- viewers that do not have the latest frame -------------------------------------------------------------------

    def next_span(self, viewer: Viewer, backlog: int, oldest: int) -> Span | None:
        """Return the rows to send to a viewer next; one that is more than `backlog` bytes behind jumps."""
        rows = max(1, backlog // (4 * len(self.columns)))
        missed = viewer.outbox.jump(self.shown, rows, oldest)
        if missed is not None:
            viewer.send(Jump(epoch=self.epoch, first=missed.first, row=missed.last))
        return viewer.outbox.span(self.shown, self.most)

    def encoded(self, span: Span) -> bytes | None:
        """Return the frame of these rows; None if they are no longer in memory."""
        if self._latest is not None and self._latest[:2] == (span, self.epoch):
            return self._latest[2]
        rows = self._buffer.take(span.first, span.last)
        return None if rows is None else self.encode(span, rows)

    def encode(self, span: Span, rows: np.ndarray) -> bytes:
        """Return the frame of rows of the past."""
        return encode_frame(self._numbers.number_at(span.last), self.epoch, span.first, rows)

    # ------------------------------------------------------------------------------------------------------------------

    def _send_events(self, last: int) -> None:
        for event in self._events:
            if event.row < last:
                self.send(event)
        self._events = [event for event in self._events if event.row >= last]

    def _switch(self) -> None:
        """Go over to the new columns when all rows of the old ones are shown."""
        following = self._following
        if following is not None and following.first == self.shown:
            self._following = None
            self._new_epoch(following.columns, self.shown)
            self._buffer.append(following.rows, self.shown)

    def _new_epoch(self, columns: tuple[str, ...], row: int) -> None:
        self.epoch += 1
        self._numbers.new_epoch()
        self._latest = None
        if row < self.shown:
            for viewer in self.viewers:
                viewer.outbox.rewind_to(row)
            self.send(Rewound(epoch=self.epoch, row=row, t=row * self.record))
        if columns != self.columns:
            self.send(Columns(epoch=self.epoch, row=row, columns=columns))
        self.shown = row
        self._set_columns(columns)
        self._buffer.clear(row, len(columns))
        for tap in self.taps:
            tap.restarted()

    def _set_columns(self, columns: tuple[str, ...]) -> None:
        self.columns = columns
        self.most = max(1, MAX_FRAME // (4 * len(columns)))  # rows of a frame
