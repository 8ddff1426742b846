"""A whole frame as a construct declaration."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, BinaryIO

from protogen.runtime.constructs import Container, PayloadError, Piece
from protogen.runtime.errors import EncodeError
from protogen.runtime.framing.assembly import check_cut, encode_frame
from protogen.runtime.framing.lines import split_parts
from protogen.runtime.framing.machine import Candidate, Cut, Failure
from protogen.runtime.framing.reading import may_start
from protogen.runtime.framing.sender import SenderSpec


class FrameFormat(Piece):
    """One frame of one sender: its identity, counters, values, and the payload's bytes.

    Parsing takes exactly the frame's bytes from the stream and checks them as a decoder does,
    without looking into the payload; building fills in literals, length, checksums and stuffing.
    The size is never fixed. Errors are PayloadErrors, their reasons those of the decoder.
    """

    def __init__(self, sender: SenderSpec[Any, Any]) -> None:
        super().__init__()
        self._sender = sender
        self._start_size = sender.layout.start_size or 1

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> Any:
        start = stream.tell()
        if not may_start(self._sender.layout, stream.read(self._start_size)):
            raise PayloadError("noise", path, start, "no frame starts so")
        stream.seek(start)
        verdict = self._verdict(stream, context.get("told", {}))
        if isinstance(verdict, Failure):
            raise PayloadError(verdict.reason, path, stream.tell(), verdict.problem)
        stream.seek(start + verdict.size)
        layout = self._sender.layout
        shown: dict[str, Any] = {name: verdict.numbers[name] for name in layout.shown}
        for index, characters in layout.texts:
            name = layout.shown[index]
            shown[name] = characters.text(shown[name])
        return Container({**shown, "payload": verdict.payload})

    def _verdict(self, stream: BinaryIO, told: Mapping[str, int]) -> Cut | Failure:
        candidate = Candidate(self._sender, told=told)
        verdict: Cut | Failure | None = None
        while verdict is None:
            byte = stream.read(1)
            verdict = candidate.push(byte[0]) if byte else candidate.flush()
        return verdict

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> Any:
        try:
            stream.write(self._frame(obj))
        except EncodeError as error:
            place = f"{path} -> {error.path}" if error.path else path
            raise PayloadError("value", place, stream.tell(), error.problem) from None
        return obj

    def _frame(self, obj: Mapping[str, Any]) -> bytes:
        parts = {name: value for name, value in obj.items() if not name.startswith("_")}
        payload = parts.pop("payload", b"")
        identity, given = split_parts(self._sender, parts)
        wire = encode_frame(self._sender, identity, payload, given, strict=False)
        told = dict(
            zip((part.name for part in self._sender.layout.identity), identity, strict=True)
        )
        check_cut(self._sender, wire, payload, told)  # The payload may be of any size here.
        return wire
