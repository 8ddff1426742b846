"""Bytes of ROS 2 messages: CDR in little-endian order, as DDS transports it.

Four bytes in front say so. Behind them a number lies at a multiple of its size, strings and lists
have their number of bytes or elements in front, and a string ends with NUL, which is counted.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from protogen.convert.ros2.layout import ListOf, Member, Message, Number, RosType, String

HEADER = bytes((0, 1, 0, 0))
"""Says that what follows is plain CDR in little-endian order."""
CODES = {
    "bool": "?",
    "uint8": "B",
    "int8": "b",
    "uint16": "H",
    "int16": "h",
    "uint32": "I",
    "int32": "i",
    "uint64": "Q",
    "int64": "q",
    "float32": "f",
    "float64": "d",
}


class CdrWriter:
    """Writes values one behind the other, from any place that is a multiple of eight."""

    def __init__(self) -> None:
        self.data = bytearray()

    def message(self, message: Message, values: Sequence[Any]) -> None:
        """Write the message of a row: a value for each member."""
        for member, value in zip(message.members, values, strict=True):
            self._member(member, value)

    def value(self, type: RosType, value: Any) -> None:
        """Write a value; None: what stands where there is none."""
        match type:
            case Number():
                self._number(type, value)
            case String():
                self._text(value or "")
            case ListOf(element=element, count=count):
                self._list(element, count, value)
            case Message(is_list=True):
                self.value(type.members[0].type, value)
            case Message(members=members):
                for member in members:
                    self._member(member, (value or {}).get(member.source))

    def align(self, size: int) -> None:
        """Write zeros up to a multiple of a size."""
        self.data += bytes(-len(self.data) % size)

    def _member(self, member: Member, value: Any) -> None:
        if member.flag is not None:
            self.data.append(value is not None)
        elif value is None and member.column is not None:
            value = missing(member.type)
        self.value(member.type, value)

    def _number(self, type: Number, value: Any) -> None:
        self.align(type.size)
        # There are many NaNs, but only one that says no more than that.
        plain = math.nan if value != value else value
        self.data += struct.pack(f"<{CODES[type.word]}", 0 if plain is None else plain)

    def _text(self, text: str) -> None:
        data = text.encode()
        self.align(4)
        self.data += struct.pack("<I", len(data) + 1) + data + b"\0"

    def _list(self, element: RosType, count: int | None, value: Any) -> None:
        values = value if value is not None else ()
        if count is None:
            self.align(4)
            self.data += struct.pack("<I", len(values))
        if isinstance(values, bytes):
            self.data += values
            return
        for item in values:
            self.value(element, missing(element) if item is None else item)


def missing(type: RosType) -> float | None:
    """What stands for a physical value where there is none, if its type has such a value."""
    return math.nan if isinstance(type, Number) and type.is_float else None


def encoder_of(message: Message) -> Callable[[Mapping[str, Any]], bytes]:
    """What makes messages of rows: values by the names of their columns."""

    def encode(row: Mapping[str, Any]) -> bytes:
        writer = CdrWriter()
        writer.message(message, [row[member.source] for member in message.members])
        return HEADER + writer.data

    return encode
