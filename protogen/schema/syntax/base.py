"""Basics of the syntax tree: the strict base class and the scalar types.

A syntax object says what was written, checked by shape only. Whether it makes sense together with
the rest of the schema is asked by the passes.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from fractions import Fraction
from typing import Annotated, Any, Literal

import msgspec
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, StringConstraints

from protogen.schema.text.scalars import exact_number

NAME_PATTERN = r"^[a-z][a-z0-9]*(_[a-z0-9]+)*$"
"""Names are lower snake case: each target derives its own spelling from that."""

GREATEST_TEXT = 8
"""Characters of a part of the frame, at most."""

INTEGER_PATTERN = r"[us]int([1-9]|[1-5][0-9]|6[0-4])"
"""Integers have 1 to 64 bits."""

_TYPE_PATTERN = f"^{INTEGER_PATTERN}$|" + NAME_PATTERN.replace("^", r"^(?![us]int[0-9]+$)")
_DURATION = re.compile(r"([0-9]{1,9}(?:\.[0-9]{1,9})?) ?(us|ms|s)")
_DURATION_UNITS = {
    "us": Fraction(1, 1_000_000),
    "ms": Fraction(1, 1000),
    "s": Fraction(1),
}
_SILENCE = re.compile(r"([0-9]{1,9}(?:\.[0-9]{1,9})?) ?(us|ms|s|characters?)")
_RATE_NUMBER = r"[0-9]{1,20}(?:\.[0-9]{1,20}|/0*[1-9][0-9]{0,20})?"
_RATE = re.compile(rf"([-+]?{_RATE_NUMBER}) ?([A-Za-zµ]*)")
_FREQUENCY_UNITS = {"": 1, "Hz": 1, "kHz": 1000}
_SPAN = re.compile(r"([0-9]{1,4})\.\.([0-9]{1,4})")
_RATIONAL_PATTERN = (
    r"^\s*[-+]?([0-9]+/0*[1-9][0-9]*|([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]{1,3})?)\s*$"
)
"""Numbers as `exact_number` reads them, for editors."""


class Syntax(BaseModel):
    """Base of all syntax classes: unknown keys are errors, objects are immutable."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, defer_build=True)


def written_as(form: Any) -> BeforeValidator:
    """Let editors offer and accept this form of what is read further inside."""
    return BeforeValidator(_as_is, json_schema_input_type=form)


def _as_is(value: object) -> object:
    return value


def as_written(value: object) -> object:
    """Text keys take `1.10` or `2014` as the characters that stand in the file."""
    return getattr(value, "text", value)


def _to_int(value: object) -> object:
    return int(value) if isinstance(value, int) and not isinstance(value, bool) else value


def _to_fraction(value: object) -> object:
    if isinstance(value, Fraction):
        return value
    if isinstance(value, int) and not isinstance(value, bool):
        return Fraction(int(value))
    if isinstance(value, float | str):
        number = exact_number(str(as_written(value)).strip())
        if number is not None:
            return number
    raise ValueError("expected an exact number such as 0.01, 1/16 or -3")


def _to_duration(value: object) -> object:
    if isinstance(value, Fraction):
        return value
    match = _DURATION.fullmatch(str(value))
    if match is None:
        raise ValueError("expected a time with its unit, such as 20 ms, 500 us or 1.5 s")
    return Fraction(match[1]) * _DURATION_UNITS[match[2]]


def _to_silence(value: object) -> object:
    match = _SILENCE.fullmatch(str(value))
    if match is None or not Fraction(match[1]):
        raise ValueError("expected a time, such as 3.5 characters, 20 ms or 500 us")
    return str(value)


def _to_rate(value: object) -> object:
    """The number and its unit; what the unit is, and whether it can be, is asked by a pass."""
    text = str(as_written(value)).strip()
    if isinstance(value, int | float) and not isinstance(value, bool):
        text = str(exact_number(text) if isinstance(value, float) else int(value))
    if _RATE.fullmatch(text) is None:
        raise ValueError("expected how often, such as 50 Hz, or after what time, such as 20 ms")
    return text


