"""Random schemas: their C compiles without a warning, and does what their Python does."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from random import Random
from types import ModuleType

import pytest
from amounts import SCHEMAS_IN_C, THOROUGH
from c_engine import Process, check_events
from c_library import held_of
from corpus import Material, stream_of
from hypothesis import HealthCheck, Phase, given, seed, settings
from schema_fuzzing import Schema, schemas
from schema_fuzzing.text import to_yaml
from test_c_decoder import steps_of

from protogen.compiler import compile_file
from protogen.fuzzing.c_calls import OK, RANGE, REFUSED, Encoded
from protogen.fuzzing.c_values import Unfit
from protogen.fuzzing.samples import Values, boundary_rounds, samples
from protogen.fuzzing.trips import same
from protogen.live.codec import module_of
from protogen.model.messages import Message
from protogen.model.protocol import Protocol, Sender
from protogen.runtime.attributes import arguments, held_arguments
from protogen.runtime.errors import EncodeError
from protogen.runtime.framing.frame import LiteralPart
from protogen.targets.c.options import EVENTS, COptions, Events

DRAWS = 26 if THOROUGH else 20
"""Few in one run, because what is drawn from one seed grows alike."""
SAMPLES = 12
STREAMS = 6
PIECES = 12
GREATEST = 2000
"""Longer payloads take long in Python, and are like shorter ones."""


@pytest.mark.usefixtures("fixed_draws")
@pytest.mark.parametrize("number", range(SCHEMAS_IN_C))
def test_a_random_schema_is_the_same_in_c(
    number: int, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.mktemp("drawn") / "drawn.yaml"

    @seed(number)
    @settings(
        max_examples=DRAWS,
        database=None,
        derandomize=False,
        phases=[Phase.generate, Phase.shrink] if THOROUGH else [Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(schemas())
    def each(schema: Schema) -> None:
        path.write_text(to_yaml(schema.data), encoding="utf-8", newline="")
        protocol = compile_file(path).protocol
        assert protocol is not None
        try:
            check_protocol(protocol, Random(number))
        except BaseException:
            sys.stdout.write(path.read_text(encoding="utf-8"))
            raise

    each()


def check_protocol(protocol: Protocol, dice: Random) -> None:
    """All messages, their frames, and streams of these."""
    options = COptions(events=dice.choice(["all", "all", "messages"]))
    process = Process(protocol, options)
    with imported(protocol) as module:
        frames: dict[str, list[bytes]] = {}
        for sender in protocol.senders:
            found = [f for m in sender.messages for f in frames_of(process, module, sender, m)]
            check_streams(process, module, sender.name, [sender], found, dice)
            frames[sender.name] = found
        for endpoint in protocol.sending:
            forms = protocol.forms(endpoint)
            if len(forms) > 1:
                found = [frame for form in forms for frame in frames[form.name]]
                check_streams(process, module, endpoint, forms, found, dice)
    process.close()


@contextmanager
def imported(protocol: Protocol) -> Iterator[ModuleType]:
    module = module_of(protocol)
    try:
        yield module
    finally:
        sys.modules.pop(module.__name__, None)


def frames_of(
    process: Process, module: ModuleType, sender: Sender, message: Message
) -> Iterator[bytes]:
    """Check payloads and frames of a message; yields those that can be sent."""
    dice = Random(f"{sender.name} {message.name}")
    rounds = min(SAMPLES, boundary_rounds(message, sender.frame)) + 4
    for values, parts in islice(samples(message, sender.frame, dice), rounds):
        payload = made(module.MESSAGES[message.name].from_dict(values).to_payload)
        try:
            encoded = process.do(process.calls.encode(message.name, values))
        except Unfit:
            encoded = Encoded(RANGE, b"")
        assert encoded == (Encoded(RANGE, b"") if payload is None else Encoded(OK, payload)), values
        if payload is None or len(payload) > GREATEST:
            continue
        check_payload(process, module, message, payload, held_of(message, values))
        frame = check_frame(process, module, sender, message, values, parts)
        if frame is not None:
            yield frame


def made(make: Callable[[], bytes]) -> bytes | None:
    """Frame that is made; None where the values are refused."""
    try:
        return make()
    except EncodeError:
        return None


def check_payload(
    process: Process, module: ModuleType, message: Message, payload: bytes, held: dict[str, int]
) -> None:
    decoded = process.do(process.calls.decode(message.name, payload, held))
    assert decoded.result == OK, payload.hex(" ")
    record = module.MESSAGES[message.name]
    expected = record.from_payload(payload, **held_arguments(held)).to_dict()
    assert same(decoded.values, expected), payload.hex(" ")


def check_frame(
    process: Process,
    module: ModuleType,
    sender: Sender,
    message: Message,
    values: Values,
    parts: Values,
) -> bytes | None:
    """The frame that both make, in a buffer and byte by byte."""
    record = module.MESSAGES[message.name].from_dict(values)
    frame = made(lambda: module.encode(record, sender.name, **arguments(parts)))
    encoded = process.do(process.calls.frame(sender.name, message.name, values, parts))
    assert encoded.intact
    if frame is None:
        assert encoded.result == REFUSED, f"{values} {parts}: Python refuses"
        return None
    assert (encoded.result, encoded.data) == (OK, frame), f"{values} {parts}: {frame.hex(' ')}"
    short = process.calls.frame(sender.name, message.name, values, parts, len(frame) - 1)
    assert process.do(short) == Encoded(REFUSED, b"")
    if process.calls.sends(sender.name, message.name):
        sent = process.do(process.calls.send(sender.name, message.name, values, parts))
        assert (sent.result, sent.data) == (OK, frame), (values, parts)
    return frame


def check_streams(
    process: Process,
    module: ModuleType,
    name: str,
    forms: Sequence[Sender],
    frames: list[bytes],
    dice: Random,
) -> None:
    """Frames, damaged frames and noise give the same events; `name` sends in these forms."""
    parts = [part for form in forms for part in module.PROTOCOL.sender(form.name).frame.parts]
    literals = b"".join(part.value for part in parts if isinstance(part, LiteralPart))
    marks = bytes(sorted({0, 1, 0xFF, 0x1B, *literals, *(frame[0] for frame in frames)}))
    material = Material(tuple(frame for frame in frames if len(frame) > 1), marks)
    for _ in range(STREAMS):
        data = bytes(dice.choice(marks) for _ in range(40))
        if material.frames:
            data = stream_of(material, dice, PIECES).data
        check_events(process, module, name, steps_of(data, dice))


# --- schemas that were drawn once, and are easily missed ------------------------------------------

DECISION = "decisions: {accepted: {question: Q, document: D, choice: C, because: B}}\n"
END_BEGINS_A_START = """
byte_bits: 7
frame:
  sync: {literal: {hex: 76 67 67}}
  kind: {type: byte, id: true}
  payload: {}
  end: {literal: {hex: 76}, unprotected: accepted}
