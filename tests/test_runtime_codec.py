"""Encoding and decoding with a module of the generated shape, and its construct layer."""

import json
import struct
from dataclasses import dataclass
from typing import Any

import construct
import handwritten_framings as framings
import handwritten_matty as matty
import handwritten_rn1 as rn1
import pytest

from protogen.runtime import api as rt
from protogen.runtime import constructs as c
from protogen.runtime.checksum import Sum
from protogen.runtime.transparency import Escape


def encode_error(action: Any, *arguments: Any, **named: Any) -> rt.EncodeError:
    with pytest.raises(rt.EncodeError) as caught:
        action(*arguments, **named)
    return caught.value


def changed(spec: Any, **changes: Any) -> Any:
    """A sender that differs in this."""
    names = ("name", "frame", "parts", "messages", "encode_only", "cut")
    return rt.SenderSpec(**({name: getattr(spec, name) for name in names} | changes))


def decode_error(module: Any, wire: str, sender: str) -> rt.DecodeError:
    with pytest.raises(rt.DecodeError) as caught:
        module.decode(bytes.fromhex(wire), sender)
    return caught.value


# Each byte by hand from the documents.
@pytest.mark.parametrize(
    ("module", "sender", "message", "parts", "wire"),
    [
        # 06 + 01 + 47 + F4 + 01 + 06 + FF = 248, and B8 makes it 300.
        (matty, "pc", matty.Go(speed=500, steer=-250), {"counter": 1}, "55 0601 47 F401 06FF B8"),
        # 02 + 55 + 53 = AA; the sum's complement is 56; 55 and 56 are escaped as 56 AA, 56 A9.
        (matty, "pc", matty.Stop(), {"counter": 0x55}, "55 02 56AA 53 56A9"),
        (matty, "pc", matty.Mode(mode=matty.RobotMode.REMOTE), {"counter": 2}, "55 03 02 4D 01 AD"),
        (matty, "esp", matty.Ack(), {"counter": 1}, "55 02 01 41 BC"),
        (matty, "esp", matty.Gps(nmea="$U\r\n"), {"counter": 0}, "55 06 00 50 24 56AA 0D 0A 1A"),
        (rn1, "brain", rn1.Gyro(status=1, int_x=-5, int_y=0, int_z=812), {},
         "80 01 7B 7F 00 00 2C 06"),
        (rn1, "host", rn1.MoveManual(speed=-64, arc=63), {}, "80 40 3F FF"),
        (rn1, "host", rn1.MoveRelativeTwostep(angle=1440, forward=-1), {}, "81 20 0B 7F 7F FF"),
        (rn1, "host", rn1.Maintenance(operation=0x52, argument=None), {}, "FE 42 11 7A 52 FF"),
        (rn1, "host",
         rn1.Maintenance(
             operation=rn1.MaintenanceOperation.RECONFIG_UART,
             argument=rn1.MaintenanceArgumentReconfigUart(baud_rate_register=0xC0DE),
         ), {}, "FE 42 11 7A 41 5E 01 03 FF"),
        (rn1, "host", rn1.Maintenance(operation=5, argument=b"\1\2"), {},
         "FE 42 11 7A 05 01 02 FF"),
    ],
)  # fmt: skip
def test_frames_are_as_computed_by_hand(
    module: Any, sender: str, message: rt.Message, parts: dict[str, int], wire: str
) -> None:
    frame = bytes.fromhex(wire)
    assert module.encode(message, **parts) == frame
    assert module.encode(message, sender, **parts) == frame
    assert module.decode(frame, sender) == message


def test_a_part_without_a_value_says_how_to_give_it() -> None:
    error = encode_error(matty.encode, matty.Ack())
    assert error.path == "counter"
    assert "encode(..., counter=0)" in error.problem
    assert "Encoder" in error.problem
    plain = rt.ValuePart("number", framings.BYTE, least=1, greatest=9)
    spec = framings.rflex().frame._replace(parts=(plain, framings.PAYLOAD))
    sender: Any = rt.SenderSpec("a", spec, dict, (framings.empty(),))
    error = encode_error(rt.Protocol("p", sender).encode, sender.messages[0]())
    assert error.problem == "the value is missing; give it as in encode(..., number=1)"