def _to_number(value: object) -> object:
    """An integer, one character (its code), or a float as written."""
    if isinstance(value, bool):
        raise ValueError("expected a number or one character; true and false are neither")
    if isinstance(value, int):
        return int(value)
    if isinstance(value, str) and len(value) == 1 and ord(value) < 256:
        return ord(value)
    raise ValueError("expected an integer or one character")


def _to_part_value(value: object) -> object:
    """An integer, or characters, of which one can stand for its code."""
    if not isinstance(value, str):
        return _to_number(value)
    if not value or len(value) > GREATEST_TEXT:
        raise ValueError(f"expected an integer, or one to {GREATEST_TEXT} characters")
    if len(value) == 1:
        _to_number(value)
    return value


def _to_byte(value: object) -> object:
    """One byte: a number or a character."""
    number = _to_number(value)
    if isinstance(number, int) and 0 <= number <= 255:
        return number
    raise ValueError("a byte is a number from 0 to 255, or one character")


def _to_bit_range(value: object) -> object:
    """`5` is one bit, `6..7` runs from the lowest to the highest bit."""
    if isinstance(value, int) and not isinstance(value, bool) and value >= 0:
        return (int(value), int(value))
    match = _SPAN.fullmatch(value) if isinstance(value, str) else None
    if match is None:
        raise ValueError("expected a bit number or LOW..HIGH, such as 6..7")
    return (int(match[1]), int(match[2]))


Character = Annotated[str, Field(min_length=1, max_length=1)]
"""A text of one character, which stands for its code."""

Text = Annotated[str, BeforeValidator(as_written, json_schema_input_type=str | float | int)]
"""Prose or a version: taken as written, also when it looks like a number."""

Name = Annotated[str, StringConstraints(pattern=NAME_PATTERN, max_length=64)]
"""A lower snake case name of something that the schema declares."""

TypeForm = Annotated[str, Field(pattern=_TYPE_PATTERN)]
"""The written form of a type's name, built in or declared."""

Int = Annotated[int, BeforeValidator(_to_int)]
"""An integer, never a boolean or a quoted number."""

Count = Annotated[int, BeforeValidator(_to_int), Field(ge=0)]
"""An integer that is not negative."""


def _no_number(value: Any) -> Any:
    """To Python, 1 is True."""
    return str(value) if isinstance(value, int) and not isinstance(value, bool) else value


OnlyTrue = Annotated[
    Literal[True], BeforeValidator(_no_number, json_schema_input_type=Literal[True])
]
"""`true`, for a key that is left out otherwise."""

RationalForm = int | float | Annotated[str, Field(pattern=_RATIONAL_PATTERN)]
"""The written form of an exact number."""

Rational = Annotated[Fraction, BeforeValidator(_to_fraction, json_schema_input_type=RationalForm)]
"""An exact number: 0.01 is one hundredth and 1/16 one sixteenth."""

Duration = Annotated[
    Fraction,
    BeforeValidator(
        _to_duration,
        json_schema_input_type=Annotated[str, Field(pattern=f"^{_DURATION.pattern}$")],
    ),
]
"""A time in seconds, written with its unit."""

SilenceText = Annotated[
    str,
    BeforeValidator(
        _to_silence,
        json_schema_input_type=Annotated[str, Field(pattern=f"^{_SILENCE.pattern}$")],
    ),
]
"""A silence of the line: a time with its unit, or a number of characters."""


def silence_seconds(text: str, character: Fraction | None) -> Fraction | None:
    """Seconds of a silence as written; None where it needs to be known how long a character is."""
    match = _SILENCE.fullmatch(text)
    assert match is not None
    unit = _DURATION_UNITS.get(match[2], character)
    return None if unit is None else Fraction(match[1]) * unit


RATE_UNITS = (*_FREQUENCY_UNITS, *_DURATION_UNITS)
"""The units of how often something is sent, or after what time again."""

RateText = Annotated[
    str,
    BeforeValidator(
        _to_rate,
        json_schema_input_type=int
        | float
        | Annotated[str, Field(pattern=f"^{_RATE_NUMBER} ?({'|'.join(RATE_UNITS)})$")],
    ),
]
"""How often: a number in Hz, with or without its unit, or the time between."""


