"""Frames: parts in wire order, and the transparency that protects them."""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag

from protogen.schema.syntax.base import (
    GREATEST_TEXT,
    BitRange,
    BitRangeForm,
    ByteForm,
    ByteNumber,
    Bytes,
    Character,
    Count,
    Int,
    Name,
    OnlyTrue,
    PartValue,
    RawNumber,
    ShortForm,
    SilenceText,
    SourceRef,
    Syntax,
    Text,
    pair_of,
    written_as,
)
from protogen.schema.syntax.digits import CharacterCode, FixedDigitsName, Positive
from protogen.schema.syntax.names import Kind, NumberPath, PartName, Ref
from protogen.schema.syntax.octets import Octets, OctetsForm, at_most

ByteOrder = Literal["little", "big"]

_RUN = re.compile(r"[a-z0-9_]+(\.\.[a-z0-9_]+)?")
_RunForm = Annotated[str, Field(pattern=f"^{_RUN.pattern}$")]
_PartType = Annotated[str, Field(pattern=r"^(uint([1-9]|[1-5][0-9]|6[0-4])|byte|char|ascii)$")]
"""The written form of a part's type: unsigned, as no bits of a frame are a sign."""


def _to_run(value: Any) -> Any:
    """`a..b` and one name become lists; the passes expand the dots, knowing the frame."""
    listed = tuple(value) if isinstance(value, list | tuple) else (value,)
    if listed and all(isinstance(item, str) and _RUN.fullmatch(item) for item in listed):
        return listed
    raise ValueError("expected a part, FIRST..LAST, or a list of parts")


PartRun = Annotated[
    tuple[PartName, ...],
    BeforeValidator(
        _to_run,
        json_schema_input_type=_RunForm | Annotated[list[_RunForm], Field(min_length=1)],
    ),
]
"""Some parts of the frame: one name, a run `first..last`, or a list of names."""


NumberName = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*(\.[a-z][a-z0-9_]*)?$"), NumberPath()]
"""MESSAGE.FIELD, or a part of some frame."""


def _to_names(value: Any) -> Any:
    return tuple(value) if isinstance(value, list | tuple) else (value,)


NumberNames = Annotated[
    tuple[NumberName, ...],
    BeforeValidator(
        _to_names,
        json_schema_input_type=NumberName | Annotated[list[NumberName], Field(min_length=1)],
    ),
    Field(min_length=1),
]
"""One of these, or a list of them."""


class CrcParameters(Syntax):
    """A checksum that no catalogue names: the Rocksoft parameters of a CRC."""

    width: Int = Field(ge=1, le=64, description="Width of the register in bits, 1 to 64.")
    poly: Count = Field(description="Generator polynomial without its highest bit.")
    init: Count = Field(0, description="What the register holds before the first byte.")
    refin: bool = Field(False, description="Whether bytes enter least significant bit first.")
    refout: bool = Field(False, description="Whether the register is reflected at the end.")
    xorout: Count = Field(0, description="What is XORed to the register at the end.")


class _FoldedParameters(Syntax):
    """Parameters that sums and exclusive ors share."""

    init: Count = Field(0, description="What there is before the first byte.")
    xorout: Count = Field(0, description="What is XORed to the result.")
    mask: Count | None = Field(None, description="The bits that are kept, behind `xorout`.")
    add: Count = Field(0, description="What is added at the end.")


class SumParameters(_FoldedParameters):
    """A sum that has no name."""

    sum: Int = Field(ge=1, le=64, description="Width of the sum in bits, 1 to 64.")
    negated: bool = Field(False, description="Whether it is what brings the sum to 0.")
    words: bool = Field(
        False, description="Whether words as wide as the sum (16 or 32 bits) are added, not bytes."
    )


class XorParameters(_FoldedParameters):
    """An exclusive or that has no name."""

    xor: Int = Field(
        ge=1, le=32, description="Width in bits: up to 8 of bytes, 16 or 32 of words as wide."
    )


def _written_as_mapping(value: Any) -> str:
    return "mapping" if isinstance(value, dict | Syntax) else "text"


