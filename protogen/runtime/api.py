"""The names that generated modules, and those who use them, need."""

from protogen.runtime.codec import Encoder, Protocol
from protogen.runtime.decoder import Decoder, Engine
from protogen.runtime.enums import Flags, OpenEnum
from protogen.runtime.errors import CodecError, DecodeError, EncodeError, Reason
from protogen.runtime.events import Event, InvalidEvent, MessageEvent, UnknownEvent
from protogen.runtime.frame import (
    AfterEnd,
    Anywhere,
    ChecksumPart,
    CounterPart,
    End,
    FrameSpec,
    IdentityPart,
    LengthPart,
    LiteralPart,
    PayloadPart,
    StartLiteral,
    StartSet,
    ValuePart,
)
from protogen.runtime.frame_format import FrameFormat
from protogen.runtime.message import Message, Sizes
from protogen.runtime.number import Number
from protogen.runtime.physical import (
    BitRange,
    EnumRange,
    Physical,
    PhysicalList,
    PhysicalListOrNone,
    PhysicalOrNone,
)
from protogen.runtime.records import ArrayRule, FieldRules, Record, StructRule, SwitchRule
from protogen.runtime.rules import (
    BoolRule,
    FloatRule,
    IntegerRule,
    OctetsRule,
    TextRule,
    Violation,
)
from protogen.runtime.sender import MessageT_co, PartsT_co, SenderSpec

__all__ = [
    "AfterEnd",
    "Anywhere",
    "ArrayRule",
    "BitRange",
    "BoolRule",
    "ChecksumPart",
    "CodecError",
    "CounterPart",
    "DecodeError",
    "Decoder",
    "EncodeError",
    "Encoder",
    "End",
    "Engine",
    "EnumRange",
    "Event",
    "FieldRules",
    "Flags",
    "FloatRule",
    "FrameFormat",
    "FrameSpec",
    "IdentityPart",
    "IntegerRule",
    "InvalidEvent",
    "LengthPart",
    "LiteralPart",
    "Message",
    "MessageEvent",
    "MessageT_co",
    "Number",
    "OctetsRule",
    "OpenEnum",
    "PartsT_co",
    "PayloadPart",
    "Physical",
    "PhysicalList",
    "PhysicalListOrNone",
    "PhysicalOrNone",
    "Protocol",
    "Reason",
    "Record",
    "SenderSpec",
    "Sizes",
    "StartLiteral",
    "StartSet",
    "StructRule",
    "SwitchRule",
    "TextRule",
    "UnknownEvent",
    "ValuePart",
    "Violation",
]