def rate_number(text: str) -> tuple[Fraction, str]:
    """The number of a rate as written, and its unit."""
    match = _RATE.fullmatch(text)
    assert match is not None
    return Fraction(match[1]), match[2]


def rate_hertz(text: str) -> Fraction | None:
    """Times a second of a rate as written; None where it is none: of an unknown unit, or zero."""
    number, unit = rate_number(text)
    if number <= 0 or unit not in RATE_UNITS:
        return None
    period = _DURATION_UNITS.get(unit)
    return number * _FREQUENCY_UNITS[unit] if period is None else 1 / (number * period)


RawNumber = Annotated[int, BeforeValidator(_to_number, json_schema_input_type=int | Character)]
"""A raw value: an integer, or one character that stands for its code."""

PartValueForm = int | Annotated[str, Field(min_length=1, max_length=GREATEST_TEXT)]
"""The written form of a part's value."""

PartValue = Annotated[
    int | str, BeforeValidator(_to_part_value, json_schema_input_type=PartValueForm)
]
"""Value of a part: an integer, or characters, of which one can stand for its code."""

ByteForm = Annotated[int, Field(ge=0, le=255)]
"""The number of one byte."""

ByteNumber = Annotated[int, BeforeValidator(_to_byte, json_schema_input_type=ByteForm | Character)]
"""One byte: a number from 0 to 255, or one character that stands for its code."""


def _to_bytes(value: Any) -> Any:
    if isinstance(value, list | tuple):
        return tuple(value)
    raise ValueError("expected a list of bytes")


Bytes = Annotated[
    tuple[ByteNumber, ...],
    BeforeValidator(_to_bytes, json_schema_input_type=list[ByteForm | Character]),
]
"""Bytes by their numbers, or by the characters that stand for these."""

BitNumber = Annotated[int, Field(ge=0, le=63)]
"""The number of a bit in the widest integer."""

BitRangeForm = BitNumber | Annotated[str, Field(pattern=f"^{_SPAN.pattern}$")]
"""The written form of a run of bits."""

BitRange = Annotated[
    tuple[int, int], BeforeValidator(_to_bit_range, json_schema_input_type=BitRangeForm)
]
"""The lowest and the highest bit of a bit range, counted from the least significant bit 0."""


def _to_bit_ranges(value: object) -> object:
    """One run of bits, or a list of some."""
    if isinstance(value, list):
        if not value:
            raise ValueError("a list of runs of bits has one at least")
        return tuple(map(_to_bit_range, value))
    return value if isinstance(value, tuple) else _to_bit_range(value)


BitRanges = Annotated[
    tuple[int, int] | tuple[tuple[int, int], ...],
    BeforeValidator(
        _to_bit_ranges,
        json_schema_input_type=BitRangeForm | Annotated[list[BitRangeForm], Field(min_length=1)],
    ),
]
"""One run of bits, or a list of some, each by its lowest and its highest bit."""


def pair_of(what: str) -> Callable[[Any], Any]:
    """Let a list of exactly two stand for a pair; `what` says what the two are."""

    def read(value: Any) -> Any:
        if isinstance(value, list | tuple) and len(value) == 2:
            return tuple(value)
        raise ValueError(f"expected {what}")

    return read


class ShortForm(msgspec.Struct, frozen=True):
    """Lets a bare scalar stand for a mapping that has only `key`."""

    key: str

    def __call__(self, value: Any) -> Any:
        """Return the mapping, or anything else as it is."""
        return {self.key: value} if isinstance(value, str | int | float) else value


class Source(Syntax):
    """Place where a fact is written down."""

    document: Text | None = Field(None, description="File name or title of the document.")
    revision: Text | None = Field(None, description="Revision, date or commit of the document.")
    lines: Text | None = Field(None, description="Line or lines of the document, such as 61-65.")
    section: Text | None = Field(None, description="Section or page of the document.")
    url: Text | None = Field(None, description="Where the document can be found.")
    license: Text | None = Field(None, description="Licence of the document or the code read.")
    note: Text | None = Field(None, description="Anything else that a reader should know.")


SourceRef = Annotated[
    Source, BeforeValidator(ShortForm("lines"), json_schema_input_type=str | int | Source)
]
"""A source; a bare text or number stands for the lines of the schema's document."""
