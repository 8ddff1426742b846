"""Parts of a sender's frame, and the role of each."""

from __future__ import annotations

from typing import Any

from protogen.copying import field_names
from protogen.model.frame import Frame
from protogen.model.origin import About
from protogen.model.parts import (
    BitsPart,
    CounterPart,
    IdentityPart,
    LengthPart,
    NumberPart,
    Part,
    PartType,
    PayloadPart,
    Telling,
    ToldIdentity,
    ToldLength,
    ToldPart,
    UnsentPart,
    ValuePart,
    VirtualPart,
)
from protogen.passes.context import Context, Loc, about
from protogen.passes.draft import Draft
from protogen.passes.framing.bit_names import check_names, place_of_number
from protogen.passes.framing.capacity import (
    counted_size,
    least_size,
    payload_range,
    range_of,
)
from protogen.passes.framing.checksums import ORDER_HINT, Checksums
from protogen.passes.framing.covered import check_checksums
from protogen.passes.framing.cutting import cut
from protogen.passes.framing.lengths import Lengths
from protogen.passes.framing.literals import literal_of
from protogen.passes.framing.mirrors import MIRRORS, Mirrors, whole_type
from protogen.passes.framing.part_bits import Others, bits_part
from protogen.passes.framing.part_digits import digits_type, is_written, part_type_hint
from protogen.passes.framing.part_values import number_of, text_bounds, text_type
from protogen.passes.framing.silences import check_silence, silence_of
from protogen.passes.framing.told_parts import lone_length, tellers
from protogen.passes.framing.transparencies import transparency_of
from protogen.passes.framing.trimming import trimmed
from protogen.passes.framing.virtual_parts import check_virtual_parts
from protogen.passes.framing.wire_counts import check_wire_length
from protogen.passes.framing.written_frames import WrittenFrame
from protogen.passes.types.type_names import Layout, has_width, integer, integer_width
from protogen.schema.syntax.parts import Part as PartSyntax

PAYLOAD = "payload"

_TYPE = frozenset({"type", "byte_order", "digits", "chars", "code"})
_NUMBER = _TYPE | {"range", "unprotected"}
_ROLES: dict[str, frozenset[str]] = {
    "bits": frozenset({"type", "byte_order", "bits", "size", "unprotected"}),
    **{key: frozenset({"type", "byte_order", "size", key}) for key in MIRRORS},
    "virtual": _TYPE | {"virtual", "size", "default"},
    "told": frozenset({"type", "told", "default", "set_by", "once"}),
    "literal": frozenset({"literal", "unprotected", "type"}),
    "id": _NUMBER | {"id", "size"},
    "counts": _NUMBER | {"counts", "over"},
    "counter": _NUMBER | {"counter", "default"},
    "algorithm": _TYPE | {"algorithm", "covers", "over", "when"},
    "type": _NUMBER | {"size", "default"},
    PAYLOAD: frozenset({"unprotected", "trailing_zeros", "longer"}),
}
_TOLD_LENGTH = frozenset({"counts", "range"})
"""Further keys of a part that is told, where it is a length."""
_TOLD_BITS = (8, 16, 32, 64)
"""So that each value that C can hold is one of the part."""
_IDENTITY_BITS = 64
_COMMON_KEYS = frozenset({"doc", "source"})


def resolve_frames(context: Context, draft: Draft) -> None:
    """One frame for each sender; frames that nobody sends are checked as well."""
    for sender in draft.senders:
        frame = _frame_of(context, sender)
        if frame is not None:
            draft.frames[sender] = frame
    sent = [context.frames[sender] for sender in draft.senders if sender in context.frames]
    seen = {written.loc for written in sent} | {written.transparency_loc for written in sent}
    for written in context.frames.values():
        if not _places(written) <= seen:
            FrameBuilder(context, written).frame()


def _places(written: WrittenFrame) -> set[Loc]:
    """The places where a frame and its transparency, if it has one, are written."""
    return {written.loc} | ({written.transparency_loc} if written.transparency else set())


def _frame_of(context: Context, sender: str) -> Frame | None:
    if sender in context.frames:
        return FrameBuilder(context, context.frames[sender]).frame()
    # A key that is no endpoint is most likely this sender's, misspelled; that was reported.
    if context.syntax.frame.keys() <= context.syntax.endpoints.keys():
        text = f"`{sender}` sends messages but has no frame"
        context.error_at_key("PG157", ("frame",), text)
    return None


