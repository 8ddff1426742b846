"""pymavlink beside the schemas of the library, which have the messages of its dialect common."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

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
from protogen.model.numbers import Integer
from protogen.model.payload_plan import IntegerStep, RepeatStep


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

    def crc(self, data: bytes) -> int:
        """The CRC that it computes."""
        crc: int = self._mavgen.module.x25crc(data).crc
        return crc

    def types_read(self, data: bytes) -> list[str]:
        """The types of what it finds in a stream."""
        link = self._mavgen.link(is_signed=False)
        link.robust_parsing = True
        return [message.get_type() for message in link.parse_buffer(bytearray(data)) or ()]


def messages_of(name: str) -> dict[str, Message]:
    """The messages of a schema of the library, by the names that definitions have for them."""
    messages = protocol_of(FOLDER / f"{name}.yaml").messages
    return {message.name.upper(): message for message in messages}


def compare_definitions(name: str, peer: Pymavlink) -> None:
    """Names, units, enums and CRC_EXTRA are those of the peer."""
    messages = messages_of(name)
    assert set(messages) == set(peer.kinds)
    for title, message in messages.items():
        kind = peer.kinds[title]
        assert message.identity[0] == kind.id
        assert message.virtual == (("extra", kind.crc_extra),)
        steps = message.plan.steps
        theirs = kind.ordered_fieldnames[: len(steps)]
        assert [step.name for step in steps] == [identifier(it) for it in theirs]
        for step, field in zip(steps, theirs, strict=True):
            unit = kind.fieldunits_by_name.get(field, "")
            assert step.field.unit == read_unit(unit, Fraction(1)).unit, (title, field)
            enum = kind.fieldenums_by_name.get(field)
            if enum is not None:
                leaf = step.element if isinstance(step, RepeatStep) else step
                assert isinstance(leaf, IntegerStep)
                compare_enum(leaf.type, peer.enums[enum])


def compare_enum(type: Integer, entries: dict[int, Any]) -> None:
    """The names of numbers and bits are those of an enum, without the beginning of those."""
    flags = type.flags.bits if type.flags is not None else ()
    values = type.enum.values if type.enum is not None else ()
    named = [(flag.name, 1 << flag.bit) for flag in flags]
    named += [(item.name, item.value) for item in values]
    assert named
    for name, number in named:
        plain = name.removeprefix("flag_").removesuffix("_value")  # names that a schema can have
        assert identifier(entries[number].name).endswith(plain), name


def frame_of(peer: Pymavlink, wire: str, number: int, payload: bytes, extra: int) -> bytes:
    """A frame with any payload, and the checksum for any CRC_EXTRA."""
    flags = b"" if wire == "1" else bytes(2)
    msgid = number.to_bytes(1 if wire == "1" else 3, "little")
    head = bytes([len(payload), *flags, 0, 1, 1, *msgid])
    crc = peer.crc(head + payload + bytes([extra]))
    return (b"\xfe" if wire == "1" else b"\xfd") + head + payload + crc.to_bytes(2, "little")