def test_a_part_with_a_default_need_not_be_given() -> None:
    sender = framings.rflex()
    protocol = rt.Protocol("rflex", sender)
    frame = protocol.encode(sender.messages[0]())
    assert frame == bytes.fromhex("1B 02 01 FF 1B 00 00 00 1B 03")
    assert protocol.encode(sender.messages[0](), number=3)[3] == 3


@pytest.mark.parametrize(
    ("message", "named", "path", "says"),
    [
        (matty.Go(speed=40000, steer=0), {"counter": 0}, "speed", "-32768..32767 (mm/s)"),
        (matty.Ack(), {"counter": 256}, "counter", "0..255"),
        (matty.Ack(), {"counter": "1"}, "counter", "integer"),
        (matty.Ack(), {"counter": 1.0}, "counter", "must be an integer, not 1.0"),
        (matty.Ack(), {"counter": 1, "sender": "pc"}, "message", "pc does not send Ack"),
        (matty.Gps(nmea="x" * 122), {"counter": 1}, "nmea", "at most 121"),
    ],
)
def test_what_can_not_be_sent_is_refused(
    message: Any, named: dict[str, Any], path: str, says: str
) -> None:
    error = encode_error(matty.encode, message, **named)
    assert error.path == path
    assert says in error.problem


def test_messages_of_another_protocol_and_unknown_parts_are_refused() -> None:
    protocol = matty.PROTOCOL
    assert "matty has no message Gyro" in str(
        encode_error(protocol.encode, rn1.Gyro(status=1, int_x=0, int_y=0, int_z=0))
    )
    error = encode_error(protocol.encode, matty.Ack(), counter=1, number=2)
    assert (error.path, error.problem) == ("number", "there is no such part; there are: counter")
    error = encode_error(rn1.PROTOCOL.encode, rn1.MoveManual(speed=0, arc=0), counter=1)
    assert error.problem == "there is no such part; there are: none"


def test_lenient_encoding_takes_what_fits_the_wire() -> None:
    message = rn1.Maintenance(
        operation=0x53,
        argument=rn1.MaintenanceArgumentRunMotorControllerFlasher(motor_controller=15),
    )
    assert encode_error(rn1.encode, message).path == "argument.motor_controller"
    frame = rn1.encode(message, strict=False)
    assert frame == bytes.fromhex("FE 42 11 7A 53 0F FF")
    assert rn1.decode(frame, "host") == message


@pytest.mark.parametrize(
    ("module", "sender", "wire", "reason", "offset", "path"),
    [
        (matty, "esp", "55 02 01 41 BD", "checksum", 4, ""),
        (matty, "esp", "55 02 01 5A A3", "unknown", 0, ""),
        (matty, "esp", "55 02 01 41 BC 00", "size", 5, ""),
        (matty, "esp", "55 02 01", "truncated", 3, ""),
        (matty, "esp", "00 55 02 01 41 BC", "noise", 0, ""),
        (matty, "esp", "", "noise", 0, ""),
        (matty, "esp", "55 01", "length", 1, ""),
        (matty, "esp", "55 56 00", "stuffing", 2, ""),
        (rn1, "brain", "05 01", "noise", 0, ""),
        (rn1, "brain", "", "noise", 0, ""),
        (rn1, "brain", "80 01 FF", "encoding", 2, ""),
        (rn1, "host", "FE 42 11 7B 52 FF", "value", 1, "magic"),
        (rn1, "host", "FE 42 11 7A 41 5E 01 04 FF", "value", 5, "argument.baud_rate_register"),
        (rn1, "host", "FE 42 11 7A 51 00 FF", "size", 5, ""),
    ],
)
def test_what_is_no_frame_says_where_and_why(
    module: Any, sender: str, wire: str, reason: str, offset: int, path: str
) -> None:
    error = decode_error(module, wire, sender)
    assert (error.reason, error.offset, error.path) == (reason, offset, path)
    assert f"byte {offset}" in str(error)
    assert reason in str(error)


def test_offsets_count_stuffed_bytes() -> None:
    # The number 1B is sent as two bytes; the payload's first field is 100, which is not below 100.
    frame = bytes.fromhex("1B 02 01 1B 00 02 03 64 00 00 64 1B 03")
    with pytest.raises(rt.DecodeError) as caught:
        rt.Protocol("rflex", framings.rflex()).decode(frame, "a")
    assert (caught.value.offset, caught.value.path) == (7, "first")


