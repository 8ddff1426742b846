"""Messages by their identity, as a receiver tells them apart."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import msgspec

from protogen.c_language.numbers import hexadecimal, unsigned_type
from protogen.model.frame_plan import FramePlan
from protogen.model.identities import Identities, Identity
from protogen.model.messages import Message
from protogen.model.parts import PartType
from protogen.model.sizes import SizeSet
from protogen.targets.c.payload.held import HeldNumber, from_parts
from protogen.targets.c.payload.messages import MessageView


class ReceivedMessage(msgspec.Struct, frozen=True):
    """A message as a receiver tells it, and the payloads that frames can have of it."""

    name: str
    constant: str
    least: int
    greatest: int
    step: int
    checks: str
    """The function that checks a payload; empty where its size says all."""
    fills: int = 0
    """Bytes that payloads are filled up to, where frames leave out zeros at their end; else 0."""
    cuts: int | None = None
    """Bytes that longer payloads are cut to; None where they are refused."""
    varies: bool = False
    """True if payloads that are cut may also be shorter."""
    tells_its_end: bool = False
    """True if the check of a longer payload tells what it is cut to."""
    numbers: tuple[HeldNumber, ...] = ()
    """The numbers of the frame that the check takes, too."""

    def held(self, parts: str) -> str:
        """These as arguments behind others; `parts` leads to an event's."""
        return from_parts(self.numbers, parts)

    @property
    def fixed(self) -> bool:
        """True if the payload has always the same size."""
        return self.least == self.greatest

    @property
    def takes_any_size(self) -> bool:
        """True if no payload is too short or too long."""
        return self.can_be_longer and self.least == 0

    @property
    def can_be_longer(self) -> bool:
        """True if payloads that are too long are cut."""
        return self.cuts is not None or self.tells_its_end

    @property
    def is_fitted(self) -> bool:
        """True if payloads are filled up, or cut."""
        return bool(self.fills) or self.can_be_longer

    @property
    def check_sees_size(self) -> bool:
        """True if the function that checks a payload is told how many bytes there are.

        Of one that is cut to a fixed size it is told that size, even where fewer bytes came.
        """
        is_cut = self.cuts is not None and not self.varies and not self.fills
        return bool(self.checks) and not self.fixed and not is_cut

    @property
    def own(self) -> int:
        """Size that payloads have when they are filled up or cut."""
        return self.fills if self.cuts is None else self.cuts

    def read_size(self, event: str) -> str:
        """The size of a payload that was filled up or cut; `event` leads to its members."""
        return f"{event}payload_size" if self.varies else f"{self.own}U"

    def fits(self, size: str) -> str:
        """The condition that a payload of that size can be its, where not any size can."""
        return self._compared(size, "==", ">=", "<=", " && ")

    def misfits(self, size: str) -> str:
        """The opposite condition."""
        return self._compared(size, "!=", "<", ">", " || ")

    def _compared(self, size: str, equal: str, least: str, greatest: str, word: str) -> str:
        if self.fixed and not self.can_be_longer:
            return f"{size} {equal} {self.least}U"
        found = [f"{size} {least} {self.least}U"] if self.least else []
        if self.can_be_longer:
            return word.join(found)
        found.append(f"{size} {greatest} {self.greatest}U")
        if self.step > 1:
            above = f"({size} - {self.least}U)" if self.least else size
            found.append(f"{above} % {self.step}U {equal} 0U")
        return word.join(found)


class Alternatives(msgspec.Struct, frozen=True):
    """Several identities of one message."""

    key: str
    """The one that stands for all."""
    condition: str
    """The condition that `key` is one of them; empty if every one is."""


class GroupView(msgspec.Struct, frozen=True):
    """The messages of one identity."""

    key: str
    messages: tuple[ReceivedMessage, ...]
    fixed: int | None
    greatest: int
    index: int

    @property
    def is_measured_by_parts(self) -> bool:
        """True if numbers of the frame may say how long the payload is."""
        return self.fixed is None and bool(self.messages[0].numbers)


