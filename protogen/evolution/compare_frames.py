"""Changes between the frames of one sender."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction

from protogen.copying import replace
from protogen.evolution.change import Change, named
from protogen.evolution.shapes import are_crossed, encoding_shape
from protogen.model.checksums import ChecksumSpec
from protogen.model.frame import Frame
from protogen.model.parts import (
    BitsPart,
    ChecksumPart,
    ChoicePart,
    CounterPart,
    LengthPart,
    LiteralPart,
    MirrorBits,
    NumberPart,
    Part,
    PartType,
    PayloadPart,
    ToldIdentity,
    ToldLength,
    ToldPart,
    TypedPart,
    ValuePart,
    VirtualPart,
)
from protogen.model.protocol import Sender
from protogen.model.transparency import Encoding, Escape, Insertion, Substitution, Transparency
from protogen.passes.framing.capacity import payload_range


def compare_frames(old: Sender, new: Sender, tellers: Mapping[str, str]) -> Iterator[Change]:
    """Yield what changed around the payloads of a sender.

    `tellers` has the new names of what tells parts that are not sent.
    """
    yield from _Frames(old, new, tellers).compare(old.frame, new.frame)
    before, after = old.framing.greatest, new.framing.greatest
    if before != after:
        yield Change(
            rule="frame-size-limit",
            place=f"{old.name} frame",
            text=f"{named(str(before), str(after))} bytes",
            sender=old.name,
        )


class _Frames:
    def __init__(self, old: Sender, new: Sender, tellers: Mapping[str, str]) -> None:
        self._old, self._new, self._tellers = old, new, tellers
        self._sender = old.name

    def _change(self, rule: str, part: str, text: str) -> Change:
        place = f"{self._sender} frame.{part}"
        return Change(rule=rule, place=place, text=text, sender=self._sender, part=part)

    def compare(self, old: Frame, new: Frame) -> Iterator[Change]:
        renamed = renamed_parts(old, new)
        crossed = renamed if are_crossed(tuple(renamed.items())) else {}
        before = [renamed.get(part.name, part.name) for part in old.declared]
        after = [part.name for part in new.declared]
        kept = [name for name in before if name in after]
        order = [name for name in after if name in before]
        by_name = {part.name: part for part in new.declared}
        for part, name in zip(old.declared, before, strict=True):
            if name not in by_name:
                yield self._change("frame-part-deleted", part.name, _kind(part))
                continue
            if part.name in crossed:
                yield self._change("frame-part-moved", part.name, f"{part.name} became {name}")
            elif name != part.name:
                change = self._change("frame-part-renamed", part.name, named(part.name, name))
                yield replace(change, old_part=part.name, new_part=name)
            if kept.index(name) != order.index(name):
                words = named(f"place {kept.index(name) + 1}", f"{order.index(name) + 1}")
                yield self._change("frame-part-moved", part.name, words)
            yield from self._part(part, by_name[name], renamed)
        for part in new.declared:
            if part.name not in before:
                yield self._change("frame-part-added", part.name, _kind(part))
        silence = old.silence or new.silence
        if silence is not None and _seconds(old) != _seconds(new):
            words = named(_silence(old), _silence(new))
            yield self._change("frame-silence", silence.name, words)
        yield from self._transparency(old.transparency, new.transparency, renamed)

    def _part(self, old: Part, new: Part, renamed: dict[str, str]) -> Iterator[Change]:
        if type(old) is not type(new):
            roles = CounterPart | ValuePart
            if isinstance(old, roles) and isinstance(new, roles) and _is_alike(old, new):
                yield self._change("frame-part-role", old.name, named(_kind(old), _kind(new)))
                return
            yield self._change("frame-part-kind", old.name, named(_kind(old), _kind(new)))
            return
        if isinstance(old, LiteralPart) and isinstance(new, LiteralPart):
            if old.bytes != new.bytes:
                words = named(old.bytes.hex(" ").upper(), new.bytes.hex(" ").upper())
                yield self._change("frame-literal", old.name, words)
        elif isinstance(old, PayloadPart) and isinstance(new, PayloadPart):
            if old.is_trimmed != new.is_trimmed:
                words = "zeros at the end are " + ("left out" if new.is_trimmed else "sent")
                yield self._change("frame-trailing-zeros", old.name, words)
            if old.is_cut != new.is_cut:
                words = "longer payloads are " + ("cut" if new.is_cut else "refused")
                yield self._change("frame-longer-payloads", old.name, words)
        else:
            yield from self._typed(old, new, renamed)

    def _typed(self, old: Part, new: Part, renamed: dict[str, str]) -> Iterator[Change]:
        if isinstance(old, NumberPart) and isinstance(new, NumberPart):
            yield from self._number(old, new, renamed)
            if isinstance(old, ToldPart) and isinstance(new, ToldPart):
                yield from self._told(old, new)
        elif isinstance(old, BitsPart) and isinstance(new, BitsPart):
            yield from self._bits(old, new, renamed)
        elif isinstance(old, ChecksumPart) and isinstance(new, ChecksumPart):
            yield from self._checksum(old, new, renamed)
        elif isinstance(old, VirtualPart) and isinstance(new, VirtualPart):
            yield from self._virtual(old, new)

    def _bits(self, old: BitsPart, new: BitsPart, renamed: dict[str, str]) -> Iterator[Change]:
        if _layout(old.type) != _layout(new.type):
            labels = named(old.type.label, new.type.label)
            yield self._change("frame-part-type", old.name, labels)
        if (old.mask, old.fixed) != (new.mask, new.fixed):
            words = named(*(f"{it.fixed:X} of the bits {it.mask:X}" for it in (old, new)))
            yield self._change("frame-literal", old.name, words)
        after = {_layout(mirror.type): mirror for mirror in new.mirrors}
        for mirror in old.mirrors:
            other = after.get(_layout(mirror.type))
            if other is not None and _origin(mirror, renamed) != _origin(other, {}):
                words = named(mirror.meaning, other.meaning)
                yield self._change("frame-mirror", mirror.name, words)
        was, now = ((*part.members, *part.sums) for part in (old, new))
        yield from self._members(was, now, renamed)

    def _members(
        self, old: Sequence[Part], new: Sequence[Part], renamed: dict[str, str]
    ) -> Iterator[Change]:
        """Changes of the parts that are bits of one; where they lie is what counts."""
        found = {part.name: part for part in new}
        for part in old:
            other = found.pop(renamed.get(part.name, part.name), None)
            if other is None:
                yield self._change("frame-part-deleted", part.name, _kind(part))
                continue
            if other.name != part.name:
                change = self._change("frame-part-renamed", part.name, named(part.name, other.name))
                yield replace(change, old_part=part.name, new_part=other.name)
            yield from self._part(part, other, renamed)
        for part in found.values():
            yield self._change("frame-part-added", part.name, _kind(part))

    def _number(
        self, old: NumberPart, new: NumberPart, renamed: dict[str, str]
    ) -> Iterator[Change]:
        labels = named(old.type.label, new.type.label)
        is_alike = _layout(old.type) == _layout(new.type)
        if is_alike and old.type.is_text != new.type.is_text:
            yield self._change("frame-part-text", old.name, labels)
        if not is_alike:
            yield self._change("frame-part-type", old.name, labels)
        elif isinstance(old, ChoicePart) and isinstance(new, ChoicePart):
            if set(old.words) != set(new.words):
                words = named(_alternatives(old), _alternatives(new))
                yield self._change("frame-value-range", old.name, words)
        elif (old.least, old.greatest) != (new.least, new.greatest):
            yield self._range(old, new)
        if isinstance(old, LengthPart) and isinstance(new, LengthPart):
            counts = [renamed.get(name, name) for name in old.counts]
            if (counts, old.over_wire) != (list(new.counts), new.over_wire):
                words = named(_counted(old), _counted(new))
                yield self._change("frame-length-rule", old.name, words)
        before, after = _default(old), _default(new)
        if before != after:
            yield self._change("frame-part-default", old.name, named(str(before), str(after)))

    def _range(self, old: NumberPart, new: NumberPart) -> Change:
        """Receivers hold a length to its range, and other numbers where that finds starts."""
        words = named(*(f"{it.shown(it.least)}..{it.shown(it.greatest)}" for it in (old, new)))
        if _refuses(self._old, old, new) or _refuses(self._new, new, old):
            return self._change("frame-value-range", old.name, words)
        if not isinstance(old, LengthPart):
            return self._change("frame-part-range", old.name, words)
        if _fits(self._old, self._new) and _fits(self._new, self._old):
            words = f"{words}, and no message is so long"
            return self._change("frame-part-range", old.name, words)
        return self._change("frame-length-range", old.name, words)

    def _checksum(
        self, old: ChecksumPart, new: ChecksumPart, renamed: dict[str, str]
    ) -> Iterator[Change]:
        if _result(old) != _result(new):
            words = named(_placed_result(old), _placed_result(new))
            yield self._change("frame-checksum-algorithm", old.name, words)
        covers = [renamed.get(name, name) for name in old.covers]
        if (covers, old.over_wire, old.when_payload) != (
            list(new.covers),
            new.over_wire,
            new.when_payload,
        ):
            words = named(_coverage(old), _coverage(new))
            yield self._change("frame-checksum-coverage", old.name, words)

    def _told(self, old: ToldPart, new: ToldPart) -> Iterator[Change]:
        """What receivers take a frame for, beside what they are told."""
        was, now = ((it.telling.default, it.telling.once, _tellers(it)) for it in (old, new))
        setters = tuple(sorted(self._tellers.get(name, name) for name in was[2]))
        if (*was[:2], setters) != now:
            words = named(_telling(old), _telling(new))
            yield self._change("frame-told", old.name, words)

    def _virtual(self, old: VirtualPart, new: VirtualPart) -> Iterator[Change]:
        if _layout(old.type) != _layout(new.type):
            words = named(old.type.label, new.type.label)
            yield self._change("frame-part-type", old.name, words)
        before, after = (
            "none" if part.default is None else str(part.shown(part.default)) for part in (old, new)
        )
        if before != after:
            yield self._change("frame-virtual-default", old.name, named(before, after))

    def _transparency(
        self, old: Transparency | None, new: Transparency | None, renamed: dict[str, str]
    ) -> Iterator[Change]:
        if _essence(old, renamed) != _essence(new, {}):
            words = named(_stuffing(old), _stuffing(new))
            yield self._change("frame-transparency", "transparency", words)
        elif old is not None and new is not None and old.lenient != new.lenient:
            words = "sloppy encodings are " + ("taken" if new.lenient else "refused")
            yield self._change("frame-leniency", "transparency", words)


def _tellers(part: ToldPart) -> tuple[str, ...]:
    return tuple(sorted(item.text for item in part.telling.set_by))


def _telling(part: ToldPart) -> str:
    """What tells a part that is not sent, for how long, and its value before, in words."""
    telling = part.telling
    by = f"told by {' and '.join(_tellers(part))}" if telling.set_by else "told by the program"
    once = ", for one frame" if telling.once else ""
    return f"{part.shown(telling.default)}, {by}{once}"


def _origin(mirror: MirrorBits, renamed: dict[str, str]) -> tuple[str, bool]:
    """What bits follow from, by its name in the new version, and how."""
    return renamed.get(mirror.of.name, mirror.of.name), mirror.inverted


def renamed_parts(old: Frame, new: Frame) -> dict[str, str]:
    """Parts that are the same but for their names."""
    before = {part.name for part in old.declared}
    after = {part.name for part in new.declared}
    found = {}
    for one, other in zip(old.declared, new.declared, strict=False):
        if one.name not in after and other.name not in before and type(one) is type(other):
            found[one.name] = other.name
        if isinstance(one, BitsPart) and isinstance(other, BitsPart):
            found |= _renamed_bits(one, other)
    return found


def _renamed_bits(old: BitsPart, new: BitsPart) -> dict[str, str]:
    """Parts that are the same bits of one, under another name."""
    before, after = (
        {part.type: part.name for part in (*it.members, *it.sums)} for it in (old, new)
    )
    names = {name: after[type_] for type_, name in before.items() if type_ in after}
    return {
        name: other
        for name, other in names.items()
        if name not in after.values() and other not in before.values()
    }


def _fits(sender: Sender, receiver: Sender) -> bool:
    """True if the receiver's length can say the sizes of the messages that both have."""
    taken = payload_range(receiver.frame)
    names = {message.name for message in receiver.messages}
    messages = (message for message in sender.messages if message.name in names)
    sizes = [sender.frame.payload.sent(message.sizes) for message in messages]
    return taken is None or all(taken.holds(item) for item in sizes)