def test_an_unknown_sender_is_named() -> None:
    with pytest.raises(ValueError, match="'robot' sends nothing in matty; pc and esp do"):
        matty.decode(b"", "robot")  # type: ignore[call-overload]


def test_an_encoder_counts_and_wraps() -> None:
    encoder = matty.Encoder("pc")
    counters = [encoder.encode(matty.Stop())[2] for _ in range(0x55)]
    assert counters == list(range(0x55))
    for _ in range(0x55, 256):
        frame = encoder.encode(matty.Stop())
    assert matty.PROTOCOL.read(frame, "pc").parts.counter == 255
    assert matty.PROTOCOL.read(encoder.encode(matty.Stop()), "pc").parts.counter == 0


def test_a_given_counter_and_an_error_do_not_count() -> None:
    encoder = matty.Encoder("esp")
    assert encoder.encode(matty.Ack(), counter=9)[2] == 9
    encode_error(encoder.encode, matty.Gps(nmea="\u0151"))
    encode_error(encoder.encode, matty.Stop())
    assert encoder.encode(matty.Ack())[2] == 0
    assert encoder.encode(matty.Ack())[2] == 1


def test_an_encoder_without_counters_only_encodes() -> None:
    assert rn1.Encoder("host").encode(rn1.MoveManual(speed=0, arc=0)).hex() == "800000ff"


def test_counters_start_at_their_default_and_wrap_to_their_least() -> None:
    counter = rt.CounterPart("counter", framings.BYTE, least=3, greatest=5, default=4)
    spec = matty.FRAME._replace(parts=(*matty.FRAME.parts[:2], counter, *matty.FRAME.parts[3:]))
    encoder = rt.Encoder(rt.SenderSpec("pc", spec, matty.Parts, (matty.Stop,)))
    assert [encoder.encode_next(matty.Stop())[2] for _ in range(4)] == [4, 5, 3, 4]


# --- several senders, overloads, unknown messages -----------------------------------------------


def both(message: type[rt.Message]) -> type[rt.Message]:
    message.SENDERS = ("a", "b")
    return message


def test_a_message_of_two_senders_needs_one_only_if_their_frames_differ() -> None:
    message = both(framings.empty(1))
    one = framings.ubx()
    first: Any = changed(one, messages=(message,))
    same: Any = changed(first, name="b")
    other: Any = changed(framings.slip_both_ends(), name="b", messages=(message,))
    protocol: rt.Protocol[Any, Any] = rt.Protocol("p", first, same)
    assert protocol.encode(message()) == protocol.encode(message(), "b")
    protocol = rt.Protocol("p", first, other)
    assert "a or b" in encode_error(protocol.encode, message()).problem
    assert protocol.encode(message(), "b") == bytes.fromhex("C0 01 01 C0")


def overloaded(*messages: type[rt.Message], encode_only: Any = ()) -> rt.Protocol[Any, Any]:
    spec: Any = changed(framings.ubx(), messages=messages, encode_only=encode_only)
    return rt.Protocol("p", spec)


def test_messages_of_one_identity_are_told_apart_by_size() -> None:
    empty, pair = framings.empty(1), framings.pair(1)
    protocol = overloaded(empty, pair)
    for message in (empty(), pair(first=1, second=-1)):  # type: ignore[call-arg]
        assert protocol.decode(protocol.encode(message), "a") == message
    wrong = framings.blob(1)(data=b"12345")  # type: ignore[call-arg]
    frame = overloaded(framings.blob(1)).encode_line(
        {"sender": "a", "message": "blob", "fields": wrong.to_dict()}
    )
    with pytest.raises(rt.DecodeError) as caught:
        protocol.decode(frame, "a")
    assert caught.value.reason == "size"


def test_messages_that_nothing_tells_apart_decode_as_one_of_them() -> None:
    blob, pair = framings.blob(1), framings.pair(1)
    protocol = overloaded(blob, encode_only=(pair,))
    frame = protocol.encode(pair(first=1, second=-1))  # type: ignore[call-arg]
    assert protocol.decode(frame, "a") == blob(data=bytes.fromhex("01 FF 1F"))  # type: ignore[call-arg]


def test_unknown_messages_can_be_sent_again() -> None:
    frame = bytes.fromhex("55 03 01 5A 07 9B")
    event = matty.PROTOCOL.read(frame, "esp")
    assert isinstance(event, matty.UnknownEvent)
    parts = {"counter": 1, "command": 0x5A}
    assert matty.PROTOCOL.encode_unknown("esp", parts, b"\x07") == frame


