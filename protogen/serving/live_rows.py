"""Rows of what comes from a line: the same that `convert` writes of a recording of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import msgspec

from protogen.convert.columns.batches import row_of, table_of
from protogen.convert.columns.tables import Table, Tables, tables_of
from protogen.convert.columns.topics import topic_of
from protogen.convert.inputs.chunks import Chunk, Clock
from protogen.model.protocol import Protocol


class Topic(msgspec.Struct, frozen=True, eq=False):
    """A stream of rows: one for each message of each sender, and for what is no message."""

    protocol: str
    path: tuple[str, ...]
    """Who sends it, and the name of its table; the table alone where it is not known who did."""
    table: Table

    @property
    def name(self) -> str:
        """The name, as Foxglove has it, and as MCAP files of `convert` do: `/rover/board/state`."""
        return topic_of(self.protocol, *self.path)


class LiveRow(msgspec.Struct, frozen=True):
    """A row, with the time in nanoseconds when its last byte came."""

    topic: Topic
    values: dict[str, Any]
    when: int


class LiveRows:
    """Makes rows of events. It is a listener of a line; offsets and times are per source."""

    def __init__(
        self,
        protocol: Protocol,
        take: Callable[[LiveRow], None],
        note: Callable[[str], None],
    ) -> None:
        """`take` takes each row as it comes, `note` takes news of the ports."""
        self._take = take
        self.take_note = note
        self._tables = {sender.name: tables_of(protocol, sender) for sender in protocol.senders}
        self._clocks: dict[str, Clock] = {}
        self._topics = {topic.path: topic for topic in self._all(protocol)}

    @property
    def topics(self) -> tuple[Topic, ...]:
        """Every stream that there can be."""
        return tuple(self._topics.values())

    def _all(self, protocol: Protocol) -> Iterator[Topic]:
        for name, tables in self._tables.items():
            for table in (*tables.messages.values(), tables.unknown):
                yield Topic(protocol.name, (name, table.name), table)
        for source in (*protocol.sending, ""):
            table = self._invalid(source)
            yield Topic(protocol.name, _path(source, table), table)

    def _invalid(self, source: str) -> Table:
        """The table of what is no frame: it is the same in each form of frame."""
        named = (tables for tables in self._tables.values() if tables.sender.endpoint == source)
        return next(named, next(iter(self._tables.values()))).invalid

    def take_bytes(self, source: str, data: bytes, when: int) -> None:
        """Note when bytes came."""
        clock = self._clocks.setdefault(source, Clock())
        clock.take(Chunk(data, [len(data)], [when]))

    def take_events(self, source: str, events: Sequence[Any], when: int) -> None:
        """Make a row of each event."""
        if not events:
            return
        clock = self._clocks[source]
        lasts = clock.at([event.offset + event.size - 1 for event in events])
        for event, last in zip(events, lasts, strict=True):
            topic = self._topic(source, event)
            time = when if last is None else last
            names = (column.name for column in topic.table.all_columns)
            row = row_of(topic.table, event, time)
            self._take(LiveRow(topic, dict(zip(names, row, strict=True)), time))
        clock.forget(events[-1].offset + events[-1].size)

    def _topic(self, source: str, event: Any) -> Topic:
        if event.kind == "invalid":
            return self._topics[_path(source, self._invalid(source))]
        tables: Tables = self._tables[event.codec.key]
        return self._topics[tables.sender.name, table_of(tables, event).name]


def _path(source: str, table: Table) -> tuple[str, ...]:
    return (source, table.name) if source else (table.name,)
