"""The frames that generated C makes, in a buffer and byte by byte, held against Python's."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from itertools import islice
from pathlib import Path
from random import Random
from typing import Any

import pytest
from c_engine import Process, process_of
from compiled import ROOT, SCHEMAS, module_at, name_of, protocol_of

from protogen.compiler import compile_file
from protogen.fuzzing.c_calls import OK, RANGE, REFUSED, Encoded
from protogen.fuzzing.c_values import Unfit
from protogen.fuzzing.samples import Values, boundary_rounds, samples
from protogen.model.parts import BitsPart
from protogen.model.protocol import Protocol
from protogen.model.transparency import Cobs, Insertion
from protogen.runtime.attributes import arguments
from protogen.runtime.errors import EncodeError
from protogen.targets.c.emit import unit_of
from protogen.targets.c.frame.message_frames import MessageFrame
from protogen.targets.c.options import COptions

SAMPLERS = sorted((ROOT / "tests" / "c_schemas").glob("*.yaml"))
SENT = [
    (path, sender.name, message.name)
    for path in (*SCHEMAS, *SAMPLERS)
    for sender in protocol_of(path).senders
    for message in sender.messages
]
EVERY_MESSAGE = pytest.mark.parametrize(("path", "sender", "message"), SENT, ids=name_of)
RANDOM = 12
"""Random samples of each message, behind those with each boundary."""


@cache
def frames_of(path: Path, sender: str, message: str) -> list[tuple[Values, Values, bytes | None]]:
    """Values, parts, and the frame that Python makes of them; None: it would be cut elsewhere."""
    return [
        (values, parts, frame_of(path, sender, message, values, parts))
        for values, parts in sampled(path, sender, message)
    ]


def sampled(path: Path, sender: str, message: str) -> Iterator[tuple[Values, Values]]:
    model, frame = protocol_of(path).message(message), protocol_of(path).sender(sender).frame
    found = samples(model, frame, Random(f"{sender} {message}"))
    return islice(found, boundary_rounds(model, frame) + RANDOM)


def frame_of(path: Path, sender: str, message: str, values: Values, parts: Values) -> bytes | None:
    module = module_at(path)
    record = module.MESSAGES[message].from_dict(values)
    record.to_payload()
    try:
        frame: bytes = module.encode(record, sender, **arguments(parts))
    except EncodeError:
        # The payload is fine, so what is wrong is that the end stands in it, or the frame's size.
        framing = protocol_of(path).sender(sender).framing
        assert framing.cut_ambiguous or framing.is_cut_off
        return None
    return frame


@EVERY_MESSAGE
def test_a_frame_has_the_bytes_that_python_makes(path: Path, sender: str, message: str) -> None:
    process = process_of(path)
    for values, parts, frame in frames_of(path, sender, message):
        made = process.do(process.calls.frame(sender, message, values, parts))
        assert made.intact
        assert (made.result, made.data) == ((REFUSED, b"") if frame is None else (OK, frame))


@EVERY_MESSAGE
def test_a_frame_that_is_sent_has_the_same_bytes(path: Path, sender: str, message: str) -> None:
    process = process_of(path)
    if not process.calls.sends(sender, message):
        return
    for values, parts, frame in frames_of(path, sender, message):
        sent = process.do(process.calls.send(sender, message, values, parts))
        assert sent == (Encoded(RANGE, b"") if frame is None else Encoded(OK, frame))


HIGH_BYTES = """\
protocol: high_bytes
endpoints: {host: Host}
byte_order: big
frame:
  start:   {literal: 0x7E, unprotected: start}
  length:  {type: uint16, counts: payload}
  payload: {}
  sum:     {type: uint8, algorithm: sum-8, covers: payload}
messages:
  block: {from: host, fields: {data: {type: bytes, size: {fill: true, max: 4096}}}}
decisions:
  start: {question: One inside?, document: Silent., choice: The sum tells., because: Nothing else.}
"""


@pytest.mark.parametrize("size", [7, 8, 255, 256, 257, 264, 512, 1023, 1024, 1500, 4096])
def test_a_sum_of_many_high_bytes_does_not_overflow(size: int, tmp_path: Path) -> None:
    path = tmp_path / "high_bytes.yaml"
    path.write_text(HIGH_BYTES)
    process = process_of(path)
    for byte in (0xFF, 0xFE, 0x80):
        data = bytes([byte]) * size
        made = process.do(process.calls.frame("host", "block", {"data": data.hex()}, {}))
        assert made.data == bytes([0x7E, *divmod(size, 256)]) + data + bytes([byte * size % 256])


BLOCKS = """\
protocol: blocks
endpoints: {host: Host}
byte_order: big
frame:
  payload: {}
  sum:     {type: uint8, algorithm: sum-8, covers: payload}
  end:     {literal: 0}
