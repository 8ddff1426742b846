"""A program in C that calls generated code: with values it is given, on whatever machine.

Requests and answers are bytes (see `c_calls`). How they come and go is up to the machine: a shared
library, the standard streams of a process, a register of a simulator. `targets/c/fuzz_driver` makes
a driver of a protocol.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import msgspec

from protogen.model.messages import Message
from protogen.model.parts import NumberPart
from protogen.model.protocol import Protocol

TEMPLATES = Path(__file__).with_name("templates")


class DrivenPart(msgspec.Struct, frozen=True):
    """A part of a frame, as C has it."""

    name: str
    """In the schema."""
    type: str
    part: NumberPart
    member: str = ""
    """The member of an event's parts."""

    @property
    def size(self) -> int:
        """Bytes of the type."""
        return _size(self.type)


def _size(kind: str) -> int:
    """Bytes of an unsigned integer, or of a boolean."""
    return 1 if kind == "bool" else int(kind.removeprefix("uint").removesuffix("_t")) // 8


class DrivenField(msgspec.Struct, frozen=True):
    """A field that is a part of the frame, as an argument."""

    name: str
    """In the schema."""
    type: str

    @property
    def size(self) -> int:
        """Bytes of the type."""
        return _size(self.type)


class DrivenMessage(msgspec.Struct, frozen=True):
    """A message, and the functions of its payload."""

    model: Message
    struct: str
    """Empty where no field has a value: functions take no message."""
    exchange: str
    """The function that takes or writes the struct's values."""
    encode: str
    decode: str
    held: tuple[DrivenField, ...] = ()
    """Further arguments of `decode`."""


class DrivenFrame(msgspec.Struct, frozen=True):
    """The functions that make the frame of a message."""

    index: int
    message: int
    has_struct: bool
    function: str
    send: str
    """Empty where frames can't be sent byte by byte."""
    parts: tuple[DrivenPart, ...]
    room: int


class DrivenHandler(msgspec.Struct, frozen=True):
    """The function that a decoder calls with a message."""

    function: str
    struct: str
    message: int


class DrivenForm(msgspec.Struct, frozen=True):
    """One of several forms that a decoder finds."""

    name: str
    member: str
    """The member of the union of parts."""
    constant: str
    decoder: int
    """Index of the decoder of that form alone, whose parts it has."""


class DrivenDecoder(msgspec.Struct, frozen=True):
    """The decoder of what one endpoint sends."""

    index: int
    name: str
    prefix: str
    all_events: bool
    polls: bool
    """True if `push` returns which message is complete, instead of calling a handler."""
    parts: tuple[DrivenPart, ...]
    handlers: tuple[DrivenHandler, ...]
    told: tuple[tuple[str, str, str], ...] = ()
    """The identities that it is told: their names, members of the parts, and types."""
    forms: tuple[DrivenForm, ...] = ()
    """The forms of the frames, where it finds several; their parts and handlers are those of the
    decoders for each of them."""


class Driver(msgspec.Struct, frozen=True):
    """The functions that a driver calls, and its sources."""

    protocol: Protocol
    messages: tuple[DrivenMessage, ...]
    decoders: tuple[DrivenDecoder, ...]
    frames: tuple[DrivenFrame, ...]
    frame_of: Mapping[tuple[str, str], DrivenFrame]
    """The functions for each sender and message; senders with the same frame share them."""
    files: Mapping[str, bytes]
    """The generated sources and the driver's own, by their names."""
    sources: tuple[str, ...]
    """The files that have to be compiled."""

    def message(self, name: str) -> int:
        """The index of a message."""
        return next(i for i, item in enumerate(self.messages) if item.model.name == name)

    def decoder(self, sender: str) -> DrivenDecoder:
        """The decoder of what an endpoint sends."""
        return next(item for item in self.decoders if item.name == sender)

    def frame(self, sender: str, message: str) -> DrivenFrame:
        """The functions for a message of a sender."""
        return self.frame_of[sender, message]

    def write(self, folder: Path) -> list[Path]:
        """Write all files into a folder; returns those that have to be compiled."""
        for name, data in self.files.items():
            (folder / name).write_bytes(data)
        header = TEMPLATES / "driver.h"
        (folder / header.name).write_bytes(header.read_bytes())
        return [folder / name for name in self.sources]
