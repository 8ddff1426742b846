# The shape of a generated module, written by hand. Not all messages are here.
"""Matty serial protocol, version 2, in Robbus frames.

The PC sends commands, each with a counter. The ESP confirms each with that counter, and sends its
status periodically and GPS sentences as they arrive. 115200 baud, 8 data bits, no parity, 1 stop
bit; call `Decoder.flush` after 20 ms of silence.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, overload

from protogen.runtime import api as rt
from protogen.runtime import checksum, transparency
from protogen.runtime import constructs as c

DecodeError = rt.DecodeError
EncodeError = rt.EncodeError
InvalidEvent = rt.InvalidEvent
MessageEvent = rt.MessageEvent
UnknownEvent = rt.UnknownEvent

SPEC_HASH = "0f1e2d3c4b5a6978"


# --- named values -----------------------------------------------------------------------------


class RobotMode(rt.OpenEnum):
    """Mode of the robot (line 18)."""

    IDLE = 0
    REMOTE = 1
    AUTONOMOUS = 2


class StatusStatus(rt.Flags):
    """Flags of the status (lines 34-43)."""

    EMERGENCY_STOP = 0x01
    VOLTAGE_LOW = 0x02
    BUMPER_FRONT = 0x04
    BUMPER_BACK = 0x08
    ERROR_ENCODER = 0x10
    ERROR_POWER = 0x20
    RUNNING = 0x80


# --- messages of pc -----------------------------------------------------------------------------


@dataclass(slots=True, kw_only=True)
class Stop(rt.Message):
    """Stops the robot (line 16).

    Switches the drives off.
    """

    NAME = "stop"
    SENDERS = ("pc",)
    IDENTITY = (0x53,)  # command S
    SIZES = rt.Sizes(0, 0)
    FORMAT = c.Struct()
    RULES = ()


@dataclass(slots=True, kw_only=True)
class Mode(rt.Message):
    """Sets the robot's mode (line 18)."""

    mode: RobotMode | int
    """The mode to take (line 18)."""

    NAME = "mode"
    SENDERS = ("pc",)
    IDENTITY = (0x4D,)  # command M
    SIZES = rt.Sizes(1, 1)
    FORMAT = c.Struct(
        "mode" / c.Int(8),
    )
    RULES = (("mode", rt.IntegerRule(8, named=RobotMode)),)


@dataclass(slots=True, kw_only=True)
class Go(rt.Message):
    """Sets the driving speed and the wanted angle of the joint (line 19)."""

    speed: int
    """Driving speed, mm/s, -32768..32767 (line 19)."""
    steer: int
    """Wanted angle of the joint, 0.01 deg, -32768..32767 (line 19)."""

    NAME = "go"
    SENDERS = ("pc",)
    IDENTITY = (0x47,)  # command G
    SIZES = rt.Sizes(4, 4)
    FORMAT = c.Struct(
        "speed" / c.Int(16, signed=True, order="little"),
        "steer" / c.Int(16, signed=True, order="little"),
    )
    RULES = (
        ("speed", rt.IntegerRule(16, signed=True, unit="mm/s")),
        ("steer", rt.IntegerRule(16, signed=True, scale=Fraction(1, 100), unit="deg")),
    )

    steer_deg = rt.Physical("steer")
    """Wanted angle of the joint in deg, -327.68..327.67."""


# --- messages of esp ----------------------------------------------------------------------------


@dataclass(slots=True, kw_only=True)
class Ack(rt.Message):
    """Confirms a command (lines 26-29).

    The frame's counter is that of the command.
    """

    NAME = "ack"
    SENDERS = ("esp",)
    IDENTITY = (0x41,)  # command A
    SIZES = rt.Sizes(0, 0)
    FORMAT = c.Struct()
    RULES = ()


@dataclass(slots=True, kw_only=True)
class Status(rt.Message):
    """State of the robot (lines 31-34).

    Sent regularly, with the period of the timing message.
    """

    status: StatusStatus | int
    """Flags (lines 34-43)."""
    mode: RobotMode | int
    """The mode that the robot is in (lines 33-34)."""
    voltage: int
    """Voltage, mV, 0..65535 (lines 33-34)."""
    current: int
    """Current, mA, 0..65535 (lines 33-34)."""
    speed: int
    """Speed, mm/s, -32768..32767 (lines 33-34)."""
    angle: int
    """Angle of the joint, 0.01 deg, -32768..32767 (lines 33-34)."""
    encoder0: int
    """Way of the first encoder, mm, 0..65535 (lines 33-34)."""
    encoder1: int
    """Way of the second encoder, mm, 0..65535 (lines 33-34)."""
    encoder2: int
    """Way of the third encoder, mm, 0..65535 (lines 33-34)."""
    encoder3: int
    """Way of the fourth encoder, mm, 0..65535 (lines 33-34)."""

    NAME = "status"
    SENDERS = ("esp",)
    IDENTITY = (0x49,)  # command I
    SIZES = rt.Sizes(18, 18)
    FORMAT = c.Struct(
        "status" / c.Int(8),
        "mode" / c.Int(8),
        "voltage" / c.Int(16, order="little"),
        "current" / c.Int(16, order="little"),
        "speed" / c.Int(16, signed=True, order="little"),
        "angle" / c.Int(16, signed=True, order="little"),
        "encoder0" / c.Int(16, order="little"),
        "encoder1" / c.Int(16, order="little"),
        "encoder2" / c.Int(16, order="little"),
        "encoder3" / c.Int(16, order="little"),
    )
    RULES = (
        ("status", rt.IntegerRule(8, named=StatusStatus)),
        ("mode", rt.IntegerRule(8, named=RobotMode)),
        ("voltage", rt.IntegerRule(16, unit="mV")),
        ("current", rt.IntegerRule(16, unit="mA")),
        ("speed", rt.IntegerRule(16, signed=True, unit="mm/s")),
        ("angle", rt.IntegerRule(16, signed=True, scale=Fraction(1, 100), unit="deg")),
        ("encoder0", rt.IntegerRule(16, unit="mm")),
        ("encoder1", rt.IntegerRule(16, unit="mm")),
        ("encoder2", rt.IntegerRule(16, unit="mm")),
        ("encoder3", rt.IntegerRule(16, unit="mm")),
    )

    angle_deg = rt.Physical("angle")
    """Angle of the joint in deg, -327.68..327.67."""


