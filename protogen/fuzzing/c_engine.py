"""Generated C as an engine."""

from __future__ import annotations

from collections.abc import Sequence

from protogen.fuzzing.c_calls import OK, RANGE, REFUSED, CEvent, Encoded, Step
from protogen.fuzzing.c_driver import Driver
from protogen.fuzzing.c_library import CLibrary
from protogen.fuzzing.c_values import Unfit
from protogen.fuzzing.engine import NOTHING_TOLD, Refused, Seen, Told
from protogen.fuzzing.samples import NOTHING_HELD, Held, Values

_WHY = ("", "size", "value", "encoding", "out of range", "no space", "no frame can have it")


class CEngine:
    """Generated C with its driver, compiled. Raises CompileError."""

    name = "c"

    def __init__(self, driver: Driver, compiler: str) -> None:
        self._library = CLibrary(driver, compiler)
        self._calls = self._library.calls

    def payload(self, message: str, values: Values) -> bytes:
        """Encode the fields alone. Raises Refused."""
        try:
            return _data(self._library.do(self._calls.encode(message, values)))
        except Unfit:
            raise Refused(_WHY[RANGE]) from None

    def values(self, message: str, payload: bytes, held: Held = NOTHING_HELD) -> Values:
        """Decode the fields alone; `held` are those that are parts of the frame."""
        decoded = self._library.do(self._calls.decode(message, payload, held))
        if decoded.values is None:
            raise ValueError(f"{payload.hex()} is refused: {_WHY[decoded.result]}")
        return decoded.values

    def frame(self, sender: str, message: str, values: Values, parts: Values) -> bytes:
        """Encode a whole frame. Raises Refused."""
        try:
            made = self._library.do(self._calls.frame(sender, message, values, parts))
            if made.result == REFUSED:
                self.payload(message, values)  # Says so of a field.
            frame = _data(made)
            if self._calls.sends(sender, message):
                sent = self._library.do(self._calls.send(sender, message, values, parts))
                if sent.data != frame:
                    raise ValueError(f"byte by byte the frame is {sent.data.hex()}")
        except Unfit:
            raise Refused(_WHY[RANGE]) from None
        return frame

    def events(self, sender: str, pieces: Sequence[bytes], told: Told = NOTHING_TOLD) -> list[Seen]:
        """Feed the pieces to a new decoder, which is told this first, and flush it."""
        telling: list[Step] = [("tell", data) for data in self._calls.told(sender, told)]
        steps: list[Step] = [("feed", piece) for piece in pieces]
        call = self._calls.events(sender, [*telling, *steps, ("flush",)])
        return [_seen(event) for events in self._library.do(call) for event in events]


def _data(encoded: Encoded) -> bytes:
    if not encoded.intact:
        raise ValueError("the encoder wrote outside of its buffer")
    if encoded.result != OK:
        raise Refused(_WHY[encoded.result])
    return encoded.data


def _seen(event: CEvent) -> Seen:
    size = event.size or 0
    if event.kind != "message":
        return Seen(event.kind, size)
    payload = event.payload or b""
    return Seen(event.kind, size, event.message, payload, event.values, event.parts)
