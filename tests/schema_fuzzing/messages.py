"""Messages: who sends them, how they are told apart, and what they carry."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hypothesis import strategies as st

from protogen.copying import replace
from schema_fuzzing import forms
from schema_fuzzing.fields import optional, structs
from schema_fuzzing.frames import FramePlan
from schema_fuzzing.names import FIELDS, MESSAGES, fresh, several
from schema_fuzzing.numbers import ORDERS
from schema_fuzzing.part_fields import part_fields, with_identity
from schema_fuzzing.parts import PartPlan, identity_values, is_text, text_of
from schema_fuzzing.separated import separated
from schema_fuzzing.setting import Built, Declared, Setting, Size

_TAIL = 8
"""Bytes that are kept for fields that may be left out."""


@dataclass(frozen=True, slots=True)
class Plan:
    """Setting that messages are drawn for."""

    byte_bits: int
    whole_bytes: bool
    orders: Mapping[str, str]
    """Byte order by sender, as far as the protocol states one."""
    frames: Mapping[str, Sequence[FramePlan]]
    """By sender, each in all of its forms."""
    identity: Mapping[str, Sequence[PartPlan]]
    """The identity parts by sender."""
    shared: bool
    """True if a message may have several senders."""
    types: tuple[Declared, ...]
    budget: int

    @property
    def senders(self) -> tuple[str, ...]:
        return tuple(self.frames)


@dataclass(frozen=True, slots=True)
class MessagePlan:
    """A message that was drawn."""

    name: str
    senders: tuple[str, ...]
    data: dict[str, Any]
    size: Size
    is_overload: bool = False
    """True if another message has its identity."""


@st.composite
def messages(draw: st.DrawFn, plan: Plan) -> tuple[list[MessagePlan], list[dict[str, Any]]]:
    """Messages that differ in identity, at least one for each sender; identities of none."""
    found: list[MessagePlan] = []
    for senders in _sendings(draw, plan):
        taken = {message.name for message in found}
        name = draw(fresh(MESSAGES, taken))
        whole = plan.byte_bits == 7 and plan.whole_bytes
        found.append(_Message(draw, plan, senders, whole=whole).message(name))
    return _identified(draw, plan, found)


def _sendings(draw: st.DrawFn, plan: Plan) -> list[tuple[str, ...]]:
    """The senders of each message."""
    found: list[tuple[str, ...]] = [(sender,) for sender in plan.senders]
    if not all(plan.identity[sender] for sender in plan.senders):
        return found
    for _ in range(draw(st.integers(0, 3))):
        if plan.shared and draw(st.booleans()):
            found.append(tuple(draw(several(plan.senders, 1, len(plan.senders)))))
        else:
            found.append((draw(st.sampled_from(plan.senders)),))
    return draw(st.permutations(found))


def _identified(
    draw: st.DrawFn, plan: Plan, found: list[MessagePlan]
) -> tuple[list[MessagePlan], list[dict[str, Any]]]:
    """The messages with an identity each: no two of one sender have the same.

    Also identities that no message has, as they are reserved.
    """
    result = list(found)
    reserved: list[dict[str, Any]] = []
    groups: dict[str, list[int]] = {}
    for index, message in enumerate(found):
        groups.setdefault("" if plan.shared else message.senders[0], []).append(index)
    for members in groups.values():
        scheme = plan.identity[found[members[0]].senders[0]]
        values = st.tuples(*map(identity_values, scheme))
        count = len(members) + draw(forms.one_in(6)) if scheme else 0
        drawn = draw(st.lists(values, min_size=count, max_size=count, unique=True))
        several = _Several(draw, scheme, drawn)
        for index, identity in zip(members, drawn, strict=False):
            runs = several.beside(identity)
            written = {"id": draw(_written_identity(scheme, runs))}
            data = {**written, **result[index].data}
            frames = [frame for sender in result[index].senders for frame in plan.frames[sender]]
            varies = [len(run) > 1 or run[0][0] < run[0][1] for run in runs]
            data = draw(with_identity(data, frames, scheme, varies))
            result[index] = replace(result[index], data=data)
        for identity in drawn[len(members) :]:
            written = {"id": draw(_written_identity(scheme, several.beside(identity)))}
            sender = found[members[0]].senders[0]
            reserved.append({"from": sender, **written, **draw(forms.about())})
            reserved[-1].pop("source", None)
    return result, reserved


class _Several:
    """Draws further identities of messages, none of which is another's."""

    def __init__(
        self, draw: st.DrawFn, scheme: Sequence[PartPlan], drawn: Sequence[Sequence[int]]
    ) -> None:
        self._draw = draw
        self._scheme = scheme
        self._taken: list[tuple[Runs, ...]] = [
            tuple(((value, value),) for value in identity) for identity in drawn
        ]

    def beside(self, identity: Sequence[int]) -> tuple[Runs, ...]:
        """The values of each part that are its identities, its own first; mostly no others."""
        runs: list[Runs] = [((value, value),) for value in identity]
        if not self._draw(forms.one_in(4)):
            return tuple(runs)
        own = tuple(runs)
        for index, part in enumerate(self._scheme):
            if not is_text(part) and self._draw(forms.one_in(3)):
                first = identity[index]
                found = [*runs]
                found[index] = ((first, min(part.bounds[1], first + self._draw(_WIDTHS))),)
                runs = found if self._is_free(tuple(found), own) else runs
            for _ in range(self._draw(st.sampled_from([0, 1, 1, 2]))):
                first = self._draw(identity_values(part))
                more = 0 if is_text(part) else self._draw(_WIDTHS)
                run = (first, min(part.bounds[1], first + more) if more else first)
                found = [*runs]
                found[index] = (*runs[index], run)
                if self._is_free(tuple(found), own) and not _meets(runs[index], (run,)):
                    runs = found
        self._taken[self._taken.index(own)] = tuple(runs)
        return tuple(runs)

    def _is_free(self, runs: tuple[Runs, ...], own: tuple[Runs, ...]) -> bool:
        others = (taken for taken in self._taken if taken != own)
        return not any(all(map(_meets, runs, taken)) for taken in others)


