"""Shows what is on a line as readable lines, while it comes."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Sequence
from threading import Condition, Thread
from typing import TYPE_CHECKING, Any

import msgspec
import typer

from protogen.cli.exits import UsageError
from protogen.cli.wire.event_lines import EventLines
from protogen.link.line import LineDecoders

if TYPE_CHECKING:
    from protogen.cli.wire.codec import Codec

_BEHIND = 1 << 16
"""Bytes that wait to be shown; with more, events are only counted, until few wait."""
_FEW = 1 << 12
_MOST_WAITING = 1 << 20
"""The most bytes that wait, for an output that takes no lines."""
_PATIENCE = 5.0
"""Seconds for which the end waits for that output."""


class _Piece(msgspec.Struct, frozen=True):
    """Bytes of a source, and how many of all sources are missing in front of them."""

    source: str
    data: bytes
    missing: int


class ShownEvents:
    """Prints the events of each source in a thread: the line waits for no output.

    What comes faster than it can be printed is left out, and the output says how much it was.
    """

    def __init__(self, codec: Codec, endpoints: Sequence[str]) -> None:
        """`endpoints` are the sources that are endpoints; any may have sent what others send."""
        self._codec = codec
        self._endpoints = endpoints
        self._lines = EventLines(codec.protocol, show_sender=len(codec.senders) > 1)
        self._line = LineDecoders(codec.runtime)
        self._alone: dict[str, LineDecoders] = {}
        silence = codec.protocol.silence
        self._silence = None if silence is None else float(silence)
        self._silent: dict[str, float] = {}
        """When the silence of each source ends what it has begun; in the order of these times."""
        self._left_out = 0
        """Events that were left out since the last one that was shown."""
        self._is_behind = False
        # What the line's thread and that of the output have in common:
        self._changed = Condition()
        self._pieces = deque[_Piece]()
        self._waiting = 0
        self._missing = 0
        self._has_ended = False
        self._error: Exception | None = None
        self._thread = Thread(target=self._run, name="shown events", daemon=True)
        self._thread.start()

    def take(self, source: str, data: bytes) -> None:
        """Have shown what these bytes complete.

        Raises UsageError where no decoder takes any sender's, and what ended the output.
        """
        if self._error is not None:
            raise self._error
        with self._changed:
            if self._waiting > _MOST_WAITING:
                self._missing += len(data)
                return
            self._pieces.append(_Piece(source, data, self._missing))
            self._waiting += len(data)
            self._missing = 0
            self._changed.notify()

    def end(self) -> None:
        """Show what is left, unless nobody takes it. Raises what ended the output."""
        with self._changed:
            self._has_ended = True
            self._changed.notify()
        self._thread.join(_PATIENCE)
        if self._error is not None:
            raise self._error

    # --- the thread -------------------------------------------------------------------------------

    def _run(self) -> None:
        try:
            while self._has_more():
                self._end_silent()
                for piece in self._taken():
                    self._show_piece(piece)
            self._flush()
            self._tell_left_out()
            self._tell_missing(self._missing)
        except Exception as error:  # Whoever gives bytes is told.
            self._error = error

    def _has_more(self) -> bool:
        """Wait for bytes, or the end of a silence; False at the end of all."""
        with self._changed:
            if not self._pieces and not self._has_ended:
                due = next(iter(self._silent.values()), None)
                self._changed.wait(None if due is None else max(0.0, due - time.monotonic()))
            return bool(self._pieces) or not self._has_ended

    def _taken(self) -> list[_Piece]:
        """All pieces that wait; whether they are too many to be shown is found out here."""
        with self._changed:
            self._is_behind = self._waiting > (_FEW if self._is_behind else _BEHIND)
            pieces = list(self._pieces)
            self._pieces.clear()
            self._waiting = 0
        return pieces

    def _show_piece(self, piece: _Piece) -> None:
        if piece.missing:
            self._flush()
            self._tell_missing(piece.missing)
        try:
            events = self._decoders(piece.source).feed(self._endpoint(piece.source), piece.data)
        except ValueError as error:
            hint = f"name them, such as {self._codec.senders[0]}=PORT"
            raise UsageError(f"{error}; which endpoint is at which port?", hint) from None
        self._show(events)
        if self._silence is not None:
            self._silent.pop(piece.source, None)
            self._silent[piece.source] = time.monotonic() + self._silence

    def _end_silent(self) -> None:
        now = time.monotonic()
        for source, due in [*self._silent.items()]:
            if due > now or self._pieces:
                return  # What waits may have come before the silence was over.
            del self._silent[source]
            self._show(self._decoders(source).idle(self._endpoint(source)))

    def _endpoint(self, source: str) -> str:
        return source if source in self._endpoints else ""

    def _decoders(self, source: str) -> LineDecoders:
        """Those of the line; two ports of unknown senders must not be mixed."""
        if source in self._endpoints:
            return self._line
        return self._alone.setdefault(source, LineDecoders(self._codec.runtime))

    def _show(self, events: Sequence[Any]) -> None:
        if self._is_behind:
            self._left_out += len(events)
        elif events:
            self._tell_left_out()
            typer.echo("\n".join(map(self._lines.text, events)))

    def _flush(self) -> None:
        for line in (self._line, *self._alone.values()):
            self._show(line.flush())

    @staticmethod
    def _tell_missing(size: int) -> None:
        if size:
            typer.echo(f"... {size:,} bytes were not shown: the output took no lines")

    def _tell_left_out(self) -> None:
        if self._left_out:
            typer.echo(f"... {self._left_out:,} were not shown, as they came too fast")
            self._left_out = 0