@pytest.mark.parametrize(
    ("module", "sender", "parts", "payload", "path"),
    [
        (matty, "esp", {"counter": 1}, b"", "command"),
        (matty, "esp", {"counter": 1, "command": 0x41}, b"", "command"),
        (matty, "esp", {"command": 0x5A}, b"", "counter"),
        (matty, "esp", {"command": 300, "counter": 1}, b"", "command"),
        (matty, "esp", {"counter": 1, "command": 0x5A}, bytes(122), "payload"),
        (rn1, "brain", {"start": 0x90}, b"\x80", "payload"),
        (rn1, "brain", {"start": 0x90}, b"\xff", "payload"),
        (rn1, "brain", {"start": 0x90}, bytes(721), "payload"),
    ],
)
def test_unknown_messages_that_no_decoder_would_see_are_refused(
    module: Any, sender: str, parts: dict[str, int], payload: bytes, path: str
) -> None:
    error = encode_error(module.PROTOCOL.encode_unknown, sender, parts, payload)
    assert error.path == path


def test_no_frame_is_unknown_where_none_has_an_identity() -> None:
    sender: Any = framings.uherobot()
    parts = tuple(p for p in sender.frame.parts if not isinstance(p, rt.IdentityPart))
    length = next(p for p in parts if isinstance(p, rt.LengthPart))
    counted = tuple(name for name in length.counts if name != "type")
    parts = tuple(p._replace(counts=counted) if p is length else p for p in parts)
    message = type("Alone", (sender.messages[0],), {"IDENTITY": (), "__slots__": ()})
    stuffed = tuple(name for name in sender.frame.stuffed if name != "type")
    frame = sender.frame._replace(parts=parts, stuffed=stuffed)
    alone = changed(sender, frame=frame, messages=(message,))
    error = encode_error(rt.Protocol("p", alone).encode_unknown, sender.name, {}, b"")
    assert "have no identity" in error.problem


def test_a_length_out_of_range_is_refused() -> None:
    short = framings.uherobot().frame._replace(parts=tuple(
        part._replace(least=4) if isinstance(part, rt.LengthPart) else part
        for part in framings.uherobot().frame.parts
    ))  # fmt: skip
    sender: Any = changed(framings.uherobot(), frame=short)
    error = encode_error(rt.Protocol("p", sender).encode, sender.messages[0]())
    assert error.path == "payload"
    assert "makes length 2, which is not in 4..255" in error.problem


def test_a_frame_that_a_decoder_would_end_elsewhere_is_refused() -> None:
    sender = framings.dagny()
    protocol = rt.Protocol("dagny", sender)
    blob = sender.messages[2]
    assert protocol.encode(blob(data=b"ab")) == b"\x03ab\x00\n"
    error = encode_error(protocol.encode, blob(data=b"a\nb"))
    assert error.path == "payload"
    # Behind 03 61 0A a decoder sees an end.
    assert "behind 3 of its 6 bytes" in error.problem
    newline = {"id": 0x0A}
    assert encode_error(protocol.encode_unknown, "a", newline, b"").path == "payload"
    unclear = encode_error(protocol.encode_unknown, "a", {"id": 9}, b"\n\n")
    assert unclear.path == "payload"


# --- JSON lines ---------------------------------------------------------------------------------


def test_lines_are_in_the_order_of_the_design() -> None:
    decoder = matty.Decoder("pc")
    lines = [
        json.dumps(event.as_json())
        for event in decoder.feed(bytes.fromhex("00 55 0601 47 F401 06FF B8 55 02 01 5A A3"))
    ]
    assert lines == [
        '{"offset": 0, "size": 1, "event": "invalid", "sender": "pc", "reason": "noise", '
        '"raw": "00"}',
        '{"offset": 1, "size": 9, "event": "message", "message": "go", "sender": "pc", '
        '"parts": {"counter": 1, "command": 71}, "fields": {"speed": 500, "steer": -250}}',
        '{"offset": 10, "size": 5, "event": "unknown", "sender": "pc", '
        '"parts": {"counter": 1, "command": 90}, "payload": ""}',
    ]


def lenient_matty() -> Any:
    stuffing = Escape(0x56, frozenset(b"\x55\x56"), "invert", lenient=True)
    return changed(matty.ESP_SENDER, frame=matty.FRAME._replace(transparency=stuffing))


