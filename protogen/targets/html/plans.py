"""What the bench goes by: frames and payloads as the compiler worked them out, as JSON.

Numbers that a JavaScript number does not hold exactly are texts, as are fractions; bytes are hex
digits. What most things do not have is left out.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import Any

from protogen.model.computed import computed
from protogen.model.expressions import (
    Arithmetic,
    Comparison,
    Expression,
    Junction,
    Membership,
    Minus,
    Not,
    Number,
    Operand,
    Quotient,
)
from protogen.model.identities import Identities
from protogen.model.meanings import BitField, Enum
from protogen.model.messages import Message
from protogen.model.numbers import FreeNumeral, Numeral
from protogen.model.packing import FilledPacking
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
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    Check,
    ChooseStep,
    ConditionalPresence,
    ConstantStep,
    Count,
    FloatStep,
    IntegerStep,
    OptionalStep,
    PartStep,
    RecordStep,
    RegionStep,
    RepeatStep,
    RestStep,
)
from protogen.model.payload_walks import packed_numbers
from protogen.model.protocol import Protocol, Sender
from protogen.model.sizes import SizeSet
from protogen.model.types import Constant, Field, Float, Integer, Text
from protogen.targets.typescript.names import Names, names_of
from protogen.targets.typescript.numbers import is_bigint

_EXACT = 1 << 53
Json = dict[str, Any]


def plans(protocol: Protocol) -> Json:
    """The protocol."""
    writer = _Plans(protocol)
    senders = [writer.sender(item) for item in protocol.senders]
    messages = {item.name: writer.message(item) for item in protocol.messages}
    return {
        "name": protocol.name,
        "schema": protocol.files[0],
        "byteRate": _rate(protocol),
        "senders": senders,
        "messages": messages,
        "examples": [
            {
                "message": message.name,
                "name": item.name,
                "sender": item.sender,
                "hex": item.bytes.hex(),
            }
            for message in protocol.messages
            for item in message.examples
            if item.covers is None
        ],
        "types": writer.types,
        "enums": writer.enums,
    }


def _rate(protocol: Protocol) -> float | None:
    """Bytes a second that the link carries."""
    time = protocol.link.byte_time
    return None if time is None else float(1 / time)


class _Plans:
    """Writes the plans; types and enums that several fields have are written once."""

    def __init__(self, protocol: Protocol) -> None:
        self._names: Names = names_of(protocol)
        self.types: list[Json] = []
        self._type_places: dict[str, int] = {}
        self.enums: dict[str, Json] = {}

    # --- frames -----------------------------------------------------------------------------------

    def sender(self, sender: Sender) -> Json:
        """A sender and its frame."""
        plan, frame = sender.plan, sender.frame
        last = frame.parts[-1]
        return _lean(
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
        return _lean(
            {
                "name": part.name,
                "kind": "identity" if is_identity else kind,
                "type": self._type(part.type),
                "least": _number(part.least),
                "greatest": _number(part.greatest),
                "default": None if default is None else _shown(part, default),
                "choices": choices,
            }
        )

    def _part(self, part: Part, sender: Sender) -> Json:
        common: Json = {"name": part.name, "size": part.size, "optional": part.is_optional}
        match part:
            case LiteralPart():
                return _lean({**common, "kind": "literal", "bytes": part.bytes.hex()})
            case PayloadPart():
                return _lean({**common, "kind": "payload"})
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
                    "flips": _number(part.flips),
                }
            case NumberPart():
                own = self._number_part(part)
            case _:
                raise AssertionError(part)
        assert isinstance(part, TypedPart)
        return _lean({**common, "type": self._type(part.type), **own})

    def _bits(self, part: BitsPart, sender: Sender) -> Json:
        mirrors = [item for item in part.mirrors if item != part.whole]
        return {
            "kind": "bits",
            "mask": _number(part.mask),
            "fixed": _number(part.fixed),
            "whole": None if part.whole is None else self._part(part.whole, sender),
            "bits": [self._part(item, sender) for item in (*part.members, *mirrors, *part.sums)],
        }

    def _number_part(self, part: NumberPart) -> Json:
        own: Json = {
            "kind": "number",
            "role": "identity" if isinstance(part, IdentityPart) else None,
            "least": _number(part.least),
            "greatest": _number(part.greatest),
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
            own |= {"values": [_number(value) for value in part.values]}
        return own

    # --- messages ---------------------------------------------------------------------------------

    def message(self, message: Message) -> Json:
        """A message and the steps of its payload."""
        return _lean(
            {
                "sizes": _sizes(message.sizes),
                "identities": _runs(message.told_by),
                "virtual": dict(message.virtual),
                "cutSize": message.cut_size,
                "canBeCut": message.can_be_cut,
                "steps": self._steps(message.plan.steps, message.name, message.fields),
            }
        )

    def _steps(self, steps: Iterable[AnyStep], record: str, fields: Sequence[Field]) -> list[Json]:
        # The codec works out no size of a region: that number is given like others.
        computes = {name for name, item in computed(fields).items() if not item.is_region}
        return [
            self._step(step, record) | ({"computed": True} if step.name in computes else {})
            for step in steps
        ]

    def _step(self, step: AnyStep, record: str) -> Json:
        """A step; `record` is the struct or message whose field it is."""
        names = self._names.records.get(record)
        key = None if names is None else names.fields.get(step.name)
        common: Json = {"name": step.name, "key": None if key == step.name else key}
        match step:
            case PartStep():
                own = self._scalar(step) | {"kind": "part", "part": step.part}
            case IntegerStep() | FloatStep() | BytesStep():
                own = self._scalar(step)
            case ConstantStep():
                own = {"kind": "constant", "step": self._step(step.value, record)}
            case RecordStep():
                inside = self._steps(step.steps, step.type.name, step.type.fields)
                own = {"kind": "record", "steps": inside, **self._packing(step)}
            case RepeatStep():
                element = self._step(step.element, record)
                own = {"kind": "repeat", "element": element, "count": self._count(step.count)}
                own |= {"label": step.type.label, **self._packing(step)}
            case ChooseStep():
                own = {"kind": "choose", **self._choose(step, record)}
            case OptionalStep():
                is_said = isinstance(step.presence, ConditionalPresence)
                when = step.presence.expression if is_said else None  # type: ignore[union-attr]
                own = {"kind": "optional", "step": self._step(step.step, record)}
                own["when"] = None if when is None else _expression(when)
            case RegionStep():
                own = {"kind": "region", "step": self._step(step.step, record)}
                own["region"] = self._count(step.region)
        return _lean({**common, **own})

    def _choose(self, step: ChooseStep, record: str) -> Json:
        cases = [
            _lean(
                {
                    "value": None if case.value is None else _number(case.value),
                    "isElse": case.value is None,
                    "name": case.name,
                    "step": self._step(case.step, record),
                }
            )
            for case in step.cases
        ]
        return {
            "expression": _expression(step.expression),
            "text": step.expression.text,
            "cases": cases,
            "rest": isinstance(step.rest, RestStep),
        }

    def _packing(self, step: RecordStep | RepeatStep) -> Json:
        packing = step.packing
        if packing is None:
            return {}
        steps = step.steps if isinstance(step, RecordStep) else (step,)
        is_filled = isinstance(packing, FilledPacking)
        numbers = [
            _lean(
                {
                    "name": item.name if isinstance(step, RecordStep) else "",
                    "index": item.index,
                    "first": item.first,
                    "type": self._type(item.step.type),
                    **self._meaning(item.step.field),
                    "const": None if item.constant is None else _number(item.constant),
                }
            )
            for item in packed_numbers(steps, int(is_filled))
        ]
        if isinstance(packing, FilledPacking):
            # The numbers are as many as fit, each like the first.
            return {"packing": {"order": packing.order, "width": packing.width, "numbers": numbers}}
        own: Json = {"size": packing.size, "order": packing.order, "bits": packing.bits}
        return {"packing": {**own, "padding": packing.padding, "numbers": numbers}}

    def _scalar(self, step: IntegerStep | FloatStep | BytesStep) -> Json:
        field = step.field
        own: Json = {
            "kind": "scalar",
            "type": self._type(step.type),
            "sevenBit": Check.SEVEN_BIT in step.checks,
            **self._meaning(field),
        }
        own["const"] = _constant(field.const)
        own["default"] = _constant(field.default)
        if isinstance(step, BytesStep):
            own["count"] = self._count(step.count)
        elif field.ranged:
            own["range"] = [_bound(field.least), _bound(field.greatest)]
        return own

    def _meaning(self, field: Field) -> Json:
        """How raw values of a field are read."""
        return {
            "unit": field.unit,
            "scale": _fraction(field.scale) if field.scaled else None,
            "offset": _fraction(field.offset) if field.scaled and field.offset else None,
            "special": {item.name: _number(item.value) for item in field.special},
        }

    def _count(self, count: Count) -> Json:
        between = count.between
        return _lean(
            {
                "known": None if count.expression is not None else count.known,
                "by": None if count.expression is None else _expression(count.expression),
                "text": None if count.expression is None else count.expression.text,
                "fills": count.fills,
                "until": count.until,
                "least": count.least,
                "greatest": count.greatest,
                "tail": None
                if count.tail is None
                else {
                    "separator": count.tail.separator,
                    "element": count.tail.element,
                    "least": count.tail.least,
                },
                "mark": None if count.mark is None else _expression(count.mark.expression),
                "between": None
                if between is None
                else {
                    "separator": between.separator,
                    "leads": between.leads,
                    "rest": between.takes_rest,
                    "characters": between.characters.decode("latin-1"),
                },
            }
        )

    # --- types ------------------------------------------------------------------------------------

    def _type(self, type_: Any) -> int:
        """The place of a type among those of the page."""
        found = self._type_json(type_)
        key = repr(found)
        if key not in self._type_places:
            self._type_places[key] = len(self.types)
            self.types.append(found)
        return self._type_places[key]

    def _type_json(self, type_: Any) -> Json:
        own: Json = {"label": type_.label}
        if isinstance(type_, Text):
            padded = type_.padded
            own["kind"] = "text"
            if padded is not None:
                form = (padded.padding, padded.bits, padded.shift, padded.add)
                own |= {"size": padded.size, "form": list(form)}
            return own
        if isinstance(type_, Float):
            return own | _bytes_of(type_) | {"kind": "float"}
        if not isinstance(type_, Integer):
            return own | {"kind": "octets"}
        own |= _bytes_of(type_) | {"kind": "integer", "name": type_.name, "signed": type_.signed}
        own |= {"role": "" if type_.role == "number" else type_.role, "isBig": is_bigint(type_)}
        own["text"] = self._text(type_)
        own["low"] = None if type_.within is None else type_.within.low
        if type_.is_text:
            own["isText"] = True
        if type_.enum is not None:
            own["enum"] = self._enum(type_.enum)
        if type_.flags is not None:
            own["flags"] = {item.name: item.bit for item in type_.flags.bits}
        own["runs"] = [self._run(item) for item in type_.bit_fields]
        return _lean(own)

    def _text(self, type_: Integer) -> Json | None:
        form = type_.text
        if isinstance(form, Numeral):
            return {"alphabet": form.alphabet.decode("latin-1")}
        if not isinstance(form, FreeNumeral):
            return None
        return _lean(
            {
                "base": form.base,
                "fraction": form.fraction,
                "separator": form.separator,
                "leads": form.leads,
                "empty": form.empty,
                "absent": _number(form.absent),
                "greatest": _number(form.greatest),
                "longest": form.longest(signed=type_.signed),
            }
        )

    def _run(self, item: BitField) -> Json:
        own = {"name": item.name, "low": item.low, "mask": _number(item.mask)}
        return _lean({**own, "enum": None if item.enum is None else self._enum(item.enum)})

    def _enum(self, enum: Enum) -> str:
        if enum.name not in self.enums:
            values = {item.name: _number(item.value) for item in enum.values}
            self.enums[enum.name] = _lean({"values": values, "closed": enum.closed})
        return enum.name


def _bytes_of(type_: Integer | Float) -> Json:
    return _lean(
        {
            "bits": type_.bits,
            "size": type_.size,
            "isBigEndian": type_.byte_order == "big",
            "sevenBit": type_.byte_bits == 7,
        }
    )


def _length(item: CountedLength) -> Json:
    return {"name": item.part.name, "base": item.base, "optional": item.optional}


def _shown(part: NumberPart, value: int) -> Any:
    shown = part.shown(value)
    return _number(shown) if isinstance(shown, int) else shown


def _sizes(sizes: SizeSet) -> list[int]:
    return [sizes.least, sizes.greatest, sizes.step]


def _runs(identities: Identities) -> list[list[list[int | str]]]:
    return [[[_number(one), _number(other)] for one, other in runs] for runs in identities.runs]


def _number(value: int) -> int | str:
    return value if abs(value) < _EXACT else str(value)


def _bound(value: Fraction | None) -> Any:
    return None if value is None else _fraction(value)


def _fraction(value: Fraction) -> str:
    return f"{value.numerator}/{value.denominator}"


def _constant(value: Constant | None) -> Any:
    match value:
        case bytes():
            return {"hex": value.hex()}
        case tuple():
            return [_number(item) for item in value]
        case bool() | str() | float() | None:
            return value
    return _number(value)


def _expression(item: Expression) -> Any:
    """An expression as a list: what it is, and what is inside of it."""
    match item:
        case Number():
            return _number(item.value)
        case Operand():
            return ["field", item.name, *(item.run or ())]
        case Minus():
            return ["minus", _expression(item.operand)]
        case Quotient():
            return ["elements", _expression(item.operand), item.size]
        case Arithmetic() | Comparison() | Junction():
            return [item.operator, _expression(item.left), _expression(item.right)]
        case Membership():
            return ["in", _expression(item.operand), *map(_expression, item.values)]
        case Not():
            return ["not", _expression(item.operand)]


def _lean(found: Json) -> Json:
    """What is there; a number is, also 0."""
    return {key: value for key, value in found.items() if not _is_nothing(value)}


def _is_nothing(value: Any) -> bool:
    return value is None or value is False or (not value and isinstance(value, str | list | dict))
