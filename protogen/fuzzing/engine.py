"""Interface of a codec under test."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Protocol

import msgspec

from protogen.fuzzing.samples import NOTHING_HELD, Held, Values

Told = Mapping[str, int]
"""Values of identity parts that are not sent, by their names."""
NOTHING_TOLD: Told = MappingProxyType({})


class Refused(Exception):  # noqa: N818 - an answer, not an error of the program
    """The engine will not send these values, and says why."""


class Seen(msgspec.Struct, frozen=True):
    """Event of a decoder; all but `kind` and `size` is a message's."""

    kind: str
    size: int
    message: str = ""
    payload: bytes = b""
    values: Values | None = None
    parts: Values | None = None


class Engine(Protocol):
    """A codec under test. Values are those of JSON lines."""

    @property
    def name(self) -> str:
        """Name in reports."""

    def payload(self, message: str, values: Values) -> bytes:
        """Encode the fields alone. Raises Refused."""

    def values(self, message: str, payload: bytes, held: Held = NOTHING_HELD) -> Values:
        """Decode the fields alone; `held` are those that are parts of the frame."""

    def frame(self, sender: str, message: str, values: Values, parts: Values) -> bytes:
        """Encode a whole frame. Raises Refused."""

    def events(self, sender: str, pieces: Sequence[bytes], told: Told = NOTHING_TOLD) -> list[Seen]:
        """Feed the pieces to a new decoder, which is told this first, and flush it."""
