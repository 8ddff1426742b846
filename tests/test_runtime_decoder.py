"""The decoder on every kind of framing: whatever the bytes, and however they arrive."""

import gc
import random
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import handwritten_framings
import handwritten_reference
import handwritten_streams as streams
import pytest
from compiled import DOCUMENTS, module_at
from hypothesis import given, settings
from hypothesis import strategies as st

from protogen.compiler import compile_file
from protogen.live.codec import module_of
from protogen.runtime import api as rt

SENDERS = {name: make() for name, make in handwritten_framings.FRAMINGS.items()}
MATTY = next(path for path in DOCUMENTS if path.stem == "matty")
fewer = settings(max_examples=20)
every_framing = pytest.mark.parametrize("sender", SENDERS.values(), ids=SENDERS.keys())


def decode(sender: Any, portions: list[bytes]) -> list[Any]:
    decoder = rt.Decoder(sender)
    events = [event for portion in portions for event in decoder.feed(portion)]
    return events + decoder.flush()


def as_bytes(stream: bytes) -> list[bytes]:
    return [stream[place : place + 1] for place in range(len(stream))]


@every_framing
@given(data=st.data())
def test_whatever_the_bytes_none_is_lost_and_portions_change_nothing(
    sender: Any, data: st.DataObject
) -> None:
    stream = data.draw(streams.streams(sender))
    portions = streams.in_portions(stream, data.draw(st.randoms(use_true_random=False)))
    events = decode(sender, [stream])
    assert b"".join(event.raw for event in events) == stream
    assert decode(sender, portions) == events
    assert decode(sender, as_bytes(stream)) == events
    offset = 0
    for event in events:
        assert (event.offset, event.size) == (offset, len(event.raw))
        assert event.size > 0
        offset += event.size
    found = [handwritten_reference.summary(event) for event in events]
    assert found == handwritten_reference.reference_events(sender, stream)


@every_framing
def test_events_of_many_streams_are_those_of_the_reference(sender: Any) -> None:
    source = random.Random(20241123)
    for _ in range(40):
        stream = streams.random_stream(sender, source, pieces=8)
        found = [handwritten_reference.summary(event) for event in decode(sender, [stream])]
        assert found == handwritten_reference.reference_events(sender, stream)


@every_framing
@fewer
@given(data=st.data())
def test_json_lines_give_the_stream_back(sender: Any, data: st.DataObject) -> None:
    stream = data.draw(streams.streams(sender))
    protocol: rt.Protocol[Any, Any] = rt.Protocol("test", sender)
    lines = [event.as_json() for event in decode(sender, [stream])]
    assert b"".join(map(protocol.encode_line, lines)) == stream
    stuffing = sender.frame.transparency
    is_only = (stuffing is None or not stuffing.lenient) and not has_same_ends(sender)
    for line in lines if is_only else ():
        # Only one frame can have this meaning, so a valid one needs no raw bytes.
        assert ("raw" in line) == (line["event"] == "invalid")


@every_framing
@fewer
@given(data=st.data())
def test_a_frame_alone_is_accepted_just_as_in_a_stream(sender: Any, data: st.DataObject) -> None:
    source = data.draw(st.randoms(use_true_random=False))
    frame = streams.random_frame(sender, source)
    if data.draw(st.booleans()):
        frame = streams.damaged(frame, source, streams.telling_bytes(sender))
    protocol: rt.Protocol[Any, Any] = rt.Protocol("test", sender)
    events = decode(sender, [frame])
    is_one = len(events) == 1 and events[0].kind != "invalid"
    try:
        event = protocol.read(frame, sender.name)
    except rt.DecodeError as error:
        assert not is_one
        assert 0 <= error.offset <= len(frame)
    else:
        assert [event] == events


@every_framing
def test_memory_is_bounded(sender: Any) -> None:
    source = random.Random(7)
    decoder = rt.Decoder(sender)
    for _ in range(30):
        for byte in streams.random_stream(sender, source):
            decoder.feed(bytes((byte,)))
            beginning = max(0, sender.layout.start_size - 2)
            assert decoder.pending <= sender.frame.greatest + beginning
    decoder.flush()
    assert decoder.pending == 0


@every_framing
@fewer
@given(data=st.data())
def test_a_flush_separates_what_comes_before_from_what_comes_behind(
    sender: Any, data: st.DataObject
) -> None:
    first, second = data.draw(streams.streams(sender)), data.draw(streams.streams(sender))
    decoder = rt.Decoder(sender)
    events = decoder.feed(first) + decoder.flush() + decoder.feed(second) + decoder.flush()
    before, behind = decode(sender, [first]), decode(sender, [second])
    assert events[: len(before)] == before
    assert [(e.offset, e.raw, e.kind) for e in events[len(before) :]] == [
        (len(first) + e.offset, e.raw, e.kind) for e in behind
    ]


# --- every frame that was not damaged is recovered -----------------------------------------------

PROTECTED = [
    "matty pc",
    "matty esp",
    "rn1 host",
    "rn1 brain",
    "rflex",
    "uherobot",
    "next protected start ends",
    "checksum over the wire",
]
AFTER_ENDS = ["dagny library", "cobs with an end only", "hdlc with an end only"]
SAME_ENDS = ["slip with two ends"]
LIKELY = ["ubx", "repeated sync", "cobs of the payload only"]
"""Noise could be a valid frame by chance; in these streams it is not."""


