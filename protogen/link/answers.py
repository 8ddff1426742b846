"""Answers that the schema's exchanges say: a reply with the values by which it is told."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from protogen.link.requests import value_of
from protogen.runtime.attributes import argument, attribute
from protogen.runtime.codec import Protocol as Codec
from protogen.runtime.events import MessageEvent
from protogen.runtime.framing.sender import SenderSpec
from protogen.runtime.line import Exchange
from protogen.runtime.payload.message import Message
from protogen.runtime.values import replace

Made = Callable[[str], tuple[Any, dict[str, Any]]]
"""Makes a message, with parts of its frame."""


class Answers:
    """The replies of an endpoint to requests."""

    def __init__(self, codec: Codec[Any, Any], endpoint: str, made: Made) -> None:
        self._exchanges = {kind: item for item in codec.exchanges for kind in item.requests}
        self._forms = codec.forms(endpoint) if endpoint in codec.endpoints else ()
        self._made = made

    def to(self, event: MessageEvent[Any, Any]) -> tuple[Any, dict[str, Any]] | None:
        """The reply to a request, with parts of its frame; None where none is said."""
        exchange = self._exchanges.get(type(event.message))
        for reply in exchange.replies if exchange else ():
            for form in self._forms:
                assert exchange is not None
                if reply in form.messages and _fits(reply, form, exchange, event):
                    return self._filled(reply, form, exchange, event)
        return None

    def _filled(
        self,
        reply: type[Message],
        form: SenderSpec[Any, Any],
        exchange: Exchange,
        event: MessageEvent[Any, Any],
    ) -> tuple[Any, dict[str, Any]]:
        message, parts = self._made(reply.NAME)
        identity = [part.name for part in form.layout.identity]
        for asked, name in exchange.match:
            value = value_of(event.message, event, asked)
            if attribute(name) in reply.__fields__:
                message = replace(message, **{attribute(name): value})
            elif name not in identity or reply.IDENTITIES is not None:
                parts = {**parts, argument(name): value}
        return message, parts


def _fits(
    reply: type[Message],
    form: SenderSpec[Any, Any],
    exchange: Exchange,
    event: MessageEvent[Any, Any],
) -> bool:
    """True if the reply can have what it is told by: an identity is that of some messages."""
    identity = [part.name for part in form.layout.identity]
    wanted = {
        name: value_of(event.message, event, asked)
        for asked, name in exchange.match
        if name in identity and attribute(name) not in reply.__fields__
    }
    known = [reply.IDENTITY] if reply.IDENTITIES is None else reply.IDENTITIES
    return not wanted or any(
        all(dict(zip(identity, one, strict=True))[name] == wanted[name] for name in wanted)
        for one in known
    )
