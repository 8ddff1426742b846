"""The messages of a protocol, listed."""

from __future__ import annotations

from collections.abc import Iterator

from protogen.model.messages import Message
from protogen.model.protocol import Protocol, Sender
from protogen.model.sizes import SizeSet
from protogen.model.transparency import FULL_GROUP
from protogen.targets.escape import markdown
from protogen.targets.markdown.frames.framing import sender_title
from protogen.targets.markdown.frames.layout import has_further_codes, is_stuffed, wire_scale
from protogen.targets.markdown.pages.context import Context, sender_code
from protogen.targets.markdown.pages.message import identity_text, overload_text
from protogen.targets.markdown.text.anchors import message_link
from protogen.targets.markdown.text.table import View, table
from protogen.targets.markdown.text.words import code, rate, size_text


def ordered(protocol: Protocol) -> Iterator[Message]:
    """Yield each message once: by its first sender, then by identity, as the indexes list them."""
    for sender in protocol.senders:
        for message in _by_identity(sender):
            if protocol.senders_of(message)[0] is sender:
                yield message


def _by_identity(sender: Sender) -> list[Message]:
    return sorted(sender.messages, key=lambda message: message.identity)


def listing(sender: Sender, context: Context) -> View:
    """Return the table of a sender's messages."""
    parts = " ".join(code(part.name) for part in sender.frame.identity)
    header = (parts, "Message", "On the wire", "Payload", "Per second", "Summary")
    rows = (_row(message, sender, context) for message in _by_identity(sender))
    return {
        "title": f"Messages from {sender_title(sender, context.protocol)}",
        "table": table(header, rows),
    }


def _row(message: Message, sender: Sender, context: Context) -> tuple[str, ...]:
    framing = context.framings[sender.name, message.name]
    return (
        identity_text(sender.frame, message),
        message_link(message.name),
        size_text(SizeSet.between(framing.least, framing.greatest)),
        size_text(message.sizes),
        "" if framing.per_second is None else rate(framing.per_second),
        markdown(message.summary),
    )


def counting(protocol: Protocol) -> tuple[str, ...]:
    """Say what the byte numbers of the messages count."""
    texts = {_counting(sender): sender_code(sender) for sender in protocol.senders}
    if len(texts) == 1:
        return tuple(texts)
    return tuple(f"From {name}: {text}" for text, name in texts.items())


def _counting(sender: Sender) -> str:
    frame = sender.frame
    if has_further_codes(frame, sender.framing.payload):
        return (
            "Frame bytes count from 0 on the wire, the COBS code byte included; behind each "
            f"{FULL_GROUP} bytes without a zero, a further code byte moves what follows a byte on."
        )
    if is_stuffed(frame):
        return (
            "Frame bytes count from 0 in the unstuffed frame; on the wire, every stuffed byte in "
            "front moves a byte further on."
        )
    if any(wire_scale(frame, part) > 1 for part in frame.parts):
        return "Frame bytes count from 0 on the wire, where an encoded byte takes two."
    return "Frame bytes count from 0 on the wire, payload bytes from 0 in the payload."


def overloads(protocol: Protocol) -> Iterator[str]:
    """Yield a line for each identity that several messages share."""
    for sender in protocol.senders:
        for overload in sender.overloads:
            yield f"From {sender_code(sender)}: {overload_text(overload)}"
