"""Python's tables with and without frames that are read in bulk."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from capture_support import assert_same_tables
from compiled import module_at, protocol_of

from protogen.capture.bulk.cutter import BulkCutter
from protogen.capture.bulk.stretch import Bulk, Run
from protogen.capture.gather import gathered
from protogen.capture.layout import capture_schema
from protogen.capture.pure import PythonEngine, Reading
from protogen.capture.tables import Tables
from protogen.model.protocol import Sender
from protogen.runtime.decoder import Decoder
from protogen.runtime.sender import SenderSpec


def reading(sender: Sender, spec: SenderSpec[Any, Any], tables: Any, least: int) -> Reading:
    """What reads payloads in bulk as soon as so many are alike; 0: never."""
    in_bulk = least > 0 and Bulk.can_read(sender)
    return Reading(tables, spec, Bulk(sender, spec, tables, least) if in_bulk else None)


@cache
def reading_at(path: Path, sender: str, least: int) -> Reading:
    protocol = protocol_of(path)
    tables = capture_schema(protocol, protocol.sender(sender))
    spec = module_at(path).PROTOCOL.sender(sender)
    return reading(protocol.sender(sender), spec, tables, least)


def tables_of(how: Reading, data: Iterable[bytes]) -> Tables:
    """The tables of a stream that comes in pieces, however small."""
    engine = PythonEngine(how, least=0)
    found = [tables for piece in data for tables in engine.feed(piece)]
    return gathered([*found, *engine.flush()], None, 1)


def pieces_of(data: bytes, size: int) -> list[bytes]:
    return [data[at : at + size] for at in range(0, len(data), size)]


def check_bulk(path: Path, sender: str, data: bytes, pieces: Sequence[bytes] = ()) -> Tables:
    """Frames read in bulk, the whole and in pieces, against events alone."""
    expected = tables_of(reading_at(path, sender, 0), [data])
    for least in (1, 3):
        how = reading_at(path, sender, least)
        assert_same_tables(tables_of(how, [data]), expected)
        if pieces:
            assert_same_tables(tables_of(how, pieces), expected)
    return expected


def left_to_events(how: Reading, data: bytes) -> list[Any]:
    """The events of what was not read in bulk."""
    assert how.bulk is not None
    cutter = BulkCutter(how.bulk, how.spec, least=0)
    decoder = Decoder(how.spec.cut_by(cutter))
    events: list[Any] = [*decoder.feed(data), *decoder.flush()]
    return [event for event in events if not isinstance(event, Run)]