transparency: {escape: {byte: 0x35, of: [0x35, 0x67, 0x76], transform: invert}}
messages:
  gyro: {id: 0, from: station, fields: {rate: byte, rest: {type: bytes, size: 4}}}
"""
IDENTITY_BEHIND_PAYLOAD = """
byte_bits: 7
byte_order: little
frame:
  start: {literal: {hex: FF}, unprotected: accepted}
  group: {type: byte, id: true}
  payload: {}
  kind: {type: uint8, id: true}
  end: {literal: {hex: FF}, unprotected: accepted}
messages:
  ping: {id: {group: 0, kind: 0}, from: station, fields: {echo: byte}}
"""
NOTHING_BUT_EMPTY_PAYLOADS = """
frame:
  sync: {literal: {hex: 7E}, unprotected: accepted}
  payload: {}
  sum: {type: uint32, byte_order: big, algorithm: CRC-32/ISO-HDLC, covers: payload, when: payload}
  end: {literal: {hex: 0A}, unprotected: accepted}
messages:
  beat: {from: station}
"""
SEVEN_BITS_AS_DIGITS = """
byte_bits: 7
frame:
  sync: {literal: {text: b}}
  length: {type: uint7, counts: payload}
  payload: {}
  sum: {type: uint7, algorithm: {sum: 7}, covers: payload}
