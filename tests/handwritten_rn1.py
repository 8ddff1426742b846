# The shape of a generated module, written by hand. Not all messages are here.
"""RN#1 brain serial link.

The link between the RN#1 BRAIN, a mobile robot's controller board, and its host computer. A byte
with its highest bit set starts a message and says which one it is; every byte behind it carries
seven bits. 115200 baud, 8 data bits, no parity, 1 stop bit.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal, overload

from protogen.runtime import api as rt
from protogen.runtime import constructs as c

DecodeError = rt.DecodeError
EncodeError = rt.EncodeError
InvalidEvent = rt.InvalidEvent
MessageEvent = rt.MessageEvent
UnknownEvent = rt.UnknownEvent

SPEC_HASH = "1f2e3d4c5b6a7988"


# --- named values -----------------------------------------------------------------------------


class MaintenanceOperation(rt.OpenEnum):
    """What to do (lines 44-56)."""

    RECONFIG_UART = 0x41
    """Set the UART's speed (lines 45-46)."""
    KILL_PWR = 0x51
    """Shuts the robot down if the battery is nearly empty, else resets the hardware (line 47)."""
    RUN_FLASHER = 0x52
    """Hands the line to the flasher (lines 48-51)."""
    RUN_MOTOR_CONTROLLER_FLASHER = 0x53
    """Hands the line to the flasher of a motor controller (lines 52-56)."""


class GyroStatus(rt.OpenEnum):
    """State of the gyroscope (line 62)."""

    OK = 1


class LidarStatus(rt.Flags):
    """State of the LIDAR (lines 87-89)."""

    INITIALIZED = 0x01
    """It should be working (line 88)."""
    SPEED_IN_SPEC = 0x02
    """Its speed is held within its limits (line 89)."""


# --- structs ------------------------------------------------------------------------------------


@dataclass(slots=True, kw_only=True)
class MaintenanceArgumentReconfigUart(rt.Record):
    """The speed (line 46)."""

    baud_rate_register: int
    """What the STM32F205 gets to hold in its baud rate register, 0..65535 (line 46)."""

    FORMAT = c.Struct(
        "baud_rate_register" / c.SevenBit(16, order="little"),
    )
    RULES = (("baud_rate_register", rt.IntegerRule(16)),)


@dataclass(slots=True, kw_only=True)
class MaintenanceArgumentRunMotorControllerFlasher(rt.Record):
    """The motor controller (line 53)."""

    motor_controller: int
    """Number of the motor controller, 1..4 (line 53)."""

    FORMAT = c.Struct(
        "motor_controller" / c.SevenBit(7),
    )
    RULES = (("motor_controller", rt.IntegerRule(7, least=1, greatest=4)),)


# --- messages of host ---------------------------------------------------------------------------


@dataclass(slots=True, kw_only=True)
class MoveManual(rt.Message):
    """MSG_MOVE_MANUAL: drive by hand, with a speed and an arc (lines 27-29)."""

    speed: int
    """0 stops, negative values drive backwards; -64..63 (line 28)."""
    arc: int
    """0 goes straight on, negative values turn left; -64..63 (line 29)."""

    NAME = "move_manual"
    SENDERS = ("host",)
    IDENTITY = (0x80,)  # start
    SIZES = rt.Sizes(2, 2)
    FORMAT = c.Struct(
        "speed" / c.SevenBit(7, signed=True),
        "arc" / c.SevenBit(7, signed=True),
    )
    RULES = (
        ("speed", rt.IntegerRule(7, signed=True)),
        ("arc", rt.IntegerRule(7, signed=True)),
    )


@dataclass(slots=True, kw_only=True)
class MoveRelativeTwostep(rt.Message):
    """MSG_MOVE_RELATIVE_TWOSTEP: turn on the spot, then drive straight (lines 31-34)."""

    angle: int
    """How far to turn, 1/16 deg, -8192..8191 (line 33)."""
    forward: int
    """How far to drive, negative is backwards, mm, -8192..8191 (line 34)."""

    NAME = "move_relative_twostep"
    SENDERS = ("host",)
    IDENTITY = (0x81,)  # start
    SIZES = rt.Sizes(4, 4)
    FORMAT = c.Struct(
        "angle" / c.SevenBit(14, signed=True, order="little"),
        "forward" / c.SevenBit(14, signed=True, order="little"),
    )
    RULES = (
        ("angle", rt.IntegerRule(14, signed=True, scale=Fraction(1, 16), unit="deg")),
        ("forward", rt.IntegerRule(14, signed=True, unit="mm")),
    )

    angle_deg = rt.Physical("angle")
    """How far to turn in deg, -512..511.9375."""


