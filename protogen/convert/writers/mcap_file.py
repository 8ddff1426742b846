"""An MCAP file, written in chunks of messages that are made at once.

The `mcap` package has a writer that takes messages one by one, which costs microseconds each. Its
records are used here, and its reader reads what is written.
"""

from __future__ import annotations

import struct
import zlib
from collections import Counter
from collections.abc import Callable, Mapping
from typing import Any, BinaryIO

from protogen.convert.columns.batches import Messages
from protogen.convert.errors import needed
from protogen.convert.writers.mcap_encodings import Encoding

_MAGIC = b"\x89MCAP0\r\n"
_PURPOSE = "writing MCAP"
_LEVEL = 1
"""Level of the compression. Negative ones are faster, but files become up to twice as large."""
_LOGS = {"window_log": 17, "hash_log": 12}
"""Powers of two: a hash table of 16 KB and a window of 128 KB stay in the processor's caches, which
saves a seventh of compressing and more. Messages repeat what is near, so files hardly grow."""
_INDEX = struct.Struct("<BQHI")
_FOOTER = struct.Struct("<BQQQ")


def _compressor(name: str) -> Callable[[Any], Any]:
    if not name:
        return lambda data: data
    zstandard: Any = needed("zstandard", _PURPOSE)
    chosen = zstandard.ZstdCompressionParameters.from_level(_LEVEL, **_LOGS)
    compress: Callable[[Any], Any] = zstandard.ZstdCompressor(compression_params=chosen).compress
    return compress


class McapFile:
    """Writes one file; `close` writes its end."""

    def __init__(self, file: BinaryIO, library: str, encoding: Encoding) -> None:
        self._records: Any = needed("mcap.records", _PURPOSE)
        self._builder: Any = needed("mcap.data_stream", _PURPOSE).RecordBuilder
        self._encoding = encoding
        self._compress = _compressor(encoding.compression)
        self._file = file
        self._schemas: list[Any] = []
        self._channels: dict[int, Any] = {}
        self._chunks: list[Any] = []
        self._metadata: list[Any] = []
        self._counts: Counter[int] = Counter()
        self._least, self._greatest = 1 << 64, 0
        file.write(_MAGIC)
        self._put(self._records.Header(profile=encoding.profile, library=library))

    @property
    def channels(self) -> frozenset[int]:
        """The numbers of the channels that there are."""
        return frozenset(self._channels)

    def add_metadata(self, name: str, facts: Mapping[str, str]) -> None:
        """Write facts about the file."""
        offset = self._file.tell()
        length = self._put(self._records.Metadata(name=name, metadata=dict(facts)))
        self._metadata.append(self._records.MetadataIndex(offset=offset, length=length, name=name))

    def add_schema(self, number: int, name: str, data: bytes) -> None:
        """Write the schema of a channel."""
        encoding = self._encoding.schema_encoding
        shape = self._records.Schema(id=number, name=name, encoding=encoding, data=data)
        self._put(shape)
        self._schemas.append(shape)

    def add_channel(self, number: int, topic: str, facts: Mapping[str, str]) -> None:
        """Write a channel, whose schema is there."""
        channel = self._records.Channel(
            id=number,
            schema_id=number,
            topic=topic,
            message_encoding=self._encoding.message_encoding,
            metadata=dict(facts),
        )
        self._put(channel)
        self._channels[number] = channel

    def add(self, messages: Messages) -> None:
        """Write a chunk of messages, whose channels are there."""
        start, compression = self._file.tell(), self._encoding.compression
        checksum = zlib.crc32(messages.data) if self._encoding.has_checksums else 0
        packed = self._compress(messages.data)
        chunk = self._records.Chunk(
            compression=compression,
            data=packed,
            message_start_time=messages.least,
            message_end_time=messages.greatest,
            uncompressed_crc=checksum,
            uncompressed_size=len(messages.data),
        )
        length = self._put(chunk)
        indices = self._file.tell()
        offsets = {}
        for channel, places in messages.places.items():
            offsets[channel] = self._file.tell()
            self._file.write(_INDEX.pack(7, 6 + len(places), channel, len(places)) + places)
            self._counts[channel] += len(places) // 16
        index = self._records.ChunkIndex(
            chunk_length=length,
            chunk_start_offset=start,
            compression=compression,
            compressed_size=len(packed),
            message_end_time=messages.greatest,
            message_index_length=self._file.tell() - indices,
            message_index_offsets=offsets,
            message_start_time=messages.least,
            uncompressed_size=len(messages.data),
        )
        self._chunks.append(index)
        self._least = min(self._least, messages.least)
        self._greatest = max(self._greatest, messages.greatest)

    def close(self) -> None:
        """Write the end: all that readers need to know in front."""
        self._put(self._records.DataEnd(0))
        start = self._file.tell()
        summary = self._builder()
        offsets = []
        groups = (self._schemas, self._channels.values(), [self._statistics()], self._chunks)
        for opcode, group in zip((3, 4, 11, 8, 13), (*groups, self._metadata), strict=True):
            before = summary.count
            for record in group:
                record.write(summary)
            size = summary.count - before
            if size:
                offsets.append(
                    self._records.SummaryOffset(
                        group_opcode=opcode, group_start=start + before, group_length=size
                    )
                )
        offsets_start = start + summary.count
        for record in offsets:
            record.write(summary)
        data = summary.end()
        crc = zlib.crc32(_FOOTER.pack(2, 20, start, offsets_start), zlib.crc32(data))
        self._file.write(data)
        footer = self._records.Footer(
            summary_start=start, summary_offset_start=offsets_start, summary_crc=crc
        )
        self._put(footer)
        self._file.write(_MAGIC)

    def _put(self, record: Any) -> int:
        """Write a record; its bytes."""
        builder = self._builder()
        record.write(builder)
        return self._file.write(builder.end())

    def _statistics(self) -> Any:
        return self._records.Statistics(
            attachment_count=0,
            channel_count=len(self._channels),
            channel_message_counts=dict(self._counts),
            chunk_count=len(self._chunks),
            message_count=self._counts.total(),
            message_end_time=self._greatest,
            message_start_time=self._least if self._chunks else 0,
            metadata_count=len(self._metadata),
            schema_count=len(self._schemas),
        )
