"""The Python target's own output as an engine."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal

from protogen.fuzzing.engine import NOTHING_TOLD, Refused, Seen, Told
from protogen.fuzzing.samples import NOTHING_HELD, Held, Values
from protogen.runtime.attributes import arguments, held_arguments
from protogen.runtime.codec import Protocol
from protogen.runtime.decoder import Decoder
from protogen.runtime.errors import EncodeError
from protogen.runtime.values import as_dict


class PythonEngine:
    """A generated module's codec: the reference, or with the module's own `encode` the fast one."""

    def __init__(
        self, codec: Protocol[Any, Any], encode: Callable[..., bytes] | None = None
    ) -> None:
        self.name = "construct" if encode is None else "python"
        self._engine: Literal["construct", "fast"] = "construct" if encode is None else "fast"
        self._encode = encode or codec.encode
        self._codec = codec
        self._messages = {
            message.NAME: message
            for sender in codec.senders.values()
            for message in (*sender.messages, *sender.encode_only)
        }

    def payload(self, message: str, values: Values) -> bytes:
        """Encode the fields alone. Raises Refused."""
        try:
            payload: bytes = self._messages[message].from_dict(values).to_payload()
        except EncodeError as error:
            raise Refused(str(error)) from None
        return payload

    def values(self, message: str, payload: bytes, held: Held = NOTHING_HELD) -> Values:
        """Decode the fields alone; `held` are those that are parts of the frame."""
        values: Values = (
            self._messages[message].from_payload(payload, **held_arguments(held)).to_dict()
        )
        return values

    def frame(self, sender: str, message: str, values: Values, parts: Values) -> bytes:
        """Encode a whole frame. Raises Refused."""
        try:
            record = self._messages[message].from_dict(values)
            spec = self._codec.sender(sender)
            form: dict[str, Any] = {"form": spec.form} if spec.form else {}
            return self._encode(record, spec.name, **form, **arguments(parts))
        except EncodeError as error:
            raise Refused(str(error)) from None

    def events(self, sender: str, pieces: Sequence[bytes], told: Told = NOTHING_TOLD) -> list[Seen]:
        """Feed the pieces to a new decoder, which is told this first, and flush it."""
        endpoint = self._codec.sender(sender).name
        decoder = Decoder(self._codec.forms(endpoint), self._engine)
        decoder.tell(**told)
        events = [event for piece in pieces for event in decoder.feed(piece)]
        return [_seen(event) for event in (*events, *decoder.flush())]


def _seen(event: Any) -> Seen:
    if event.kind != "message":
        return Seen(event.kind, event.size)
    message = event.message
    parts = as_dict(event.parts)
    return Seen(event.kind, event.size, message.NAME, event.payload, message.to_dict(), parts)