def _kind_of_algorithm(value: Any) -> str:
    if isinstance(value, dict):
        kind = next((key for key in ("sum", "xor") if key in value), "crc")
        return f"parameters of {kind}"  # No key, or it would be taken for a place in the file.
    if isinstance(value, SumParameters):
        return "parameters of sum"
    if isinstance(value, XorParameters):
        return "parameters of xor"
    return "parameters of crc" if isinstance(value, CrcParameters) else "text"


Algorithm = Annotated[
    Annotated[Text, Tag("text")]
    | Annotated[CrcParameters, Tag("parameters of crc")]
    | Annotated[SumParameters, Tag("parameters of sum")]
    | Annotated[XorParameters, Tag("parameters of xor")],
    Discriminator(_kind_of_algorithm),
]
"""A checksum algorithm by name or by its parameters."""


RawRange = Annotated[
    tuple[RawNumber, RawNumber],
    BeforeValidator(
        pair_of("two values: [LEAST, GREATEST]"),
        json_schema_input_type=Annotated[list[int | Character], Field(min_length=2, max_length=2)],
    ),
]
"""The least and the greatest raw value, both included."""


class LiteralChoice(Syntax):
    """Several literals, of which a frame has one."""

    any_of: Annotated[tuple[Annotated[Octets, at_most(8)], ...], Field(strict=False)] = Field(
        description="The literals, all of one size: at most 8 bytes."
    )
    default: Annotated[Octets, at_most(8)] | None = Field(
        None, description="The one that an encoder writes where the caller gives none."
    )


def _kind_of_literal(value: Any) -> str:
    keys = {"any_of", "default"} & value.keys() if isinstance(value, dict) else ()
    return "choice of literals" if keys or isinstance(value, LiteralChoice) else "bytes"


Literals = Annotated[
    Annotated[Octets, at_most(64), Tag("bytes")]
    | Annotated[LiteralChoice, Tag("choice of literals")],
    Discriminator(_kind_of_literal),
]
"""Fixed bytes, or several literals of which a frame has one."""


def _stated(value: Any) -> Any:
    """What was written; a key without a value says as little as another word."""
    return "" if value is None else value


_Trimming = Annotated[
    Literal["trimmed"] | None,
    BeforeValidator(_stated, json_schema_input_type=Literal["trimmed"]),
]
"""How zeros at the end of a payload are left out."""

_Cutting = Annotated[
    Literal["cut"] | None,
    BeforeValidator(_stated, json_schema_input_type=Literal["cut"]),
]
"""What becomes of a payload that is longer than its message."""


class PartBits(Syntax):
    """Some bits of a part: a part of their own, a checksum, constant, or those of a number."""

    bits: BitRange = Field(description="Bit number, or LOW..HIGH counted from bit 0.")
    id: OnlyTrue | None = Field(None, description="The bits tell which message this is.")
    counts: PartRun | None = Field(
        None, description="The bits are the length in bytes of these parts, unstuffed."
    )
    counter: OnlyTrue | None = Field(
        None, description="The bits count frames; encoders advance them by one and wrap."
    )
    algorithm: Algorithm | None = Field(
        None, description="The bits are a checksum, or some bits of one: its algorithm."
    )
    covers: PartRun | None = Field(None, description="The parts that the checksum covers.")
    takes: BitRange | None = Field(
        None,
        description="The bits of the checksum that stand here: a bit number, or LOW..HIGH counted "
        "from bit 0. Without it, all of them.",
    )
    const: Count | None = Field(None, description="What the bits are in each frame.")
    repeats: PartName | None = Field(
        None,
        description="The number whose value the bits have: a part in front, or bits of one or of "
        "this part.",
    )
    complements: PartName | None = Field(
        None,
        description="The number whose value the bits have with each bit inverted: a part in front, "
        "or bits of one or of this part.",
    )
    range: RawRange | None = Field(None, description="Least and greatest value of the bits.")
    default: PartValue | None = Field(
        None, description="What an encoder writes where the caller gives no value."
    )
    doc: Text | None = Field(None, description="What the bits mean.")
    source: SourceRef | None = Field(None, description="Where the bits are written down.")


PartBitsRef = Annotated[
    PartBits,
    BeforeValidator(ShortForm("bits"), json_schema_input_type=BitRangeForm | PartBits),
]