transparency: {covers: payload..sum, encoding: cobs}
messages:
  block: {from: host, fields: {data: {type: bytes, size: {fill: true, max: MOST}}}}
"""


@pytest.mark.parametrize("most", [252, 253])
def test_content_that_never_fills_a_group_of_cobs_is_stuffed_where_it_stands(
    most: int, tmp_path: Path
) -> None:
    """With 253 bytes of data and their sum, content may be one full group."""
    path = tmp_path / "blocks.yaml"
    path.write_text(BLOCKS.replace("MOST", str(most)))
    process, module = process_of(path), module_at(path)
    framing = unit_of(protocol_of(path), COptions()).framing
    assert framing.in_place == ({"host"} if most == 252 else set())
    for size in (0, 1, 2, 251, most):
        for data in (b"\x11" * size, bytes(size), (b"\x11" * size)[1:] + b"\0"[:size]):
            made = process.do(process.calls.frame("host", "block", {"data": data.hex()}, {}))
            assert made.data == module.encode(module.Block(data=data))


@cache
def copied() -> tuple[tuple[Path, MessageFrame], ...]:
    """The frames that are put on the stack before they are sent, or not sent at all."""
    return tuple(
        (path, item)
        for path in SCHEMAS
        for item in unit_of(protocol_of(path), COptions()).framing.messages
        if not item.streams
    )


def test_frames_are_sent_without_a_copy_where_nothing_in_them_depends_on_what_follows() -> None:
    for path, item in copied():
        it = protocol_of(path).sender(item.decoder.name)
        length = it.frame.length
        is_late = length is not None and length.over_wire
        code = it.frame.transparency
        is_late |= code is not None and isinstance(code.encoding, Cobs | Insertion)
        is_late |= any(isinstance(part, BitsPart) and part.sums for part in it.frame.parts)
        assert is_late or it.framing.cut_ambiguous or it.framing.is_cut_off, it.name


def test_each_message_can_be_sent_but_those_of_which_a_copy_would_be_great() -> None:
    assert {item.sends for _, item in copied()} == {True, False}
    assert all(item.sends == (item.room <= 256) for _, item in copied())


@EVERY_MESSAGE
def test_nothing_is_written_where_the_buffer_is_too_short(
    path: Path, sender: str, message: str
) -> None:
    process = process_of(path)
    dice = Random(message)
    for values, parts, frame in frames_of(path, sender, message)[::3]:
        if frame is None:
            continue
        for capacity in {0, min(1, len(frame) - 1), len(frame) - 1, dice.randrange(len(frame))}:
            made = process.do(process.calls.frame(sender, message, values, parts, capacity))
            assert (made.result, made.data) == (REFUSED, b"")
            assert made.intact
            assert made.exact


@EVERY_MESSAGE
def test_a_buffer_that_is_longer_than_needed_is_left_alone_behind_the_room(
    path: Path, sender: str, message: str
) -> None:
    """Between the frame and the stated room anything may stand; outside of it, nothing."""
    process = process_of(path)
    room = process.driver.frame(sender, message).room
    for values, parts, frame in frames_of(path, sender, message)[::5]:
        if frame is None:
            continue
        assert len(frame) <= room
        for capacity in {len(frame), (len(frame) + room) // 2, room, room + 5}:
            made = process.do(process.calls.frame(sender, message, values, parts, capacity))
            assert made.intact
            if made.result == REFUSED:
                assert capacity < room
                assert made.exact
            else:
                assert (made.result, made.data) == (OK, frame)


# --- what can't be sent ---------------------------------------------------------------------------

RANGED = """
protocol: ranged
endpoints: {pc: Computer}
byte_order: little
frame:
  start: {literal: 0xAA, unprotected: start_in_data}
  number: {type: uint16, range: [10, 1000]}
  id: {type: uint8, id: true}
  step: {type: uint8, counter: true, range: [0, 15]}
  size: {type: uint8, range: [1, 3], default: 1}
  length: {type: uint8, counts: payload, range: [1, 12]}
  payload: {}
  check: {type: uint16, algorithm: CRC-16/KERMIT, covers: start..payload}
messages:
  speed:
    id: 1
    from: pc
    fields:
      speed: {type: uint16, range: [5, 500]}
  text:
    id: 2
    from: pc
    fields:
      text: {type: ascii, size: fill}
decisions:
  start_in_data: {question: Why?, document: silent, choice: accept it, because: a test}
