"""Streams of frames, noise and damage: what a decoder loses, keeps and holds back.

For every framing there is: the five documents, the dialects, and those of `tests/framings`. What is
due of an undamaged frame is stated in `recovery_oracle`.
"""

from __future__ import annotations

import gc
import tracemalloc
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from math import sqrt
from pathlib import Path
from random import Random
from typing import Any

import pytest
from amounts import OF_A_SENDER, STREAMS
from compiled import FRAMINGS, module_at, name_of, protocol_of, senders
from corpus import (
    DAMAGES,
    WHOLE,
    Material,
    Piece,
    Stream,
    joined,
    marks_of,
    material_of,
    portions,
    single_bytes,
    stream_of,
    unknown_frames,
)
from hypothesis import given, settings
from hypothesis import strategies as st
from recovery_oracle import Fate, fates, is_protected

from protogen.model.frame_plan import StartRule
from protogen.runtime.errors import EncodeError
from protogen.runtime.framing.frame import AfterEnd, FrameSpec
from protogen.runtime.framing.starts import starts_of

EVERY_SENDER = pytest.mark.parametrize(("path", "sender"), senders(), ids=name_of)
SEEDS = range(STREAMS)
PIECES = 60
PEAKS = {
    "terminated_alone": 240_000,
    "last_elements_alone": 240_000,
    "part_fields_alone": 240_000,
}
"""Bytes while a portion of noise is decoded, where they are more than of others. These look at the
payload again with each byte, and what the looks leave is collected behind the portion."""
BY_CHANCE = {
    "digits_line": 1 / 64,
    "written_line": 1 / 64,
    "separated_line": 1 / 64,
    "mavlink_like": 1 / 20,
}
"""Shares of damage that looks right: checksums of six bits alone, and signatures that are cut off
behind a checksum that covers none of their bytes."""


def spec_of(path: Path, sender: str) -> FrameSpec:
    spec: FrameSpec = module_at(path).PROTOCOL.sender(sender).frame
    return spec


def events_of(path: Path, sender: str, data: Iterable[bytes]) -> list[Any]:
    decoder = module_at(path).Decoder(sender)
    events = [event for portion in data for event in decoder.feed(portion)]
    return [*events, *decoder.flush()]


def shown(events: Iterable[Any]) -> list[tuple[Any, ...]]:
    """All there is to events, in a form in which what is not a number equals itself."""
    return [(event.kind, event.offset, event.raw, event.as_json()) for event in events]


def is_input(events: Iterable[Any], data: bytes) -> bool:
    """True if the raw bytes of the events, joined, are the input, and the offsets are right."""
    offset = 0
    for event in events:
        if event.offset != offset or event.size != len(event.raw):
            return False
        offset += event.size
    return b"".join(event.raw for event in events) == data


# --- seeded corpora -------------------------------------------------------------------------------


@cache
def corpus(path: Path, sender: str) -> list[tuple[Stream, list[Any]]]:
    """Streams, and their events."""
    material = material_of(path, sender)
    streams = [stream_of(material, Random(seed), PIECES) for seed in SEEDS]
    return [(stream, events_of(path, sender, [stream.data])) for stream in streams]


@EVERY_SENDER
def test_no_byte_is_lost_or_invented(path: Path, sender: str) -> None:
    for stream, events in corpus(path, sender):
        assert is_input(events, stream.data)


@EVERY_SENDER
def test_every_undamaged_frame_is_found(path: Path, sender: str) -> None:
    spec = spec_of(path, sender)
    found: Counter[Fate] = Counter()
    for stream, events in corpus(path, sender):
        became = fates(spec, stream, events)
        lost = [
            frame for frame, fate in zip(stream.frames, became, strict=True) if fate is Fate.LOST
        ]
        assert lost == []
        found.update(became)
    # The promise without "but": whatever begins with, or behind, something protected.
    assert found[Fate.COVERED] == 0 or not is_protected(spec)
    assert found[Fate.NOT_DUE] == 0 or isinstance(spec.start, AfterEnd) or spec.silence is not None
    # Elsewhere it takes a checksum that is right by chance, in few frames sometimes more often.
    expected = BY_CHANCE.get(path.stem, 0) * found.total()
    assert found[Fate.COVERED] <= max(0.005 * found.total(), expected + 2 * sqrt(expected))


@EVERY_SENDER
def test_portions_do_not_change_the_events(path: Path, sender: str) -> None:
    for seed, (stream, events) in zip(SEEDS, corpus(path, sender), strict=True):
        cut = portions(stream.data, Random(seed))
        assert shown(events_of(path, sender, cut)) == shown(events)


@EVERY_SENDER
def test_single_bytes_do_not_change_the_events_and_little_is_held_back(
    path: Path, sender: str
) -> None:
    spec = spec_of(path, sender)
    kept = spec.greatest * (1 if spec.silence is None else 2)
    for stream, events in corpus(path, sender)[::3]:
        decoder = module_at(path).Decoder(sender)
        found: list[Any] = []
        for portion in single_bytes(stream.data):
            found += decoder.feed(portion)
            assert decoder.pending <= kept
        found += decoder.flush()
        assert shown(found) == shown(events)


