"""Which parts does a sender's frame have, and what does each do?"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from itertools import pairwise

from protogen.model.checksums import ChecksumSpec, algorithm_names, find_algorithm
from protogen.model.frame import (
    Base16,
    ChecksumPart,
    Cobs,
    CounterPart,
    Encoding,
    Escape,
    Frame,
    IdentityPart,
    LengthPart,
    LiteralPart,
    NumberPart,
    Part,
    PayloadPart,
    Substitution,
    Transparency,
    ValuePart,
)
from protogen.model.types import ByteOrder, Integer
from protogen.passes.context import Context, Loc, about
from protogen.passes.type_names import COMMON_NAMES, Layout, integer, integer_width
from protogen.problems import hint_for
from protogen.schema.syntax.parts import CrcParameters, EscapeSyntax, TransparencySyntax
from protogen.schema.syntax.parts import Part as PartSyntax

PAYLOAD = "payload"

SLIP = Substitution(table=((0xC0, b"\xdb\xdc"), (0xDB, b"\xdb\xdd")))
"""RFC 1055: END and ESC, each behind ESC with a byte of its own."""

HDLC = Escape(byte=0x7D, of=(0x7D, 0x7E), xor=0x20)
"""RFC 1662: flag and control escape, with bit 5 inverted."""

_ROLES: dict[str, frozenset[str]] = {
    "literal": frozenset({"literal", "unprotected"}),
    "id": frozenset({"id", "type", "range", "byte_order"}),
    "counts": frozenset({"counts", "type", "range", "byte_order"}),
    "counter": frozenset({"counter", "type", "range", "default", "byte_order"}),
    "algorithm": frozenset({"algorithm", "type", "covers", "over", "when", "byte_order"}),
    "type": frozenset({"type", "range", "default", "byte_order"}),
    PAYLOAD: frozenset(),
}
_COMMON_KEYS = frozenset({"doc", "source"})


class FrameBuilder:
    """Resolves the frame of one sender."""

    def __init__(self, context: Context, sender: str, layout: Layout) -> None:
        self._context = context
        self._key = sender if sender in context.syntax.frame else ""
        self._syntax: Mapping[str, PartSyntax] = context.syntax.frame[self._key]
        self._layout = layout

    def frame(self) -> Frame | None:
        """The frame, or None where something about it is wrong."""
        before = len(self._context.problems.errors)
        parts = [self._part(name, item) for name, item in self._syntax.items()]
        if PAYLOAD not in self._syntax:
            loc = ("frame", self._key)
            self._context.error_at_key("PG130", loc, "the frame has no part called `payload`")
        transparency = self._transparency()
        self._one_length(parts)
        known = tuple(part for part in parts if part is not None)
        if len(self._context.problems.errors) > before:
            return None
        return Frame(parts=known, transparency=transparency)

    # -- parts --------------------------------------------------------------------------------

    def _loc(self, *rest: str | int) -> Loc:
        return ("frame", self._key, *rest)

    def _part(self, name: str, item: PartSyntax) -> Part | None:
        role = self._role(name, item)
        if role is None:
            return None
        text = about(item.doc, item.source)
        if role == PAYLOAD:
            return PayloadPart(name=name, about=text)
        if role == "literal":
            return self._literal(name, item)
        type_ = self._type(name, item)
        if type_ is None:
            return None
        if role == "algorithm":
            return self._checksum(name, item, type_)
        least, greatest = self._range(name, item, type_)
        part = NumberPart(name=name, type=type_, least=least, greatest=greatest, about=text)
        return self._number(role, item, part)

    def _number(self, role: str, item: PartSyntax, part: NumberPart) -> Part:
        """The part as what its role makes of it."""
        given = {field.name: getattr(part, field.name) for field in fields(part)}
        if role == "id":
            return IdentityPart(**given)
        if role == "counts":
            return LengthPart(**given, counts=self._counted(part.name, item))
        self._default_fits(item, part)
        if role == "counter":
            return CounterPart(**given, default=item.default)
        return ValuePart(**given, default=item.default)

    def _default_fits(self, item: PartSyntax, part: NumberPart) -> None:
        if item.default is not None and not part.least <= item.default <= part.greatest:
            text = f"{item.default} is out of {part.least} to {part.greatest}"
            self._context.error("PG114", self._loc(part.name, "default"), text)

    def _role(self, name: str, item: PartSyntax) -> str | None:
        written = {key for key in item.model_fields_set if getattr(item, key) is not None}
        role = self._role_key(name, written)
        if role is None:
            self._context.error_at_key(
                "PG131",
                self._loc(name),
                f"nothing says what `{name}` does in the frame",
                "give it a literal, id, counts, counter, algorithm, or at least a type",
            )
            return None
        strange = sorted(written - _ROLES[role] - _COMMON_KEYS)
        for key in strange:
            text = f"`{key}` does not go together with `{role}`"
            self._context.error_at_key("PG131", self._loc(name, key), text)
        return None if strange else role

    def _role_key(self, name: str, written: set[str]) -> str | None:
        if name == PAYLOAD:
            return PAYLOAD
        return next((role for role in _ROLES if role in written), None)

    def _literal(self, name: str, item: PartSyntax) -> LiteralPart:
        if not item.literal:
            self._context.error("PG147", self._loc(name, "literal"), "the literal has no bytes")
        return LiteralPart(
            name=name,
            bytes=item.literal or b"\0",
            unprotected=item.unprotected,
            about=about(item.doc, item.source),
        )

    def _type(self, name: str, item: PartSyntax) -> Integer | None:
        loc = self._loc(name, "type")
        if item.type is None:
            self._context.error_at_key("PG131", self._loc(name), f"`{name}` needs a `type`")
            return None
        order = item.byte_order or self._layout.byte_order
        layout = Layout(byte_bits=self._layout.byte_bits, byte_order=order)
        width = integer_width(item.type)
        if width is not None and not 1 <= width <= 64:
            self._context.error("PG105", loc, f"integers are 1 to 64 bits wide, not {width}")
            return None
        found = integer(item.type, layout)
        if found is None or found.signed or found.role == "bool":
            text = f"`{item.type}` is no unsigned integer, which a part of a frame is"
            self._context.error("PG104", loc, text, hint_for(item.type, COMMON_NAMES))
            return None
        if found.size > 1 and order is None:
            hint = "set `byte_order: little` or `big` on the part or the protocol"
            text = "nothing says in which order the bytes of this number are sent"
            self._context.error("PG109", loc, text, hint)
        return found

    def _range(self, name: str, item: PartSyntax, type_: Integer) -> tuple[int, int]:
        if item.range is None:
            return type_.least, type_.greatest
        least, greatest = item.range
        if least > greatest:
            text = f"the range is empty: {least} is greater than {greatest}"
            self._context.error("PG115", self._loc(name, "range"), text)
        elif not (type_.holds(least) and type_.holds(greatest)):
            text = f"{least} to {greatest} does not fit {item.type}"
            self._context.error("PG114", self._loc(name, "range"), text)
        return least, greatest

    # -- lengths and checksums ----------------------------------------------------------------

    def _counted(self, name: str, item: PartSyntax) -> tuple[str, ...]:
        counts = self.run(item.counts or (), self._loc(name, "counts"))
        names = list(self._syntax)
        if counts and PAYLOAD not in counts:
            text = "a length that does not count the payload can't tell where the frame ends"
            self._context.error("PG133", self._loc(name, "counts"), text)
        if PAYLOAD in names and names.index(name) > names.index(PAYLOAD):
            text = "a length behind the payload comes too late for a receiver"
            self._context.error_at_key("PG133", self._loc(name), text)
        return counts

    def _one_length(self, parts: Sequence[Part | None]) -> None:
        lengths = [part for part in parts if isinstance(part, LengthPart)]
        for part in lengths[1:]:
            text = f"the frame already has a length: `{lengths[0].name}`"
            self._context.error_at_key("PG133", self._loc(part.name), text)

    def _checksum(self, name: str, item: PartSyntax, type_: Integer) -> ChecksumPart | None:
        algorithm = self._algorithm(name, item)
        covers = self._covers(name, item)
        if algorithm is None or covers is None:
            return None
        if algorithm.width != type_.bits:
            text = f"{algorithm.name} has {algorithm.width} bits, {item.type} has {type_.bits}"
            self._context.error("PG135", self._loc(name, "type"), text)
        return ChecksumPart(
            name=name,
            type=type_,
            algorithm=algorithm,
            covers=covers,
            over_wire=item.over == "wire",
            when_payload=item.when is not None,
            about=about(item.doc, item.source),
        )

    def _algorithm(self, name: str, item: PartSyntax) -> ChecksumSpec | None:
        if isinstance(item.algorithm, CrcParameters):
            return self._parameters(name, item.algorithm)
        found = find_algorithm(item.algorithm or "")
        if found is None:
            hint = hint_for(item.algorithm or "", algorithm_names())
            text = f"there is no checksum algorithm `{item.algorithm}`"
            self._context.error("PG134", self._loc(name, "algorithm"), text, hint)
        return found

    def _parameters(self, name: str, given: CrcParameters) -> ChecksumSpec | None:
        for key in ("poly", "init", "xorout"):
            if getattr(given, key) >> given.width:
                text = f"`{key}` has more than {given.width} bits"
                self._context.error("PG135", self._loc(name, "algorithm", key), text)
                return None
        return ChecksumSpec(name="CRC", kind="crc", **given.model_dump())

    def _covers(self, name: str, item: PartSyntax) -> tuple[str, ...] | None:
        if item.covers is None:
            text = f"`{name}` does not say what it covers"
            self._context.error_at_key("PG131", self._loc(name), text, "add `covers: FIRST..LAST`")
            return None
        covers = self.run(item.covers, self._loc(name, "covers"))
        if name in covers:
            self._context.error(
                "PG136", self._loc(name, "covers"), f"the checksum `{name}` covers itself"
            )
        return covers

    # -- runs of parts ------------------------------------------------------------------------

    def run(self, written: Sequence[str], loc: Loc) -> tuple[str, ...]:
        """The names of parts, with `first..last` written out, in wire order."""
        names = list(self._syntax)
        chosen: set[str] = set()
        for item in written:
            ends = item.split("..")
            if not self._all_known(ends, names, loc):
                return ()
            first, last = names.index(ends[0]), names.index(ends[-1])
            if first > last:
                self._context.error("PG132", loc, f"`{ends[0]}` comes behind `{ends[-1]}`")
            chosen.update(names[first : last + 1])
        return tuple(name for name in names if name in chosen)

    def _all_known(self, wanted: Sequence[str], names: Sequence[str], loc: Loc) -> bool:
        for name in wanted:
            if name not in names:
                text = f"the frame has no part called `{name}`"
                self._context.error("PG132", loc, text, hint_for(name, names))
                return False
        return True

    # -- transparency -------------------------------------------------------------------------

    def _transparency(self) -> Transparency | None:
        syntax = self._context.syntax.transparency
        key = self._key if self._key in syntax else ""
        item = syntax.get(key)
        if item is None:
            return None
        loc: Loc = ("transparency", key)
        covered = self._region(item, (*loc, "covers"))
        encoding = self._encoding(item, loc)
        if encoding is None or not covered:
            return None
        return Transparency(
            first=covered[0],
            last=covered[-1],
            encoding=encoding,
            preset=item.preset or item.encoding,
            lenient=item.lenient,
            about=about(item.doc, item.source),
        )

    def _region(self, item: TransparencySyntax, loc: Loc) -> tuple[str, ...]:
        names = list(self._syntax)
        if item.covers is None:
            return _between_literals(self._syntax)
        covered = self.run(item.covers, loc)
        if any(names.index(b) - names.index(a) != 1 for a, b in pairwise(covered)):
            self._context.error("PG138", loc, "the parts under transparency are one run")
        return covered

    def _encoding(self, item: TransparencySyntax, loc: Loc) -> Encoding | None:
        kinds = ("substitute", "escape", "encoding", "preset")
        chosen = [key for key in kinds if getattr(item, key) is not None]
        if len(chosen) != 1:
            self._context.error_at_key(
                "PG138", loc, f"a transparency is exactly one of {', '.join(kinds)}"
            )
            return None
        if item.substitute is not None:
            return Substitution(table=item.substitute)
        if item.escape is not None:
            return self._escape(item.escape, (*loc, "escape"))
        if item.preset is not None:
            return SLIP if item.preset == "slip" else HDLC
        return Base16() if item.encoding == "base16-upper" else Cobs()

    def _escape(self, item: EscapeSyntax, loc: Loc) -> Escape:
        if item.byte not in item.of:
            self._context.error(
                "PG139",
                (*loc, "of"),
                f"the escape byte 0x{item.byte:02X} is not escaped itself",
                "add it to `of`, or a receiver takes it in the data for an escape",
            )
        match item.transform:
            case "invert":
                xor = 0xFF
            case "none":
                xor = 0
            case _:
                xor = item.transform.xor
        return Escape(byte=item.byte, of=tuple(sorted(set(item.of))), xor=xor)


def _between_literals(parts: Mapping[str, PartSyntax]) -> tuple[str, ...]:
    """Everything between the literals that open and those that close the frame."""
    names = list(parts)
    while names and parts[names[0]].literal is not None:
        names.pop(0)
    while names and parts[names[-1]].literal is not None:
        names.pop()
    return tuple(names)


def byte_order_of(context: Context, sender: str) -> ByteOrder | None:
    """The byte order that the protocol states for a sender."""
    order = context.syntax.byte_order
    return order.get(sender, order.get(""))


__all__ = ["HDLC", "SLIP", "FrameBuilder", "byte_order_of"]
