"""pymavlink beside the schemas of the library, which have the messages of its dialect common."""

from __future__ import annotations

from collections.abc import Iterator

from compiled import protocol_of
from library_support import peer_module
from mavlink_support import Mavgen, sent_by_mavgen

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case
from protogen.importing.mavlink.identifiers import identifier
from protogen.importing.mavlink.units import read_unit
from protogen.library import FOLDER
from protogen.model.messages import Message
from protogen.model.payload_plan import AnyStep, BytesStep, FloatStep, IntegerStep, RepeatStep

WIDTHS = {"8": 1, "16": 2, "32": 4, "64": 8}


class Pymavlink:
    """The module that mavgen made of common for a version of the protocol."""

    def __init__(self, module: str, wire: str) -> None:
        peer_module(module)
        self._mavgen = Mavgen("common", wire)
        self.kinds = self._mavgen.kinds
        self.enums = self._mavgen.module.enums

    def frame(self, case: Case) -> bytes:
        return self._mavgen.frame(case.message.upper(), case)

    def sent(self, case: Case) -> Case:
        """The case with what its encoder chooses, the signature too."""
        case = sent_by_mavgen(case)
        if "signature" not in case.parts:
            return case
        signature = int.from_bytes(self.frame(case)[-6:], "big")
        return replace(case, parts=case.parts | {"signature": signature})

    def values(self, case: Case, frame: bytes) -> Values:
        title, is_signed = case.message.upper(), "signature" in case.parts
        read = self._mavgen.read(title, frame, is_signed=is_signed)
        return case.values if read == self._mavgen.values(title, case) else {"it reads": read}

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        return self._mavgen.found(data)

    def types_read(self, data: bytes) -> list[str]:
        """The types of what it finds in a stream."""
        link = self._mavgen.link(is_signed=False)
        link.robust_parsing = True
        return [message.get_type() for message in link.parse_buffer(bytearray(data)) or ()]


def messages_of(name: str) -> dict[str, Message]:
    """The messages of a schema of the library, by the names that definitions have for them."""
    return {message.name.upper(): message for message in protocol_of(FOLDER / f"{name}.yaml").messages}


def frame_of(peer: Pymavlink, wire: str, number: int, payload: bytes, extra: int) -> bytes:
    """A frame with any payload."""
    size = len(payload)
    head = bytes([size, 0, 1, 1, number]) if wire == "1" else bytes([size, 0, 0, 0, 1, 1, number, 0, 0])
    crc = peer._mavgen.module.x25crc(head + payload + bytes([extra])).crc
    return (b"\xfe" if wire == "1" else b"\xfd") + head + payload + crc.to_bytes(2, "little")
