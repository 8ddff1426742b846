"""Silences that the times of a log tell of."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

from protogen.cli.exits import UsageError
from protogen.cli.wire.tagged import Piece

if TYPE_CHECKING:
    from protogen.model.protocol import Protocol

_SECOND = 10**9


class _Sent(NamedTuple):
    """When bytes were noted down, and how long they were on the line."""

    when: int
    duration: Fraction


class Silences:
    """Which bytes come behind a silence that ends what a decoder holds."""

    def __init__(self, protocol: Protocol) -> None:
        """Of frames that a silence ends, or a link with an `idle_timeout`.

        Raises UsageError where there is neither.
        """
        link, ends = protocol.link, protocol.frame_silences
        if link.idle_timeout is None and not ends:
            raise UsageError(
                "the schema does not say which silence ends a frame",
                "give it, such as `link: {idle_timeout: 20 ms}`, or leave --timed out",
            )
        self._ends = ends
        self._timeout = link.idle_timeout
        self._of_byte = (link.byte_time or Fraction(0)) * _SECOND
        self._last: dict[str, _Sent] = {}

    def _of(self, sender: str) -> Fraction | None:
        """Seconds of silence that end what a sender, or any if it has no name, has begun."""
        ends = self._ends.values() if not sender else filter(None, [self._ends.get(sender)])
        return min(ends, default=self._timeout)

    def passed(self, piece: Piece) -> list[str]:
        """The senders that were silent for at least that long in front of these bytes.

        A line may be noted down when its bytes begin or when they are there, so the longer time
        that they, or those before, were on the line is no silence.
        """
        if piece.when is None:
            return []
        duration = len(piece.data) * self._of_byte
        before = self._last.get(piece.sender)
        if before is not None and before.when == piece.when:
            duration += before.duration
        found = [
            name
            for name, sent in self._last.items()
            if self._is_over(name, piece.when - sent.when - max(sent.duration, duration))
        ]
        self._last[piece.sender] = _Sent(piece.when, duration)
        return found

    def _is_over(self, sender: str, passed: Fraction) -> bool:
        silence = self._of(sender)
        return silence is not None and passed >= silence * _SECOND
