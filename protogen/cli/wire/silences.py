"""Silences that the times of a log tell of."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from protogen.cli.exits import UsageError
from protogen.cli.wire.tagged import Piece
from protogen.model.protocol import Link

_SECOND = 10**9


class _Sent(NamedTuple):
    """When bytes were noted down, and how long they were on the line."""

    when: int
    duration: Fraction


class Silences:
    """Which bytes come behind a silence that ends what a decoder holds."""

    def __init__(self, link: Link) -> None:
        """Of a link with an `idle_timeout`. Raises UsageError where it has none."""
        if link.idle_timeout is None:
            raise UsageError(
                "the schema does not say which silence ends a frame",
                "give it, such as `link: {idle_timeout: 20 ms}`, or leave --timed out",
            )
        self._timeout = link.idle_timeout * _SECOND
        bits = Fraction(link.bits_per_byte * _SECOND)
        self._of_byte = bits / link.baud if link.baud else Fraction(0)
        self._last: dict[str, _Sent] = {}

    def are_in_front(self, piece: Piece) -> bool:
        """True if its sender was silent for at least the timeout in front of these bytes.

        A line may be noted down when its bytes begin or when they are there, so the longer time
        that they, or those before, were on the line is no silence.
        """
        if piece.when is None:
            return False
        duration = len(piece.data) * self._of_byte
        before = self._last.get(piece.sender)
        if before is not None and before.when == piece.when:
            duration += before.duration
        self._last[piece.sender] = _Sent(piece.when, duration)
        if before is None:
            return False
        return piece.when - before.when - max(before.duration, duration) >= self._timeout
