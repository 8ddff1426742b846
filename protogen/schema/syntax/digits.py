"""Digits of integers that are written as text."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag

from protogen.schema.syntax.base import ByteNumber, Count, Syntax

DigitsName = Literal["base10", "base16-upper", "base16-lower"]

Positive = Annotated[Count, Field(ge=1)]


class DigitCount(Syntax):
    """How many digits stand in front of the point."""

    min: Positive | None = Field(
        None, description="At least so many, with zeros where the number has fewer; 1 if not said."
    )
    max: Positive | None = Field(
        None, description="At most so many; as the `range` needs, or 9 in all, if not said."
    )


def _digits_form(value: Any) -> str:
    if isinstance(value, str):
        return "name"
    return "count" if isinstance(value, int) else "mapping"


Digits = Annotated[
    Annotated[DigitsName, Tag("name")]
    | Annotated[Positive, Tag("count")]
    | Annotated[DigitCount, Tag("mapping")],
    Discriminator(_digits_form),
]
"""Kind of digits, or how many there are."""


def _is_name(value: Any) -> Any:
    if isinstance(value, str):
        return value
    text = "expected base10, base16-upper or base16-lower: a part of a frame has as many digits"
    raise ValueError(f"{text} each time, of which `chars` is the number")


FixedDigitsName = Annotated[
    DigitsName, BeforeValidator(_is_name, json_schema_input_type=DigitsName)
]
"""Kind of digits of what has as many each time."""


class CharacterCode(Syntax):
    """How the characters of an integer come of its bits, or the bytes of a text of characters."""

    bits: Annotated[Count, Field(ge=1, le=7)] = Field(
        description="Bits of the integer in each character; of a text, 7: those of a character."
    )
    shift: Annotated[Count, Field(le=8)] = Field(
        0, description="Of a text: bits by which each character is shifted left."
    )
    add: ByteNumber = Field(
        0,
        description="What is added to them, which is the character of zeros; 0 if not said.",
    )
