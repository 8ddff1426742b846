"""Handlers: one function for each message that a receiver can get, and what calls it."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec

from protogen.targets.c.decoders.decoder import DecoderView
from protogen.targets.c.payload.message_names import claim_handler
from protogen.targets.c.payload.messages import MessageView
from protogen.targets.c.spelling import Names, from_sender


class Handler(msgspec.Struct, frozen=True):
    """The function for one message of one sender."""

    function: str
    """`rn1_on_gyro`; with the sender's name behind it where several send the message."""
    message: MessageView
    parts: str
    """The struct of the frame's parts."""

    @property
    def arguments(self) -> tuple[str, ...]:
        """Parameters of the function."""
        return ("void *user", *self.message.parameter, f"const {self.parts} *parts")


class Dispatch(msgspec.Struct, frozen=True):
    """Calls the handlers for what one endpoint sends."""

    decoder: DecoderView
    handlers: tuple[Handler, ...]


def dispatches(
    decoders: Sequence[DecoderView], messages: Sequence[MessageView], names: Names
) -> tuple[Dispatch, ...]:
    """The handlers of each decoder's messages, in the schema's order."""
    received = {d.name: {m.name for group in d.groups for m in group.messages} for d in decoders}
    return tuple(
        Dispatch(
            decoder,
            tuple(
                Handler(
                    claim_handler(names, message.name, _suffix(message, decoder, received)),
                    message,
                    f"struct {decoder.prefix}_parts",
                )
                for message in messages
                if message.name in received[decoder.name]
            ),
        )
        for decoder in decoders
    )


def _suffix(message: MessageView, decoder: DecoderView, received: dict[str, set[str]]) -> str:
    is_shared = sum(message.name in names for names in received.values()) > 1
    return from_sender(decoder.name) if is_shared else ""