transparency: {covers: length..sum, encoding: base16-upper}
messages:
  text: {from: station, fields: {text: {type: ascii, size: {fill: true, max: 40}}}}
"""

BITS_BEHIND_A_CHECKSUM_THAT_MAY_BE_ABSENT = """
frame:
  length: {type: uint8, counts: payload}
  payload: {}
  sum: {type: uint8, algorithm: sum-8, covers: payload, when: payload}
  tail:
    type: uint8
    bits:
      mark: {bits: 5..7, const: 5}
      low: {bits: 0..3, algorithm: xor-8, covers: length..sum, takes: 0..3}
messages:
  text: {from: station, fields: {text: {type: ascii, size: {fill: true, max: 40}}}}
"""

NOTHING_BUT_WHETHER_CONSTANTS_ARE_THERE = """
frame:
  length: {type: uint8, counts: payload}
  payload: {}
  sum: {type: uint8, algorithm: sum-8, covers: payload}
messages:
  mark: {from: station, fields: {tail: {optional: true, fields: {one: {type: uint8, const: 27}}}}}
"""
THE_SAME_IN_A_CASE = """
frame:
  length: {type: uint8, counts: payload}
  payload: {}
  sum: {type: uint8, algorithm: sum-8, covers: payload}
types:
  one: {fields: {one: {type: uint8, const: 27}}}
messages:
  mark:
    from: station
    fields:
      kind: {type: uint8, range: [0, 1]}
      value:
        switch: kind
        cases: {0: {fields: {tail: {type: one, optional: true}}}, 1: {fields: {}}}
"""
A_SIGNED_NUMBER_THAT_IS_NEVER_READ = """
frame:
  length: {type: uint8, counts: payload}
  payload: {}
  sum: {type: uint8, algorithm: sum-8, covers: payload}
messages:
  sized:
    from: station
    fields:
      size: uint8
      text: {fields: {text: {type: ascii, size: {fill: true, max: 3}}}, size: size}
      packed:
        fields: {speed: sint10, mark: {type: uint6, const: 5}}
        packed: msb_first
        count: {fill: true, max: 0}
"""
CHARACTERS_OF_ONE_SIZE_BETWEEN_SEPARATORS = """
frame:
  length: {type: uint8, counts: payload}
  payload: {}
  sum: {type: uint8, algorithm: sum-8, covers: payload}
messages:
  sides:
    from: station
    separator: ","
    fields:
      name: {type: ascii, size: {max: 3}}
      sides: {type: char, values: {left: L, right: R}, closed: true, count: 2}
      digits: {type: hexadecimal, count: {fill: true, max: 3}}
"""
VIRTUAL_AND_NOTHING_STUFFED_OVER_WIRE = """
frame:
  start: {literal: 0x55, unprotected: accepted}
  sum: {type: uint8, algorithm: sum-8, covers: [extra, end], over: wire}
  id: {type: uint8, id: true}
  extra: {type: uint8, virtual: true}
  payload: {}
  end: {literal: 0xC0}
transparency: slip
messages:
  ping: {id: 1, from: station, parts: {extra: 50}, fields: {text: {type: ascii, size: 2}}}
"""
NOTHING_BUT_A_LITERAL_BEHIND_A_START = """
byte_bits: 7
frame:
  start: {type: byte, id: true, range: [0x80, 0xFF]}
  version: {literal: 1}
  payload: {}
messages:
  state: {id: 0x8E, from: station, fields: {level: sint7}}
"""
A_START_OF_THREE_BYTES_THAT_ENDS_FRAMES = """
frame:
  start: {literal: {hex: AA 55 00}, unprotected: accepted}
  version: {literal: 1}
  id: {type: uint8, id: true}
  payload: {}
  sum: {type: uint8, algorithm: CRC-8/SMBUS, covers: id..payload}
messages:
  state: {id: 0x80, from: station, fields: {level: uint8}}
  calm: {id: 1, from: station}
"""
STARTS_OF_FOUR_BYTES = """
frame:
  start: {literal: {any_of: [{hex: AA 55 00 01}, {hex: AA 55 00 02}]}, unprotected: accepted}
  id: {type: uint8, id: true}
  payload: {}
  sum: {type: uint8, algorithm: CRC-8/SMBUS, covers: id..payload}
