"""How busy a line is with what an endpoint sends by itself."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from typing import Self

import msgspec

from protogen.model.frame import Frame
from protogen.model.framing import MessageFraming
from protogen.model.messages import Message
from protogen.model.protocol import Protocol


class Load(msgspec.Struct, frozen=True):
    """Share of the time in which a line is busy: with the smallest frames, and the greatest."""

    least: Fraction
    greatest: Fraction

    @property
    def shown(self) -> str:
        """The share in percent, rounded up."""
        least, greatest = (_percent(share) for share in (self.least, self.greatest))
        return f"{least} %" if least == greatest else f"{least} to {greatest} %"


def _percent(share: Fraction) -> str:
    """Print a share in percent, rounded up: whole from ten on, else to a tenth."""
    places = 1 if share * 100 < 10 else 0
    scale = 10**places
    up = Fraction(-(-share * 100 * scale // 1), scale)
    return f"{float(up):.{places}f}"


class RatedFrame(msgspec.Struct, frozen=True):
    """A message in a form of frame, with its rate."""

    message: str
    rate: Fraction | None
    least: int
    greatest: int
    silence: Fraction
    """Seconds behind it in which nothing is sent."""

    @classmethod
    def of(cls, message: Message, framing: MessageFraming, frame: Frame) -> Self:
        """A message as a sender sends it."""
        silence = Fraction(0) if frame.silence is None else frame.silence.seconds
        return cls(message.name, message.rate, framing.least, framing.greatest, silence)

    def seconds(self, size: int, character: Fraction) -> Fraction:
        """How long so many bytes take."""
        return size * character + self.silence


def load_of(frames: Iterable[RatedFrame], character: Fraction | None) -> Load | None:
    """The load of what one endpoint sends; None where nothing has a rate, or the line has none.

    A message that several forms of frame carry is sent in any of them.
    """
    by_message: dict[str, list[RatedFrame]] = {}
    for frame in frames:
        if frame.rate is not None:
            by_message.setdefault(frame.message, []).append(frame)
    if character is None or not by_message:
        return None
    least = greatest = Fraction(0)
    for forms in by_message.values():
        rate = forms[0].rate or 0
        least += rate * min(form.seconds(form.least, character) for form in forms)
        greatest += rate * max(form.seconds(form.greatest, character) for form in forms)
    return Load(least, greatest)


def line_load(protocol: Protocol, endpoint: str) -> Load | None:
    """How busy an endpoint keeps its line; None where the schema does not say it."""
    frames = []
    for sender in protocol.forms(endpoint):
        known = {message.name: message for message in sender.messages}
        frames += [
            RatedFrame.of(known[item.message], item, sender.frame)
            for item in sender.framing.messages
        ]
    return load_of(frames, protocol.link.byte_time)
