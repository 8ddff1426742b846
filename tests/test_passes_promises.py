"""Promises of the framing analysis, against frames that the generated code makes and reads."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from itertools import islice
from random import Random
from types import ModuleType

import pytest
from passes_support import HEAD, SCHEMAS, protocol_of, repository_protocol

from protogen.fuzzing.samples import samples
from protogen.live.codec import module_of
from protogen.model.framing import StartLiteral, StartSet
from protogen.model.protocol import Protocol, Sender
from protogen.runtime.attributes import arguments
from protogen.runtime.errors import EncodeError
from protogen.runtime.events import MessageEvent

NAMES = sorted(
    path.relative_to(SCHEMAS).with_suffix("").as_posix() for path in SCHEMAS.glob("**/*.yaml")
)
EACH = 12
"""Frames of each message, the boundaries of its values first."""

Frames = list[tuple[str, bytes]]
"""Names of messages, and their frames."""


@cache
def loaded(name: str) -> tuple[Protocol, ModuleType]:
    protocol = repository_protocol(name)
    return protocol, module_of(protocol)


def frames_of(module: ModuleType, sender: Sender, each: int = EACH) -> Frames:
    made: Frames = []
    for message in sender.messages:
        random = Random(message.name)
        for values, parts in islice(samples(message, sender.frame, random), each):
            given = module.MESSAGES[message.name].from_dict(values)
            try:
                wire = module.PROTOCOL.encode(given, sender.name, strict=False, **arguments(parts))
            except EncodeError:  # A decoder would cut it elsewhere.
                continue
            made.append((message.name, wire))
    return made


def senders(names: list[str] = NAMES) -> Iterator[tuple[ModuleType, Sender]]:
    for name in names:
        protocol, module = loaded(name)
        for sender in protocol.senders:
            yield module, sender


@pytest.mark.parametrize("name", NAMES)
def test_frames_are_as_long_as_the_analysis_says(name: str) -> None:
    for module, sender in senders([name]):
        bounds = {item.message: (item.least, item.greatest) for item in sender.framing.messages}
        for message, wire in frames_of(module, sender):
            least, greatest = bounds[message]
            assert least <= len(wire) <= greatest <= sender.framing.greatest, wire.hex(" ")


@pytest.mark.parametrize("name", NAMES)
def test_protected_delimiters_stand_nowhere_else(name: str) -> None:
    for module, sender in senders([name]):
        start, end = sender.framing.start, sender.framing.end
        for _, wire in frames_of(module, sender):
            if isinstance(start, StartLiteral) and start.protected:
                assert wire.startswith(start.bytes)
                assert wire.find(start.bytes, 1) == -1
            if isinstance(start, StartSet) and start.protected:
                assert wire.startswith(start.words)
                assert not any(word in wire[1:] for word in start.words)
            if end is not None and end.protected:
                assert wire.find(end.bytes) == len(wire) - len(end.bytes)


def unnoticed(module: ModuleType, sender: str, wire: bytes, after: bytes) -> set[int]:
    """Places where one wrong byte of a frame makes a decoder see nothing but messages.

    A good frame follows, as it does on a line.
    """
    found = set()
    for place in range(len(wire)):
        for byte in set(range(256)) - {wire[place]}:
            wrong = wire[:place] + bytes([byte]) + wire[place + 1 :]
            decoder = module.Decoder(sender=sender)
            events = [*decoder.feed(wrong + after), *decoder.flush()]
            if all(isinstance(event, MessageEvent) for event in events):
                found.add(place)
    return found


def short_frames(module: ModuleType, sender: Sender, longest: int = 24) -> Frames:
    made = [(name, wire) for name, wire in frames_of(module, sender, 3) if len(wire) <= longest]
    return made[:3]


@pytest.mark.parametrize("sender", ["pc", "esp"])
def test_a_sum_over_everything_notices_every_wrong_byte(sender: str) -> None:
    protocol, module = loaded("matty")
    made = short_frames(module, protocol.sender(sender))
    for _, wire in made:
        assert unnoticed(module, sender, wire, made[0][1]) == set()


@pytest.mark.parametrize("algorithm", ["CRC-16/XMODEM", "fletcher-16"])
def test_a_crc_notices_every_wrong_byte_and_fletcher_does_not(algorithm: str) -> None:
    text = f"""\
frame:
  id: {{type: uint8, id: true}}
  length: {{type: uint8, counts: payload}}
  payload: {{}}
  check: {{type: uint16, algorithm: {algorithm}, covers: id..payload}}
  end: {{literal: 0x0A, unprotected: accepted}}
messages: {{gyro: {{id: 1, from: robot, fields: {{data: {{type: bytes, size: 3}}}}}}}}
decisions: {{accepted: {{question: Q, document: D, choice: C, because: B}}}}
"""
    module = module_of(protocol_of(HEAD + text))
    wire = module.encode(module.Gyro(data=b"\x00\x12\xff"))
    # Fletcher takes 00 for FF, in the first and the last byte of the data.
    expected = {2, 4} if algorithm == "fletcher-16" else set()
    assert unnoticed(module, "robot", wire, wire) == expected


def test_rflex_notices_all_but_what_it_says() -> None:
    protocol, module = loaded("rflex")
    for sender in protocol.senders:
        said = " ".join(sender.framing.undetected)
        assert all(f"`{part}`" in said for part in ("number", "subclass"))
        _, wire = short_frames(module, sender)[0]
        # Behind 1B 02 come class, number and subclass; the checksum covers none of them.
        assert {3} <= unnoticed(module, sender.name, wire, wire) <= {2, 3, 4}


def test_rn1_notices_no_wrong_byte_of_the_payload() -> None:
    protocol, module = loaded("rn1")
    brain = protocol.sender("brain")
    assert any("payload" in sentence for sentence in brain.framing.undetected)
    wire = next(wire for name, wire in frames_of(module, brain) if name == "facing")
    assert unnoticed(module, "brain", wire, wire) >= set(range(1, len(wire)))


def test_uherobot_notices_what_is_no_hex_digit() -> None:
    protocol, module = loaded("uherobot")
    made = short_frames(module, protocol.sender("board"))
    for _, wire in made:
        # b, two digits of the length, two of the type, the payload, e
        assert unnoticed(module, "board", wire, wire) == set(range(5, len(wire) - 1))
