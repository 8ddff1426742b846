"""In which order are the bytes of a sender's numbers?"""

from __future__ import annotations

from protogen.model.types import ByteOrder
from protogen.passes.context import Context
from protogen.schema.syntax.protocol import ALL_SENDERS


def byte_order_of(context: Context, sender: str) -> ByteOrder | None:
    """The byte order that the protocol states for a sender."""
    order = context.syntax.byte_order
    return order.get(sender, order.get(ALL_SENDERS))
