"""What the bench goes by: frames and payloads as the compiler worked them out, as JSON."""

from __future__ import annotations

from protogen.model.protocol import Protocol
from protogen.targets.html.plans.frames import FramePlans
from protogen.targets.html.plans.messages import MessagePlans
from protogen.targets.html.plans.plain import Json
from protogen.targets.html.plans.types import TypeTable
from protogen.targets.typescript.names import names_of


def plans(protocol: Protocol) -> Json:
    """The protocol."""
    types = TypeTable()
    frames, payloads = FramePlans(types), MessagePlans(names_of(protocol), types)
    senders = [frames.sender(item) for item in protocol.senders]
    messages = {item.name: payloads.message(item) for item in protocol.messages}
    return {
        "name": protocol.name,
        "schema": protocol.files[0],
        "byteRate": _rate(protocol),
        "senders": senders,
        "messages": messages,
        "examples": [
            {
                "message": message.name,
                "name": item.name,
                "sender": item.sender,
                "hex": item.bytes.hex(),
            }
            for message in protocol.messages
            for item in message.examples
            if item.covers is None
        ],
        "types": types.types,
        "enums": types.enums,
    }


def _rate(protocol: Protocol) -> float | None:
    """Bytes a second that the link carries."""
    time = protocol.link.byte_time
    return None if time is None else float(1 / time)