class Part(Syntax):
    """One item of a frame. Its keys give its role; the part called `payload` holds the fields."""

    literal: Literals | None = Field(
        None,
        description="Fixed bytes that open, close or mark; `{any_of: [BYTES, ...]}` where there "
        "are several, of which a frame has one.",
    )
    unprotected: Annotated[Name, Ref(Kind.DECISION, missing="PG143")] | None = Field(
        None,
        description="The decision that accepts that this literal can also occur inside a frame; "
        "or, on a first part that is none, that nothing marks the start.",
    )
    type: Annotated[Text, written_as(_PartType), Ref(Kind.TYPE)] | None = Field(
        None, description="Type of the part: uint8, uint16, char, byte, ascii ..."
    )
    size: Annotated[Int, Field(ge=1, le=GREATEST_TEXT)] | None = Field(
        None, description="Characters of a part of the type ascii, 1 to 8."
    )
    digits: FixedDigitsName | None = Field(
        None,
        description="The number is written as text, the highest digit first: base10, "
        "base16-upper or base16-lower.",
    )
    chars: Positive | None = Field(
        None,
        description="Characters of a number that is written as text; else as many digits as its "
        "greatest value needs.",
    )
    code: CharacterCode | None = Field(
        None, description="Each character is some bits of the number, the highest ones first."
    )
    bits: Annotated[dict[Name, PartBitsRef], Field(min_length=1)] | None = Field(
        None,
        description="Bits of the number that are parts, or the same in each frame. Those that no "
        "name has are 0.",
    )
    id: OnlyTrue | None = Field(None, description="The part tells which message this is.")
    repeats: PartName | None = Field(
        None,
        description="The number in front whose value the part has, too: a part, or bits of one.",
    )
    complements: PartName | None = Field(
        None,
        description="The number in front whose value the part has with each bit inverted: a part, "
        "or bits of one.",
    )
    virtual: OnlyTrue | None = Field(
        None,
        description="The part goes into the checksums that cover it and is not sent; each message "
        "gives its value under `parts`, unless the part has a default.",
    )
    told: OnlyTrue | None = Field(
        None,
        description="The part tells which message this is or, with `counts`, how long the frame "
        "is, and is not sent: a receiver is told it, as it is told what was asked where an answer "
        "does not say so.",
    )
    set_by: NumberNames | None = Field(
        None,
        description="What tells it in frames that a receiver takes: a part of frames, or "
        "MESSAGE.FIELD; or several of these.",
    )
    once: OnlyTrue | None = Field(
        None, description="What was told holds for one frame, and then the default does again."
    )
    counts: PartRun | None = Field(
        None,
        description="The part is the length in bytes of these parts, unstuffed unless it says "
        "`over: wire`.",
    )
    counter: OnlyTrue | None = Field(
        None, description="The part counts frames; encoders advance it by one and wrap."
    )
    algorithm: Algorithm | None = Field(
        None,
        description="The part is a checksum: xor-8, sum-8, sum-8/negated, sum-8/inverted (or of 16 "
        "or 32 bits), fletcher-16, fletcher-16/256, a name of the CRC RevEng catalogue, or the "
        "parameters of a CRC, a sum or an exclusive or.",
    )
    covers: PartRun | None = Field(None, description="The parts that the checksum covers.")
    over: Literal["content", "wire"] | None = Field(
        None,
        description="Checksum over unstuffed bytes, or their number (content, the default), or as "
        "they are on the wire.",
    )
    when: Annotated[Literal["payload"], Ref(Kind.PART)] | None = Field(
        None,
        description="The part is present only in frames whose payload is not empty.",
    )
    trailing_zeros: _Trimming = Field(
        None,
        description="Zero bytes at the end of the payload are left out; receivers fill it up "
        "with them: trimmed.",
    )
    longer: _Cutting = Field(
        None,
        description="A payload longer than its message, as newer senders may have it: receivers "
        "take the bytes that they know and leave the rest: cut.",
    )
    range: RawRange | None = Field(
        None,
        description="Least and greatest value of the part; of a text, of each of its characters.",
    )
    default: PartValue | None = Field(
        None,
        description="What an encoder writes where the caller gives no value; of a virtual part, "
        "the value of messages that give none; of one that is told, what there is before.",
    )
    idle: SilenceText | None = Field(
        None,
        description="The silence behind a frame that alone ends it: 3.5 characters, 20 ms.",
    )
    byte_order: ByteOrder | None = Field(None, description="Byte order of this part.")
    doc: Text | None = Field(None, description="What the part means.")
    source: SourceRef | None = Field(None, description="Where the part is written down.")

    @property
    def is_sent(self) -> bool:
        """True if the part has bytes on the wire."""
        return not (self.virtual or self.told)