@dataclass(slots=True, kw_only=True)
class Gps(rt.Message):
    """A sentence of the GPS receiver (lines 45-48).

    Sent as soon as it has arrived.
    """

    nmea: str
    """The whole sentence, from $ to CR LF; at most 121 characters (lines 47-48)."""

    NAME = "gps"
    SENDERS = ("esp",)
    IDENTITY = (0x50,)  # command P
    SIZES = rt.Sizes(0, 121)
    FORMAT = c.Struct(
        "nmea" / c.Latin1Fill(121),
    )
    RULES = (("nmea", rt.TextRule(greatest=121)),)


# --- frames -------------------------------------------------------------------------------------


class Parts(rt.Frozen):
    """The parts of a frame that are no message's field."""

    __slots__ = ("command", "counter")

    counter: int
    """Counts what the sender sends; an acknowledgement has the counter of its command."""
    command: int
    """Which command or message this is."""

    def __init__(self, counter: int, command: int) -> None:
        self._set(counter, command)


FRAME = rt.FrameSpec(
    parts=(
        rt.LiteralPart("sync", b"\x55"),
        rt.LengthPart(
            "length", rt.Number(8), counts=("counter", "command", "payload"), least=2, greatest=123
        ),
        rt.CounterPart("counter", rt.Number(8), least=0, greatest=255),
        rt.IdentityPart("command", rt.Number(8)),
        rt.PayloadPart("payload"),
        rt.ChecksumPart(
            "crc",
            rt.Number(8),
            algorithm=checksum.Sum(negated=True),
            covers=("length", "counter", "command", "payload"),
        ),
    ),
    start=rt.StartLiteral(b"\x55", protected=True),
    end=None,
    transparency=transparency.Escape(0x56, frozenset(b"\x55\x56"), "invert"),
    stuffed=("length", "counter", "command", "payload", "crc"),
    least=5,
    greatest=251,
    greatest_payload=121,
)

# --- the codec ----------------------------------------------------------------------------------

PcMessage = Stop | Mode | Go
EspMessage = Ack | Status | Gps
Sender = Literal["pc", "esp"]

PC_SENDER: rt.SenderSpec[PcMessage, Parts] = rt.SenderSpec(
    "pc", FRAME, Parts, messages=(Stop, Mode, Go)
)
ESP_SENDER: rt.SenderSpec[EspMessage, Parts] = rt.SenderSpec(
    "esp", FRAME, Parts, messages=(Ack, Status, Gps)
)
PC_FORMAT = rt.FrameFormat(PC_SENDER)
ESP_FORMAT = rt.FrameFormat(ESP_SENDER)
PROTOCOL: rt.Protocol[PcMessage | EspMessage, Parts] = rt.Protocol(
    "matty", PC_SENDER, ESP_SENDER, spec_hash=SPEC_HASH
)


def encode(
    message: PcMessage | EspMessage,
    sender: Sender | None = None,
    strict: bool = True,
    *,
    counter: int | None = None,
) -> bytes:
    """The frame of a message.

    `counter` (0..255) has to be given; an `Encoder` counts by itself. Raises EncodeError where a
    value is out of range; with `strict=False` only where it does not fit the wire.
    """
    return PROTOCOL.encode(message, sender, strict, counter=counter)


@overload
def decode(frame: bytes, sender: Literal["pc"]) -> PcMessage: ...
@overload
def decode(frame: bytes, sender: Literal["esp"]) -> EspMessage: ...
@overload
def decode(frame: bytes, sender: Sender) -> PcMessage | EspMessage: ...
def decode(frame: bytes, sender: Sender) -> PcMessage | EspMessage:
    """The message of exactly one frame. Raises DecodeError with offset, path and reason."""
    return PROTOCOL.decode(frame, sender)


class Decoder(rt.Decoder[rt.MessageT_co, rt.PartsT_co]):
    """Cuts what one endpoint sends into events: `feed(bytes)`, and `flush()` after a silence."""

    @overload
    def __init__(self: Decoder[PcMessage, Parts], sender: Literal["pc"]) -> None: ...
    @overload
    def __init__(self: Decoder[EspMessage, Parts], sender: Literal["esp"]) -> None: ...
    @overload
    def __init__(self: Decoder[PcMessage | EspMessage, Parts], sender: Sender) -> None: ...
    def __init__(self, sender: Sender) -> None:
        super().__init__(PROTOCOL.sender(sender))


class Encoder(rt.Encoder):
    """Makes the frames of one endpoint and advances its counter."""

    def __init__(self, sender: Sender) -> None:
        super().__init__(PROTOCOL.sender(sender))

    def encode(
        self,
        message: PcMessage | EspMessage,
        strict: bool = True,
        *,
        counter: int | None = None,
    ) -> bytes:
        """The next frame. A given counter is used once and does not change the count."""
        return self.encode_next(message, strict, counter=counter)