@pytest.mark.parametrize(
    "wire",
    [
        "55 02 01 56BE BC",  # 56 BE stands for 41, which no encoder escapes.
        "55 02 01 56A5 A3",  # The same of an unknown message.
    ],
)
def test_a_line_has_raw_bytes_where_encoding_would_give_others(wire: str) -> None:
    sender = lenient_matty()
    frame = bytes.fromhex(wire)
    (event,) = rt.Decoder(sender).feed(frame)
    line = event.as_json()
    assert line["raw"] == wire.replace(" ", "").lower()
    assert rt.Protocol("matty", sender).encode_line(line) == frame


@dataclass(slots=True, kw_only=True)
class Level(rt.Message):
    level: float

    NAME = "level"
    SENDERS = ("a",)
    IDENTITY = (1,)
    SIZES = rt.Sizes(8, 8)
    FORMAT = c.Struct("level" / c.Float(64))
    RULES = (("level", rt.FloatRule(64)),)


@pytest.mark.parametrize(
    ("bits", "shown", "has_raw"),
    [
        (0x7FF8_0000_0000_0000, "nan", False),
        (0x7FF8_0000_DEAD_BEEF, "nan", True),
        (0xFFF0_0000_0000_0000, "-inf", False),
        (0x3FF0_0000_0000_0000, 1.0, False),
    ],
)
def test_the_payload_of_a_nan_is_kept_as_raw_bytes(bits: int, shown: Any, has_raw: bool) -> None:
    sender: Any = changed(framings.ubx(), messages=(Level,))
    frame = framings.ubx().frame
    sender = changed(sender, frame=frame._replace(greatest_payload=8))
    payload = struct.pack("<Q", bits)
    content = b"\x01\x08\x00" + payload
    wire = b"\xb5\x62" + content + framings.CRC16.compute(content).to_bytes(2, "little")
    (event,) = rt.Decoder(sender).feed(wire)
    line = json.loads(json.dumps(event.as_json(), allow_nan=False))
    assert line["fields"]["level"] == shown
    assert ("raw" in line) is has_raw
    assert rt.Protocol("p", sender).encode_line(line) == wire


LINE = {"sender": "pc", "event": "message", "message": "go", "parts": {"counter": 1},
        "fields": {"speed": 1, "steer": 2}}  # fmt: skip


@pytest.mark.parametrize(
    ("changes", "path"),
    [
        ({"sender": "robot"}, "sender"),
        ({"sender": None}, "sender"),
        ({"event": "invalid"}, "event"),
        ({"event": "noise"}, "event"),
        ({"message": "fly"}, "message"),
        ({"message": "ack"}, "message"),
        ({"fields": None}, "fields"),
        ({"fields": {"speed": 1}}, "fields.steer"),
        ({"fields": {"speed": 1, "steer": 99999}}, "fields.steer"),
        ({"parts": 5}, "parts"),
        ({"parts": {}}, "counter"),
        ({"parts": {"counter": 1, "other": 2}}, "other"),
        ({"raw": "5"}, "raw"),
        ({"raw": 5}, "raw"),
        ({"event": "unknown"}, "command"),
        ({"event": "unknown", "parts": {"command": 1, "counter": 1}}, "payload"),
        ({"event": "unknown", "parts": None}, "parts"),
    ],
)
def test_a_broken_line_says_what_is_wrong(changes: dict[str, Any], path: str) -> None:
    assert encode_error(matty.PROTOCOL.encode_line, {**LINE, **changes}).path == path


def test_a_line_needs_only_what_says_something() -> None:
    line = {"sender": "esp", "message": "ack", "parts": {"counter": 1}, "fields": {}}
    assert matty.PROTOCOL.encode_line(line) == bytes.fromhex("55 02 01 41 BC")
    without_parts = {"sender": "brain", "message": "gyro", "fields": {
        "status": "ok", "int_x": 0, "int_y": 0, "int_z": 0}}  # fmt: skip
    assert rn1.PROTOCOL.encode_line(without_parts) == bytes.fromhex("80 01 00 00 00 00 00 00")


# --- frames as construct declarations -----------------------------------------------------------


