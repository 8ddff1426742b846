"""Parts, and bits of parts, that repeat a number of the frame or complement it."""

from __future__ import annotations

from collections.abc import Mapping

from protogen.model.numbers import BitPlace
from protogen.model.origin import About
from protogen.model.parts import LengthPart, MirrorBits, NumberPart, Part, PartType, varying_bits
from protogen.passes.context import Context, Loc
from protogen.passes.framing.bit_names import holders_of
from protogen.problems import hint_for
from protogen.schema.syntax.parts import Part as PartSyntax
from protogen.schema.syntax.parts import PartBits

MIRRORS = ("repeats", "complements")
"""Keys that name what a part, or some bits, follow from."""
_PAYLOAD = "payload"
_LATE = "is a checksum, which is worked out when all else is known"


def mirror_key(item: PartSyntax | PartBits) -> str | None:
    """The key by which something follows from another number; None where it does not."""
    return next((key for key in MIRRORS if getattr(item, key) is not None), None)


def whole_type(type_: PartType) -> PartType:
    """The type of all bits of a part, as bits of it."""
    place = BitPlace(low=0, size=type_.size)
    return PartType(
        bits=type_.bits, byte_bits=type_.byte_bits, byte_order=type_.byte_order, within=place
    )


class Mirrors:
    """The numbers of a frame, as far as it was read, and what follows from them."""

    def __init__(self, context: Context, loc: Loc, parts: Mapping[str, PartSyntax]) -> None:
        self._context = context
        self._loc = loc
        self._parts = parts
        self._order = list(parts)
        self._holders = holders_of(parts)
        self._numbers: dict[str, Part] = {}

    def add(self, *parts: Part | None) -> None:
        """Take what was read, from which what stands behind it may follow."""
        for part in parts:
            if part is not None:
                self._numbers |= {item.name: item for item in (part, *varying_bits(part))}

    def read(
        self, loc: Loc, item: PartSyntax | PartBits, type_: PartType, text: About
    ) -> MirrorBits | None:
        """The bits of this type that follow from another number; None where that is no such."""
        key = mirror_key(item)
        assert key is not None
        place, named = (*loc, key), getattr(item, key)
        holder = str(loc[len(self._loc)])
        if not self._is_number(place, named) or not self._is_in_front(place, named, holder):
            return None
        of = self._numbers.get(named)
        if not isinstance(of, NumberPart):
            return None  # What is wrong with it was reported.
        if not self._is_plain(place, of):
            return None
        if of.type.bits != type_.bits:
            text_ = f"`{loc[-1]}` has {_bits(type_)}, and `{named}` has {_bits(of.type)}"
            self._context.error("PG274", place, text_)
            return None
        inverted = key == "complements"
        return MirrorBits(name=str(loc[-1]), about=text, type=type_, of=of, inverted=inverted)

    def _is_number(self, place: Loc, named: str) -> bool:
        """True if the frame has something of the name that is a number by itself."""
        item = self._item(named)
        if item is None:
            text = f"the frame has no part called `{named}`"
            hint = hint_for(named, [*self._parts, *self._holders])
            self._context.error("PG132", place, text, hint)
            return False
        what, hint = _no_number(named, item)
        if what:
            self._context.error("PG273", place, f"`{named}` {what}", hint)
        return not what

    def _item(self, name: str) -> PartSyntax | PartBits | None:
        """What is written of a part, or of some bits of one."""
        holder = self._parts.get(self._holders.get(name, name))
        return holder.bits[name] if holder and holder.bits and name in self._holders else holder

    def _is_in_front(self, place: Loc, named: str, holder: str) -> bool:
        other = self._holders.get(named, named)
        where, there = self._order.index(holder), self._order.index(other)
        if there > where:
            text = f"`{named}` stands behind `{holder}`"
            hint = f"let `{named}` follow from what is in front, which is then the number itself"
            self._context.error("PG275", place, text, hint)
            return False
        if _PAYLOAD in self._order[there:where]:
            text = f"`{named}` stands in front of the payload, and `{holder}` behind it"
            self._context.error("PG275", place, text)
            return False
        return True

    def _is_plain(self, place: Loc, of: NumberPart) -> bool:
        if of.type.text is not None or of.type.is_text:
            text = f"`{of.name}` is written as characters, which are no bits of a number"
            self._context.error("PG273", place, text)
            return False
        if isinstance(of, LengthPart) and of.over_wire:
            text = f"`{of.name}` counts bytes on the wire, whose number its copy may change"
            self._context.error("PG273", place, text)
            return False
        return True


def _no_number(name: str, item: PartSyntax | PartBits) -> tuple[str, str | None]:
    """Why something of a frame is no number that others can follow from; and what to do."""
    if isinstance(item, PartBits) and item.const is not None:
        return "is the same in each frame", "write these bits with `const`, too"
    key = mirror_key(item)
    if key is not None:
        of = getattr(item, key)
        return "itself follows from another number", f"name `{of}`" if of != name else None
    if isinstance(item, PartBits):
        return "" if item.algorithm is None else _LATE, None
    if name == _PAYLOAD:
        return "is no number", None
    if item.bits is not None:
        return "has bits that are parts, and is none itself", "name some of its bits"
    whats = {
        "literal": "is a literal",
        "algorithm": _LATE,
        "virtual": "is not sent",
        "told": "is not sent",
    }
    found = (text for key, text in whats.items() if getattr(item, key) is not None)
    return next(found, ""), None


def _bits(type_: PartType) -> str:
    return "1 bit" if type_.bits == 1 else f"{type_.bits} bits"