def corpus(sender: Any, source: random.Random) -> tuple[bytes, dict[int, bytes]]:
    """A stream of noise, damaged and whole frames; offset and bytes of the whole ones.

    Where only an end marks a start, a frame counts only if it follows a whole end.
    """
    telling = streams.telling_bytes(sender)
    end = sender.frame.end
    stream, whole = b"", {}
    for _ in range(200):
        kind = source.randrange(6)
        frame = known_frame(sender, source)
        if kind == 0:
            stream += bytes(source.choice(telling) for _ in range(source.randrange(12)))
        elif kind < 3:
            stream += streams.damaged(frame, source, telling)
        else:
            needs_end = isinstance(sender.frame.start, rt.AfterEnd)
            if not stream or not needs_end or stream.endswith(end.value):
                whole[len(stream)] = frame
            stream += frame
    return stream, whole


def has_same_ends(sender: Any) -> bool:
    start = sender.frame.start
    return isinstance(start, rt.StartLiteral) and start.value == getattr(
        sender.frame.end, "value", None
    )


def known_frame(sender: Any, source: random.Random) -> bytes:
    while True:
        frame = streams.random_frame(sender, source)
        events = decode(sender, [frame])
        if [event.kind for event in events] == ["message"]:
            return frame


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("name", [*PROTECTED, *AFTER_ENDS, *SAME_ENDS, *LIKELY])
def test_every_frame_that_was_not_damaged_is_recovered(name: str, seed: int) -> None:
    sender = SENDERS[name]
    source = random.Random(f"{name} {seed}")
    stream, whole = corpus(sender, source)
    events = decode(sender, streams.in_portions(stream, source))
    recovered = {event.offset: event.raw for event in events if event.kind == "message"}
    assert len(whole) > 50
    for offset, frame in whole.items():
        assert is_recovered(sender, offset, frame, recovered)


def is_recovered(sender: Any, offset: int, frame: bytes, recovered: dict[int, bytes]) -> bool:
    """Frames that lost an end that is also the start end with the next one's start;
    that one then lacks it, but nothing else.
    """
    if recovered.get(offset) == frame:
        return True
    start = len(sender.frame.start.value) if has_same_ends(sender) else 0
    return start > 0 and recovered.get(offset + start) == frame[start:]


# --- garbage ------------------------------------------------------------------------------------


@contextmanager
def collections() -> Iterator[list[str]]:
    """Beginnings of the garbage collector's runs."""
    seen: list[str] = []

    def note(phase: str, _: dict[str, int]) -> None:
        if phase == "start":
            seen.append(phase)

    gc.callbacks.append(note)
    try:
        yield seen
    finally:
        gc.callbacks.remove(note)


def test_garbage_is_collected_between_pieces_of_a_large_portion() -> None:
    # A "stop" of matty's: start, size, counter, "S", and what makes the sum 0.
    stream = bytes.fromhex("55 02 00 53 AB") * 50_000
    assert gc.isenabled()
    decoder = module_at(MATTY).Decoder("pc")
    with collections() as seen:
        events = decoder.feed(stream)
    assert b"".join(event.raw for event in events) == stream
    assert len(events) == 50_000
    assert 4 < len(seen) < 10  # One for each piece; without pauses, for some hundreds of events.
    assert gc.isenabled()


def test_a_collector_that_is_off_stays_off() -> None:
    gc.disable()
    try:
        rt.Decoder(SENDERS["matty pc"]).feed(bytes(3 << 15))
        assert not gc.isenabled()
    finally:
        gc.enable()


def test_the_collector_is_on_again_after_an_error() -> None:
    class Odd(rt.Decoder[Any, Any]):
        def _run(self, final: bool) -> None:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        Odd(SENDERS["matty pc"]).feed(bytes(3 << 15))
    assert gc.isenabled()


TRACK = """\
protocol: track
endpoints: {board: Tracker}
byte_order: little
frame:
  id: {type: uint8, id: true}
  payload: {}
  crc: {type: uint16, algorithm: CRC-16/KERMIT, covers: id..payload}
messages:
  path:
    id: 1
    from: board
    fields:
      n: uint16
      points: {count: n, fields: {has_height: bool, height: {type: uint8, when: has_height}}}
"""


@pytest.mark.parametrize("engine", ["fast", "construct"])
def test_a_frame_that_only_its_payload_ends_takes_time_in_proportion_to_its_size(
    engine: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "track.yaml"
    path.write_text(TRACK)
    module = module_at(path)
    point, parsed = module.PathPoints, 0
    parse = point.FORMAT._parse

    def count(*arguments: Any) -> Any:
        nonlocal parsed
        parsed += 1
        return parse(*arguments)

    monkeypatch.setattr(point.FORMAT, "_parse", count)
    frame = module.encode(module.Path(n=300, points=[point(has_height=True, height=7)] * 300))
    (event,) = module.Decoder("board", engine).feed(frame)
    assert event.message.n == 300
    # Each is tried at its first byte and behind it, once for the size and then for the message.
    assert parsed <= 4 * 300


A_RANGE_AND_AN_END = """
protocol: ranged
endpoints: {host: Host}
byte_bits: 7
frame:
  kind: {type: byte, id: true, range: [0x80, 0x94]}
  payload: {}
  end: {literal: {hex: 65 0A 65}}
transparency: {encoding: base16-upper, covers: payload}
messages:
  ping: {id: 0x81, from: host}
"""


def test_the_beginning_of_an_end_alone_is_no_beginning_of_a_frame(tmp_path: Path) -> None:
    """65 can begin the end, which nothing is in front of, and no frame begins with it."""
    path = tmp_path / "ranged.yaml"
    path.write_text(A_RANGE_AND_AN_END)
    protocol = compile_file(path).protocol
    assert protocol is not None
    spec = module_of(protocol).PROTOCOL.sender("host")
    data = bytes.fromhex("81 65 0A 65 65")
    events = decode(spec, [data])
    assert [(event.kind, event.size) for event in events] == [("message", 4), ("invalid", 1)]
    assert events[1].reason == "noise"
    assert decode(spec, as_bytes(data)) == events
