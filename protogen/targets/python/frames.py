"""Frames as the runtime's tables of parts."""

from __future__ import annotations

from protogen.model.checksums import ChecksumSpec
from protogen.model.frame import Silence
from protogen.model.framing import AfterEnd, Anywhere, End, Start, StartLiteral, StartSet
from protogen.model.identities import Identities
from protogen.model.part_plans import VirtualPlan
from protogen.model.parts import (
    BitsPart,
    ChecksumPart,
    ChoicePart,
    CounterPart,
    IdentityPart,
    LengthPart,
    LiteralPart,
    MirrorBits,
    NumberPart,
    Part,
    PayloadPart,
    ToldLength,
    ToldPart,
    TypedPart,
    ValuePart,
)
from protogen.model.protocol import Sender
from protogen.model.transparency import (
    Base16,
    Cobs,
    Encoding,
    Escape,
    Insertion,
    Substitution,
    Transparency,
)
from protogen.targets.python.formats import numeral
from protogen.targets.python.literals import call, mapping, octets, text, tuple_of


def part(item: Part) -> str:
    """One part of the table."""
    name = text(item.name)
    match item:
        case LiteralPart():
            return call("_rt.LiteralPart", name, octets(item.bytes))
        case BitsPart():
            members = f"members={tuple_of(map(part, item.members))}"
            bits = {"mask": f"0x{item.mask:02X}", "fixed": f"0x{item.fixed:02X}"}
            mirrors = tuple_of(map(mirror, item.mirrors)) if item.mirrors else None
            sums = tuple_of(map(part, item.sums)) if item.sums else None
            given = {**bits, "mirrors": mirrors, "sums": sums}
            return call("_rt.BitsPart", name, number(item), members, **given)
        case IdentityPart():
            return call("_rt.IdentityPart", name, number(item))
        case LengthPart():
            return _length_part(item, number(item))
        case CounterPart() | ValuePart():
            kind = "_rt.CounterPart" if isinstance(item, CounterPart) else "_rt.ValuePart"
            default = None if item.default is None else str(item.default)
            values = tuple_of(map(str, item.values)) if isinstance(item, ChoicePart) else None
            given = {**_bounds(item), "default": default, "values": values}
            return call(kind, name, number(item), **given)
        case ChecksumPart():
            return _checksum_part(item)
        case PayloadPart():
            kept, longest = (None if it is None else str(it) for it in (item.kept, item.longest))
            return call("_rt.PayloadPart", name, kept=kept, longest=longest)
    raise TypeError(f"{type(item).__name__} is no part that a frame has")


def _length_part(item: LengthPart, number_: str) -> str:
    counts = f"counts={tuple_of(map(text, item.counts))}"
    given = {**_bounds(item), "over_wire": "True" if item.over_wire else None}
    return call("_rt.LengthPart", text(item.name), number_, counts, **given)


def mirror(item: MirrorBits) -> str:
    """Bits that follow from another number."""
    flips = f"0x{item.flips:02X}" if item.inverted else None
    return call("_rt.MirrorBits", text(item.name), number(item), text(item.of.name), flips=flips)


def told_part(item: ToldPart) -> str:
    """One part that is not sent."""
    telling = item.telling
    set_by = tuple_of(
        tuple_of((text(it.message or it.name), text(it.name if it.message else "")))
        for it in telling.set_by
    )
    number_ = f"_rt.Number({item.type.bits})"
    given = {
        "default": str(telling.default) if telling.default else None,
        "once": "True" if telling.once else None,
        "set_by": set_by if telling.set_by else None,
        "length": _length_part(item, number_) if isinstance(item, ToldLength) else None,
    }
    return call("_rt.ToldPart", text(item.name), number_, **given)


def virtual_part(plan: VirtualPlan) -> str:
    """One part that is not sent."""
    item = plan.part
    values = (tuple_of((_identity(key), str(value))) for key, value in plan.values)
    default = None if item.default is None else str(item.default)
    given = f"values={tuple_of(values)}"
    return call("_rt.VirtualPart", text(item.name), number(item), given, default=default)


def _identity(key: Identities) -> str:
    if key.count > 1:
        return identities(key)
    return tuple_of(f"0x{value:02X}" for value in key.first)


def identities(several: Identities) -> str:
    """Several identities of one message."""
    parts = (
        tuple_of(tuple_of(f"0x{value:02X}" for value in run) for run in runs)
        for runs in several.runs
    )
    return call("_rt.Identities", tuple_of(parts))


def number(item: TypedPart) -> str:
    """The codec of a part's number."""
    type_ = item.type
    if type_.is_text:
        seven_bits = "True" if type_.byte_bits == 7 else None
        bounds = item.between if isinstance(item, NumberPart) else None
        between = None if bounds is None else octets(bytes(bounds))
        return call("_rt.Characters", str(type_.size), seven_bit=seven_bits, between=between)
    if type_.text is not None:
        return numeral(type_)
    order = text(type_.byte_order) if type_.size > 1 else None
    seven = "True" if type_.byte_bits == 7 else None
    if type_.within is not None:
        place = (str(type_.bits), str(type_.within.low), str(type_.within.size))
        return call("_rt.BitsNumber", *place, order=order, seven_bit=seven)
    return call("_rt.Number", str(type_.bits), order=order, seven_bit=seven)