_WIDTHS = st.sampled_from([0, 0, 1, 5, 3000])
"""Further values of a range."""

Runs = tuple[tuple[int, int], ...]


def _meets(one: Runs, other: Runs) -> bool:
    return any(a[0] <= b[1] and b[0] <= a[1] for a in one for b in other)


@st.composite
def _written_identity(draw: st.DrawFn, scheme: Sequence[PartPlan], several: Sequence[Runs]) -> Any:
    written: dict[str, Any] = {}
    for part, runs in zip(scheme, several, strict=True):
        assert part.type is not None
        character = part.type.type == "char"
        found: list[Any] = []
        for first, last in runs:
            is_one = first == last and (not found or draw(st.booleans()))
            ends = [draw(forms.raw_number(end, character=character)) for end in (first, last)]
            found.append(ends[0] if is_one else {"range": ends})
        if is_text(part):
            found = [text_of(first, part.type) for first, _ in runs]
        written[part.identity or part.name] = (
            found if len(found) > 1 or draw(forms.one_in(9)) else found[0]
        )
    if len(written) == 1 and not draw(forms.one_in(4)):
        return next(iter(written.values()))
    return dict(draw(st.permutations(list(written.items()))))


class _Message:
    """Draws one message."""

    def __init__(
        self, draw: st.DrawFn, plan: Plan, senders: tuple[str, ...], *, whole: bool
    ) -> None:
        self._draw = draw
        self._plan = plan
        self._senders = senders
        self._whole = whole
        self._frames = [frame for sender in senders for frame in plan.frames[sender]]

    def message(self, name: str) -> MessagePlan:
        data: dict[str, Any] = {"from": self._written_senders()}
        if self._must_be_ordered() or self._draw(forms.one_in(5)):
            data["byte_order"] = self._draw(ORDERS)
        setting = self._setting(ordered="byte_order" in data)
        unspecified = setting.delimited and not self._whole and self._draw(forms.one_in(10))
        if unspecified:
            fields, size = self._unspecified(setting)
        elif self._may_separate(setting) and self._draw(forms.one_in(5)):
            fields, size = self._separated(setting)
        else:
            fields, size = self._fields(setting)
        data.update(fields)
        data.update(self._texts())
        return MessagePlan(name, self._senders, data, size)

    def _written_senders(self) -> Any:
        if len(self._senders) == 1 and self._draw(st.booleans()):
            return self._senders[0]
        return list(self._senders)

    def _must_be_ordered(self) -> bool:
        """Senders of different byte orders: the message has to say which is its own."""
        return len({self._plan.orders.get(sender) for sender in self._senders}) > 1

    def _setting(self, *, ordered: bool) -> Setting:
        rooms = [frame.room for frame in self._frames if frame.room is not None]
        surely = [frame.surely for frame in self._frames if frame.surely is not None]
        bounded = len(rooms) == len(self._frames)
        return Setting(
            byte_bits=self._plan.byte_bits,
            ordered=ordered or self._plan.orders.get(self._senders[0]) is not None,
            whole_bytes=self._plan.whole_bytes,
            budget=min([*surely, self._plan.budget]),
            room=max(rooms) if bounded else None,
            delimited=all(frame.delimited for frame in self._frames),
            last=True,
            types=self._plan.types,
        )

    def _fields(self, setting: Setting) -> tuple[dict[str, Any], Size]:
        fields: dict[str, Any] = {}
        size = Size(0, 0)
        if self._whole:
            fields["whole_byte"] = "byte"
            size = Size(1, 1)
        held, here = self._draw(part_fields(self._frames, setting.behind(size)))
        fields = {**held, **fields}
        if setting.delimited and here.budget >= _TAIL and self._draw(forms.one_in(4)):
            return self._with_tail(here, fields, size)
        built: Built = self._draw(structs(here, greatest=5))
        fields.update(built.data)
        if not fields and self._draw(st.booleans()):
            return {}, size
        return {"fields": fields}, size + built.size

    def _with_tail(
        self, setting: Setting, fields: dict[str, Any], size: Size
    ) -> tuple[dict[str, Any], Size]:
        """Fields, and behind them some that may be left out."""
        inner = replace(setting, last=False, budget=setting.budget - _TAIL)
        front: Built = self._draw(structs(inner, greatest=3))
        fields.update(front.data)
        size += front.size
        left = replace(setting.behind(front.size), budget=_TAIL)
        tail: dict[str, Any] = {}
        for _ in range(self._draw(st.integers(1, 3))):
            built: Built = self._draw(optional(left))
            tail[self._draw(fresh(FIELDS, {**fields, **tail}))] = built.data
            size += built.size
            left = left.behind(built.size)
            if left.budget < 1 or built.fills:
                break
        if self._draw(forms.one_in(3)):
            tail = {self._draw(fresh(FIELDS, fields)): {"fields": tail}}
        return {"fields": {**fields, **tail}}, size

    def _may_separate(self, setting: Setting) -> bool:
        return setting.delimited and setting.byte_bits == 8 and setting.budget > 2

    def _separated(self, setting: Setting) -> tuple[dict[str, Any], Size]:
        separator, built = self._draw(separated(setting.budget))
        return {"separator": separator, "fields": built.data}, built.size

    def _unspecified(self, setting: Setting) -> tuple[dict[str, Any], Size]:
        data: dict[str, Any] = {"fields": "unspecified"}
        greatest = setting.room
        if greatest is None or self._draw(st.booleans()):
            greatest = data["max_size"] = self._draw(st.integers(0, setting.budget))
        least = 0
        if self._draw(st.booleans()):
            least = data["min_size"] = self._draw(st.integers(0, min(greatest, 4)))
        return data, Size(least, greatest)

    def _texts(self) -> dict[str, Any]:
        found = dict(self._draw(forms.about()))
        for key in ("title", "summary"):
            if self._draw(forms.one_in(6)):
                found[key] = self._draw(forms.a_text)
        if self._draw(forms.one_in(6)):
            found["rate"] = self._draw(st.sampled_from(forms.RATES))
        if self._draw(forms.one_in(12)):
            found["renamed_from"] = "older"
        return found


