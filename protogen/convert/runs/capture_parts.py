"""One part of a capture made into Parquet files: what a worker of a fleet does.

A part may be done twice, by a worker that was thought dead and by the one in its place: both write
the same files under names of their own and then put them in the same places. A marker, written
last, says that a part is done, so that a run which starts again need not do it again.
"""

from __future__ import annotations

import json
import pickle
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any
from uuid import uuid4

import msgspec

from protogen.convert.columns.batches import Tally, batches_of
from protogen.convert.columns.tables import Tables, tables_of
from protogen.convert.errors import ConvertError
from protogen.convert.formats import InputKind, OutputFormat
from protogen.convert.inputs.sources import Source, open_stream, opened
from protogen.convert.runs.byte_ranges import END, START, Frame, RangeDecoder, guess_entry
from protogen.convert.runs.journal import marker_of
from protogen.convert.writers.format_writers import write_all
from protogen.convert.writers.pending_files import Pending, name_place, write_whole
from protogen.model.protocol import Protocol
from protogen.runtime.framing.sender import SenderSpec

_LEAST_LEAD = 1 << 14
"""A decoder that is to guess an entry begins at least so many bytes before the range."""


class Work(msgspec.Struct, frozen=True):
    """Facts that all parts of a run have in common."""

    protocol: Protocol
    sender: str
    folder: str
    engine: str | None = None


class Part(msgspec.Struct, frozen=True):
    """A part of a capture: a range of bytes, or where `span` is None the whole of it."""

    name: str
    """Name of its files, and of its marker."""
    place: str
    capture: str
    """The name of the capture in metadata."""
    stamp: Mapping[str, Any]
    """Facts that the result depends on."""
    input: str | None
    size: int = 0
    """Bytes of the capture."""
    span: tuple[int, int] | None = None
    entry: Frame | None = None
    """None: to be guessed."""


class PartDone(msgspec.Struct, frozen=True):
    """Result of a part."""

    entry: Frame
    exit: Frame
    tally: Tally
    files: Sequence[str]
    complaints: Sequence[str] = ()


class _Marker(msgspec.Struct):
    stamp: Mapping[str, Any]
    done: PartDone


def read_marker(folder: Path, part: Part) -> PartDone | None:
    """Result of a part in an earlier run; None where it is not done, or things changed."""
    try:
        text = marker_of(folder, part.name).read_text(encoding="utf-8")
        marker = msgspec.convert(json.loads(text), _Marker)
    except (OSError, ValueError):
        return None
    holds = marker.stamp == part.stamp
    there = all((folder / file).is_file() for file in marker.done.files)
    return marker.done if holds and there else None


def write_marker(folder: Path, part: Part, done: PartDone) -> None:
    """Write down that a part is done. Raises OSError."""
    text = json.dumps(msgspec.to_builtins(_Marker(part.stamp, done)))
    write_whole(marker_of(folder, part.name), text.encode(), token=uuid4().hex[:12])


def convert_part(work: Work, part: Part) -> PartDone:
    """Write the files of a part and its marker. Raises ConvertError and OSError."""
    folder = Path(work.folder)
    pending = Pending(folder, token=uuid4().hex[:12])
    try:
        done = _whole(work, part, pending) if part.span is None else _range(work, part, pending)
        pending.commit()
    except BaseException as error:
        pending.discard()
        if isinstance(error, EOFError):  # It became shorter since its parts were planned.
            raise ConvertError(f"{part.place}: {error}", "convert it again") from None
        name_place(error, folder)
        raise
    write_marker(folder, part, done)
    return done


def _tools(protocol: Protocol, sender: str) -> tuple[Tables, SenderSpec[Any, Any]]:
    """Tables and codec of a sender; made once in a process."""
    return _tools_of(pickle.dumps(protocol), sender)


@lru_cache(maxsize=4)
def _tools_of(pickled: bytes, sender: str) -> tuple[Tables, SenderSpec[Any, Any]]:
    """Each task brings its own copy of a protocol, which has no hash."""
    from protogen.live.codec import module_of

    protocol: Protocol = pickle.loads(pickled)  # noqa: S301 - what was pickled just now
    tables = tables_of(protocol, protocol.sender(sender))
    return tables, module_of(protocol).PROTOCOL.sender(sender)


def _whole(work: Work, part: Part, pending: Pending) -> PartDone:
    from protogen.convert.columns.decoders import open_decoder
    from protogen.convert.writers.arrow_writers import ParquetWriter

    tables, spec = _tools(work.protocol, work.sender)
    complaints: list[str] = []
    tally = Tally()
    writer = ParquetWriter(part.name, pending, part.capture)
    kind = None if part.input is None else InputKind(part.input)
    senders = [sender.name for sender in work.protocol.senders]
    decoder = open_decoder(tables, spec, OutputFormat.PARQUET, work.engine)
    with opened(Source(part.place), kind, work.sender, senders, complaints.append) as capture:
        write_all(writer, batches_of(decoder, capture.chunks), tally)
    return PartDone(START, END, tally, pending.relatives, complaints)


def _range(work: Work, part: Part, pending: Pending) -> PartDone:
    from protogen.convert.columns.decoders import column_decoders
    from protogen.convert.writers.arrow_writers import ParquetWriter

    assert part.span is not None
    tables, _ = _tools(work.protocol, work.sender)
    make = column_decoders(tables, work.engine)
    tally = Tally()
    with open_stream(part.place) as stream:
        entry = part.entry
        if entry is None:
            entry = guess_entry(stream, part.size, part.span[0], lead_of(tables), make)
        decoder = RangeDecoder(stream, part.size, part.span, entry, make)
        writer = ParquetWriter(part.name, pending, part.capture)
        write_all(writer, decoder.batches(), tally)
    return PartDone(entry, decoder.exit, tally, pending.relatives)


def lead_of(tables: Tables) -> int:
    """Bytes before a range at which the decoder begins that is to guess its entry."""
    return max(_LEAST_LEAD, 4 * tables.sender.framing.greatest)
