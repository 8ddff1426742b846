"""Frames of senders: parts, lengths, checksums and what a caller gives."""

from __future__ import annotations

from typing import Any

from protogen.model.part_plans import CountedLength
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
    ToldIdentity,
    ToldLength,
    TypedPart,
    ValuePart,
    VirtualPart,
)
from protogen.model.protocol import Sender
from protogen.targets.html.plans.plain import Json, lean, number
from protogen.targets.html.plans.types import TypeTable


class FramePlans:
    """Writes the frames of senders."""

    def __init__(self, types: TypeTable) -> None:
        self._types = types

    def sender(self, sender: Sender) -> Json:
        """A sender and its frame."""
        plan, frame = sender.plan, sender.frame
        last = frame.parts[-1]
        return lean(
            {
                "name": sender.name,
                "endpoint": sender.endpoint,
                "form": sender.form,
                "start": plan.start_bytes.hex(),
                "parts": [self._part(part, sender) for part in frame.declared],
                "payload": frame.payload.name,
                "identity": [part.name for part in frame.identity],
                "virtual": [part.name for part in frame.virtual],
                "coded": "" if frame.transparency is None else frame.transparency.first,
                "isStuffed": frame.transparency is not None,
                "region": self._region(sender),
                "last": last.bytes.hex() if isinstance(last, LiteralPart) else None,
                "length": None if plan.length is None else _length(plan.length),
                "lengthOverWire": plan.length is not None and plan.length.over_wire,
                "around": plan.head_size + plan.tail_size + len(plan.end_bytes),
                "looksAhead": sender.looks_ahead,
                "further": {item.part.name: _length(item) for item in plan.further_lengths},
                "isTrimmed": plan.is_trimmed,
                "isCut": plan.is_cut,
                "messages": [message.name for message in sender.messages],
                "hidden": {
                    message.name: sender.received_as(message.name)
                    for message in sender.messages
                    if sender.received_as(message.name) != message.name
                },
                "sums": [item.part.name for item in plan.checksums],
                "given": [self._given(part) for part in sender.given_parts],
            }
        )

    def _region(self, sender: Sender) -> Json | None:
        region, frame = sender.plan.region, sender.frame
        if region is None:
            return None
        parts = [frame.part(name) for name in region.parts]
        return {
            "before": region.before,
            "behind": region.behind + sum(part.size for part in sender.plan.end_literals),
            "code": frame.code_size,
            "least": sum(part.size for part in parts if not part.is_optional),
        }

    def _given(self, part: NumberPart) -> Json:
        kind = "counter" if isinstance(part, CounterPart) else "value"
        default = part.default if isinstance(part, ValuePart | CounterPart) else None
        choices = {}
        if isinstance(part, ChoicePart):
            pairs = zip(part.values, part.words, strict=True)
            choices = {word.hex(" ").upper(): _shown(part, value) for value, word in pairs}
        is_identity = isinstance(part, IdentityPart)
        return lean(
            {
                "name": part.name,
                "kind": "identity" if is_identity else kind,
                "type": self._types.place(part.type),
                "least": number(part.least),
                "greatest": number(part.greatest),
                "default": None if default is None else _shown(part, default),
                "choices": choices,
            }
        )

    def _part(self, part: Part, sender: Sender) -> Json:
        common: Json = {"name": part.name, "size": part.size, "optional": part.is_optional}
        match part:
            case LiteralPart():
                return lean({**common, "kind": "literal", "bytes": part.bytes.hex()})
            case PayloadPart():
                return lean({**common, "kind": "payload"})
            case VirtualPart():
                own: Json = {"kind": "virtual", "default": part.default}
            case ToldIdentity():
                own = {"kind": "told", "default": part.telling.default}
            case ToldLength():
                own = self._number_part(part) | {"kind": "told", "isLength": True}
            case ChecksumPart():
                own = {
                    "kind": "sum",
                    "sum": [item.part.name for item in sender.plan.checksums].index(part.name),
                    "meaning": f"{f'{part.taken} of ' if part.taken else ''}"
                    f"{part.algorithm.name} of {', '.join(part.covers)}",
                    "covers": list(part.covers),
                    "overWire": part.over_wire,
                    "lowest": part.lowest,
                }
            case BitsPart():
                own = self._bits(part, sender)
            case MirrorBits():
                own = {
                    "kind": "mirror",
                    "of": part.of.name,
                    "meaning": part.meaning,
                    "flips": number(part.flips),
                }
            case NumberPart():
                own = self._number_part(part)
            case _:
                raise AssertionError(part)
        assert isinstance(part, TypedPart)
        return lean({**common, "type": self._types.place(part.type), **own})

    def _bits(self, part: BitsPart, sender: Sender) -> Json:
        mirrors = [item for item in part.mirrors if item != part.whole]
        return {
            "kind": "bits",
            "mask": number(part.mask),
            "fixed": number(part.fixed),
            "whole": None if part.whole is None else self._part(part.whole, sender),
            "bits": [self._part(item, sender) for item in (*part.members, *mirrors, *part.sums)],
        }

    def _number_part(self, part: NumberPart) -> Json:
        own: Json = {
            "kind": "number",
            "role": "identity" if isinstance(part, IdentityPart) else None,
            "least": number(part.least),
            "greatest": number(part.greatest),
            "allowed": f"{'' if part.between else 'from '}{part.allowed}",
        }
        if part.between is not None:
            own["between"] = list(part.between)
        if isinstance(part, LengthPart):
            where = " on the wire" if part.over_wire else ""
            own |= {"role": "length", "meaning": f"bytes of {', '.join(part.counts)}{where}"}
            own["agrees"] = part.agrees_with
        if isinstance(part, ChoicePart):
            own |= {"words": [word.hex(" ").upper() for word in part.words]}
            own |= {"values": [number(value) for value in part.values]}
        return own


def _length(item: CountedLength) -> Json:
    return {"name": item.part.name, "base": item.base, "optional": item.optional}


def _shown(part: NumberPart, value: int) -> Any:
    shown = part.shown(value)
    return number(shown) if isinstance(shown, int) else shown
