"""A part of a protocol: some of its messages, as a small receiver takes them.

The others are unknown to it. Nothing else changes: how frames are found and checked follows from
the whole protocol, because the other end may send all of it.
"""

from __future__ import annotations

from collections.abc import Collection

from protogen.copying import replace
from protogen.model.framing import Framing
from protogen.model.messages import Message, Overload
from protogen.model.protocol import Protocol, Sender
from protogen.model.sizes import SizeSet
from protogen.passes.framing.frame_plan import plan_frame


def select(
    protocol: Protocol,
    messages: Collection[str] | None = None,
    senders: Collection[str] | None = None,
) -> Protocol:
    """The protocol with only these messages of these senders; None stands for all of them.

    No frame is longer than the greatest of a message that is left, so that a length beyond it is
    wrong as soon as it is read; but where longer payloads are cut, newer versions of these messages
    may be as long as a frame can be. Types, exchanges and the spec hash stay. Raises KeyError where
    a name is unknown.
    """
    for name in messages or ():
        protocol.message(name)
    for name in senders or ():
        if not protocol.forms(name):
            protocol.sender(name)
    if messages is None and senders is None:
        return protocol
    chosen = [
        item
        for item in protocol.senders
        if senders is None or item.name in senders or item.endpoint in senders
    ]
    left = [narrowed for item in chosen if (narrowed := _sender(item, messages)).messages]
    names = {message.name for sender in left for message in sender.messages}
    return replace(
        protocol,
        senders=tuple(left),
        messages=tuple(item for item in protocol.messages if item.name in names),
    )


def narrow(protocol: Protocol) -> Protocol:
    """The protocol as one who knows its messages alone reads it.

    No frame is longer than the greatest of a message, but where longer payloads are cut.
    """
    names = {message.name for message in protocol.messages}
    senders = (item if item.plan.is_cut else _sender(item, names) for item in protocol.senders)
    return replace(protocol, senders=tuple(senders))


def _sender(sender: Sender, messages: Collection[str] | None) -> Sender:
    if messages is None:
        return sender
    left = tuple(message for message in sender.messages if message.name in messages)
    if not left:
        return replace(sender, messages=())
    framing = _framing(sender.framing, left, is_cut=sender.plan.is_cut)
    overloads = tuple(_overloads(sender, {message.name for message in left}))
    plan = plan_frame(sender.frame, framing, left, overloads)
    return replace(
        sender,
        messages=left,
        framing=framing,
        overloads=overloads,
        # What is verified does not depend on what is known: others send all messages.
        plan=replace(plan, virtual=sender.plan.virtual),
    )


def _framing(framing: Framing, messages: tuple[Message, ...], *, is_cut: bool) -> Framing:
    names = {message.name for message in messages}
    sizes = tuple(item for item in framing.messages if item.message in names)
    greatest = max(message.sizes.greatest for message in messages)
    payload = framing.payload
    if is_cut:
        return replace(framing, messages=sizes, least=min(item.least for item in sizes))
    return replace(
        framing,
        messages=sizes,
        least=min(item.least for item in sizes),
        greatest=max(item.greatest for item in sizes),
        payload=SizeSet.between(payload.least, min(payload.greatest, greatest), payload.step),
    )


def _overloads(sender: Sender, left: set[str]) -> list[Overload]:
    """Those that more than one message is left of."""
    found = []
    for overload in sender.overloads:
        names = tuple(name for name in overload.messages if name in left)
        if len(names) > 1:
            yields = overload.yields
            if yields is not None and yields not in names:
                yields = names[0]
            found.append(replace(overload, messages=names, yields=yields))
    return found