messages:
  state: {id: 0x80, from: station, fields: {level: uint8}}
  calm: {id: 1, from: station}
"""


def protocol_of(text: str, folder: Path) -> Protocol:
    path = folder / "drawn.yaml"
    path.write_text(f"protocol: drawn\nendpoints: {{station: Station}}{text}{DECISION}")
    protocol = compile_file(path).protocol
    assert protocol is not None
    return protocol


def test_an_end_of_an_unknown_message_starts_no_other(tmp_path: Path) -> None:
    """The last byte of what nobody asked for belongs to it, though a start begins alike."""
    protocol = protocol_of(END_BEGINS_A_START, tmp_path)
    process = Process(protocol, COptions(events="messages"))
    unknown, rest = "76 67 67 6C 1C 0A 7E 76", "67 67 00 20 1A 3A 0C 06 76"
    known = "76 67 67 00 01 02 03 04 05 76"
    with imported(protocol) as module:
        steps = [("feed", bytes.fromhex(unknown + rest + known)), ("flush",)]
        check_events(process, module, "station", steps)
    process.close()


def test_a_payload_whose_size_is_told_behind_it_may_hold_an_end(tmp_path: Path) -> None:
    protocol = protocol_of(IDENTITY_BEHIND_PAYLOAD, tmp_path)
    process = Process(protocol, COptions())
    sender = protocol.sender("station")
    with imported(protocol) as module:
        made = [
            check_frame(process, module, sender, sender.messages[0], {"echo": echo}, {})
            for echo in (0xFE, 0xFF)
        ]
    process.close()
    # A group of 00, FE, and a kind in two bytes of seven bits; an FF would end the frame.
    assert made == [bytes.fromhex("FF 00 FE 00 00 FF"), None]


def test_a_part_that_needs_a_payload_may_never_be_there(tmp_path: Path) -> None:
    """The checksum is longer than the greatest frame."""
    protocol = protocol_of(NOTHING_BUT_EMPTY_PAYLOADS, tmp_path)
    process = Process(protocol, COptions())
    sender = protocol.sender("station")
    with imported(protocol) as module:
        frame = check_frame(process, module, sender, sender.messages[0], {}, {})
        data = bytes.fromhex("7E 0A 00 7E 0A 7E 00 7E 0A")
        check_events(process, module, "station", [("feed", data), ("flush",)])
    process.close()
    assert frame == bytes.fromhex("7E 0A")


@pytest.mark.parametrize("events", EVENTS)
@pytest.mark.parametrize(
    "text", [A_START_OF_THREE_BYTES_THAT_ENDS_FRAMES, STARTS_OF_FOUR_BYTES], ids=["one", "several"]
)
def test_bytes_of_a_start_that_are_held_back_may_all_differ(
    text: str, events: Events, tmp_path: Path
) -> None:
    protocol = protocol_of(text, tmp_path)
    process = Process(protocol, COptions(events=events))
    with imported(protocol) as module:
        sender, frames = protocol.sender("station"), []
        for message in sender.messages:
            values, parts = next(samples(message, sender.frame, Random(1)))
            frames.append(check_frame(process, module, sender, message, values, parts) or b"")
        for size in range(1, 4):
            begun = frames[0][:size]
            data = frames[0] + begun + frames[1] + bytes.fromhex("AA 55 00 01 07 AA 55 00") + begun
            steps = [("push", data), ("flush",), ("feed", data), ("flush",)]
            check_events(process, module, "station", steps)
    process.close()


def test_a_start_that_tells_the_message_may_have_a_literal_behind_it(tmp_path: Path) -> None:
    protocol = protocol_of(NOTHING_BUT_A_LITERAL_BEHIND_A_START, tmp_path)
    process = Process(protocol, COptions(events="messages"))
    with imported(protocol) as module:
        data = bytes.fromhex("8E 01 07  8E 02 07  8F 01 07  8E 8E 01 7F  01 05")
        steps = [("push", data), ("feed", data), ("flush",)]
        check_events(process, module, "station", steps)
    process.close()


def test_bits_are_checked_behind_a_checksum_that_may_be_absent(tmp_path: Path) -> None:
    protocol = protocol_of(BITS_BEHIND_A_CHECKSUM_THAT_MAY_BE_ABSENT, tmp_path)
    process = Process(protocol, COptions())
    sender = protocol.sender("station")
    with imported(protocol) as module:
        made = [
            check_frame(process, module, sender, sender.messages[0], {"text": text}, {})
            for text in ("", "A")
        ]
        data = bytes.fromhex("00 80 00 A1 01 41 41 61 01 41 41 A0 00 A0 01 41 41 A1")
        check_events(process, module, "station", [("feed", data), ("flush",)])
    process.close()
    # Nothing but the length; 1 ^ 41 ^ 41.
    assert made == [bytes.fromhex("00 A0"), bytes.fromhex("01 41 41 A1")]


@pytest.mark.parametrize(
    ("text", "values", "wire"),
    [
        (NOTHING_BUT_WHETHER_CONSTANTS_ARE_THERE, {"tail": None}, b"\0\0"),
        (NOTHING_BUT_WHETHER_CONSTANTS_ARE_THERE, {"tail": {"one": 27}}, b"\x01\x1b\x1b"),
        (
            A_SIGNED_NUMBER_THAT_IS_NEVER_READ,
            {"size": 1, "text": {"text": "a"}, "packed": []},
            b"\x02\x01a\x62",
        ),
        (THE_SAME_IN_A_CASE, {"kind": 0, "value": {"tail": None}}, b"\x01\0\0"),
        (THE_SAME_IN_A_CASE, {"kind": 0, "value": {"tail": {"one": 27}}}, b"\x02\0\x1b\x1b"),
        (
            CHARACTERS_OF_ONE_SIZE_BETWEEN_SEPARATORS,
            {"name": "a", "sides": [82, 76], "digits": [1, 10]},
            b"\x09a,R,L,1,A\x21",  # 61 + 52 + 4C + 31 + 41 + 4 * 2C = 221
        ),
    ],
)
def test_a_value_is_read_as_it_was_written(
    text: str, values: Values, wire: bytes, tmp_path: Path
) -> None:
    """By the reader of payloads as well as by that of frames, and in C."""
    protocol = protocol_of(text, tmp_path)
    process = Process(protocol, COptions())
    sender = protocol.sender("station")
    (message,) = sender.messages
    with imported(protocol) as module:
        payload = wire[1:-1]
        assert module.MESSAGES[message.name].from_payload(payload).to_dict() == values
        check_payload(process, module, message, payload, {})
        assert check_frame(process, module, sender, message, values, {}) == wire
    process.close()


def test_a_sum_over_the_wire_may_cover_what_is_not_sent_and_an_end_alone(tmp_path: Path) -> None:
    protocol = protocol_of(VIRTUAL_AND_NOTHING_STUFFED_OVER_WIRE, tmp_path)
    process = Process(protocol, COptions())
    sender = protocol.sender("station")
    with imported(protocol) as module:
        frame = check_frame(process, module, sender, sender.messages[0], {"text": "ab"}, {})
    process.close()
    assert frame == bytes.fromhex("55 F2 01 61 62 C0")  # 32 + C0 = F2


@pytest.mark.parametrize("portion", [1, 3, 40])
def test_digits_of_a_byte_that_seven_bits_do_not_make_are_refused_at_once(
    portion: int, tmp_path: Path
) -> None:
    protocol = protocol_of(SEVEN_BITS_AS_DIGITS, tmp_path)
    process = Process(protocol, COptions())
    # A length of 16, A, and a byte of eight bits: the frame ends there.
    data = b"b1041F0" + b"41" * 14
    pieces = [data[at : at + portion] for at in range(0, len(data), portion)]
    with imported(protocol) as module:
        check_events(process, module, "station", [("feed", piece) for piece in pieces])
        decoder = module.Decoder()
        assert decoder.feed(data[:6]) == []
        (event,) = decoder.feed(data[6:7])
    process.close()
    assert (event.offset, event.size, event.reason) == (0, 7, "encoding")
