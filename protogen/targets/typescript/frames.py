"""Frame plans as objects that the runtime's decoder and encoder go by."""

from __future__ import annotations

from collections.abc import Iterable

from protogen.model.checksums import ChecksumSpec
from protogen.model.frame_places import Place, PlacedPart, Run
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
from protogen.model.plain_frames import is_put_together
from protogen.model.protocol import Sender
from protogen.model.transparency import Base16, Cobs, Escape, Insertion, Substitution
from protogen.targets.typescript.at_once import AtOnce, is_taken_at_once
from protogen.targets.typescript.literals import (
    Code,
    Data,
    call,
    characters,
    given,
    integer,
    is_big,
    lines,
    literal,
    told,
)
from protogen.targets.typescript.names import Names
from protogen.targets.typescript.put_together import PutTogether

_STARTS = {
    StartRule.LITERAL: "word",
    StartRule.SET: "word",
    StartRule.AFTER_END: "after_end",
    StartRule.ANYWHERE: "anywhere",
}
_FACTS = """
head_size tail_size tail_size_empty identity_is_early start_words start_bytes start_is_unique
end_is_unique shares_delimiter mark_size ends_idle least greatest given_up_at seven_bit
rescans takes_whole cut_ambiguous is_cut payload_index first_stuffed last_stuffed
"""
"""What the runtime takes as the plan has it."""


class FramePrinter:
    """Prints the frame of a sender."""

    def __init__(self, sender: Sender, names: Names) -> None:
        self._sender = sender
        self._plan: FramePlan = sender.plan
        self._names = names
        shown = [item.name for item in sender.frame.shown_parts]
        self._keys = {name: names.shown(sender.name, name) for name in shown}
        """Members of the parts of events, by the names of parts."""
        every = dict.fromkeys([*shown, *(item.name for item in sender.frame.lengths)])
        self._slots = {name: slot for slot, name in enumerate(every)}
        """Places of the values of parts."""
        self._sums = [item.part.name for item in sender.plan.checksums]

    def text(self) -> Code:
        """The object, one member a line."""
        plan, frame = self._plan, self._sender.frame
        sent, region = plan.sent_identity, plan.region
        facts = {
            "sender": self._sender.endpoint,
            "form": "" if self._sender.is_only_form else self._sender.form,
            **told(plan, _FACTS),
            "start": _STARTS[plan.start],
            "end": plan.end_bytes,
            "parts": _lines(map(self._part, plan.content)),
            "whole": AtOnce(self._sender).text() if is_taken_at_once(plan) else None,
            "put": PutTogether(plan).text() if is_put_together(plan) else None,
            "slots": len(self._slots),
            "identity": [self._slots[item.name] for item in frame.identity],
            "lastIdentity": self._slots[sent[-1].name] if sent else -1,
            "told": _lines(map(self._told, frame.told)),
            "virtual": _lines(map(self._virtual, plan.virtual)),
            "shown": _lines({"name": name, "key": key} for name, key in self._keys.items()),
            "partsOf": self._parts_of(),
            "sums": _lines(map(self._sum, plan.checksums)),
            "transparency": None if region is None else self._transparency(),
            "behindRegion": 0 if region is None else region.behind,
            "greatestPayload": self._sender.framing.payload.greatest,
            "isBounded": frame.limit is not None,
            "kept": frame.payload.kept,
            "groups": _lines(map(self._group, plan.groups)),
            "encodeOnly": _lines(map(self._plan_name, self._sender.encode_only)),
        }
        return call("rt.frame", lines({k: it for k, it in facts.items() if not _is_usual(it)}))

    def _plan_name(self, message: Message) -> Code:
        return Code(self._names.functions[message.name][2])

    # --- parts ------------------------------------------------------------------------------------

    def _part(self, part: Part) -> Data:
        own = told(part, "name size") | given(isOptional=part.is_optional or None)
        match part:
            case LiteralPart():
                return {"kind": "literal", **own, "bytes": part.bytes}
            case PayloadPart():
                return {"kind": "payload", **own}
            case BitsPart():
                return {"kind": "bits", **own, **self._bits(part)}
            case ChecksumPart():
                return {"kind": "sum", **own, "sum": self._sums.index(part.name)}
        assert isinstance(part, NumberPart)
        return call("rt.single", self._number_part(part))

    def _bits(self, part: BitsPart) -> dict[str, Data]:
        return {
            "number": number(part),
            "members": map(self._number_part, part.members),
            "mirrors": [
                _numbered(item) | {"of": self._slots[item.of.name], "flips": integer(item.flips)}
                for item in part.mirrors
            ],
            "sums": [self._sums.index(item.name) for item in part.sums],
            "mask": integer(part.mask),
            "fixed": integer(part.fixed),
        }

    def _number_part(self, part: NumberPart) -> Data:
        own = _numbered(part) | {"slot": self._slots[part.name]}
        match part:
            case IdentityPart():
                return {"kind": "identity", **own}
            case LengthPart():
                counted = self._plan.counted(part)
                own |= told(counted, "base optional greatest") | {"least": part.least}
                rare = given(
                    isFurther=counted.is_further or None,
                    overWire=part.over_wire or None,
                    regionEnd=counted.region_end,
                )
                return {"kind": "length", **own, **rare}
            case CounterPart() | ValuePart():
                return {"kind": "value", **own, **self._value(part)}
        raise TypeError(f"{type(part).__name__} is no number of a frame")

    def _value(self, part: CounterPart | ValuePart) -> dict[str, Data]:
        between = part.between
        choices = part.values if isinstance(part, ChoicePart) else None
        return {
            "least": _shown(part, part.least),
            "greatest": _shown(part, part.greatest),
            "default": None if part.default is None else _shown(part, part.default),
            **given(
                isCounter=isinstance(part, CounterPart) or None,
                values=choices and [_shown(part, value) for value in choices],
                between=None if between is None else characters(bytes(between)),
                isHeld=any(item.part is part for item in self._plan.bounded) or None,
            ),
        }

    def _told(self, part: ToldPart) -> Data:
        return {
            "name": part.name,
            "slot": self._slots[part.name],
            **told(part.telling, "default once"),
            "bits": part.type.bits,
            "setBy": [
                {"message": item.message, "name": self._teller(item.message, item.name)}
                for item in part.telling.set_by
            ],
            "length": self._number_part(part) if isinstance(part, ToldLength) else None,
        }

    def _teller(self, message: str, name: str) -> str:
        """A field as records have it; a part as the schema does."""
        return self._names.records[message].fields[name] if message else name

    def _virtual(self, plan: VirtualPlan) -> Data:
        part = plan.part
        values = [
            {"identities": self._runs(key), "value": _shown(part, value)}
            for key, value in plan.values
        ]
        default = None if part.default is None else _shown(part, part.default)
        return _numbered(part) | {"values": values, "default": default}

    def _parts_of(self) -> Code:
        """The function that makes the parts of events out of values by their slots."""
        found = {key: Code(f"v[{self._slots[name]}]") for name, key in self._keys.items()}
        return Code(f"(v) => ({literal(found)})")

    # --- checksums and stuffing -------------------------------------------------------------------

    def _sum(self, plan: ChecksumPlan) -> Data:
        part = plan.part
        return {
            **_numbered(part),
            "algorithm": algorithm(part.algorithm),
            "covers": map(self._covered, plan.covers),
            **given(overWire=part.over_wire or None, isOptional=part.is_optional or None),
            **given(isBits=part.type.within is not None or None),
            "lowest": part.lowest,
            "place": _place(plan.placed.place),
            "size": plan.placed.size,
            "greatest": part.type.greatest,
        }

    def _covered(self, item: Run | bytes | VirtualPart) -> Data:
        if isinstance(item, bytes):
            return {"bytes": item}
        if isinstance(item, VirtualPart):
            names = [plan.part.name for plan in self._plan.virtual]
            return {"virtual": names.index(item.name)}
        ends = {"from": _place(item.first), "to": _place(item.end)}
        return {**ends, "stuffed": item.over_stuffing}

    def _transparency(self) -> Code:
        region = self._plan.region
        assert region is not None
        lenient, codes = region.lenient or None, region.codes
        match region.encoding:
            case Substitution():
                return call("rt.substitution", codes, lenient)
            case Escape(byte=byte, xor=xor):
                return call("rt.escape", byte, xor, codes, lenient)
            case Insertion(sequence=sequence, byte=byte):
                return call("rt.insertion", sequence, byte)
            case Base16():
                return call("rt.base16", lenient)
            case Cobs():
                return call("rt.cobs", lenient)

    # --- identities -------------------------------------------------------------------------------

    def _runs(self, identities: Identities) -> Data:
        return runs_of(self._sender.frame.identity, identities)

    def _group(self, group: IdentityGroup) -> Code:
        more = {}
        if group.told_by != group.messages[0].told_by:
            more["identities"] = self._runs(group.told_by)
        if group.sizes != tuple(item.sizes for item in group.messages):
            more["carried"] = [told(sizes, "least greatest step") for sizes in group.sizes]
        return call("rt.group", map(self._plan_name, group.messages), more or None)