def test_a_frame_format_parses_and_builds_frames() -> None:
    frame = bytes.fromhex("55 02 56AA 53 56A9")
    parsed = matty.PC_FORMAT.parse(frame)
    assert parsed == {"counter": 0x55, "command": 0x53, "payload": b""}
    assert matty.PC_FORMAT.build(parsed) == frame
    assert matty.PC_FORMAT.build({"counter": 0x55, "command": 0x53}) == frame
    unknown = matty.PC_FORMAT.build({"counter": 1, "command": 0x5A, "payload": b"\7"})
    assert unknown == bytes.fromhex("55 03 01 5A 07 9B")


def test_a_frame_format_takes_exactly_one_frame_from_a_stream() -> None:
    log = construct.Struct(
        "time" / construct.Int16ub, "frame" / matty.PC_FORMAT, "rest" / construct.GreedyBytes
    )
    wire = bytes.fromhex("0102 55 02 01 53 AA 99")
    parsed = log.parse(wire)
    assert (parsed.frame.counter, parsed.rest) == (1, b"\x99")
    assert log.build(parsed) == wire
    frames = construct.GreedyRange(rn1.BRAIN_FORMAT)
    parsed = frames.parse(bytes.fromhex("90 01 02 80 01 00 00 00 00 00 00 91"))
    assert [(frame.start, len(frame.payload)) for frame in parsed] == [
        (0x90, 2),
        (0x80, 7),
        (0x91, 0),
    ]


@pytest.mark.parametrize(
    ("format", "wire", "reason"),
    [
        (matty.PC_FORMAT, "55 02 01 53 AB", "checksum"),
        (matty.PC_FORMAT, "55 02", "truncated"),
        (matty.PC_FORMAT, "54 02", "noise"),
        (matty.PC_FORMAT, "", "noise"),
        (rn1.HOST_FORMAT, "05 FF", "noise"),
    ],
)
def test_a_frame_format_says_what_is_wrong(format: Any, wire: str, reason: str) -> None:
    with pytest.raises(c.PayloadError) as caught:
        construct.Struct("frame" / format).parse(bytes.fromhex(wire))
    assert (caught.value.reason, caught.value.path) == (reason, "frame")


@pytest.mark.parametrize(
    ("values", "path"),
    [
        ({"counter": 1}, "frame.command"),
        ({"command": 0x53}, "frame.counter"),
        ({"command": 0x53, "counter": 1, "payload": bytes(200)}, "frame.payload"),
    ],
)
def test_a_frame_format_says_what_it_can_not_build(values: dict[str, Any], path: str) -> None:
    with pytest.raises(c.PayloadError) as caught:
        construct.Struct("frame" / matty.PC_FORMAT).build({"frame": values})
    assert caught.value.path == path


def test_checksums_may_cover_checksums() -> None:
    first = rt.ChecksumPart("first", framings.BYTE, Sum(), covers=("second", "payload"))
    second = rt.ChecksumPart("second", framings.BYTE, Sum(), covers=("payload",))
    spec = rt.FrameSpec(
        parts=(framings.literal(b"\xaa"), framings.ID, first, framings.PAYLOAD, second),
        start=rt.StartLiteral(b"\xaa", protected=False),
        end=None,
        least=4,
        greatest=10,
        greatest_payload=6,
    )
    sender: Any = rt.SenderSpec("a", spec, framings.Id, (framings.pair(2),))
    protocol = rt.Protocol("p", sender)
    message = sender.messages[0](first=1, second=2)
    frame = protocol.encode(message)
    assert frame == bytes.fromhex("AA 02 06 01 02 00 03")
    assert protocol.decode(frame, "a") == message


# --- what a sender is ---------------------------------------------------------------------------


def test_senders_are_compared_by_what_they_send() -> None:
    same = changed(matty.PC_SENDER)
    assert same == matty.PC_SENDER
    assert hash(same) == hash(matty.PC_SENDER)
    assert same != changed(same, name="other")
    assert same != changed(same, messages=(matty.Stop,))
    assert same != "pc"
    assert repr(same) == "<what pc sends: stop, mode, go>"


def test_a_frame_is_described_when_it_is_needed() -> None:
    calls: list[int] = []

    def frame() -> rt.FrameSpec:
        calls.append(1)
        return matty.FRAME

    sender = changed(matty.PC_SENDER, frame=frame)
    assert not calls
    assert sender.layout.spec is sender.frame is matty.FRAME
    assert calls == [1]
    assert sender == matty.PC_SENDER