@dataclass(slots=True, kw_only=True)
class Maintenance(rt.Message):
    """MSG_MAINTENANCE: reconfigure the UART, cut the power or start a flasher (lines 42-56).

    Three magic bytes unlock it.
    """

    magic: list[int] = field(default_factory=lambda: [0x42, 0x11, 0x7A])
    """Magic key numbers, always 0x42, 0x11, 0x7A (line 43)."""
    operation: MaintenanceOperation | int
    """What to do (lines 44-56)."""
    argument: (
        MaintenanceArgumentReconfigUart
        | MaintenanceArgumentRunMotorControllerFlasher
        | bytes
        | None
    )
    """What the operation needs to know; the rest of the payload for unknown operations."""

    NAME = "maintenance"
    SENDERS = ("host",)
    IDENTITY = (0xFE,)  # start
    SIZES = rt.Sizes(4, 7)
    FORMAT = c.Struct(
        "magic" / c.Fixed(c.Counted(3, c.SevenBit(7)), [0x42, 0x11, 0x7A]),
        "operation" / c.SevenBit(7),
        "argument"
        / c.Cases(
            "operation",
            {
                0x41: MaintenanceArgumentReconfigUart.FORMAT,
                0x51: c.Pass,
                0x52: c.Pass,
                0x53: MaintenanceArgumentRunMotorControllerFlasher.FORMAT,
            },
            rest=c.OctetsFill(3, seven_bit=True),
        ),
    )
    RULES = (
        ("magic", rt.ArrayRule(rt.IntegerRule(7), count=3, const=[0x42, 0x11, 0x7A])),
        ("operation", rt.IntegerRule(7, named=MaintenanceOperation)),
        (
            "argument",
            rt.SwitchRule(
                "operation",
                {
                    0x41: rt.StructRule(MaintenanceArgumentReconfigUart),
                    0x51: None,
                    0x52: None,
                    0x53: rt.StructRule(MaintenanceArgumentRunMotorControllerFlasher),
                },
                rest=rt.OctetsRule(greatest=3),
            ),
        ),
    )


# --- messages of brain --------------------------------------------------------------------------


@dataclass(slots=True, kw_only=True)
class Gyro(rt.Message):
    """MSG_GYRO: readings of the three-axis gyroscope (lines 61-65)."""

    status: GyroStatus | int
    """State of the gyroscope (line 62)."""
    int_x: int
    """Integral of gyro X since the message before, -8192..8191 (line 63)."""
    int_y: int
    """Integral of gyro Y since the message before, -8192..8191 (line 64)."""
    int_z: int
    """Integral of gyro Z since the message before, -8192..8191 (line 65)."""

    NAME = "gyro"
    SENDERS = ("brain",)
    IDENTITY = (0x80,)  # start
    SIZES = rt.Sizes(7, 7)
    FORMAT = c.Struct(
        "status" / c.SevenBit(7),
        "int_x" / c.SevenBit(14, signed=True, order="little"),
        "int_y" / c.SevenBit(14, signed=True, order="little"),
        "int_z" / c.SevenBit(14, signed=True, order="little"),
    )
    RULES = (
        ("status", rt.IntegerRule(7, named=GyroStatus)),
        ("int_x", rt.IntegerRule(14, signed=True)),
        ("int_y", rt.IntegerRule(14, signed=True)),
        ("int_z", rt.IntegerRule(14, signed=True)),
    )