# --- overloads ----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Overload:
    """A second message with the identity of a first one, and how they are told apart."""

    partner: MessagePlan
    data: dict[str, Any]


@st.composite
def overload(
    draw: st.DrawFn, plan: Plan, first: MessagePlan, taken: Sequence[str], decision: str
) -> Overload | None:
    """A partner for a message, where one can be made."""
    frames = [frame for sender in first.senders for frame in plan.frames[sender]]
    rooms = [frame.surely for frame in frames if frame.surely is not None]
    delimited = all(frame.delimited for frame in frames)
    size = first.size.greatest + 1
    by_size = (
        delimited and size <= min(rooms, default=plan.budget + 1) and not draw(forms.one_in(4))
    )
    if not by_size and not (first.size.fixed or delimited):
        return None
    if not by_size:
        size = first.size.least
    name = draw(fresh(MESSAGES, taken))
    shared = ("id", "from", "byte_order")
    kept = {key: value for key, value in first.data.items() if key in shared}
    data: dict[str, Any] = {**kept, "fields": {"filling": {"type": "bytes", "size": size}}}
    written: dict[str, Any] = {"messages": [first.name, name], "by": "size", **draw(forms.about())}
    if draw(forms.one_in(3)):
        written["decision"] = decision
    if not by_size:
        written = {**written, "by": "undecidable", "yields": first.name}
    partner = MessagePlan(name, first.senders, data, Size(size, size), is_overload=True)
    return Overload(partner, written)