"""
FINE = {"number": 10, "step": 15, "size": 3}


@pytest.fixture(scope="module")
def ranged(tmp_path_factory: pytest.TempPathFactory) -> Process:
    return Process(compiled(RANGED, tmp_path_factory.mktemp("ranged")))


def compiled(text: str, folder: Path) -> Protocol:
    path = folder / "drawn.yaml"
    path.write_text(text, encoding="utf-8")
    compilation = compile_file(path)
    assert compilation.protocol is not None, [str(item) for item in compilation.problems]
    return compilation.protocol


@pytest.mark.parametrize(
    ("parts", "result"),
    [
        ({}, OK),
        ({"number": 1000}, OK),
        ({"number": 9}, RANGE),
        ({"number": 1001}, RANGE),
        ({"number": 0xFFFF}, RANGE),
        ({"step": 16}, RANGE),
        ({"step": 0}, OK),
        ({"size": 0}, RANGE),
        ({"size": 4}, RANGE),
    ],
)
def test_parts_that_are_out_of_range_are_refused(
    ranged: Process, parts: Values, result: int
) -> None:
    given: Any = ("pc", "speed", {"speed": 5}, FINE | parts)
    made = ranged.do(ranged.calls.frame(*given))
    assert (made.result, made.intact) == (OK if result == OK else REFUSED, True)
    assert made.exact or result == OK
    sent = ranged.do(ranged.calls.send(*given))
    assert (sent.result, sent.data) == (result, made.data)


def test_parts_are_no_wider_than_their_types(ranged: Process) -> None:
    with pytest.raises(Unfit):
        ranged.calls.frame("pc", "speed", {"speed": 5}, FINE | {"step": 256})


@pytest.mark.parametrize(
    ("message", "values", "result"),
    [
        ("speed", {"speed": 500}, OK),
        ("speed", {"speed": 4}, RANGE),
        ("speed", {"speed": 501}, RANGE),
        ("text", {"text": "a"}, OK),
        ("text", {"text": "abcdefghijkl"}, OK),
        ("text", {"text": ""}, RANGE),
        ("text", {"text": "\x80"}, RANGE),
    ],
)
def test_nothing_is_sent_of_a_message_that_is_out_of_range(
    ranged: Process, message: str, values: Values, result: int
) -> None:
    made = ranged.do(ranged.calls.frame("pc", message, values, FINE))
    assert (made.result, made.intact) == (OK if result == OK else REFUSED, True)
    assert made.exact or result == OK
    sent = ranged.do(ranged.calls.send("pc", message, values, FINE))
    assert (sent.result, sent.data) == (result, made.data)


BESIDE = """
protocol: beside
endpoints: {pc: Computer}
byte_order: little
frame:
  start: {literal: 0x55}
  kind: {literal: {text: "k"}}
  check: {type: uint16, algorithm: CRC-16/KERMIT, covers: kind, over: wire}
  payload: {}
transparency: {escape: {byte: 0x56, of: [0x55, 0x56], transform: invert}, covers: check..payload}
messages:
  speed:
    from: pc
    fields:
      speed: {type: uint16}
"""


def test_a_checksum_of_the_wire_may_cover_nothing_that_is_stuffed(tmp_path: Path) -> None:
    """Its C has no function to sum stuffed bytes then, which a compiler would warn of."""
    process = Process(compiled(BESIDE, tmp_path))
    made = process.do(process.calls.frame("pc", "speed", {"speed": 0x5502}, {}))
    # CRC-16/KERMIT of "k" (0x6B) alone is 0xDDD5: by another implementation. 0x55 goes as 56 AA.
    assert (made.result, made.data) == (OK, bytes.fromhex("55 6B D5 DD 02 56 AA"))
    process.close()


BITS_AHEAD = """
protocol: bits_ahead
endpoints: {pc: Computer}
byte_order: big
frame:
  start: {literal: 0x7E, unprotected: in_front}
  head:
    type: uint8
    bits:
      sum: {bits: 0..3, algorithm: xor-8, covers: payload, takes: 0..3}
      flow: {bits: 4..6, default: 5}
  payload: {}
  end: {literal: 0x7D, unprotected: in_front}
transparency: {covers: payload, encoding: base16-upper}
messages:
  speed: {from: pc, fields: {speed: uint16}}
decisions:
  in_front:
    question: Can 7E and 7D stand in front of the payload?
    document: Only the payload goes as digits.
    choice: Yes.
    because: The sum tells wrong starts.
"""


def test_a_checksum_may_stand_in_bits_in_front_of_what_is_stuffed(tmp_path: Path) -> None:
    """It is not known before the payload is, unlike other bytes in front."""
    process = Process(compiled(BITS_AHEAD, tmp_path))
    made = process.do(process.calls.frame("pc", "speed", {"speed": 0x1234}, {"flow": 3}))
    # 12 xor 34 is 26, of which 6 is taken; flow 3 stands above it: 36. The digits are "1234".
    assert (made.result, made.data) == (OK, bytes.fromhex("7E 36 31 32 33 34 7D"))
    process.close()
