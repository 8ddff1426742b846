"""Frame plans as objects that the runtime's decoder and encoder go by."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from protogen.model.checksums import ChecksumSpec
from protogen.model.frame_places import Place, PlacedPart, Run, Side
from protogen.model.frame_plan import FramePlan, StartRule
from protogen.model.identities import Identities
from protogen.model.messages import Message
from protogen.model.part_plans import ChecksumPlan, IdentityGroup, VirtualPlan
from protogen.model.parts import (
    BitsPart,
    ChecksumPart,
    ChoicePart,
    CounterPart,
    IdentityPart,
    LengthPart,
    LiteralPart,
    NumberPart,
    Part,
    PayloadPart,
    ToldLength,
    ToldPart,
    TypedPart,
    ValuePart,
    VirtualPart,
)
from protogen.model.protocol import Sender
from protogen.model.sizes import SizeSet
from protogen.model.transparency import Base16, Cobs, Escape, Insertion, Substitution
from protogen.targets.typescript.literals import (
    boolean,
    call,
    characters,
    integer,
    is_big,
    listed,
    mapping,
    octets,
    text,
)
from protogen.targets.typescript.names import Names

_STARTS = {
    StartRule.LITERAL: "word",
    StartRule.SET: "word",
    StartRule.AFTER_END: "after_end",
    StartRule.ANYWHERE: "anywhere",
}


class FramePrinter:
    """Prints the frame of a sender."""

    def __init__(self, sender: Sender, names: Names) -> None:
        self._sender = sender
        self._plan: FramePlan = sender.plan
        self._names = names
        frame = sender.frame
        shown = [item.name for item in frame.shown_parts]
        every = dict.fromkeys([*shown, *(item.name for item in frame.lengths)])
        self._slots = {name: slot for slot, name in enumerate(every)}
        """Places of the values of parts."""

    def text(self) -> str:
        """The object, one member a line."""
        inside = (f"  {name}: {value}," for name, value in self._members().items())
        return "\n".join(["{", *inside, "}"])

    def _members(self) -> Mapping[str, str]:
        plan, frame, framing = self._plan, self._sender.frame, self._sender.framing
        content = self._content()
        stuffed = [item.name in frame.stuffed for item in content]
        region = plan.region
        return {
            "sender": text(self._sender.endpoint),
            "form": text("" if self._sender.is_only_form else self._sender.form),
            "parts": _lines(self._part(item) for item in content),
            "payloadIndex": str(content.index(frame.payload)),
            "headSize": str(plan.head_size),
            "tailSize": str(plan.tail_size),
            "tailSizeEmpty": str(plan.tail_size_empty),
            "slots": str(len(self._slots)),
            "identity": listed(str(self._slots[item.name]) for item in frame.identity),
            "lastIdentity": self._last_identity(),
            "identityIsEarly": boolean(plan.identity_is_early),
            "told": _lines(self._told(item) for item in frame.told),
            "virtual": _lines(self._virtual(item) for item in plan.virtual),
            "shown": _lines(self._shown(item.name) for item in frame.shown_parts),
            "sums": _lines(self._sum(item) for item in plan.checksums),
            "start": text(_STARTS[plan.start]),
            "startWords": _octets_list(plan.start_words),
            "startBytes": octets(plan.start_bytes),
            "startIsUnique": boolean(plan.start_is_unique),
            "end": octets(plan.end_bytes),
            "endIsUnique": boolean(plan.end_is_unique),
            "sharesDelimiter": boolean(plan.shares_delimiter),
            "markSize": str(plan.mark_size),
            "endsIdle": boolean(plan.ends_idle),
            "transparency": "null" if region is None else self._transparency(),
            "firstStuffed": str(stuffed.index(True) if True in stuffed else -1),
            "lastStuffed": str(max((i for i, it in enumerate(stuffed) if it), default=-1)),
            "behindRegion": str(0 if region is None else region.behind),
            "least": str(plan.least),
            "greatest": str(plan.greatest),
            "givenUpAt": str(plan.given_up_at),
            "greatestPayload": str(framing.payload.greatest),
            "sevenBit": boolean(plan.seven_bit),
            "rescans": boolean(plan.rescans),
            "takesWhole": boolean(plan.takes_whole),
            "cutAmbiguous": boolean(plan.cut_ambiguous),
            "isBounded": boolean(frame.limit is not None),
            "kept": "null" if frame.payload.kept is None else str(frame.payload.kept),
            "isCut": boolean(plan.is_cut),
            "groups": _lines(self._group(item) for item in plan.groups),
            "encodeOnly": listed(self._plan_name(item) for item in self._encode_only()),
        }

    def _content(self) -> list[Part]:
        """The parts, but for the end literals."""
        parts = list(self._sender.frame.parts)
        return parts[: len(parts) - len(self._plan.end_literals)]

    def _last_identity(self) -> str:
        sent = self._plan.sent_identity
        return str(self._slots[sent[-1].name]) if sent else "-1"

    def _encode_only(self) -> list[Message]:
        received = {message.name for message in self._sender.received}
        return [message for message in self._sender.messages if message.name not in received]

    def _plan_name(self, message: Message) -> str:
        return self._names.functions[message.name][2]

    # --- parts ------------------------------------------------------------------------------------

    def _part(self, part: Part) -> str:
        given: dict[str, str | None] = {"name": text(part.name), "size": str(part.size)}
        given["isOptional"] = "true" if part.is_optional else None
        match part:
            case LiteralPart():
                found = {"kind": text("literal"), **given, "bytes": octets(part.bytes)}
            case PayloadPart():
                found = {"kind": text("payload"), **given}
            case BitsPart():
                found = {"kind": text("bits"), **given, **self._bits(part)}
            case ChecksumPart():
                found = {"kind": text("sum"), **given, "sum": str(self._index(part))}
            case _:
                assert isinstance(part, NumberPart)
                found = {"kind": text("number"), **given, "part": self._number_part(part)}
        return mapping(found)

    def _index(self, part: ChecksumPart) -> int:
        return [item.part.name for item in self._plan.checksums].index(part.name)

    def _bits(self, part: BitsPart) -> dict[str, str | None]:
        mirrors = (
            mapping(
                {
                    "name": text(item.name),
                    "number": number(item),
                    "of": str(self._slots[item.of.name]),
                    "flips": integer(item.flips, big=True),
                }
            )
            for item in part.mirrors
        )
        return {
            "number": number(part),
            "members": listed(self._number_part(item) for item in part.members),
            "mirrors": listed(mirrors),
            "sums": listed(str(self._index(item)) for item in part.sums),
            "mask": f"{part.mask}n",
            "fixed": f"{part.fixed}n",
        }

    def _number_part(self, part: NumberPart) -> str:
        given: dict[str, str | None] = {
            "name": text(part.name),
            "number": number(part),
            "slot": str(self._slots[part.name]),
        }
        match part:
            case IdentityPart():
                found = {"kind": text("identity"), **given}
            case LengthPart():
                found = {"kind": text("length"), **given, **self._length(part)}
            case CounterPart() | ValuePart():
                found = {"kind": text("value"), **given, **self._value(part)}
            case _:
                raise TypeError(f"{type(part).__name__} is no number of a frame")
        return mapping(found)

    def _length(self, part: LengthPart) -> dict[str, str | None]:
        first = self._plan.length
        assert first is not None
        plans = [first, *self._plan.further_lengths]
        plan = next(item for item in plans if item.part.name == part.name)
        is_first = plan is first
        return {
            "base": str(plan.base),
            "optional": str(plan.optional),
            "least": str(part.least),
            "greatest": str(first.greatest if is_first else part.greatest),
            "overWire": boolean(part.over_wire),
            "isFurther": boolean(not is_first),
            "regionEnd": str((first.region_end if is_first else None) or 0),
        }

    def _value(self, part: CounterPart | ValuePart) -> dict[str, str | None]:
        between = part.between
        choices = part.values if isinstance(part, ChoicePart) else None
        return {
            "least": _value(part, part.least),
            "greatest": _value(part, part.greatest),
            "default": "null" if part.default is None else _value(part, part.default),
            "isCounter": boolean(isinstance(part, CounterPart)),
            "values": "null" if choices is None else listed(_value(part, it) for it in choices),
            "between": "null" if between is None else characters(bytes(between)),
            "isHeld": boolean(any(item.part is part for item in self._plan.bounded)),
        }

    def _told(self, part: ToldPart) -> str:
        set_by = (
            mapping(
                {"message": text(item.message), "name": text(self._teller(item.message, item.name))}
            )
            for item in part.telling.set_by
        )
        return mapping(
            {
                "name": text(part.name),
                "slot": str(self._slots[part.name]),
                "default": str(part.telling.default),
                "bits": str(part.type.bits),
                "once": boolean(part.telling.once),
                "setBy": listed(set_by),
                "length": self._number_part(part) if isinstance(part, ToldLength) else "null",
            }
        )

    def _teller(self, message: str, name: str) -> str:
        """A field as records have it; a part as the schema does."""
        return self._names.records[message].fields[name] if message else name

    def _virtual(self, plan: VirtualPlan) -> str:
        values = (
            mapping({"identities": self._runs(key), "value": _value(plan.part, value)})
            for key, value in plan.values
        )
        part = plan.part
        return mapping(
            {
                "name": text(part.name),
                "number": number(part),
                "values": listed(values),
                "default": "null" if part.default is None else _value(part, part.default),
            }
        )

    def _shown(self, name: str) -> str:
        own = self._names.shown(self._sender.name, name)
        return mapping({"name": text(name), "key": text(own), "slot": str(self._slots[name])})

    # --- checksums --------------------------------------------------------------------------------

    def _sum(self, plan: ChecksumPlan) -> str:
        part = plan.part
        return mapping(
            {
                "name": text(part.name),
                "number": number(part),
                "algorithm": algorithm(part.algorithm),
                "covers": listed(map(self._covered, plan.covers)),
                "overWire": boolean(part.over_wire),
                "place": _place(plan.placed.place),
                "size": str(plan.placed.size),
                "isOptional": boolean(part.is_optional),
                "isBits": boolean(part.type.within is not None),
                "lowest": str(part.lowest),
                "greatest": str(part.type.greatest),
            }
        )

    def _covered(self, item: Run | bytes | VirtualPart) -> str:
        if isinstance(item, bytes):
            return mapping({"bytes": octets(item)})
        if isinstance(item, VirtualPart):
            names = [plan.part.name for plan in self._plan.virtual]
            return mapping({"virtual": str(names.index(item.name))})
        stuffed = boolean(item.over_stuffing)
        return mapping({"from": _place(item.first), "to": _place(item.end), "stuffed": stuffed})

    def _transparency(self) -> str:
        region = self._plan.region
        assert region is not None
        lenient = "true" if region.lenient else None
        codes = listed(f"[{byte}, {octets(word)}]" for byte, word in region.codes)
        match region.encoding:
            case Substitution():
                return call("rt.substitution", codes, lenient)
            case Escape(byte=byte, xor=xor):
                return call("rt.escape", str(byte), str(xor), codes, lenient)
            case Insertion(sequence=sequence, byte=byte):
                return call("rt.insertion", octets(sequence), str(byte))
            case Base16():
                return call("rt.base16", lenient)
            case Cobs():
                return call("rt.cobs", lenient)

    # --- identities -------------------------------------------------------------------------------

    def _runs(self, identities: Identities) -> str:
        return runs_of(self._sender.frame.identity, identities)

    def _group(self, group: IdentityGroup) -> str:
        return mapping(
            {
                "identities": self._runs(group.told_by),
                "messages": listed(map(self._plan_name, group.messages)),
                "fixed": "null" if group.fixed is None else str(group.fixed),
                "greatest": str(max(item.sizes.greatest for item in group.messages)),
                "carried": listed(map(sizes_of, group.sizes)),
            }
        )


def runs_of(parts: Iterable[IdentityPart], identities: Identities) -> str:
    """Values of each identity part, from the first to the last of each run."""
    return listed(
        listed(f"[{_value(part, first)}, {_value(part, last)}]" for first, last in runs)
        for part, runs in zip(parts, identities.runs, strict=True)
    )


def sizes_of(sizes: SizeSet) -> str:
    """Sizes in bytes."""
    given = {"least": sizes.least, "greatest": sizes.greatest, "step": sizes.step}
    return mapping({name: str(value) for name, value in given.items()})


def _value(part: TypedPart, value: int) -> str:
    shown = part.shown(value)
    return text(shown) if isinstance(shown, str) else integer(shown, big=is_big(part.type.bits))


def _lines(items: Iterable[str]) -> str:
    found = [f"\n    {item}," for item in items]
    return f"[{''.join(found)}\n  ]" if found else "[]"


def _octets_list(items: Iterable[bytes]) -> str:
    return listed(map(octets, items))


def _place(place: Place) -> str:
    is_tail = boolean(place.side is Side.TAIL)
    given = {"isTail": is_tail, "offset": str(place.offset), "absent": str(place.absent)}
    return mapping(given)


def number(item: TypedPart | PlacedPart) -> str:
    """The codec of a part's number."""
    part = item.part if isinstance(item, PlacedPart) else item
    assert isinstance(part, TypedPart)
    type_ = part.type
    seven = "true" if type_.byte_bits == 7 else None
    order = text(type_.byte_order)
    if type_.is_text:
        return call("rt.characters", str(type_.size), seven)
    if type_.text is not None:
        assert not type_.is_free
        alphabet = octets(type_.characters)
        return call("rt.digits", str(type_.bits), alphabet, str(type_.size))
    if type_.within is not None:
        place = (str(type_.bits), str(type_.within.low), str(type_.within.size))
        return call("rt.bitsNumber", *place, order, seven)
    return call("rt.number", str(type_.bits), order, seven)


def algorithm(spec: ChecksumSpec) -> str:
    """A checksum algorithm with its parameters."""
    match spec.kind:
        case "xor" | "sum":
            numbers = {"init": spec.init, "xorout": spec.xorout, "add": spec.add}
            given: dict[str, str | None] = {k: str(item) for k, item in numbers.items() if item}
            given["mask"] = None if spec.mask is None else str(spec.mask)
            given["words"] = None if spec.words is None else text(spec.words)
            given["negated"] = "true" if spec.negated else None
            return call(f"rt.{spec.kind}", str(spec.width), mapping(given))
        case "fletcher":
            return call("rt.fletcher16", str(spec.modulus))
    parameters = {
        "poly": f"{spec.poly}n",
        "init": f"{spec.init}n",
        "refin": boolean(spec.refin),
        "refout": boolean(spec.refout),
        "xorout": f"{spec.xorout}n",
    }
    return call("rt.crc", str(spec.width), mapping(parameters))