def _bounds(item: NumberPart) -> dict[str, str]:
    return {"least": str(item.least), "greatest": str(item.greatest)}


def _checksum_part(item: ChecksumPart) -> str:
    return call(
        "_rt.ChecksumPart",
        text(item.name),
        number(item),
        f"algorithm={algorithm(item.algorithm)}",
        f"covers={tuple_of(map(text, item.covers))}",
        over_wire="True" if item.over_wire else None,
        when_payload="True" if item.when_payload else None,
        lowest=str(item.lowest) if item.lowest else None,
    )


def algorithm(spec: ChecksumSpec) -> str:
    """A checksum algorithm with its parameters."""
    match spec.kind:
        case "xor" | "sum":
            return _folded(spec)
        case "fletcher":
            modulus = None if spec.modulus == 255 else str(spec.modulus)
            return call("_checksum.Fletcher16", modulus=modulus)
    return _crc(spec)


def _folded(spec: ChecksumSpec) -> str:
    numbers = {"init": spec.init, "xorout": spec.xorout, "add": spec.add}
    given: dict[str, str | None] = {key: hex(item) for key, item in numbers.items() if item}
    given["mask"] = None if spec.mask is None else hex(spec.mask)
    given["words"] = None if spec.words is None else text(spec.words)
    given["negated"] = "True" if spec.negated else None
    name = "_checksum.Sum" if spec.kind == "sum" else "_checksum.Xor"
    return call(name, *([] if spec.width == 8 else [str(spec.width)]), **given)


def _crc(spec: ChecksumSpec) -> str:
    digits = -(-spec.width // 4)
    return call(
        "_checksum.Crc",
        str(spec.width),
        f"0x{spec.poly:0{digits}X}",
        init=f"0x{spec.init:0{digits}X}",
        refin=str(spec.refin),
        refout=str(spec.refout),
        xorout=f"0x{spec.xorout:0{digits}X}",
    )


def transparency(item: Transparency | None) -> str:
    """The transparency of the covered parts."""
    if item is None:
        return "None"
    lenient = "True" if item.lenient else None
    return encoding(item.encoding, lenient)


def encoding(encoding: Encoding, lenient: str | None = None) -> str:
    """The transparency with an encoding, strict unless it says otherwise."""
    match encoding:
        case Substitution():
            table = mapping({f"0x{key:02X}": octets(value) for key, value in encoding.table})
            return call("_transparency.Substitution", table, lenient=lenient)
        case Insertion():
            given = f"0x{encoding.byte:02X}"
            return call("_transparency.Insertion", octets(encoding.sequence), given)
        case Escape():
            of = ", ".join(f"0x{byte:02X}" for byte in encoding.of)
            given = f"frozenset({{{of}}})"
            return call(
                "_transparency.Escape",
                f"0x{encoding.byte:02X}",
                given,
                _transform(encoding),
                lenient=lenient,
            )
        case Base16():
            return call("_transparency.Base16Upper", lenient=lenient)
        case Cobs():
            return call("_transparency.Cobs", lenient=lenient)


def _transform(encoding: Escape) -> str:
    return {0xFF: '"invert"', 0: '"none"'}.get(encoding.xor, f"0x{encoding.xor:02X}")


def start(item: Start) -> str:
    """The start of a frame."""
    match item:
        case StartLiteral():
            return call("_rt.StartLiteral", octets(item.bytes), protected=str(item.protected))
        case StartSet() if item.is_run:
            bounds = (f"0x{word[0]:02X}" for word in (item.words[0], item.words[-1]))
            return call("_rt.StartSet", *bounds, protected=str(item.protected))
        case StartSet():
            listed = tuple_of(map(octets, item.words))
            return call("_rt.StartWords", listed, protected=str(item.protected))
        case AfterEnd():
            return "_rt.AfterEnd()"
        case Anywhere():
            return "_rt.Anywhere()"


def end(item: End | None) -> str:
    """The end of a frame."""
    if item is None:
        return "None"
    return call("_rt.End", octets(item.bytes), protected=str(item.protected))


def silence(item: Silence | None) -> str | None:
    """The seconds of silence that end a frame; None where something else does."""
    return None if item is None else repr(float(item.seconds))


def stuffed(sender: Sender) -> str:
    """The names of the parts under transparency."""
    frame = sender.frame
    if frame.transparency is None:
        return "()"
    names = [item.name for item in frame.parts]
    first, last = names.index(frame.transparency.first), names.index(frame.transparency.last)
    return tuple_of(text(name) for name in names[first : last + 1])
