"""The fast ways of C's `feed` find what `push` finds, byte by byte, and what Python finds."""

from __future__ import annotations

import platform
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from random import Random

import pytest
from amounts import STREAMS_OF_TWO_ENGINES
from c_engine import SANITIZERS, Process, check_events, process_of
from compiled import DIALECTS, DOCUMENTS, FRAMINGS, module_at, name_of, protocol_of
from corpus import material_of, stream_of

from protogen.fuzzing.c_calls import Step
from protogen.model.protocol import Protocol
from protogen.targets.c.emit import unit_of
from protogen.targets.c.options import COptions, Events

MACROS = {"none": "_FAST_FEED=0", "sse2": "_SSE2=1"}
"""What is defined for a way. Without, it is the portable one, which other tests compile as well."""
SEEDS = range(STREAMS_OF_TWO_ENGINES)


def takes_whole(protocol: Protocol) -> bool:
    """True if the C of a protocol has a fast way."""
    return unit_of(protocol, COptions()).framing.takes_whole


PATHS = [path for path in (*DOCUMENTS, *DIALECTS, *FRAMINGS) if takes_whole(protocol_of(path))]


def test_the_fast_way_is_there_where_frames_tell_their_size_in_front() -> None:
    found = {path.stem for path in PATHS}
    assert {"rn1", "rflex", "matty", "bounded_length", "sync_length_crc"} <= found


@pytest.mark.parametrize("events", ["all", "messages"])
@pytest.mark.parametrize("way", ["portable", *MACROS])
@pytest.mark.parametrize("path", PATHS, ids=name_of)
def test_whole_streams_and_large_parts_of_them(path: Path, way: str, events: Events) -> None:
    if way == "sse2" and platform.machine() not in ("x86_64", "AMD64"):
        pytest.skip("only x86 has SSE2")
    with process_of_way(path, way, events) as process:
        check_feed(process, path)


@contextmanager
def process_of_way(path: Path, way: str, events: Events) -> Iterator[Process]:
    protocol, options = protocol_of(path), COptions(events=events)
    if way not in MACROS:
        yield process_of(path, options)
        return
    define = f"-D{protocol.name.upper()}{MACROS[way]}"
    process = Process(protocol, options, ("-O0", define, *SANITIZERS))
    yield process
    process.close()


def check_feed(process: Process, path: Path) -> None:
    """Give whole streams, and large parts of them, to every sender's decoder."""
    for sender in protocol_of(path).senders:
        material = material_of(path, sender.name)
        for seed in SEEDS:
            dice = Random(f"{path.stem} {sender.name} {seed}")
            stream = stream_of(material, dice, 60).data
            cuts = sorted(dice.randrange(len(stream)) for _ in range(seed % 4))
            ends = [*cuts, len(stream)]
            parts = [stream[low:high] for low, high in zip([0, *cuts], ends, strict=True)]
            steps: list[Step] = [*(("feed", part) for part in parts), ("flush",)]
            check_events(process, module_at(path), sender.name, steps)