@dataclass(slots=True, kw_only=True)
class Lidar(rt.Message):
    """MSG_LIDAR: the latest full turn of the LIDAR (lines 85-90)."""

    status: LidarStatus | int
    """State of the LIDAR (lines 87-89)."""
    distances: list[int]
    """One distance for each point of the turn; 360 values in mm, 0 is no datapoint (line 90)."""

    NAME = "lidar"
    SENDERS = ("brain",)
    IDENTITY = (0x84,)  # start
    SIZES = rt.Sizes(721, 721)
    FORMAT = c.Struct(
        "status" / c.SevenBit(7),
        "distances" / c.Counted(360, c.SevenBit(14, order="little")),
    )
    RULES = (
        ("status", rt.IntegerRule(7, named=LidarStatus)),
        (
            "distances",
            rt.ArrayRule(rt.IntegerRule(14, special={"no_datapoint": 0}, unit="mm"), count=360),
        ),
    )


# --- frames -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Parts:
    """The parts of a frame that are no message's field."""

    start: int
    """Which message this is."""


HOST_FRAME = rt.FrameSpec(
    parts=(
        rt.IdentityPart("start", rt.Number(8)),
        rt.PayloadPart("payload"),
        rt.LiteralPart("stop", b"\xff"),
    ),
    start=rt.StartSet(0x80, 0xFE, protected=True),
    end=rt.End(b"\xff", protected=True),
    least=4,
    greatest=9,
    greatest_payload=7,
    seven_bit=True,
)

BRAIN_FRAME = rt.FrameSpec(
    parts=(
        rt.IdentityPart("start", rt.Number(8)),
        rt.PayloadPart("payload"),
    ),
    start=rt.StartSet(0x80, 0xFE, protected=True),
    end=None,
    least=8,
    greatest=722,
    greatest_payload=721,
    seven_bit=True,
)

# --- the codec ----------------------------------------------------------------------------------

HostMessage = MoveManual | MoveRelativeTwostep | Maintenance
BrainMessage = Gyro | Lidar
Sender = Literal["host", "brain"]

HOST_SENDER: rt.SenderSpec[HostMessage, Parts] = rt.SenderSpec(
    "host", HOST_FRAME, Parts, messages=(MoveManual, MoveRelativeTwostep, Maintenance)
)
BRAIN_SENDER: rt.SenderSpec[BrainMessage, Parts] = rt.SenderSpec(
    "brain", BRAIN_FRAME, Parts, messages=(Gyro, Lidar)
)
HOST_FORMAT = rt.FrameFormat(HOST_SENDER)
BRAIN_FORMAT = rt.FrameFormat(BRAIN_SENDER)
PROTOCOL: rt.Protocol[HostMessage | BrainMessage, Parts] = rt.Protocol(
    "rn1", HOST_SENDER, BRAIN_SENDER, spec_hash=SPEC_HASH
)


def encode(
    message: HostMessage | BrainMessage, sender: Sender | None = None, strict: bool = True
) -> bytes:
    """The frame of a message.

    Raises EncodeError where a value is out of range; with `strict=False` only where it does not
    fit the wire.
    """
    return PROTOCOL.encode(message, sender, strict)


@overload
def decode(frame: bytes, sender: Literal["host"]) -> HostMessage: ...
@overload
def decode(frame: bytes, sender: Literal["brain"]) -> BrainMessage: ...
@overload
def decode(frame: bytes, sender: Sender) -> HostMessage | BrainMessage: ...
def decode(frame: bytes, sender: Sender) -> HostMessage | BrainMessage:
    """The message of exactly one frame. Raises DecodeError with offset, path and reason."""
    return PROTOCOL.decode(frame, sender)


class Decoder(rt.Decoder[rt.MessageT_co, rt.PartsT_co]):
    """Cuts what one endpoint sends into events: `feed(bytes)`, and `flush()` after a silence."""

    @overload
    def __init__(self: Decoder[HostMessage, Parts], sender: Literal["host"]) -> None: ...
    @overload
    def __init__(self: Decoder[BrainMessage, Parts], sender: Literal["brain"]) -> None: ...
    @overload
    def __init__(self: Decoder[HostMessage | BrainMessage, Parts], sender: Sender) -> None: ...
    def __init__(self, sender: Sender) -> None:
        super().__init__(PROTOCOL.sender(sender))


class Encoder(rt.Encoder):
    """Makes the frames of one endpoint."""

    def __init__(self, sender: Sender) -> None:
        super().__init__(PROTOCOL.sender(sender))

    def encode(self, message: HostMessage | BrainMessage, strict: bool = True) -> bytes:
        """The next frame."""
        return self.encode_next(message, strict)
