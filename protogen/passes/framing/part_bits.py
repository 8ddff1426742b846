"""Parts that are bits of another one, and bits that are the same in each frame."""

from __future__ import annotations

from typing import NamedTuple

from protogen.copying import field_names, replace
from protogen.model.numbers import BitPlace
from protogen.model.origin import About
from protogen.model.parts import (
    BitsMember,
    BitsPart,
    ChecksumPart,
    CounterPart,
    FixedBits,
    IdentityPart,
    LengthPart,
    NumberPart,
    PartType,
    ValuePart,
    place_mask,
)
from protogen.passes.context import Context, Loc, about
from protogen.passes.framing.checksums import Checksums
from protogen.passes.framing.lengths import Lengths
from protogen.passes.framing.mirrors import MIRRORS, Mirrors, mirror_key
from protogen.passes.framing.part_values import number_of
from protogen.schema.syntax.parts import Part, PartBits

_OF_SUMS = ("algorithm", "covers", "takes")
"""Keys that only bits have that are a checksum."""
_OF_MEMBERS = ("id", "counts", "counter", "range", "default")
"""Keys that only bits have that are a part of their own."""
_ROLES = {
    "algorithm": _OF_MEMBERS,
    "id": ("counts", "counter", "default"),
    "counts": ("counter", "default"),
}
"""Keys that say what bits are that are a part, and keys that do not go together with them."""


class Others(NamedTuple):
    """What bits of a part have to do with other parts of the frame."""

    mirrors: Mirrors
    lengths: Lengths
    checksums: Checksums


def bits_part(
    context: Context, loc: Loc, item: Part, type_: PartType, text: About, others: Others
) -> BitsPart | None:
    """The part whose bits these are; None where something about them is wrong."""
    before = context.tally.errors
    loc = (*loc, "bits")
    if type_.is_text:
        hint = "give the part a type such as `uint8`"
        context.error_at_key("PG256", loc, "the bits of a text are those of its characters", hint)
        return None
    reader = _Reader(context, loc, type_, others)
    for name, bits in (item.bits or {}).items():
        reader.read(name, bits)
    others.mirrors.add(*reader.members)
    mirrored = [others.mirrors.read(*given) for given in reader.mirrors]
    varies = reader.members or mirrored or reader.sums
    if not varies and context.tally.errors == before:
        hint = "leave out `bits` and `type`, and write the bytes as a `literal`"
        context.error_at_key("PG260", loc, "no bit of the part varies", hint)
    if context.tally.errors > before:
        return None
    return BitsPart(
        name=str(loc[-2]),
        about=text,
        unprotected=item.unprotected,
        type=type_,
        members=tuple(reader.members),
        fixed=reader.fixed,
        constants=tuple(reader.constants),
        mirrors=tuple(filter(None, mirrored)),
        sums=tuple(reader.sums),
    )


