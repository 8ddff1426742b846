"""The style in which a decoder is printed, row by row."""

from __future__ import annotations

from pathlib import Path

import pytest

from protogen.api import load
from protogen.targets.c.decoders.members import members_of
from protogen.targets.c.decoders.received import ReceivedFrame
from protogen.targets.c.decoders.style import DecoderStyle, decoder_style
from protogen.targets.c.emit import unit_of
from protogen.targets.c.frame.part_numbers import PartNumbers
from protogen.targets.c.options import COptions, Events
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.protocol_names import names_of

ROOT = Path(__file__).parent.parent
FLAT, DELIMITED, PUSH = DecoderStyle.FLAT, DecoderStyle.DELIMITED, DecoderStyle.PUSH


@pytest.mark.parametrize(
    ("schema", "sender", "events", "style"),
    [
        # A flat decoder says nothing of invalid bytes.
        ("schemas/rn1", "brain", "all", PUSH),
        # A byte of a set that stands nowhere else, and a size that it tells.
        ("schemas/rn1", "brain", "messages", FLAT),
        # An end that stands nowhere else tells the size of some payload: only then is it known.
        ("schemas/rn1", "host", "messages", DELIMITED),
        # The same where the end has two bytes.
        ("tests/framings/digit_parts", "station", "messages", DELIMITED),
        ("tests/framings/hex_lines", "station", "messages", DELIMITED),
        # The first of which may be stuffed.
        ("tests/framings/text_parts", "station", "messages", PUSH),
        # Start and end are told by what stands behind their common first byte.
        ("schemas/rflex", "linux", "messages", DELIMITED),
        # A start that nothing of a frame can be, and a length in the head.
        ("schemas/matty", "pc", "messages", FLAT),
        # Digits between a start and an end of one byte each.
        ("schemas/uherobot", "board", "messages", DELIMITED),
        # A set of starts whose bytes stand in frames, too: bytes have to be read again.
        ("tests/framings/bounded_length", "station", "messages", PUSH),
        # The same of a literal.
        ("tests/framings/sync_length_crc", "station", "messages", PUSH),
        # A frame starts where the one before ended, and ends with what may stand in its data.
        ("schemas/dagny", "host", "messages", PUSH),
        # It starts where the one before ended.
        ("tests/framings/slip_end_only", "station", "messages", DELIMITED),
        # The end is the next frame's start.
        ("tests/framings/hdlc", "station", "messages", DELIMITED),
        ("tests/framings/slip", "station", "messages", DELIMITED),
        # The bytes that follow decide what a byte is.
        ("tests/framings/cobs", "station", "messages", DELIMITED),
        # Somebody asks what was wrong.
        ("tests/framings/cobs", "station", "all", PUSH),
        # Nothing but a checksum tells a frame from other bytes.
        ("tests/framings/checksum_only", "station", "messages", PUSH),
        # And only a silence ends it.
        ("tests/framings/idle_end", "station", "messages", PUSH),
    ],
)
def test_the_style_of_a_decoder(
    schema: str, sender: str, events: Events, style: DecoderStyle
) -> None:
    protocol = load(ROOT / f"{schema}.yaml")
    names = names_of(protocol)
    plan, numbers = protocol.sender(sender).plan, PartNumbers(Helpers(names))
    frame = ReceivedFrame(names, sender, plan, groups=(), events=events, numbers=numbers)
    assert decoder_style(frame) is style


LAST_BYTE = """\
protocol: sample
byte_order: big
endpoints: {host: Host, board: Board}
frame:
  opening: {literal: 0x7E}
  id:      {type: uint8, id: true}
  length:  {type: uint8, counts: payload}
  payload: {}
CHECKS
transparency: {covers: id..check, escape: {byte: 0x7D, of: [0x7D, 0x7E], transform: invert}}
messages:
  reading: {from: board, id: 1, fields: {a: uint32}}
"""


@pytest.mark.parametrize(
    ("checks", "room"),
    [
        # It is compared as it comes.
        (["check: {type: uint8, algorithm: sum-8, covers: id..payload}"], 6),
        # Its last byte says nothing without its first.
        (["check: {type: uint16, algorithm: sum-16, covers: id..payload}"], 8),
        # Another checksum is summed over it, too.
        (
            [
                "first: {type: uint8, algorithm: xor-8, covers: [id, payload, check]}",
                "check: {type: uint8, algorithm: sum-8, covers: id..payload}",
            ],
            8,
        ),
        (
            [
                "first: {type: uint8, algorithm: xor-8, covers: id..payload}",
                "check: {type: uint8, algorithm: sum-8, covers: id..first}",
            ],
            7,
        ),
    ],
)
def test_a_checksum_that_is_the_last_byte_takes_no_room(
    checks: list[str], room: int, tmp_path: Path
) -> None:
    path = tmp_path / "sample.yaml"
    lines = "\n".join(f"  {line}" for line in checks)
    path.write_text(LAST_BYTE.replace("CHECKS", lines), encoding="utf-8")
    [decoder] = unit_of(load(path), COptions(events="messages")).framing.decoders
    [buffer] = [member for member in members_of(decoder) if member.name == "buffer"]
    assert decoder.flat
    assert buffer.count == room
