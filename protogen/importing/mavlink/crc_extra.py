"""CRC_EXTRA of a message: a byte that tells whether two sides have the same definition of it.

It goes into the checksum of the frame and is not sent.
"""

from __future__ import annotations

from protogen.importing.mavlink.spec import FieldSpec, Message
from protogen.runtime.checksum import Crc

_MCRF4XX = Crc(16, 0x1021, 0xFFFF, refin=True, refout=True)


def wire_order(message: Message) -> list[FieldSpec]:
    """Return the fields as they are sent: by the size of their elements, extensions at the end."""
    base = [field for field in message.fields if not field.is_extension]
    extensions = [field for field in message.fields if field.is_extension]
    return [*sorted(base, key=lambda field: -field.size), *extensions]


def crc_extra(message: Message) -> int:
    """Return the CRC_EXTRA of a message: of its name, and of types and names of its fields.

    Extensions have no part in it, so that they can come later.
    """
    text = f"{message.name} ".encode()
    for field in wire_order(message):
        if not field.is_extension:
            text += f"{field.type} {field.name} ".encode()
            text += bytes([field.count]) if field.count is not None else b""
    crc = _MCRF4XX.compute(text)
    return (crc & 0xFF) ^ (crc >> 8)
