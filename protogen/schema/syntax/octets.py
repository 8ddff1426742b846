"""Byte strings: `{hex: 1B 02}`, `{text: b}`, a number, or a list of numbers."""

from __future__ import annotations

import re
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field

from protogen.schema.syntax.base import ByteForm, Syntax, Text, written_as

_HEX = re.compile(r"(?:[0-9A-Fa-f]{2}\s*)*")


HexForm = Annotated[str, Field(pattern=f"^{_HEX.pattern}$")] | int | float
"""The written form of hexadecimal digits; those without letters read as a number."""


class OctetsForm(Syntax):
    """The written form of a byte string, for editors; values are plain `bytes`."""

    model_config = ConfigDict(json_schema_extra={"minProperties": 1, "maxProperties": 1})

    hex: Annotated[Text, written_as(HexForm)] | None = Field(
        None, description="Bytes as pairs of hex digits: 1B 02."
    )
    text: Text | None = Field(None, description="Bytes as characters (Latin-1), one byte each.")


def _characters(value: object) -> str:
    """A text, or a number as it was written."""
    if isinstance(value, str | int | float) and not isinstance(value, bool):
        return str(getattr(value, "text", value))
    raise ValueError("expected characters, in quotes where they mean something else")


def _from_hex(value: object) -> bytes:
    text = _characters(value)
    if not _HEX.fullmatch(text):
        raise ValueError("hex bytes are pairs of hex digits, such as 1B 02")
    return bytes.fromhex(text)


def _from_text(value: object) -> bytes:
    text = _characters(value)
    try:
        return text.encode("latin-1")
    except UnicodeEncodeError as error:
        raise ValueError(f"the character {text[error.start]!r} is not one byte") from None


def _from_number(value: object) -> int:
    if isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= 255:
        return int(value)
    raise ValueError("a byte is a number from 0 to 255")


def to_octets(value: Any) -> Any:
    """Read a written byte string; raises ValueError that says how it is written."""
    if isinstance(value, bytes):
        return value
    if isinstance(value, list):
        return bytes(_from_number(item) for item in value)
    if isinstance(value, dict) and len(value) == 1:
        if "hex" in value:
            return _from_hex(value["hex"])
        if "text" in value:
            return _from_text(value["text"])
    if isinstance(value, int):
        return bytes([_from_number(value)])
    raise ValueError("bytes are written {hex: 1B 02}, {text: b}, a number or a list of numbers")


def at_most(size: int) -> AfterValidator:
    """Bound the length of a byte string, in bytes."""

    def check(value: bytes) -> bytes:
        if len(value) > size:
            raise ValueError(f"at most {size} bytes can stand here, not {len(value)}")
        return value

    return AfterValidator(check)


Octets = Annotated[
    bytes,
    BeforeValidator(to_octets, json_schema_input_type=OctetsForm | ByteForm | list[ByteForm]),
]
"""A byte string in one of its written forms."""
