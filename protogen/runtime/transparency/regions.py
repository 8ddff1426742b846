"""The interfaces of all kinds of transparency, and their error."""

from __future__ import annotations

from typing import Literal, Protocol

TransparencyReason = Literal["stuffing", "encoding"]
"""Fault of a region: bytes that are no escape sequence, or that break an encoding of the region."""

EscapeTransform = Literal["invert", "none"] | int
"""Change of the byte behind an escape: invert its bits, nothing, exclusive or with this."""


class TransparencyError(ValueError):
    """A region on the wire is not what its transparency would have made."""

    def __init__(self, reason: TransparencyReason, message: str) -> None:
        super().__init__(message)
        self.reason: TransparencyReason = reason


class Unstuffer(Protocol):
    """Decodes one region, byte by byte. Of no use after an error or `finish`."""

    def push(self, byte: int) -> bytes:
        """Take the next byte of the region and return the decoded bytes that it releases.

        Raises TransparencyError at the first byte that no region could have here.
        """

    def finish(self) -> bytes:
        """Take the end of the region and return the decoded bytes that were held back.

        Raises TransparencyError when the region can't end here.
        """


class Transparency(Protocol):
    """One kind of transparency with its parameters."""

    @property
    def lenient(self) -> bool:
        """True if the decoder accepts more than the encoder makes."""

    def encode(self, data: bytes) -> bytes:
        """Return the region on the wire that stands for `data`."""

    def decode(self, region: bytes) -> bytes:
        """Return what a whole region stands for; raise TransparencyError as the decoder does."""

    def decoder(self) -> Unstuffer:
        """Return a new decoder at the start of a region."""


def decode_by_byte(unstuffer: Unstuffer, region: bytes) -> bytes:
    """Return what the unstuffer makes of a whole region."""
    released = [unstuffer.push(byte) for byte in region]
    released.append(unstuffer.finish())
    return b"".join(released)


def spelled(data: bytes) -> str:
    """Return the bytes as an error shows them."""
    return data.hex(" ").upper()


def cut_sequence(held: bytes) -> TransparencyError:
    """Return the error where the region ends too early."""
    return TransparencyError(
        "stuffing", f"the region ends inside a sequence, behind {spelled(held)}"
    )
