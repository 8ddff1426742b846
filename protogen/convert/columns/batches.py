"""Bytes of the line made into batches of rows."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Protocol

import msgspec

from protogen.convert.columns.csv_text import csv_of
from protogen.convert.columns.event_values import plain_fields, reached
from protogen.convert.columns.rows import Rows
from protogen.convert.columns.tables import Column, Table, Tables
from protogen.convert.inputs.chunks import Chunk, Clock
from protogen.runtime.attributes import attribute
from protogen.runtime.decoder import Decoder
from protogen.runtime.framing.sender import SenderSpec

_ORDER = ("offset", "size", "event", "message", "sender", "form", "parts", "fields")


class Messages(msgspec.Struct, frozen=True):
    """Message records of MCAP one behind the other, and where they are."""

    data: Any
    """Bytes, or an array of them that is used again."""
    places: Mapping[int, bytes]
    """For each channel the pairs of time and place in `data`, as an index has them."""
    least: int
    """The least time of all messages."""
    greatest: int


class Tally(msgspec.Struct):
    """Counts of what was in a capture, for people."""

    bytes: int = 0
    """Bytes of the line."""
    messages: dict[str, int] = msgspec.field(default_factory=dict)
    """Frames of each message."""
    unknown: int = 0
    """Frames of unknown identity."""
    invalid: dict[str, int] = msgspec.field(default_factory=dict)
    """Bytes that are no frame, by reason."""

    def add(self, other: Tally) -> None:
        """Add what was in another part."""
        self.bytes += other.bytes
        self.messages = Counter(self.messages) + Counter(other.messages)
        self.unknown += other.unknown
        self.invalid = Counter(self.invalid) + Counter(other.invalid)


class Batch(Protocol):
    """Rows of some bytes of a capture."""

    @property
    def tally(self) -> Tally:
        """Counts of what is in it."""

    def rows(self) -> Iterable[Rows]:
        """The rows of each table that has some, in the order of the capture."""

    def lines(self) -> Iterable[bytes]:
        """The events as lines of JSON, in the order of the capture: one or more in each text."""

    def csv(self) -> Iterable[tuple[Table, Iterable[bytes]]]:
        """The rows of each table that has some, as lines of CSV."""

    def messages(self) -> Iterable[Messages] | None:
        """The rows as messages of MCAP, in the order of the capture; None: they are not printed."""


class BatchDecoder(Protocol):
    """Decodes a capture."""

    def feed(self, chunk: Chunk) -> Iterator[Batch]:
        """Take the next bytes of the capture; what is certain now."""

    def flush(self) -> Iterator[Batch]:
        """Take the end of the capture; what remains."""


def batches_of(decoder: BatchDecoder, chunks: Iterable[Chunk]) -> Iterator[Batch]:
    """All batches of a capture, its end included."""
    for chunk in chunks:
        yield from decoder.feed(chunk)
    yield from decoder.flush()


# --- by events ------------------------------------------------------------------------------------


class EventDecoder:
    """Decodes with the generated Python, an object for each event. It needs no other package."""

    def __init__(self, tables: Tables, spec: SenderSpec[Any, Any]) -> None:
        self._tables = tables
        self._decoder = Decoder(spec)
        self._clock = Clock()

    def feed(self, chunk: Chunk) -> Iterator[EventBatch]:
        """Take the next bytes of the capture; what is certain now."""
        self._clock.take(chunk)
        yield self._batch(self._decoder.feed(chunk.data))

    def flush(self) -> Iterator[EventBatch]:
        """Take the end of the capture; what remains."""
        yield self._batch(self._decoder.flush())

    def _batch(self, events: Sequence[Any]) -> EventBatch:
        times = self._clock.at([event.offset + event.size - 1 for event in events])
        if events:
            self._clock.forget(events[-1].offset + events[-1].size)
        return EventBatch(self._tables, events, times)


class EventBatch(msgspec.Struct, frozen=True):
    """Events, each with the time of its last byte."""

    tables: Tables
    events: Sequence[Any]
    times: Sequence[int | None]

    @property
    def tally(self) -> Tally:
        """Counts of what is in it."""
        messages, invalid = Counter[str](), Counter[str]()
        unknown = 0
        for event in self.events:
            if event.kind == "message":
                messages[event.message.NAME] += 1
            elif event.kind == "unknown":
                unknown += 1
            else:
                invalid[event.reason] += event.size
        return Tally(sum(event.size for event in self.events), messages, unknown, invalid)

    def rows(self) -> Iterator[Rows]:
        """The rows of each table that has some."""
        rows: dict[str, list[list[Any]]] = {}
        for event, when in zip(self.events, self.times, strict=True):
            table = table_of(self.tables, event)
            rows.setdefault(table.name, []).append(row_of(table, event, when))
        for table in self.tables.all_tables:
            if table.name in rows:
                yield Rows(table, list(zip(*rows[table.name], strict=True)))

    def lines(self) -> Iterator[bytes]:
        """The events as lines of JSON."""
        for pair in zip(self.events, self.times, strict=True):
            yield self._line(*pair).encode("utf-8", "surrogatepass")

    def csv(self) -> Iterator[tuple[Table, Iterable[bytes]]]:
        """The rows of each table that has some, as lines of CSV."""
        for rows in self.rows():
            yield rows.table, [csv_of(rows)]

    def messages(self) -> None:
        """Nothing: what writes MCAP makes messages of the rows."""

    def _line(self, event: Any, when: int | None) -> str:
        line = event.as_json()
        ordered = {key: line.pop(key) for key in _ORDER if key in line}
        timed = {} if when is None else {"t_ns": when}
        return json.dumps({**ordered, **line, **timed}, ensure_ascii=False) + "\n"


def table_of(tables: Tables, event: Any) -> Table:
    """The table that has the row of an event."""
    if event.kind == "message":
        return tables.messages[event.message.NAME]
    return tables.unknown if event.kind == "unknown" else tables.invalid


def row_of(table: Table, event: Any, when: int | None) -> list[Any]:
    """The row of an event: a value for each of the table's columns."""
    if event.kind == "message":
        assert table.message is not None
        values = plain_fields(table.message.fields, event.message.to_dict())
    elif event.kind == "unknown":
        values = {"payload": event.payload}
    else:
        values = {"reason": event.reason, "raw": event.raw}
    frame = {"offset": event.offset, "size": event.size, "t_ns": when}
    return [
        *(_frame_value(column, frame, event) for column in table.frame_columns),
        *(value_in(column, values) for column in table.columns),
    ]


def _frame_value(column: Column, frame: Mapping[str, Any], event: Any) -> Any:
    if column.path[0] == "@":
        return getattr(event.parts, attribute(column.path[1]))
    return frame[column.path[0]]


def value_in(column: Column, values: Mapping[str, Any]) -> Any:
    """Value of a column, out of those of a message."""
    raw = reached(values, column.path)
    return raw if column.derived is None else column.derived.of(raw)