def runs_of(parts: Iterable[IdentityPart], identities: Identities) -> Data:
    """Values of each identity part, from the first to the last of each run."""
    return [
        [[_shown(part, end) for end in run] for run in runs]
        for part, runs in zip(parts, identities.runs, strict=True)
    ]


def _shown(part: TypedPart, value: int) -> Data:
    shown = part.shown(value)
    return shown if isinstance(shown, str) else integer(shown, big=is_big(part.type.bits))


def _lines(items: Iterable[Data]) -> Code:
    return lines(items, "  ")


def _is_usual(fact: Data) -> bool:
    """True if the runtime takes a fact for so that a frame does not say; numbers are all said."""
    return fact is False or fact is None or fact in ("", "[]")


def _place(place: Place) -> Data:
    return told(place, "is_tail offset absent")


def _numbered(part: TypedPart) -> dict[str, Data]:
    return {"name": part.name, "number": number(part)}


def number(item: TypedPart | PlacedPart) -> Code:
    """The codec of a part's number."""
    part = item.part if isinstance(item, PlacedPart) else item
    assert isinstance(part, TypedPart)
    type_ = part.type
    seven = type_.byte_bits == 7 or None
    order = type_.byte_order if seven or type_.byte_order == "big" else None
    if type_.is_text:
        return call("rt.characters", type_.size, seven)
    if type_.text is not None:
        assert not type_.is_free
        return call("rt.digits", type_.bits, type_.characters, type_.size)
    if type_.within is not None:
        place = type_.within
        return call("rt.bitsNumber", type_.bits, place.low, place.size, order, seven)
    return call("rt.number", type_.bits, order, seven)


def algorithm(spec: ChecksumSpec) -> Code:
    """A checksum algorithm with those of its parameters that are not as usual."""
    if spec.kind == "fletcher":
        return call("rt.fletcher16", spec.modulus)
    is_crc = spec.kind == "crc"
    found = spec.parameters.items()
    parameters = {n: integer(it) if is_crc and type(it) is int else it for n, it in found}
    return call(f"rt.{spec.kind}", spec.width, parameters or None)