def _refuses(receiver: Sender, part: NumberPart, sent: NumberPart) -> bool:
    """True if a receiver holds the part to its range, and the other version sends more."""
    is_bounded = any(item.part is part for item in receiver.plan.bounded)
    return is_bounded and (sent.least < part.least or sent.greatest > part.greatest)


def _is_alike(old: NumberPart, new: NumberPart) -> bool:
    """True if receivers take the same numbers from the same bytes."""
    numbers = [(_layout(part.type), part.least, part.greatest) for part in (old, new)]
    return numbers[0] == numbers[1]


def _default(part: Part) -> int | str | None:
    if not isinstance(part, CounterPart | ValuePart) or part.default is None:
        return None
    return part.shown(part.default)


def _layout(type: PartType) -> tuple[object, ...]:
    """Layout of its bytes; how the number is shown does not count."""
    return type.bits, type.signed, type.byte_bits, type.byte_order, type.text, type.within


def _sum(algorithm: ChecksumSpec) -> object:
    """The algorithm by its parameters; its name does not count."""
    return replace(algorithm, name=""), algorithm.modulus


def _result(part: ChecksumPart) -> object:
    """The bits of a result, and where they stand."""
    return _sum(part.algorithm), part.lowest, _layout(part.type)


def _placed_result(part: ChecksumPart) -> str:
    taken = f"{part.taken} of " if part.taken else ""
    return f"{taken}{part.algorithm.name} in {part.type.label}"