class XorTransform(Syntax):
    """The escaped byte is XORed with a constant."""

    xor: ByteNumber = Field(description="The constant.")


class EscapeSyntax(Syntax):
    """One escape byte, and what becomes of the byte behind it."""

    byte: ByteNumber = Field(description="The escape byte.")
    of: Bytes = Field(
        description="The bytes that have to be escaped; the escape byte is one of them."
    )
    transform: Annotated[
        Annotated[Literal["invert", "none"], Tag("text")] | Annotated[XorTransform, Tag("mapping")],
        Discriminator(_written_as_mapping),
    ] = Field(
        description="How the byte behind the escape is changed: invert, none, or {xor: 0x20}."
    )


def _table(value: Any) -> Any:
    if isinstance(value, dict):
        return tuple(value.items())
    if isinstance(value, tuple):
        return value
    raise ValueError("expected a mapping of bytes to what stands for them")


_SEQUENCE = re.compile(r"[0-9A-Fa-f]{2}( [0-9A-Fa-f]{2})+")
_SequenceForm = Annotated[str, Field(pattern=f"^{_SEQUENCE.pattern}$")]
"""The written form of several bytes in a table: FF FF FD."""


def _to_sequence(value: Any) -> Any:
    """Read `FF FF FD` as bytes, and leave all else."""
    if isinstance(value, str) and _SEQUENCE.fullmatch(value):
        return bytes.fromhex(value)
    return value


def _is_sequence(value: Any) -> str:
    return "bytes" if isinstance(_to_sequence(value), bytes) else "byte"


Substituted = Annotated[
    Annotated[ByteNumber, Tag("byte")]
    | Annotated[bytes, BeforeValidator(_to_sequence), at_most(8), Tag("bytes")],
    Discriminator(_is_sequence),
]
"""What something else stands for on the wire: a byte, or several that follow each other."""
Substitutions = Annotated[
    tuple[tuple[Substituted, Annotated[Octets, BeforeValidator(_to_sequence), at_most(16)]], ...],
    BeforeValidator(
        _table,
        json_schema_input_type=dict[str, OctetsForm | list[ByteForm] | ByteForm | _SequenceForm],
    ),
]
"""Byte, or several, to the bytes that stand for it on the wire."""


_Preset = Literal["slip", "hdlc"]


class TransparencySyntax(Syntax):
    """Rule that keeps delimiters out of a region of the frame."""

    covers: PartRun | None = Field(
        None,
        description="The run of parts that is stuffed; without it all between the outer literals.",
    )
    substitute: Substitutions | None = Field(
        None,
        description="Substitution table: byte to the bytes that stand for it; or several bytes, "
        "such as FF FF FD, to the same and one more.",
    )
    escape: EscapeSyntax | None = Field(None, description="An escape byte and its transform.")
    encoding: Literal["base16-upper", "cobs"] | None = Field(
        None, description="The region is encoded as a whole."
    )
    preset: _Preset | None = Field(
        None,
        description="SLIP (RFC 1055) or asynchronous HDLC (RFC 1662) byte stuffing.",
    )
    lenient: bool = Field(
        False,
        description="Decoders also accept stuffing that an encoder would not have made.",
    )
    doc: Text | None = Field(None, description="What a reader should know about it.")
    source: SourceRef | None = Field(None, description="Where it is written down.")


TransparencyRef = Annotated[
    TransparencySyntax,
    BeforeValidator(ShortForm("preset"), json_schema_input_type=_Preset | TransparencySyntax),
]