@EVERY_SENDER
def test_a_frame_is_delivered_with_its_last_byte(path: Path, sender: str) -> None:
    """Nothing waits for what follows, unless only that can end the frame."""
    for frame in material_of(path, sender).frames:
        decoder = module_at(path).Decoder(sender)
        found = decoder.feed(frame)
        if spec_of(path, sender).silence is not None:
            assert found == []
            found = decoder.idle()
        (event,) = found
        assert event.raw == frame
        assert decoder.pending == 0


# --- chosen by Hypothesis -------------------------------------------------------------------------


def drawn_pieces(material: Material) -> st.SearchStrategy[list[Piece]]:
    """Pieces that shrink: to fewer, to the first frame, to less damage."""
    frames = st.sampled_from(material.frames)
    marks = st.sampled_from(list(material.marks)) | st.integers(0, 255)
    noise = st.lists(marks, min_size=1, max_size=12).map(bytes)
    edits = st.tuples(st.sampled_from(["drop", "insert", "write"]), st.integers(0, 200), marks)
    damage = st.builds(edited, frames, st.lists(edits, min_size=1, max_size=3))
    whole = frames.map(lambda frame: Piece(WHOLE, frame))
    other = (noise | damage).map(lambda data: Piece("other", data))
    return st.lists(whole | other, max_size=12)


def edited(frame: bytes, edits: Sequence[tuple[str, int, int]]) -> bytes:
    """A frame with some bytes dropped, inserted and overwritten; place -1 is the last byte."""
    found = bytearray(frame)
    for kind, number, byte in edits:
        place = number % (len(found) + 1) - 1
        if kind == "insert":
            found.insert(place, byte)
        elif found and kind == "drop":
            del found[place]
        elif found:
            found[place] = byte
    return bytes(found)


@EVERY_SENDER
@settings(max_examples=OF_A_SENDER)
@given(data=st.data())
def test_any_mixture_is_cut_as_promised(path: Path, sender: str, data: st.DataObject) -> None:
    spec = spec_of(path, sender)
    stream = joined(data.draw(drawn_pieces(material_of(path, sender))))
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream.data)), max_size=6)))
    ends = [*cuts, len(stream.data)]
    cut = [stream.data[low:high] for low, high in zip([0, *cuts], ends, strict=True)]
    events = events_of(path, sender, [stream.data])
    assert is_input(events, stream.data)
    assert shown(events_of(path, sender, cut)) == shown(events)
    became = fates(spec, stream, events)
    assert Fate.LOST not in became
    assert Fate.COVERED not in became or not is_protected(spec)


@EVERY_SENDER
@settings(max_examples=OF_A_SENDER)
@given(data=st.data())
def test_a_decoder_is_as_new_behind_a_flush(path: Path, sender: str, data: st.DataObject) -> None:
    """A silence on the line ends whatever was going on, and counts as the start of a stream."""
    mixture = drawn_pieces(material_of(path, sender))
    first, second = (joined(data.draw(mixture)).data for _ in range(2))
    decoder = module_at(path).Decoder(sender)
    events = [*decoder.feed(first), *decoder.flush()]
    assert decoder.pending == 0
    again = [*decoder.feed(second), *decoder.flush()]
    assert shown(events) == shown(events_of(path, sender, [first]))
    alone = events_of(path, sender, [second])
    assert [
        (event.kind, event.offset - len(first), event.raw, reason_of(event)) for event in again
    ] == [(event.kind, event.offset, event.raw, reason_of(event)) for event in alone]


def reason_of(event: Any) -> str:
    return event.reason if event.kind == "invalid" else ""


# --- single cases ---------------------------------------------------------------------------------


@EVERY_SENDER
@pytest.mark.parametrize("kind", DAMAGES)
def test_one_damaged_frame_costs_no_other(path: Path, sender: str, kind: str) -> None:
    """Between two undamaged frames; the one in front is never in danger."""
    spec = spec_of(path, sender)
    material = material_of(path, sender)
    dice = Random(f"{path.stem} {sender} {kind}")
    for _ in range(20):
        before, middle, behind = dice.choices(material.frames, k=3)
        wrong = DAMAGES[kind](middle, material, dice)
        stream = joined([Piece(WHOLE, before), Piece(kind, wrong), Piece(WHOLE, behind)])
        first, second = fates(spec, stream, events_of(path, sender, [stream.data]))
        assert first is (Fate.FOUND if spec.silence is None else Fate.NOT_DUE)
        assert second is not Fate.LOST


