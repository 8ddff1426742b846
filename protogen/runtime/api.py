"""The names that generated modules, and those who use them, need.

What belongs to the reference is imported when it is first asked for.
"""

from typing import TYPE_CHECKING

from protogen.runtime.codec import Encoder, Protocol
from protogen.runtime.decoder import BytesLike, Decoder, Engine
from protogen.runtime.errors import CodecError, DecodeError, EncodeError, Reason
from protogen.runtime.events import Event, InvalidEvent, MessageEvent, UnknownEvent
from protogen.runtime.framing.frame import (
    AfterEnd,
    Anywhere,
    BitsPart,
    ChecksumPart,
    CounterPart,
    End,
    FrameSpec,
    IdentityPart,
    LengthPart,
    LiteralPart,
    MirrorBits,
    PayloadPart,
    StartLiteral,
    StartSet,
    StartWords,
    ToldPart,
    ValuePart,
    VirtualPart,
)
from protogen.runtime.framing.sender import MessageT_co, PartsT_co, SenderSpec
from protogen.runtime.identities import Identities
from protogen.runtime.lazy import importer, lazily
from protogen.runtime.line import Exchange, Line
from protogen.runtime.payload.enums import Flags, OpenEnum
from protogen.runtime.payload.message import Message, Record, Sizes
from protogen.runtime.payload.number import BitsNumber, Characters, Number
from protogen.runtime.payload.numerals import FreeNumeral, Numeral, Separated
from protogen.runtime.payload.physical import (
    BitRange,
    EnumRange,
    IfThere,
    Physical,
    PhysicalList,
    PhysicalListOrNone,
    PhysicalOrNone,
)
from protogen.runtime.values import OMITTED, Frozen, as_dict, count_of, replace

__all__ = [
    "OMITTED",
    "AfterEnd",
    "Anywhere",
    "ArrayRule",
    "BitRange",
    "BitsNumber",
    "BitsPart",
    "BoolRule",
    "BytesLike",
    "Characters",
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
    "Exchange",
    "FieldRules",
    "Flags",
    "FloatRule",
    "Formula",
    "Fraction",
    "FrameFormat",
    "FrameSpec",
    "FreeNumeral",
    "Frozen",
    "Identities",
    "IdentityPart",
    "IfThere",
    "IntegerRule",
    "InvalidEvent",
    "LengthPart",
    "Line",
    "LiteralPart",
    "Message",
    "MessageEvent",
    "MessageT_co",
    "MirrorBits",
    "Number",
    "Numeral",
    "OctetsRule",
    "OpenEnum",
    "OptionalRule",
    "PaddedText",
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
    "Separated",
    "Sizes",
    "StartLiteral",
    "StartSet",
    "StartWords",
    "StructRule",
    "SwitchRule",
    "TextRule",
    "ToldPart",
    "UnknownEvent",
    "ValuePart",
    "Violation",
    "VirtualPart",
    "WhenRule",
    "as_dict",
    "count_of",
    "lazily",
    "region_size",
    "replace",
]

if TYPE_CHECKING:
    from fractions import Fraction

    from protogen.runtime.framing.frame_format import FrameFormat
    from protogen.runtime.payload.formula import Formula
    from protogen.runtime.payload.number_rules import BoolRule, FloatRule, IntegerRule
    from protogen.runtime.payload.records import (
        ArrayRule,
        FieldRules,
        OptionalRule,
        StructRule,
        SwitchRule,
        WhenRule,
    )
    from protogen.runtime.payload.regions import region_size
    from protogen.runtime.payload.rules import Violation
    from protogen.runtime.payload.string_rules import OctetsRule, TextRule
    from protogen.runtime.payload.texts import PaddedText
else:
    __getattr__ = importer(
        globals(),
        {
            "fractions": ("Fraction",),
            ".framing.frame_format": ("FrameFormat",),
            ".payload.formula": ("Formula",),
            ".payload.number_rules": ("BoolRule", "FloatRule", "IntegerRule"),
            ".payload.records": (
                "ArrayRule",
                "FieldRules",
                "OptionalRule",
                "StructRule",
                "SwitchRule",
                "WhenRule",
            ),
            ".payload.regions": ("region_size",),
            ".payload.rules": ("Violation",),
            ".payload.string_rules": ("OctetsRule", "TextRule"),
            ".payload.texts": ("PaddedText",),
        },
    )