_KINDS = {ToldIdentity: "told identity", ToldLength: "told length"}


def _kind(part: Part) -> str:
    name = _KINDS.get(type(part)) or type(part).__name__.removesuffix("Part").lower()
    if isinstance(part, ChoicePart):
        return f"one of the literals {_alternatives(part)}"
    if isinstance(part, TypedPart):
        return f"{name}, {part.type.label}"
    return f"{name} {part.bytes.hex(' ').upper()}" if isinstance(part, LiteralPart) else name


def _alternatives(part: ChoicePart) -> str:
    return " or ".join(word.hex(" ").upper() for word in part.words)


def _listed(names: tuple[str, ...]) -> str:
    return ", ".join(names)


def _counted(part: LengthPart) -> str:
    return f"{_listed(part.counts)}{' on the wire' if part.over_wire else ''}"


def _coverage(part: ChecksumPart) -> str:
    wire = " on the wire" if part.over_wire else ""
    empty = ", absent without a payload" if part.when_payload else ""
    return f"{_listed(part.covers)}{wire}{empty}"


def _seconds(frame: Frame) -> Fraction | None:
    return None if frame.silence is None else frame.silence.seconds


def _silence(frame: Frame) -> str:
    return "no silence" if frame.silence is None else f"{frame.silence.text} of silence"


def _essence(item: Transparency | None, renamed: dict[str, str]) -> object:
    if item is None:
        return None
    first, last = (renamed.get(name, name) for name in (item.first, item.last))
    return first, last, encoding_shape(item.encoding)


def _stuffing(item: Transparency | None) -> str:
    if item is None:
        return "none"
    return f"{_encoding(item.encoding)} over {item.first}..{item.last}"


def _encoding(item: Encoding) -> str:
    match item:
        case Escape():
            return (
                f"escape {item.byte:02X} of {bytes(item.of).hex(' ').upper()}, xor {item.xor:02X}"
            )
        case Substitution():
            pairs = (f"{byte:02X} as {other.hex(' ').upper()}" for byte, other in item.table)
            return f"{', '.join(pairs)}"
        case Insertion():
            return f"{item.byte:02X} put in behind {item.sequence.hex(' ').upper()}"
    return type(item).__name__.lower()
