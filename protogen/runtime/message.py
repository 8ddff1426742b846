"""What the generated messages inherit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

from protogen.runtime.constructs import PayloadError, whole
from protogen.runtime.errors import DecodeError, EncodeError
from protogen.runtime.records import Record, outermost, record_from_wire, record_to_wire


@dataclass(frozen=True, slots=True)
class Sizes:
    """Sizes in bytes: `least`, `least + step`, ... up to `greatest`."""

    least: int
    greatest: int
    step: int = 1

    @property
    def fixed(self) -> int | None:
        """The size, where there is only one."""
        return self.least if self.least == self.greatest else None

    def __contains__(self, size: int) -> bool:
        return size in range(self.least, self.greatest + 1, self.step)

    def __str__(self) -> str:
        if self.fixed is not None:
            return str(self.fixed)
        steps = f" in steps of {self.step}" if self.step > 1 else ""
        return f"{self.least}..{self.greatest}{steps}"


class Message(Record):
    """Base of the generated messages."""

    __slots__ = ()

    NAME: ClassVar[str]
    """The message's name in the schema."""
    SENDERS: ClassVar[tuple[str, ...]]
    """The endpoints that send it."""
    IDENTITY: ClassVar[tuple[int, ...]]
    """The values of the frame's identity parts, in wire order."""
    SPEC_HASH: ClassVar[str]
    """SHA-256, in hex, of its identity, its layout and what its values mean."""
    SIZES: ClassVar[Sizes]
    """The sizes that its payload can have."""

    def to_payload(self, strict: bool = True) -> bytes:
        """The payload's bytes.

        Raises EncodeError where a value is out of range or does not fit; with `strict=False` a
        value may be anything that fits the wire.
        """
        values = record_to_wire(self, outermost(), strict)
        try:
            payload = bytes(type(self).FORMAT.build(values))
        except PayloadError as error:
            raise EncodeError(error.path, error.problem) from None
        if len(payload) not in self.SIZES:
            problem = f"makes {len(payload)} bytes of payload; {self.NAME} has {self.SIZES}"
            raise EncodeError("", problem)
        return payload

    @classmethod
    def from_payload(cls, payload: bytes) -> Self:
        """The message of a payload's bytes. Raises DecodeError: size, value or encoding."""
        try:
            return cls.parse_payload(payload)
        except PayloadError as error:
            raise DecodeError(
                error.reason, error.problem, offset=error.offset, path=error.path
            ) from None

    @classmethod
    def parse_payload(cls, payload: bytes) -> Self:
        """The same, but raises construct's kind of error: PayloadError."""
        if len(payload) not in cls.SIZES:
            problem = f"{cls.NAME} has {cls.SIZES} bytes of payload, not {len(payload)}"
            raise PayloadError("size", "", min(len(payload), cls.SIZES.greatest), problem)
        raw = whole(cls.FORMAT).parse(payload)
        return record_from_wire(cls, raw, outermost())
