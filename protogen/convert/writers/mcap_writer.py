"""MCAP, with one topic for each message.

Topics are `/PROTOCOL/SENDER/MESSAGE`. A message has all columns of its table: `heading` and
`heading_deg`. The log's time is when the frame's last byte came. A capture without times gets the
time that its bytes take on the line at the schema's baud rate, from 1970-01-01 on; without one, a
microsecond a byte. What is no frame is in the topics `unknown_frames` and `invalid_spans`.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator

from protogen.convert.columns.batches import Batch, Messages
from protogen.convert.columns.python_values import as_list
from protogen.convert.columns.rows import Rows
from protogen.convert.columns.tables import Table, Tables
from protogen.convert.columns.topics import topic_of
from protogen.convert.errors import needed
from protogen.convert.writers.mcap_encodings import Encoding
from protogen.convert.writers.mcap_file import McapFile
from protogen.convert.writers.pending_files import Pending

_MESSAGE = 5
"""Number of the records that hold messages."""
_HEAD = struct.Struct("<BQHIQQ")
"""What stands in front of a message."""
_PLACE = struct.Struct("<QQ")
"""A message in an index: its time, and where it begins in its chunk."""


class McapWriter:
    """Writes one file."""

    def __init__(
        self, name: str, file: str, pending: Pending, tables: Tables, encoding: Encoding
    ) -> None:
        """Begin a file, relative to the output folder, for the capture of that name."""
        needed("mcap", "writing MCAP")
        self._tables = tables
        self._encoding = encoding
        self._encoders = {it.name: encoding.encoder(it) for it in tables.all_tables}
        self._file = pending.path(file).open("wb")
        facts = tables.invalid.facts
        library = f"protogen {facts['protogen.version']}"
        self._mcap = McapFile(self._file, library, encoding)
        self._mcap.add_metadata("protogen", {**facts, "protogen.capture": name})

    def write(self, batch: Batch) -> None:
        """Write the rows of a batch in the order of the capture."""
        for messages in batch.messages() or self._made(batch):
            for number in sorted(messages.places.keys() - self._mcap.channels):
                self._open(number, self._tables.all_tables[number - 1])
            self._mcap.add(messages)

    def close(self) -> None:
        """Write what is left, and the index."""
        with self._file:
            self._mcap.close()

    def _made(self, batch: Batch) -> Iterator[Messages]:
        """The rows made by Python, where no C prints them."""
        records = sorted(record for rows in batch.rows() for record in self._records(rows))
        places: dict[int, list[bytes]] = {}
        place = 0
        for _, time, channel, data in records:
            places.setdefault(channel, []).append(_PLACE.pack(time, place))
            place += len(data)
        if records:
            times = [time for _, time, _, _ in records]
            yield Messages(
                b"".join(data for *_, data in records),
                {channel: b"".join(found) for channel, found in places.items()},
                min(times),
                max(times),
            )

    def _records(self, rows: Rows) -> Iterator[tuple[int, int, int, bytes]]:
        channel, byte_time = self._tables.channels[rows.table.name], self._tables.byte_time
        names = [column.name for column in rows.table.all_columns]
        columns = [as_list(values) for values in rows.columns]
        encode = self._encoders[rows.table.name]
        for row in zip(*columns, strict=True):
            offset, size, when = row[:3]
            data = encode(dict(zip(names, row, strict=True)))
            # The log knows no time before 1970; `t_ns` says what a recording has.
            time = int((offset + size) * byte_time) if when is None else max(0, when)
            head = (_MESSAGE, 22 + len(data), channel, offset & 0xFFFFFFFF, time, time)
            yield offset, time, channel, _HEAD.pack(*head) + data

    def _open(self, number: int, table: Table) -> None:
        facts = table.facts
        topic = topic_of(facts["protogen.protocol"], facts["protogen.sender"], table.name)
        self._mcap.add_schema(number, *self._encoding.schema(table))
        self._mcap.add_channel(number, topic, facts)