class FrameBuilder:
    """Resolves the frame of one sender."""

    def __init__(self, context: Context, written: WrittenFrame) -> None:
        self._context = context
        self._written = written
        self._loc = written.loc
        self._syntax = written.parts
        self._names = list(self._syntax)
        self._layout = Layout(context.syntax.byte_bits, context.byte_order(written.endpoint))
        self._mirrors = Mirrors(context, self._loc, self._syntax)
        self._lengths = Lengths(context, self._loc, self._syntax)
        self._checksums = Checksums(context, self._loc, self._syntax, self._layout.byte_order)

    def frame(self) -> Frame | None:
        """The frame, or None where something about it is wrong."""
        before = self._context.tally.errors
        check_names(self._context, self._loc, self._syntax)
        parts: list[Part | None] = []
        for name, item in self._syntax.items():
            part = self._part(name, item)
            self._mirrors.add(part)
            parts.append(part)
        if PAYLOAD not in self._syntax:
            text = "the frame has no part called `payload`"
            self._context.error_at_key("PG130", self._loc, text)
        transparency = transparency_of(self._context, self._written)
        silence = silence_of(self._context, self._written)
        self._lengths.check_first(parts)
        before += self._checksums.replaced
        if self._context.tally.errors > before or self._loc in self._context.doubtful:
            return None
        frame = Frame(
            parts=tuple(part for part in parts if part and not isinstance(part, UnsentPart)),
            virtual=tuple(part for part in parts if isinstance(part, VirtualPart)),
            told=tuple(part for part in parts if isinstance(part, ToldPart)),
            transparency=transparency,
            limit=self._written.limit,
            silence=silence,
        )
        if not lone_length(self._context, self._written, frame):
            return None
        agreed = self._lengths.agreed(frame)
        if agreed is None:
            return None
        frame = agreed
        if self._syntax[PAYLOAD].trailing_zeros is not None:
            frame = trimmed(self._context, self._loc, frame)
        if self._syntax[PAYLOAD].longer is not None:
            frame = cut(self._context, self._loc, frame)
        self._check(frame)
        return frame if self._context.tally.errors == before else None

    def _check(self, frame: Frame) -> None:
        """Check what can only be asked when all parts are there."""
        check_checksums(self._context, frame, self._loc)
        check_virtual_parts(self._context, frame, self._loc)
        check_wire_length(self._context, frame, self._loc)
        self._check_identity(frame)
        check_silence(self._context, self._written, frame)
        length = next((it for it in frame.lengths if range_of(frame, it) is None), None)
        if length is not None:
            around = counted_size(frame, length, empty=True)
            besides = "1 byte" if around == 1 else f"{around} bytes"
            text = f"`{length.name}` counts {besides} besides the payload"
            text = f"{text}, and can't say more than {length.greatest}"
            place = place_of_number(self._loc, frame, length.name)
            self._context.error_at_key("PG137", place, text)
        elif frame.limit is not None and payload_range(frame) is None:
            text = f"a frame of {self._written.endpoint} has at least {least_size(frame)} bytes"
            loc = self._written.limit_loc
            self._context.error("PG181", loc, f"{text}, and may have {frame.limit}")

    def _check_identity(self, frame: Frame) -> None:
        """Check that one number can hold all identity parts, as decoders compare them."""
        bits = sum(part.type.bits for part in frame.identity)
        if bits > _IDENTITY_BITS:
            text = f"the identity has {bits} bits together, and {_IDENTITY_BITS} are the most"
            hint = "make one of its parts a value: a part with a `type` and no `id`"
            last = frame.identity[-1]
            if isinstance(last, ToldIdentity):
                place: Loc = (*self._loc, last.name, "told")
            else:
                place = (*place_of_number(self._loc, frame, last.name), "id")
            self._context.error_at_key("PG193", place, text, hint)

    # -- parts --------------------------------------------------------------------------------

    def _part(self, name: str, item: PartSyntax) -> Part | None:
        role = self._role(name, item)
        if role is None:
            return None
        text = about(item.doc, item.source, self._context.find_key((*self._loc, name)))
        if role == PAYLOAD:
            return PayloadPart(name=name, about=text, unprotected=item.unprotected)
        if role == "literal":
            return literal_of(self._context, (*self._loc, name), name, item, text)
        type_ = self._type(name, item)
        if type_ is None:
            return None
        if role == "bits":
            others = Others(self._mirrors, self._lengths, self._checksums)
            return bits_part(self._context, (*self._loc, name), item, type_, text, others)
        if role in MIRRORS:
            return self._mirror(name, item, type_, text)
        if role == "algorithm":
            return self._checksums.whole(name, item, type_)
        least, greatest = self._range(name, item, type_)
        part = NumberPart(
            name=name,
            type=type_,
            least=least,
            greatest=greatest,
            about=text,
            unprotected=item.unprotected,
        )
        return self._number(role, item, part)

    def _mirror(self, name: str, item: PartSyntax, type_: PartType, text: About) -> Part | None:
        """A part all of whose bits follow from a number in front."""
        if type_.is_text:
            words = f"`{name}` is a text, and what follows from a number is one"
            self._context.error("PG273", (*self._loc, name, "type"), words)
            return None
        found = self._mirrors.read((*self._loc, name), item, whole_type(type_), text)
        if found is None:
            return None
        return BitsPart(name=name, about=text, type=type_, members=(), fixed=0, mirrors=(found,))

    def _number(self, role: str, item: PartSyntax, part: NumberPart) -> Part:
        """The part as what its role makes of it."""
        if role == "virtual":
            return VirtualPart(
                name=part.name,
                type=part.type,
                about=part.about,
                place=self._parts_before(part.name),
                default=self._default(item, part),
            )
        given = {name: getattr(part, name) for name in field_names(type(part))}
        if role == "told":
            return self._told(item, part, given)
        if role == "id":
            return IdentityPart(**given)
        if role == "counts":
            over_wire = item.over == "wire"
            return LengthPart(**given, counts=self._counted(item, part), over_wire=over_wire)
        kind = CounterPart if role == "counter" else ValuePart
        return kind(**given, default=self._default(item, part))

    def _told(self, item: PartSyntax, part: NumberPart, given: dict[str, Any]) -> Part:
        """A number that receivers are told: a length, or else an identity."""
        telling = Telling(
            place=self._parts_before(part.name),
            default=self._default(item, part) or 0,
            once=item.once is not None,
            set_by=tellers(item.set_by),
        )
        if item.counts is None:
            return ToldIdentity(**given, telling=telling)
        return ToldLength(**given, counts=self._counted(item, part), telling=telling)

    def _counted(self, item: PartSyntax, part: NumberPart) -> tuple[str, ...]:
        return self._lengths.counted((*self._loc, part.name), item.counts or ())

    def _parts_before(self, name: str) -> int:
        """Parts that are sent in front of the one called so."""
        before = self._names[: self._names.index(name)]
        return sum(self._syntax[other].is_sent for other in before)

    def _default(self, item: PartSyntax, part: NumberPart) -> int | None:
        loc = (*self._loc, part.name, "default")
        if item.default is None:
            return None
        default = number_of(self._context, loc, part, item.default)
        if default is not None and not part.holds(default):
            text = f"{part.shown(default)} is out of {part.allowed}"
            self._context.error("PG114", loc, text)
        return default

    def _role(self, name: str, item: PartSyntax) -> str | None:
        written = {key for key in item.model_fields_set if getattr(item, key) is not None}
        role = self._role_key(name, written)
        if role is None:
            self._context.error_at_key(
                "PG131",
                (*self._loc, name),
                f"nothing says what `{name}` does in the frame",
                "give it a literal, id, counts, counter, algorithm, or at least a type",
            )
            return None
        known = _ROLES[role] | _COMMON_KEYS
        if role == "told" and "counts" in written:
            known |= _TOLD_LENGTH
        strange = sorted(written - known)
        for key in strange:
            text = f"`{key}` does not go together with `{role}`"
            self._context.error_at_key("PG131", (*self._loc, name, key), text)
        return None if strange else role

    def _role_key(self, name: str, written: set[str]) -> str | None:
        if name == PAYLOAD:
            return PAYLOAD
        return next((role for role in _ROLES if role in written), None)

    def _type(self, name: str, item: PartSyntax) -> PartType | None:
        if item.type is None:
            text = f"`{name}` needs a `type`"
            self._context.error_at_key("PG131", (*self._loc, name), text)
            return None
        loc = (*self._loc, name, "type")
        if item.type == "ascii" or item.size is not None:
            return text_type(self._context, (*self._loc, name), item, self._layout.byte_bits)
        order = item.byte_order or self._layout.byte_order
        found = integer(item.type, Layout(byte_bits=self._layout.byte_bits, byte_order=order))
        if not has_width(item.type):
            text = f"integers are 1 to 64 bits wide, not {integer_width(item.type)}"
            self._context.error("PG105", loc, text)
            return None
        if found is None or found.signed or found.role == "bool":
            text = f"`{item.type}` is no unsigned integer, which a part of a frame is"
            self._context.error("PG104", loc, text, part_type_hint(item.type))
            return None
        if is_written(item):
            return digits_type(self._context, (*self._loc, name), item, found)
        if item.told and found.bits not in _TOLD_BITS:
            text = f"a part that is told has no bytes, and `{item.type}` is no whole number of them"
            self._context.error("PG105", loc, text, "make it uint8, uint16, uint32 or uint64")
        if item.told:
            return found
        if item.algorithm is None and found.bits < found.byte_bits:
            text = f"a part takes whole bytes, and `{item.type}` is less than one"
            hint = f"make it `uint{found.byte_bits}`"
            hint = hint if item.virtual else f"{hint}, with a `range` if its upper bits are zero"
            self._context.error("PG105", loc, text, hint)
        if found.size > 1 and order is None:
            text = "nothing says in which order the bytes of this number are sent"
            self._context.error("PG109", loc, text, ORDER_HINT)
        return found

    def _range(self, name: str, item: PartSyntax, type_: PartType) -> tuple[int, int]:
        if type_.is_text:
            return text_bounds(self._context, (*self._loc, name), item, type_)
        if item.range is None:
            return type_.least, type_.greatest
        least, greatest = item.range
        loc = (*self._loc, name, "range")
        if least > greatest:
            text = f"the range is empty: {least} is greater than {greatest}"
            self._context.error("PG115", loc, text)
        elif not (type_.holds(least) and type_.holds(greatest)):
            self._context.error("PG114", loc, f"{least} to {greatest} does not fit {item.type}")
        return least, greatest