def groups_of(plan: FramePlan, views: Mapping[str, MessageView]) -> tuple[GroupView, ...]:
    """The groups of the messages that have a view."""
    return tuple(
        GroupView(
            key=key_constant(plan, group.identity),
            messages=tuple(
                _message(plan, item, sizes, views[item.name])
                for item, sizes in zip(group.messages, group.sizes, strict=True)
            ),
            fixed=group.fixed,
            greatest=group.greatest,
            index=index,
        )
        for index, group in enumerate(plan.groups)
    )


def constants_by_size(groups: Iterable[GroupView]) -> dict[int, tuple[str, ...]]:
    """The constants of messages of fixed sizes by these."""
    found: dict[int, tuple[str, ...]] = {}
    for group in groups:
        for message in group.messages:
            found[message.least] = (*found.get(message.least, ()), message.constant)
    return found


def alternatives_of(plan: FramePlan) -> tuple[Alternatives, ...]:
    """The identities of the messages that have several."""
    return tuple(
        Alternatives(key_constant(plan, group.identity), is_among(plan, group.identities))
        for group in plan.groups
        if group.identities is not None
    )


def is_among(plan: FramePlan, identities: Identities) -> str:
    """The condition that `key` is one of several identities; empty if every one is."""
    shift, found = plan.identity_bits, []
    for part, runs in zip(plan.identity, identities.runs, strict=True):
        shift -= part.type.bits
        value = f"(key >> {shift})" if shift else "key"
        if len(plan.identity) > 1:
            value = f"({value} & {hexadecimal((1 << part.type.bits) - 1)})"
        conditions = [in_run(value, run, part.type) for run in runs]
        if all(conditions):
            joined = " || ".join(f"({item})" if " && " in item else item for item in conditions)
            found.append(f"({joined})" if len(runs) > 1 else joined)
    return " && ".join(found) if len(found) > 1 else "".join(found)


def in_run(value: str, run: tuple[int, int], type_: PartType) -> str:
    """The condition that a number is one of a run of values; empty if every one of its type is."""
    first, last = run
    if first == last:
        return f"{value} == {hexadecimal(first)}"
    found = [f"{value} >= {hexadecimal(first)}"] if first > 0 else []
    found += [f"{value} <= {hexadecimal(last)}"] if last < (1 << type_.width) - 1 else []
    return " && ".join(found)


def key_type(plan: FramePlan) -> str:
    """The type of a number that holds all identity parts."""
    return unsigned_type(max(plan.identity_bits, 8))


def key_from(plan: FramePlan, values: Mapping[str, str]) -> str:
    """All identity parts in one number, made of the C of each."""
    type_ = key_type(plan)
    shift = plan.identity_bits
    terms = []
    for part in plan.identity:
        shift -= part.type.bits
        value = values[part.name]
        terms.append(f"({type_})(({type_}){value} << {shift})" if shift else value)
    return f"({type_})({' | '.join(terms)})" if len(terms) > 1 else "".join(terms)


def key_constant(plan: FramePlan, identity: Identity) -> str:
    """An identity as one number."""
    return hexadecimal(plan.frame.key(identity), max(2, -(-plan.identity_bits // 4)))


def _message(
    plan: FramePlan, message: Message, sizes: SizeSet, view: MessageView
) -> ReceivedMessage:
    checks = view.check if _needs_check(plan, view) else ""
    # In another form of frame it may be longer, than what counts bytes of this one can say.
    sizes = sizes.within(0, plan.payload.greatest) or sizes
    own, varies = message.cut_size, message.sizes.fixed is None
    # Where nothing can be longer, there is nothing to cut.
    is_cut = plan.is_cut and own is not None and (not varies or own < sizes.greatest)
    return ReceivedMessage(
        message.name,
        view.constant,
        sizes.least,
        sizes.greatest,
        sizes.step,
        checks,
        fills=own or 0 if plan.is_trimmed else 0,
        cuts=own if is_cut else None,
        varies=is_cut and varies,
        tells_its_end=plan.is_cut and message.tells_its_end,
        numbers=view.held,
    )


def _needs_check(plan: FramePlan, view: MessageView) -> bool:
    """True if a payload of a right size can still be none of the message's.

    Where all bytes carry seven bits, they were looked at one by one when they came.
    """
    if view.fixed is None or not plan.seven_bit:
        return view.checks
    return view.checks and view.checks_values