class _Reader:
    """The named bits of one part, read one after another."""

    def __init__(self, context: Context, loc: Loc, type_: PartType, others: Others) -> None:
        self._context = context
        self._loc = loc
        self._type = type_
        self._lengths = others.lengths
        self._checksums = others.checksums
        self._taken: dict[str, int] = {}
        self.members: list[BitsMember] = []
        self.fixed = 0
        self.constants: list[FixedBits] = []
        self.mirrors: list[tuple[Loc, PartBits, PartType, About]] = []
        """Bits that follow from others, which may stand behind them in the schema."""
        self.sums: list[ChecksumPart] = []

    def read(self, name: str, item: PartBits) -> None:
        """Take some bits."""
        loc, (low, high) = (*self._loc, name), item.bits
        if low > high:
            text = f"{low}..{high} is no run of bits"
            hint = f"write `{high}..{low}`: the lower bit stands first"
            self._context.error_at_key("PG256", loc, text, hint)
            return
        if high >= self._type.bits:
            text = f"`{name}` has bit {high}, and {self._type.name} ends with {self._type.bits - 1}"
            self._context.error_at_key("PG256", loc, text)
            return
        place = BitPlace(low=low, size=self._type.size)
        type_ = replace(self._type, bits=high - low + 1, role="number", within=place)
        mask = place_mask(type_)
        for other, taken in self._taken.items():
            if taken & mask:
                text = f"the bits of `{name}` overlap those of `{other}`"
                self._context.error_at_key("PG257", loc, text)
                return
        self._taken[name] = mask
        if item.const is not None:
            self._constant(loc, item, type_)
        elif mirror_key(item) is not None:
            self._mirror(loc, item, type_)
        else:
            self._member(loc, item, type_)

    def _constant(self, loc: Loc, item: PartBits, type_: PartType) -> None:
        """Bits that are the same in each frame."""
        const = item.const or 0
        self._check_alone(loc, item, "const", "PG260")
        if const > type_.greatest:
            text = f"{const} does not fit {type_.label}"
            self._context.error("PG114", (*loc, "const"), text)
            return
        assert type_.within is not None
        self.fixed |= const << type_.within.low
        given = about(item.doc, item.source, self._context.find_key(loc))
        self.constants.append(FixedBits(name=str(loc[-1]), about=given, type=type_, value=const))

    def _mirror(self, loc: Loc, item: PartBits, type_: PartType) -> None:
        """Bits that follow from others; those of this part are known when all of it was read."""
        own = mirror_key(item)
        assert own is not None
        self._check_alone(loc, item, own, "PG276")
        given = about(item.doc, item.source, self._context.find_key(loc))
        self.mirrors.append((loc, item, type_, given))

    def _check_alone(self, loc: Loc, item: PartBits, own: str, code: str) -> None:
        """Report other keys that say what the bits are."""
        for key in (*MIRRORS, *_OF_SUMS, *_OF_MEMBERS):
            if key != own and getattr(item, key) is not None:
                text = f"`{key}` does not go together with `{own}`"
                self._context.error(code, (*loc, key), text, f"remove `{key}`")

    def _member(self, loc: Loc, item: PartBits, type_: PartType) -> None:
        """Bits that are a part of their own."""
        role = next((key for key in _ROLES if getattr(item, key) is not None), None)
        others = _ROLES.get(role or "", ())
        strange = next((key for key in others if getattr(item, key) is not None), None)
        if strange is not None:
            text = f"`{strange}` does not go together with `{role}`"
            self._context.error("PG131", (*loc, strange), text)
            return
        if role == "algorithm":
            self._sum(loc, item, type_)
            return
        alone = next((key for key in _OF_SUMS if getattr(item, key) is not None), None)
        if alone is not None:
            text = f"`{alone}` is for bits that are a checksum"
            self._context.error("PG131", (*loc, alone), text, "add the checksum's `algorithm`")
            return
        least, greatest = item.range or (type_.least, type_.greatest)
        if least > greatest:
            text = f"the range is empty: {least} is greater than {greatest}"
            self._context.error("PG115", (*loc, "range"), text)
        elif not (type_.holds(least) and type_.holds(greatest)):
            text = f"{least} to {greatest} does not fit {type_.label}"
            self._context.error("PG114", (*loc, "range"), text)
        part = NumberPart(
            name=str(loc[-1]),
            type=type_,
            least=least,
            greatest=greatest,
            about=about(item.doc, item.source, self._context.find_key(loc)),
        )
        given = {name: getattr(part, name) for name in field_names(type(part))}
        if item.id is not None:
            self.members.append(IdentityPart(**given))
            return
        if item.counts is not None:
            counts = self._lengths.counted(loc, item.counts)
            self.members.append(LengthPart(**given, counts=counts))
            return
        kind = ValuePart if item.counter is None else CounterPart
        self.members.append(kind(**given, default=self._default(loc, item, part)))

    def _sum(self, loc: Loc, item: PartBits, type_: PartType) -> None:
        """Bits that are a checksum, or some bits of one."""
        found = self._checksums.bits(loc, item, type_)
        if found is not None:
            self.sums.append(found)

    def _default(self, loc: Loc, item: PartBits, part: NumberPart) -> int | None:
        if item.default is None:
            return None
        place = (*loc, "default")
        default = number_of(self._context, place, part, item.default)
        if default is not None and not part.holds(default):
            self._context.error("PG114", place, f"{default} is out of {part.allowed}")
        return default
