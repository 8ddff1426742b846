"""Functions for parts that are texts: in C they are numbers, of which each byte is a character."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec

from protogen.c_language.numbers import unsigned_type
from protogen.model.parts import CounterPart, IdentityPart, PartType, ValuePart
from protogen.model.protocol import Protocol
from protogen.targets.c.spelling import Names
from protogen.targets.naming import OWN


class TextView(msgspec.Struct, frozen=True):
    """The functions for texts of some characters."""

    size: int
    bits: int
    """Bits of a character."""
    type: str

    @property
    def mask(self) -> str:
        """What takes the bits of a character."""
        return "0x7FU" if self.bits == 7 else "0xFFU"

    @property
    def words(self) -> tuple[str, str]:
        """What the functions are called behind the protocol's name."""
        return f"text_{self.size}", f"characters_{self.size}"


def texts_of(protocol: Protocol) -> tuple[TextView, ...]:
    """The texts of several characters that frames have; one is a number like any other."""
    found = {
        type_.size: TextView(type_.size, type_.byte_bits, unsigned_type(type_.bits))
        for type_ in _types(protocol)
        if type_.is_text and type_.size > 1
    }
    return tuple(found[size] for size in sorted(found))


def claim_texts(names: Names, protocol: Protocol) -> None:
    """Claim the functions' names."""
    for text in texts_of(protocol):
        for word in text.words:
            names.claim(OWN, word)


def comment_of(type_: PartType) -> str:
    """What is said of a member that is a text."""
    if not type_.is_text or type_.size == 1:
        return ""
    return f"{type_.size} characters, the first one in the highest byte."


def _types(protocol: Protocol) -> Iterator[PartType]:
    for sender in protocol.senders:
        for part in sender.frame.parts:
            if isinstance(part, IdentityPart | CounterPart | ValuePart):
                yield part.type
