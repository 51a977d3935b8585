"""What the viewers of a session see: the rows shown so far, in frames that are encoded once for all of them."""

from pydantic import BaseModel

from thetascope.live.room.prefetch_plan import RowBatch
from thetascope.live.wire.frames import FrameBuffer, FrameNumbers, encode_frame
from thetascope.live.wire.outbox import Span
from thetascope.live.wire.viewer import Viewer
from thetascope_schemas.service.session import Columns, Event, Jump, Rewound

MAX_FRAME = 256 * 1024
"""Bytes of samples in one frame."""

_KEPT = 256  # rows that were just shown and are kept for viewers that are a little late


class Broadcast:
    """`shown` rows have been sent, in `columns`. Whatever changes columns or past begins a new `epoch`."""

    def __init__(self, columns: tuple[str, ...], shown: int, record: float) -> None:
        self.shown, self.record = shown, record
        self._set_columns(columns)
        self.epoch = 0
        self.viewers: list[Viewer] = []
        self._numbers = FrameNumbers()
        self._buffer = FrameBuffer(shown, len(columns))
        self._following: RowBatch | None = None  # the first rows after a change of columns that is still to come
        self._events: list[Event] = []  # of rows that are computed but not shown
        self._latest: tuple[Span, int, bytes] | None = None

    @property
    def end(self) -> int:
        """The row after the last that can be shown at once."""
        return self._buffer.end

    @property
    def left(self) -> int:
        """Rows that can be shown at once."""
        return self._buffer.end - self.shown

    @property
    def blocked(self) -> bool:
        """Whether nothing more is to be computed before what is there has been shown."""
        return self._following is not None

    def send(self, message: BaseModel, key: str | None = None) -> None:
        """Send a message to all."""
        if self.viewers:
            text = message.model_dump_json()
            for viewer in self.viewers:
                viewer.put(text, key)

    def add(self, computed: RowBatch) -> None:
        """Rows that follow those that are there; they are shown when they are due."""
        self._events += computed.events
        if computed.columns != self.columns:
            self._following = computed
            self._switch()
        else:
            self._buffer.append(computed.rows, self.shown - _KEPT)

    def publish_findings(self, events: list[Event]) -> None:
        """What was found in rows that are there, or have been shown already."""
        self._events += events
        self._send_events(self.shown)

    def show(self, due: float) -> None:
        """Show rows up to `due` − 1, as far as they are there and fit into a frame."""
        first = self.shown
        last = int(min(due, self._buffer.end, first + self.most))
        if last > first:
            if self._events:
                self._send_events(last)
            number = self._numbers.add(last)
            data = encode_frame(number, self.epoch, first, self._buffer.take(first, last))
            self.shown = last
            self._latest = Span(first, last), self.epoch, data
            for viewer in self.viewers:
                viewer.frame(data, first, last)
        if self._following is not None:
            self._switch()

    def restart(self, columns: tuple[str, ...], row: int) -> None:
        """What was computed ahead is void, and perhaps rows that were shown, and the columns may be others."""
        self._following, self._events = None, []
        if row < self.shown or columns != self.columns:
            self._new_epoch(columns, row)
        else:
            self._buffer.clear(row, len(columns))

    def rows_after(self, number: int | None) -> int:
        """How many rows a viewer has that names the last frame it got; 0: it is to get all."""
        return (self._numbers.rows_after(number) or 0) if number is not None else 0

    # ---- viewers that do not have the latest frame ---------------------------------------------------------------------

    def next_span(self, viewer: Viewer, backlog: int, oldest: int) -> Span | None:
        """The rows to send to a viewer next; one that is more than `backlog` bytes behind jumps."""
        rows = max(1, backlog // (4 * len(self.columns)))
        missed = viewer.outbox.jump(self.shown, rows, oldest)
        if missed is not None:
            viewer.put(Jump(epoch=self.epoch, first=missed.first, row=missed.last).model_dump_json())
        return viewer.outbox.span(self.shown, self.most)

    def encoded(self, span: Span) -> bytes | None:
        """The frame of these rows, if they are at hand."""
        if self._latest is not None and self._latest[:2] == (span, self.epoch):
            return self._latest[2]
        rows = self._buffer.take(span.first, span.last)
        return None if rows is None else self.encode(span, rows)

    def encode(self, span: Span, rows: object) -> bytes:
        """The frame of rows of the past."""
        return encode_frame(self._numbers.number_at(span.last), self.epoch, span.first, rows)

    # --------------------------------------------------------------------------------------------------------------------

    def _send_events(self, last: int) -> None:
        for event in self._events:
            if event.row < last:
                self.send(event)
        self._events = [event for event in self._events if event.row >= last]

    def _switch(self) -> None:
        """When all rows of the old columns are shown, go over to the new ones."""
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

    def _set_columns(self, columns: tuple[str, ...]) -> None:
        self.columns = columns
        self.most = max(1, MAX_FRAME // (4 * len(columns)))  # rows of a frame
