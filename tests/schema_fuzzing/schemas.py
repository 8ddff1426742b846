"""Whole schemas as plain data, valid because of how they are made."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hypothesis import strategies as st

from protogen.copying import replace
from schema_fuzzing import forms, names
from schema_fuzzing.alphabets import payload_alphabet
from schema_fuzzing.frame_forms import Drawn, Form, named, restrict, written
from schema_fuzzing.frames import FramePlan, frames
from schema_fuzzing.messages import MessagePlan, Plan, messages, overload
from schema_fuzzing.numbers import ORDERS, unnamed_values
from schema_fuzzing.parts import Maker, PartPlan, every_payload_byte
from schema_fuzzing.requests import requests
from schema_fuzzing.setting import Declared
from schema_fuzzing.shapes import frames_of, shapes_of
from schema_fuzzing.told import add_told, add_told_length
from schema_fuzzing.types import declared_types
from schema_fuzzing.virtual import add_virtual

DECISION = "delimiter_in_data"
_SHARED = ""
_IDENTITY_BITS = 64


@dataclass(frozen=True, slots=True)
class Schema:
    """A schema as a reader of YAML sees it, and in words what occurs in it."""

    data: dict[str, Any]
    shapes: tuple[str, ...]


@st.composite
def schemas(draw: st.DrawFn) -> Schema:
    """Valid schemas of every shape that the language has words for."""
    return _Drawing(draw).schema()


def _bits(part: PartPlan) -> int:
    assert part.type is not None
    return part.type.bits


class _Drawing:
    """Draws one schema."""

    def __init__(self, draw: st.DrawFn) -> None:
        self._draw = draw
        self._byte_bits = draw(st.sampled_from([8, 8, 8, 7]))
        self._whole = self._byte_bits == 8 or draw(forms.one_in(3))
        self._payload = every_payload_byte(self._byte_bits, whole_bytes=self._whole)
        self._endpoints = draw(names.several(names.ENDPOINTS, 1, 3))
        self._senders = self._endpoints[: draw(st.integers(1, len(self._endpoints)))]
        self._order, self._orders = self._byte_orders()
        self._per_sender = draw(st.booleans())
        self._same_identity = not self._per_sender or draw(st.booleans())

    def schema(self) -> Schema:
        types = self._draw(declared_types(self._byte_bits, whole_bytes=self._whole))
        identity = self._identities()
        has_forms = self._draw(forms.one_in(5))
        drawn = self._frames(identity, has_forms=has_forms)
        plan = Plan(
            byte_bits=self._byte_bits,
            whole_bytes=self._whole,
            orders=self._orders,
            frames={
                sender: [item.plan for item in drawn if item.sender in (_SHARED, sender)]
                for sender in self._senders
            },
            identity={sender: self._of(identity, sender) for sender in self._senders},
            shared=self._same_identity,
            types=types,
            budget=self._draw(st.sampled_from([6, 20, 20, 40, 300])),
        )
        found, self._gone = self._draw(messages(plan))
        overloads = self._overloads(plan, found)
        by_size = bool(overloads) and overloads["shared_identity"]["by"] == "size"
        finished = self._finished(drawn, found, types, may_trim=not by_size)
        of_forms = named(finished) if has_forms else []
        finished = [form.drawn for form in of_forms] or finished
        data = self._root(types=types, found=found, frames=finished, of_forms=of_forms)
        if overloads:
            data["overloads"] = overloads
        data.update(self._extras(data, found))
        add_virtual(self._draw, data, self._byte_bits, self._orders)
        add_told(self._draw, data)
        add_told_length(self._draw, data)
        plans = [item.plan for item in finished]
        return Schema(data, tuple(shapes_of(data, plans, self._byte_bits)))

    def _of(self, keyed: Mapping[str, Any], sender: str) -> Any:
        return keyed[sender] if sender in keyed else keyed[_SHARED]

    # -- what holds for frames and messages --------------------------------------------------

    def _byte_orders(self) -> tuple[Any, dict[str, str]]:
        """As written, and by sender."""
        choice = self._draw(st.sampled_from(["none", "all", "all", "all", "each"]))
        if choice == "none":
            return None, {}
        if choice == "all":
            order = self._draw(ORDERS)
            return order, dict.fromkeys(self._senders, order)
        orders = {sender: self._draw(ORDERS) for sender in self._senders}
        return orders, orders

    def _common_order(self, senders: Sequence[str]) -> str | None:
        orders = {self._orders.get(sender) for sender in senders}
        return next(iter(orders)) if len(orders) == 1 else None

    def _identities(self) -> dict[str, list[PartPlan]]:
        """The identity parts of all senders, or of each."""
        if self._same_identity:
            return {_SHARED: self._identity(self._common_order(self._senders))}
        return {sender: self._identity(self._orders.get(sender)) for sender in self._senders}

    def _identity(self, order: str | None) -> list[PartPlan]:
        maker = Maker(self._draw, self._byte_bits, order)
        count = self._draw(st.sampled_from([0, 1, 1, 1, 2, 3]))
        start = self._draw(st.booleans())
        parts = [maker.new_identity(start=start and index == 0) for index in range(count)]
        while sum(_bits(part) for part in parts) > _IDENTITY_BITS:
            parts.pop()
        return parts

    def _frames(self, identity: Mapping[str, list[PartPlan]], *, has_forms: bool) -> list[Drawn]:
        found: list[Drawn] = []
        for sender in self._senders if self._per_sender else [_SHARED]:
            order = self._common_order([sender] if sender else self._senders)
            drawn = frames(self._byte_bits, order, self._of(identity, sender), self._payload)
            found.append(Drawn(sender, self._draw(drawn)))
            for _ in range(self._draw(st.integers(0, 2)) if has_forms else 0):
                beside = found[-1].plan
                own = self._of(identity, sender)
                other = frames(self._byte_bits, order, own, self._payload, beside)
                found.append(Drawn(sender, self._draw(other)))
        return found

    def _finished(
        self,
        drawn: Sequence[Drawn],
        found: list[MessagePlan],
        types: Sequence[Declared],
        *,
        may_trim: bool,
    ) -> list[Drawn]:
        """The frames with what depends on the messages."""
        finished: list[Drawn] = []
        for item in drawn:
            key, frame = item.sender, item.plan
            sent = [message for message in found if key == _SHARED or key in message.senders]
            least = min(message.size.least for message in sent)
            slack = self._draw(st.sampled_from([0, 0, 1, 1000]))
            bounded = frame.with_least_payload(least, slack)
            are_fixed = all(message.size.least == message.size.greatest for message in sent)
            if may_trim and are_fixed and bounded.has_length and self._draw(st.booleans()):
                bounded = bounded.trimmed()
            fixed = [item.size.least for item in sent if item.size.least == item.size.greatest]
            has_room = frame.room is not None and min(fixed, default=frame.room) < frame.room
            if may_trim and has_room and bounded.has_length and self._draw(st.booleans()):
                bounded = bounded.cut()
            payload = self._payload
            if self._byte_bits == 8 and not bounded.is_cut:
                senders = self._senders if key == _SHARED else [key]
                of_each = [[item.data for item in sent if name in item.senders] for name in senders]
                declared = {item.name: item.built.data for item in types}
                payload = _alphabet(of_each, declared, delimited=frame.delimited)
            finished.append(Drawn(key, bounded.with_unprotected(payload, DECISION)))
        return finished

    def _overloads(self, plan: Plan, found: list[MessagePlan]) -> dict[str, Any]:
        """Sometimes a second message with the identity of one; adds it to those found."""
        if not self._draw(forms.one_in(5)):
            return {}
        first = self._draw(st.sampled_from(found))
        taken = [message.name for message in found]
        made = self._draw(overload(plan, first, taken, DECISION))
        if made is None:
            return {}
        found[found.index(first)] = replace(first, is_overload=True)
        found.append(made.partner)
        return {"shared_identity": made.data}

    # -- as it is written --------------------------------------------------------------------

    def _root(
        self,
        *,
        types: Sequence[Declared],
        found: list[MessagePlan],
        frames: Sequence[Drawn],
        of_forms: Sequence[Form],
    ) -> dict[str, Any]:
        draw = self._draw
        data: dict[str, Any] = {
            "protocol": draw(st.sampled_from(names.PROTOCOLS)),
            "endpoints": {name: self._endpoint() for name in self._endpoints},
        }
        if self._order is not None:
            data["byte_order"] = self._order
        if self._byte_bits == 7 or draw(st.booleans()):
            data["byte_bits"] = self._byte_bits
        if of_forms:
            data["forms"] = written(draw, of_forms, self._senders, DECISION)
        else:
            data.update(self._written_frames({item.sender: item.plan for item in frames}))
        if types:
            data["types"] = {declared.name: declared.built.data for declared in types}
        data["messages"] = {message.name: message.data for message in found}
        if of_forms:
            alone = [message.name for message in found if not message.is_overload]
            restrict(draw, of_forms, data["messages"], alone, self._senders)
        return data

    def _written_frames(self, frames: Mapping[str, FramePlan]) -> dict[str, Any]:
        """Frames that are no forms, with what is stated once for all, or of each sender."""
        data = {"frame": self._by_sender({key: frame.data() for key, frame in frames.items()})}
        stuffed = {key: frame.transparency() for key, frame in frames.items()}
        stuffed = {key: value for key, value in stuffed.items() if value is not None}
        if stuffed:
            data["transparency"] = self._by_sender(stuffed)
            if _SHARED in stuffed and self._draw(forms.one_in(4)):
                data["transparency"] = dict.fromkeys(self._senders, stuffed[_SHARED])
        limits = {key: frame.limit for key, frame in frames.items() if frame.limit is not None}
        if limits:
            data["max_frame"] = self._by_sender(limits)
        return data

    def _by_sender(self, keyed: dict[str, Any]) -> Any:
        return keyed.get(_SHARED, keyed)

    def _endpoint(self) -> Any:
        title = self._draw(forms.a_text)
        return self._draw(st.sampled_from([title, {"title": title, "doc": "Some words."}]))

    def _extras(self, root: dict[str, Any], found: list[MessagePlan]) -> dict[str, Any]:
        """Entries that do not change a byte, and the decisions that are referred to."""
        draw = self._draw
        data: dict[str, Any] = {}
        for key in ("title", "doc", "version"):
            if draw(forms.one_in(4)):
                data[key] = draw(forms.a_text)
        if draw(forms.one_in(3)):
            data["link"] = draw(_links())
        if draw(forms.one_in(6)):
            data["source"] = {"document": draw(forms.a_text), "url": "https://example.org/"}
        accepted = any("unprotected" in p for f in frames_of(root) for p in f.values())
        accepted |= any("decision" in item for item in root.get("overloads", {}).values())
        accepted |= any("behind" in form for form in root.get("forms", {}).values())
        if accepted or draw(forms.one_in(6)):
            keys = ("question", "document", "choice", "because")
            texts = {key: draw(forms.a_text) for key in keys}
            data["decisions"] = {DECISION: {**texts, **draw(forms.a_source())}}
        if draw(forms.one_in(5)):
            names = [message.name for message in found]
            data["exchanges"] = {"startup": draw(_exchanges(names))}
        asking = draw(requests(root, found))
        if asking is not None:
            data["exchanges"] = {**data.get("exchanges", {}), "asked": asking}
        reserved = self._reserved(root, found)
        if reserved:
            data["reserved"] = reserved
        return data

    def _reserved(self, root: dict[str, Any], found: list[MessagePlan]) -> dict[str, Any]:
        """What may not come back with another meaning."""
        reserved: dict[str, Any] = {}
        if self._draw(forms.one_in(6)):
            reserved["fields"] = {found[0].name: ["no_longer_used"]}
        if self._gone:
            reserved["identities"] = self._gone
        for name, declared in root.get("types", {}).items():
            free = unnamed_values(declared)
            if free and self._draw(forms.one_in(4)):
                value = self._draw(forms.raw_number(self._draw(st.sampled_from(free))))
                reserved["values"] = {name: [value]}
        return reserved


@st.composite
def _links(draw: st.DrawFn) -> dict[str, Any]:
    options: dict[str, list[Any]] = {
        "baud": [9600, 115200],
        "data_bits": [7, 8],
        "parity": ["none", "even", "odd", "mark", "space"],
        "stop_bits": [1, 2],
        "idle_timeout": ["20 ms", "1.5 s"],
    }
    chosen = draw(names.several(tuple(options), 0, len(options)))
    found = {key: draw(st.sampled_from(options[key])) for key in chosen}
    return {**found, **draw(forms.about())}


@st.composite
def _exchanges(draw: st.DrawFn, messages: Sequence[str]) -> dict[str, Any]:
    found: dict[str, Any] = {**draw(forms.about())}
    if draw(st.booleans()):
        found["title"] = draw(forms.a_text)
    found["steps"] = [
        message if draw(st.booleans()) else {"message": message, **draw(forms.about())}
        for message in draw(st.lists(st.sampled_from(messages), max_size=4))
    ]
    return found


def _alphabet(
    of_each: Iterable[Sequence[Any]], declared: Mapping[str, Any], *, delimited: bool
) -> frozenset[int]:
    """The bytes of payloads of any sender; its messages are one item of `of_each`."""
    found = [payload_alphabet(own, declared, delimited=delimited) for own in of_each if own]
    return frozenset().union(*found)
