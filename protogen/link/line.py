"""The decoders of a line: one for each end that sends, which hear each other."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, Protocol

from protogen.runtime.codec import Protocol as Codec
from protogen.runtime.decoder import BytesLike, Decoder
from protogen.runtime.events import Event

NewDecoder = Callable[[str], Decoder[Any, Any]]
"""Makes the decoder of what a source sends; "" stands for any."""


class Generated(Protocol):
    """A generated module."""

    PROTOCOL: Codec[Any, Any]


class LineDecoders:
    """The decoders of what is on a line.

    A *source* is the endpoint whose bytes come in, or "" where any of the senders may have sent
    them. Each source has its own decoder, and offsets count its bytes. What one end sends may tell
    what another's frames are: then all that is fed is decoded, and heard by the other decoders.
    """

    def __init__(
        self,
        codec: Generated | Codec[Any, Any],
        senders: Sequence[str] | None = None,
        idle: float | None = None,
        *,
        new: NewDecoder | None = None,
    ) -> None:
        """`senders` are the endpoints whose events are wanted; without them, all that send.

        `codec` is a generated module, or its `PROTOCOL`. `idle` is for whoever feeds: seconds
        without bytes after which to call `idle`. `new` makes decoders in another way.
        """
        self.codec: Codec[Any, Any] = codec if isinstance(codec, Codec) else codec.PROTOCOL
        self.senders = self.codec.endpoints if senders is None else tuple(senders)
        self.silence = idle
        """Seconds without bytes that end what a decoder holds; None: they never do."""
        self._new = new or self._plain
        self._decoders: dict[str, Decoder[Any, Any]] = {}
        self._is_told = any(item.frame.told for item in self.codec.senders.values())

    @property
    def pending(self) -> int:
        """Bytes that were taken and that no event covers yet."""
        return sum(decoder.pending for decoder in self._decoders.values())

    def prepare(self) -> None:
        """Do now what the first bytes would have to wait for: fill the tables of fast decoding."""
        for name in self.codec.endpoints if self._is_told else self.senders:
            for form in self.codec.forms(name):
                if form.cut is not None:
                    form.cut(b"", 0, 0, [])

    def feed(self, source: str, data: BytesLike) -> list[Event[Any, Any]]:
        """Take bytes; the events that are certain now, of the senders that are wanted.

        Raises ValueError where `source` sends nothing, or is "" and the senders' frames are found
        in different ways, so that no decoder takes them together.
        """
        if not (self._is_told or self._is_wanted(source)):
            return []  # Nobody wants it, and nobody learns from it.
        return self._heard(source, self._decoder(source).feed(data))

    def idle(self, source: str) -> list[Event[Any, Any]]:
        """Take a silence of a source, which ends what it has begun."""
        decoder = self._decoders.get(source)
        return [] if decoder is None else self._heard(source, decoder.idle())

    def flush(self) -> list[Event[Any, Any]]:
        """Take the end of all input; the remaining events."""
        return [event for _, events in self.flush_each() for event in events]

    def flush_each(self) -> list[tuple[str, list[Event[Any, Any]]]]:
        """Take the end of all input; the remaining events of each source."""
        ends = [(source, decoder.flush()) for source, decoder in self._decoders.items()]
        return [(source, self._heard(source, events)) for source, events in ends]

    def _is_wanted(self, source: str) -> bool:
        return not source or source in self.senders

    def _decoder(self, source: str) -> Decoder[Any, Any]:
        """The decoder of a source. With the first one, all are made that have to hear it."""
        found = self._decoders.get(source)
        if found is None:
            for name in (source, *self._listening(source)):
                if name not in self._decoders:
                    self._decoders[name] = self._new(name)
            found = self._decoders[source]
        return found

    def _listening(self, source: str) -> Iterable[str]:
        return self.codec.endpoints if source and self._is_told else ()

    def _plain(self, source: str) -> Decoder[Any, Any]:
        names = (source,) if source else self.senders
        return Decoder([form for name in names for form in self.codec.forms(name)])

    def _heard(self, source: str, events: list[Event[Any, Any]]) -> list[Event[Any, Any]]:
        """The events, if they are wanted; the other decoders hear them."""
        if self._is_told:
            for other in (item for name, item in self._decoders.items() if name != source):
                for event in events:
                    other.hear(event)
        return events if self._is_wanted(source) else []