@pytest.mark.parametrize("path", FRAMINGS, ids=name_of)
def test_a_torrent_of_noise_fills_no_memory(path: Path) -> None:
    """Nothing but marks, so that frames seem to begin all the time."""
    sender = protocol_of(path).senders[0].name
    marks = marks_of(path, sender)
    decoder = module_at(path).Decoder(sender)
    noise = bytes(Random(1).choices(marks, k=12_000))
    portions = [noise[start : start + 100] for start in range(0, len(noise), 100)]

    def feed_all() -> None:
        for portion in portions:
            decoder.feed(portion)
            gc.collect()

    peak, left = memory_of(feed_all)
    # 12,000 bytes went through. What stays is a frame or two, and some 5,000 bytes that the
    # interpreter keeps of code that it has run, more or less of them by what ran before.
    assert left < 9_000
    assert peak < PEAKS.get(path.stem, 45_000)


def memory_of(work: Callable[[], None]) -> tuple[int, int]:
    """The bytes that a piece of work holds at most, and those that it leaves behind."""
    # What is there already is not looked at again, so that work may collect as often as it likes.
    # If it didn't, the peak would be a matter of when the interpreter last collected. It stays
    # frozen, as in `settled_objects`: else the next test would take seconds to look through it.
    gc.collect()
    gc.freeze()
    # Once unmeasured: the interpreter keeps what it learns about code that runs for the first time.
    work()
    tracemalloc.start()
    try:
        work()
        _, peak = tracemalloc.get_traced_memory()
        gc.collect()
        left, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    return peak, left


WITH_STARTS = [
    (path, sender)
    for path, sender in senders()
    if protocol_of(path).sender(sender).plan.start in (StartRule.LITERAL, StartRule.SET)
]


@pytest.mark.parametrize(("path", "sender"), WITH_STARTS, ids=name_of)
def test_noise_is_delivered_when_it_is_as_long_as_a_greatest_frame(path: Path, sender: str) -> None:
    spec = spec_of(path, sender)
    decoder, starts = module_at(path).Decoder(sender), starts_of(spec)
    noise = next(byte for byte in (b"\x41", b"\x00") if starts.find(byte, 0, 1) != 0)
    assert decoder.feed(noise * (spec.greatest - 1)) == []
    (event,) = decoder.feed(noise)
    assert (event.reason, event.size) == ("noise", spec.greatest)
    assert decoder.pending == 0


NEITHER_LENGTH_NOR_END = [
    (path, sender)
    for path, sender in senders()
    if protocol_of(path).sender(sender).framing.end is None
    and protocol_of(path).sender(sender).frame.length is None
    and protocol_of(path).sender(sender).plan.start_words
]


@pytest.mark.parametrize(("path", "sender"), NEITHER_LENGTH_NOR_END, ids=name_of)
def test_an_unknown_frame_without_length_and_end_is_found_if_a_frame_follows(
    path: Path, sender: str
) -> None:
    """Nothing else tells where it ends: of such frames nothing more can be promised."""
    module = module_at(path)
    (identity,) = protocol_of(path).sender(sender).frame.identity
    frame = module.PROTOCOL.encode_unknown(sender, {identity.name: 0xC5}, b"\x01\x02")
    for known in material_of(path, sender).frames:
        events = events_of(path, sender, [known + frame + known + frame])
        assert [event.raw for event in events] == [known, frame, known, frame]
        assert [event.kind for event in events] == ["message", "unknown"] * 2
    assert list(unknown_frames(path, protocol_of(path).sender(sender))) == []


@pytest.mark.parametrize("engine", ["fast", "construct"])
@pytest.mark.parametrize(
    ("framing", "start", "reason"),
    [
        # The beginning of a ping, which has no payload, and a length of 64.
        ("sync_length_crc", "B5 62 00 40 00", "size"),
        ("bounded_head", "55 01 40 00 02 00", "size"),
        ("bounded_length", "40 00", "size"),
        ("bounded_head", "55 01 40 03 21", "value"),  # Flags 801.
        ("bounded_head", "55 00", "value"),  # A counter of 0.
    ],
)
def test_a_wrong_start_is_given_up_with_the_byte_that_shows_it(
    engine: Any, framing: str, start: str, reason: str
) -> None:
    (path,) = (path for path in FRAMINGS if path.stem == framing)
    data = bytes.fromhex(start)
    for parts in ([data], [data[at : at + 1] for at in range(len(data))]):
        decoder = module_at(path).Decoder("station", engine=engine)
        events = [event for part in parts for event in decoder.feed(part)]
        assert (events[0].offset, events[0].reason) == (0, reason)
        assert decoder.pending == len(data) - sum(event.size for event in events)


def test_a_frame_that_no_receiver_takes_is_not_made() -> None:
    (path,) = (path for path in FRAMINGS if path.stem == "bounded_head")
    module = module_at(path)
    for number, flags, place in [(0, 2, "number"), (251, 2, "number"), (1, 801, "flags")]:
        with pytest.raises(EncodeError, match=place):
            module.encode(module.Ping(), number=number, flags=flags, strict=False)
