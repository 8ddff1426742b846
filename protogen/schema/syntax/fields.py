"""Fields of a payload, and the types that a schema declares."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag

from protogen.schema.syntax.base import (
    BitNumber,
    BitRangeForm,
    BitRanges,
    ByteForm,
    ByteNumber,
    Bytes,
    Character,
    Count,
    Name,
    OnlyTrue,
    Rational,
    RationalForm,
    RawNumber,
    ShortForm,
    SourceRef,
    Syntax,
    Text,
    TypeForm,
    pair_of,
)
from protogen.schema.syntax.digits import CharacterCode, Digits, Positive
from protogen.schema.syntax.names import CaseKey, ExpressionText, Kind, MemberText, Ref, TypeName
from protogen.schema.syntax.octets import OctetsForm, to_octets
from protogen.schema.syntax.parts import ByteOrder


class NamedValue(Syntax):
    """A name for a raw value: an entry of an enum, or a special value."""

    value: RawNumber = Field(description="The raw value, or one character.")
    doc: Text | None = Field(None, description="What it means.")
    source: SourceRef | None = Field(None, description="Where it is written down.")


class NamedBit(Syntax):
    """A name for one bit."""

    bit: Count = Field(description="Bit number, counted from the least significant bit 0.")
    doc: Text | None = Field(None, description="What a set bit means.")
    source: SourceRef | None = Field(None, description="Where it is written down.")


NamedValueRef = Annotated[
    NamedValue,
    BeforeValidator(ShortForm("value"), json_schema_input_type=int | Character | NamedValue),
]
NamedBitRef = Annotated[
    NamedBit,
    BeforeValidator(ShortForm("bit"), json_schema_input_type=BitNumber | NamedBit),
]


ValueNames = Annotated[dict[Name, NamedValueRef], Field(min_length=1)]
"""Names of raw values, one at least."""


class NamedBits(Syntax):
    """A named run of bits of one integer, or several runs that mean something together."""

    bits: BitRanges = Field(
        description="Bit number, or LOW..HIGH counted from bit 0; or a list of these, which may "
        "have other names as well, and which keep their distances in the value."
    )
    values: ValueNames | None = Field(None, description="Names of its values.")
    doc: Text | None = Field(None, description="What the bits mean.")
    source: SourceRef | None = Field(None, description="Where it is written down.")


NamedBitsRef = Annotated[
    NamedBits,
    BeforeValidator(ShortForm("bits"), json_schema_input_type=BitRangeForm | NamedBits),
]


class Fill(Syntax):
    """As many elements or bytes as the payload has left, or a separator lets there be."""

    fill: OnlyTrue | None = Field(
        None,
        description="To the end of the payload. Only a text between separators can do without "
        "it: it ends in front of the next one.",
    )
    min: Count = Field(0, description="The least number of elements or bytes.")
    max: Count | None = Field(None, description="The greatest number of elements or bytes.")


def _to_fill(value: Any) -> Any:
    return Fill(fill=True) if value == "fill" else value


def _extent_form(value: Any) -> str:
    if isinstance(value, dict | Fill) or value == "fill":
        return "fill"
    return "expression" if isinstance(value, str) else "number"


Extent = Annotated[
    Annotated[Count, Tag("number")]
    | Annotated[ExpressionText, Tag("expression")]
    | Annotated[Fill, BeforeValidator(_to_fill, json_schema_input_type=str | Fill), Tag("fill")],
    Discriminator(_extent_form),
]
"""Number of elements or bytes: a number, an expression over earlier fields, or `fill`."""


class Until(Syntax):
    """As many bytes as stand in front of a terminator."""

    byte: ByteNumber = Field(
        description="The terminator, which is on the wire and no part of the value."
    )
    min: Count = Field(0, description="The least number of bytes, without the terminator.")
    max: Count | None = Field(
        None, description="The greatest number of bytes, without the terminator."
    )


class UntilElement(Syntax):
    """As many elements as there are up to one that says that it is the last."""

    element: MemberText = Field(
        description="The field of an element, or bits of one, that is not 0 in the last element "
        "and 0 in all others."
    )
    min: Positive = Field(1, description="The least number of elements, the last one included.")
    max: Positive | None = Field(
        None, description="The greatest number of elements, the last one included."
    )


def _to_until(value: Any) -> Any:
    return {"byte": value} if isinstance(value, int | str) else value


def _until_form(value: Any) -> str:
    is_of_elements = isinstance(value, UntilElement) or (
        isinstance(value, dict) and "element" in value
    )
    return "last element" if is_of_elements else "terminator"


UntilRef = Annotated[
    Annotated[
        Until,
        BeforeValidator(_to_until, json_schema_input_type=ByteForm | Character | Until),
        Tag("terminator"),
    ]
    | Annotated[UntilElement, Tag("last element")],
    Discriminator(_until_form),
]
"""A byte or character, or a mapping; of an array, what its last element says."""


BitOrder = Literal["lsb_first", "msb_first"]


def _to_constant(value: Any) -> Any:
    """A number, a text (also an enum's name) or bytes; which of them fits the type is not asked."""
    if isinstance(value, bool | bytes | tuple):
        return value
    if isinstance(value, int):
        return int(value)
    if isinstance(value, float):
        return float(value)
    if isinstance(value, list):
        return tuple(map(_to_element, value))
    return str(value) if isinstance(value, str) else to_octets(value)


def _to_element(value: Any) -> int:
    if isinstance(value, int) and not isinstance(value, bool):
        return int(value)
    raise ValueError("a list holds integers here")


Constant = Annotated[
    Any,
    BeforeValidator(
        _to_constant, json_schema_input_type=bool | int | float | str | OctetsForm | list[int]
    ),
    Ref(Kind.VALUE),
]
"""A value of a field: a number, a text (also an enum's name), or bytes."""


NumberRange = Annotated[
    tuple[Rational, Rational],
    BeforeValidator(
        pair_of("two numbers: [LEAST, GREATEST]"),
        json_schema_input_type=Annotated[list[RationalForm], Field(min_length=2, max_length=2)],
    ),
]
"""Least and greatest raw value, both included (for floats: the value itself)."""


class FieldSyntax(Syntax):
    """One field of a payload, or a declared type."""

    type: TypeName | None = Field(
        None,
        description="uint1..uint64, sint1..sint64, byte, char, bool, float32, float64, ascii, "
        "bytes, decimal, hexadecimal, or a name declared under types.",
    )
    fields: dict[Name, FieldRef] | None = Field(
        None, description="The field is a struct of these fields."
    )
    switch: ExpressionText | None = Field(
        None,
        description="The field is one of several, chosen by this earlier field, or expression "
        "over earlier fields.",
    )
    cases: dict[CaseKey, FieldRef] | None = Field(
        None,
        description="What the field is for each value (name or number) of the switch; under else, "
        "for all other values.",
    )
    count: Extent | None = Field(
        None,
        description="The field is an array: number of elements, the earlier field or expression "
        "that counts them, or fill (to the end of the payload).",
    )
    size: Extent | None = Field(
        None,
        description="Bytes of an ascii or bytes field, of an array instead of a count of its "
        "elements, or of the region that a struct or switch fills: a number, the earlier field or "
        "expression that gives it, or fill (to the end of the payload).",
    )
    until: UntilRef | None = Field(
        None,
        description="In place of a size: an ascii or bytes field ends in front of this byte, "
        "which is on the wire and no part of the value. In place of a count: an array of structs "
        "ends with the element that says so.",
    )
    without: Bytes | None = Field(
        None,
        description="Characters that an ascii field between separators can't have, beside the "
        "separator and those that can't be printed.",
    )
    packed: BitOrder | None = Field(
        None,
        description="The integers of the array or struct follow each other bit by bit, without "
        "byte boundaries: lsb_first (bit 0 of each byte comes first, and of each number) or "
        "msb_first (bit 7 and the most significant bit do).",
    )
    digits: Digits | None = Field(
        None,
        description="The integer is written as text, the highest digit first: base10, "
        "base16-upper or base16-lower. Of decimal and hexadecimal: digits in front of the point "
        "at least, or a mapping.",
    )
    fraction: Count | None = Field(
        None,
        description="Digits behind the point of a decimal; the raw value is as many powers of "
        "ten greater.",
    )
    case: Literal["upper", "lower"] | None = Field(
        None, description="Case of hexadecimal digits; upper if not said."
    )
    empty: Name | None = Field(
        None,
        description="Beside separators: the field may have no text, and this is the name of the "
        "value that it then has.",
    )
    chars: Positive | None = Field(
        None,
        description="Characters of an integer that is written as text; else as many digits as "
        "its greatest value needs.",
    )
    code: CharacterCode | None = Field(
        None,
        description="Each character is some bits of the integer, the highest ones first. Of an "
        "ascii field of a fixed size: what the byte of each character is.",
    )
    padding: ByteNumber | None = Field(
        None,
        description="Character that fills up an ascii field of a fixed size, such as a blank; NUL "
        "if not said.",
    )
    part: Annotated[Name, Ref(Kind.PART)] | None = Field(
        None,
        description="The field is the number of this part of the frame and takes no bytes of the "
        "payload. Expressions of the fields behind it may name it; the encoder writes the part.",
    )
    when: ExpressionText | None = Field(
        None,
        description="The field is there only where this expression over earlier fields is true "
        "(a number: is not 0).",
    )
    optional: bool = Field(
        False,
        description="The field is there only where the payload goes on: it may be left out, and "
        "all behind it then are.",
    )
    values: ValueNames | None = Field(
        None,
        description="Enum: names of raw values. Unknown values are kept unless closed.",
    )
    closed: bool = Field(False, description="Values without a name are invalid.")
    flags: Annotated[dict[Name, NamedBitRef], Field(min_length=1)] | None = Field(
        None, description="Names of single bits."
    )
    bits: Annotated[dict[Name, NamedBitsRef], Field(min_length=1)] | None = Field(
        None, description="Named bit ranges of one integer."
    )
    const: Constant | None = Field(None, description="The only valid value.")
    default: Constant | None = Field(None, description="What an encoder writes by default.")
    range: NumberRange | None = Field(None, description="Least and greatest raw value.")
    scale: Rational | None = Field(
        None,
        description="physical value = raw value x scale + offset; exact, such as 1/16.",
    )
    offset: Rational | None = Field(
        None,
        description="physical value = raw value x scale + offset, in the field's unit.",
    )
    unit: Text | None = Field(None, description="Unit of the physical value.")
    special: ValueNames | None = Field(
        None, description="Raw values that mean that there is no reading."
    )
    byte_order: ByteOrder | None = Field(None, description="Byte order of this field.")
    unknown: bool = Field(False, description="The document does not say what the field is.")
    renamed_from: Name | None = Field(
        None, description="The field's name in the version before: only the name changed."
    )
    doc: Text | None = Field(None, description="What the field means.")
    source: SourceRef | None = Field(None, description="Where the field is written down.")


OF_PAYLOADS = (
    "count", "size", "until", "without", "packed", "digits", "fraction", "case", "empty", "chars",
    "code", "padding", "when", "optional", "const", "byte_order",
)  # fmt: skip
"""Keys about bytes of a payload, or about what the frame says of its parts: none beside `part`."""

FieldRef = Annotated[
    FieldSyntax,
    BeforeValidator(ShortForm("type"), json_schema_input_type=TypeForm | FieldSyntax),
]
"""A field; a bare type name stands for a field with nothing to add."""

FieldSyntax.model_rebuild()
