"""Two resolved protocols -> what changed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import msgspec

from protogen.copying import replace
from protogen.evolution.appended import with_appended
from protogen.evolution.change import Change, named
from protogen.evolution.compare_fields import FieldComparison
from protogen.evolution.compare_frames import compare_frames, renamed_parts
from protogen.evolution.compare_reserved import compare_reserved
from protogen.evolution.rules import BY_NAME, Category
from protogen.evolution.shapes import shape
from protogen.evolution.tellers import renamed_tellers
from protogen.model.frame_plan import EndRule, FramePlan
from protogen.model.frame_room import room
from protogen.model.identities import Identities
from protogen.model.messages import Message
from protogen.model.protocol import Link, Protocol, Sender


class Comparison(msgspec.Struct, frozen=True):
    """Two versions of a protocol, and what changed between them."""

    old: Protocol
    new: Protocol
    endpoints: dict[str, str]
    """Senders of OLD with their names in NEW."""
    messages: dict[str, str]
    """Messages of OLD with their names in NEW."""
    changes: tuple[Change, ...]


def compare(old: Protocol, new: Protocol) -> Comparison:
    """Compare the models; texts for people, examples and the order of keys don't count."""
    endpoints = _paired_endpoints(old, new)
    messages = _paired_messages(old, new, endpoints)
    found = list(_changes(old, new, endpoints, messages))
    if _is_unbumped(old, new, found):
        words = f"both are {new.version}"
        found.append(Change(rule="version-not-bumped", place="version", text=words))
    return Comparison(old, new, endpoints, messages, tuple(_joined(found)))


def _changes(
    old: Protocol, new: Protocol, endpoints: dict[str, str], messages: dict[str, str]
) -> Iterator[Change]:
    if old.name != new.name:
        yield Change(rule="protocol-renamed", place="protocol", text=named(old.name, new.name))
    for endpoint in old.endpoints:
        before, after = endpoint.name, endpoints.get(endpoint.name, endpoint.name)
        if before != after:
            yield Change(
                rule="endpoint-renamed", place=f"endpoint {before}", text=named(before, after)
            )
    yield from _link(old.link, new.link)
    yield from compare_reserved(old, new, endpoints, messages)
    yield from _forms(old, new, endpoints)
    tellers = renamed_tellers(
        ((sender.frame, other.frame) for sender, other in _pairs(old, new, endpoints)),
        _kept_messages(old, new, messages),
    )
    for sender, other in _pairs(old, new, endpoints):
        yield from compare_frames(sender, other, tellers)
        yield from _overloads(sender, other, messages)
        yield from _identities(sender, other, new, messages)
        yield from _virtual(sender, other, messages)
    yield from _messages(old, new, endpoints, messages)


def _pairs(
    old: Protocol, new: Protocol, endpoints: dict[str, str]
) -> Iterator[tuple[Sender, Sender]]:
    """The senders that both versions have."""
    for sender in old.senders:
        other = _counterpart(sender, new, endpoints)
        if other is not None:
            yield sender, other


def _kept_messages(
    old: Protocol, new: Protocol, messages: dict[str, str]
) -> Iterator[tuple[Message, Message]]:
    """The messages that both versions have."""
    after = {message.name: message for message in new.messages}
    for message in old.messages:
        name = messages.get(message.name, message.name)
        if name in after:
            yield message, after[name]


# --- messages -------------------------------------------------------------------------------------


def _messages(
    old: Protocol, new: Protocol, endpoints: dict[str, str], messages: dict[str, str]
) -> Iterator[Change]:
    after = {message.name: message for message in new.messages}
    for message in old.messages:
        name = messages.get(message.name)
        if name is None:
            yield _deleted(message, old, new, endpoints)
            continue
        other = after[name]
        if name != message.name:
            yield _change("message-renamed", message, named(message.name, name))
        yield from _senders(message, other, old, new, endpoints)
        found = list(FieldComparison(message.name).compare(message.fields, other.fields))
        plans = _plans(message, other, old, new, endpoints)
        yield from with_appended(found, message, other, plans)
        if message.sizes != other.sizes and not any(_is_wire(item) for item in found):
            yield _change("message-size", message, named(str(message.sizes), str(other.sizes)))
    known = set(messages.values())
    for message in new.messages:
        if message.name not in known:
            text = f"{', '.join(message.senders)} sends it, {_identity(message, new)}"
            yield _change("message-added", message, text)
            yield from _unskippable(message, old, new, endpoints)


def _plans(
    message: Message, other: Message, old: Protocol, new: Protocol, endpoints: dict[str, str]
) -> list[tuple[FramePlan, FramePlan]]:
    """The frames that carry a message in OLD and in NEW, where both versions have them."""
    pairs = ((item, _counterpart(item, new, endpoints)) for item in old.senders)
    return [
        (sender.plan, their.plan)
        for sender, their in pairs
        if their is not None and sender.sends(message) and their.sends(other)
    ]


def _unskippable(
    message: Message, old: Protocol, new: Protocol, endpoints: dict[str, str]
) -> Iterator[Change]:
    """A message whose frames an old receiver can't pass over: it would look for frames inside."""
    for sender in old.senders:
        other = _counterpart(sender, new, endpoints)
        is_known = any(item.told_by.covers(message.told_by) for item in sender.messages)
        if other is None or not other.sends(message) or is_known:
            continue
        words = _obstacle(message, sender.plan, other.plan)
        if words:
            found = _change("message-unskippable", message, f"{sender.name}: {words}")
            yield replace(found, sender=sender.name)


def _obstacle(message: Message, old: FramePlan, new: FramePlan) -> str:
    """Reason why OLD can't pass over frames of a message; empty if it can."""
    if old.start_is_unique > new.start_is_unique or old.cut_ambiguous < new.cut_ambiguous:
        return "old receivers take bytes that its payload can hold for a delimiter"
    if old.end_bytes or old.start_is_unique or not old.identity:
        return ""  # It goes on at the next delimiter, or has no other messages.
    if old.end_rule is EndRule.IDENTITY:
        return "an unknown identity tells no size"
    greatest = room(new, message.sizes.greatest)
    sizes = new.frame.payload.sent(message.sizes)
    if greatest > old.greatest or not old.payload.holds(sizes):
        return f"frames of up to {greatest} bytes, and old receivers take {old.greatest} at most"
    return ""


def _senders(
    message: Message, other: Message, old: Protocol, new: Protocol, endpoints: dict[str, str]
) -> Iterator[Change]:
    names = {sender: endpoints.get(sender, sender) for sender in message.senders}
    if not set(other.senders) <= set(names.values()):
        words = named(", ".join(message.senders), ", ".join(other.senders))
        yield _change("message-sender-added", message, words)
    for sender, name in names.items():
        if name in other.senders:
            continue
        if _is_reserved(new, name, message.told_by):
            identity = _identity(message, old)
            words = f"{sender} does not send it any more, {identity} is reserved"
            yield _change("message-reserved", message, words)
        else:
            words = f"{sender} does not send it any more"
            yield replace(_change("message-sender-deleted", message, words), sender=sender)


def _is_reserved(protocol: Protocol, sender: str, identities: Identities) -> bool:
    """True if nobody can use these identities again."""
    own = [item.told_by for item in protocol.reserved.identities if item.sender == sender]
    return all(any(item.covers(run) for item in own) for run in identities.each_run())


def _deleted(message: Message, old: Protocol, new: Protocol, endpoints: dict[str, str]) -> Change:
    identity = _identity(message, old)
    senders = [endpoints.get(item, item) for item in message.senders]
    if all(_is_reserved(new, sender, message.told_by) for sender in senders):
        return _change("message-reserved", message, f"{identity} is reserved")
    return _change("message-deleted", message, f"{identity} is free for another meaning")


def _identities(
    old: Sender, new: Sender, protocol: Protocol, messages: dict[str, str]
) -> Iterator[Change]:
    after = {message.name: message for message in new.messages}
    owners, before = _Owners(new.messages), _Owners(old.messages)
    for message in old.messages:
        name = messages.get(message.name)
        if name in after:
            words = named(_shown(message, old), _shown(after[name], new))
            found = _other_identity(message, after[name], words, protocol, new.endpoint)
            yield from (replace(item, sender=old.name) for item in found)
        mine = {messages.get(item) for item in before.of(message.told_by)} | {name}
        taken = [item for item in owners.of(message.told_by) if item not in mine]
        if taken:
            words = f"{_shown(message, old)} was {message.name}, is {', '.join(taken)}"
            change = _change("identity-reused", message, words)
            yield replace(change, sender=old.name, taken_by=tuple(taken))


def _other_identity(
    old: Message, new: Message, words: str, protocol: Protocol, endpoint: str
) -> Iterator[Change]:
    """Changes of a message's identities: more are unknown to old receivers, fewer to new ones."""
    before, after = old.told_by, new.told_by
    if not after.covers(before):
        gone = [run for run in before.each_run() if not after.covers(run)]
        kept = all(_is_reserved(protocol, endpoint, run) for run in gone)
        if kept and before.covers(after):
            yield _change("message-reserved", old, f"{words}, and the others are reserved")
        else:
            yield _change("message-identity", old, words)
    elif not before.covers(after):
        yield _change("message-identity-added", old, words)
    elif old.identity != new.identity:
        yield _change("frame-part-default", old, words)


class _Owners:
    """Names of messages by their identities."""

    def __init__(self, messages: Iterable[Message]) -> None:
        self._alone: dict[Identities, list[str]] = {}
        self._several: list[Message] = []
        for message in messages:
            if message.identities is None:
                self._alone.setdefault(message.told_by, []).append(message.name)
            else:
                self._several.append(message)

    def of(self, identities: Identities) -> list[str]:
        """The messages that have one of these identities."""
        found = self._alone.get(identities, [])
        if identities.count > 1:
            known = self._alone.items()
            found = [name for item, own in known if item.meet(identities) for name in own]
        several = (item for item in self._several if item.told_by.meet(identities) is not None)
        return [*found, *(item.name for item in several)]


def _virtual(old: Sender, new: Sender, messages: dict[str, str]) -> Iterator[Change]:
    """Other values of what is not sent, whatever its part is called now."""
    after = {message.name: message for message in new.messages}
    renamed = renamed_parts(old.frame, new.frame)
    for part in old.frame.virtual:
        same = new.frame.virtual_part(renamed.get(part.name, part.name))
        for message in old.messages if same is not None else ():
            other = after.get(messages.get(message.name, ""))
            if other is None or same is None:
                continue
            values = message.virtual_value(part), other.virtual_value(same)
            if None not in values and values[0] != values[1]:
                words = f"{part.name} {named(*(str(part.shown(value or 0)) for value in values))}"
                yield replace(_change("message-virtual", message, words), sender=old.name)


def _overloads(old: Sender, new: Sender, messages: dict[str, str]) -> Iterator[Change]:
    before = {o.identity: messages.get(o.yields or "", o.yields) for o in old.overloads}
    after = {o.identity: o.yields for o in new.overloads}
    for identity in before.keys() & after.keys():
        if before[identity] != after[identity]:
            words = named(before[identity] or "told by size", after[identity] or "told by size")
            yield Change(
                rule="message-overload",
                place=f"{old.name} {Identities.only(identity).shown(old.frame.identity)}",
                text=words,
                sender=old.name,
            )


def _change(rule: str, message: Message, text: str) -> Change:
    return Change(rule=rule, place=message.name, text=text, message=message.name)


def _identity(message: Message, protocol: Protocol) -> str:
    if not message.identity:
        return "without an identity"
    return f"identity {_shown(message, protocol.senders_of(message)[0])}"


def _shown(message: Message, sender: Sender) -> str:
    return message.told_by.shown(sender.frame.identity) or "none"


# --- what belongs together ------------------------------------------------------------------------


def _paired_endpoints(old: Protocol, new: Protocol) -> dict[str, str]:
    before = [endpoint.name for endpoint in old.endpoints]
    after = [endpoint.name for endpoint in new.endpoints]
    gone = [name for name in before if name not in after]
    fresh = [name for name in after if name not in before]
    pairs = {name: name for name in before if name in after}
    if len(before) == len(after) and [before.index(n) for n in gone] == [
        after.index(n) for n in fresh
    ]:
        pairs |= dict(zip(gone, fresh, strict=True))
    return pairs | {
        sender.name: other.name
        for sender in old.senders
        if not sender.is_only_form and (other := _counterpart(sender, new, pairs)) is not None
    }


def _paired_messages(old: Protocol, new: Protocol, endpoints: dict[str, str]) -> dict[str, str]:
    """Messages as `renamed_from` says, or of the same name; else those that are alike.

    These have the same senders, identity, layout and names of fields. Where names of fields are
    others, too, nothing says that the message means what it did.
    """
    after = {message.name for message in new.messages}
    before = {message.name for message in old.messages}
    said = {
        message.renamed_from: message.name
        for message in new.messages
        if message.renamed_from is not None and message.renamed_from in before
    }
    taken = set(said.values())
    pairs = {name: name for name in (before & after) - said.keys() - taken} | said
    fresh = [m for m in new.messages if m.name not in before and m.name not in taken]
    for message in old.messages:
        if message.name in after or message.name in said:
            continue
        senders = {endpoints.get(item, item) for item in message.senders}
        for other in fresh:
            same = (set(other.senders), other.told_by) == (senders, message.told_by)
            if same and _layout(other) == _layout(message) and message.identity:
                pairs[message.name] = other.name
                fresh.remove(other)
                break
    return pairs


def _layout(message: Message) -> list[object]:
    return [(field.name, shape(field.type), field.position) for field in message.fields]


def _counterpart(sender: Sender, new: Protocol, endpoints: dict[str, str]) -> Sender | None:
    """The same endpoint in NEW, in the same form of its frames."""
    forms = new.forms(endpoints.get(sender.endpoint, sender.endpoint))
    if sender.is_only_form and len(forms) == 1:
        return forms[0]
    return next((item for item in forms if item.form == sender.form), None)


def _forms(old: Protocol, new: Protocol, endpoints: dict[str, str]) -> Iterator[Change]:
    """Forms of frame that are gone or new, or stand in another order."""
    for endpoint in old.sending:
        before, after = old.forms(endpoint), new.forms(endpoints.get(endpoint, endpoint))
        if not after or (len(before) == 1 and len(after) == 1):
            continue
        kept = [item.form for item in before if item.form in {other.form for other in after}]
        for rule, items in (("form-deleted", before), ("form-added", after)):
            for item in items:
                if item.form not in kept:
                    text = f"frames of {', '.join(message.name for message in item.messages)}"
                    place = f"{endpoint} forms.{item.form or 'frame'}"
                    yield Change(rule=rule, place=place, text=text, sender=item.name)
        order = [item.form for item in after if item.form in kept]
        if order != kept:
            words = named(", ".join(kept), ", ".join(order))
            yield Change(rule="form-moved", place=f"{endpoint} forms", text=words)


def _link(old: Link, new: Link) -> Iterator[Change]:
    """Changes of the line: bits that are sent another way, and the pause that ends a frame."""
    rates = old.baud, new.baud
    is_wire = None not in rates and rates[0] != rates[1]
    if is_wire or _character(old) != _character(new):
        yield Change(rule="link", place="link", text=named(_line(old), _line(new)))
    elif rates[0] != rates[1]:
        yield Change(rule="link-stated", place="link", text=named(_line(old), _line(new)))
    if old.idle_timeout != new.idle_timeout:
        words = named(_pause(old), _pause(new))
        yield Change(rule="link-timeout", place="link.idle_timeout", text=words)


def _character(link: Link) -> tuple[int, str, int]:
    return link.data_bits, link.parity, link.stop_bits


def _line(link: Link) -> str:
    rate = "any rate" if link.baud is None else f"{link.baud} baud"
    return f"{rate} {link.data_bits}{link.parity[0].upper()}{link.stop_bits}"


def _pause(link: Link) -> str:
    return "none" if link.idle_timeout is None else f"{float(link.idle_timeout * 1000):g} ms"


# --- the whole ------------------------------------------------------------------------------------


def _is_wire(change: Change) -> bool:
    return BY_NAME[change.rule].category is Category.WIRE


def _is_unbumped(old: Protocol, new: Protocol, found: Iterable[Change]) -> bool:
    """True if two meanings have one version."""
    if new.version is None or new.version != old.version:
        return False
    grave = (Category.WIRE, Category.VALUE)
    return any(BY_NAME[change.rule].category in grave for change in found)


def _joined(found: Iterable[Change]) -> Iterator[Change]:
    """The same change of a type that many fields have, once."""
    kept: dict[tuple[str, str, str], Change] = {}
    for change in found:
        shared = change.rule.startswith(("enum-", "flag-")) or change.rule == "bits"
        key = (change.rule, change.text, "" if shared else change.place)
        if key in kept:
            kept[key] = replace(kept[key], places=(*kept[key].places, change.place))
        else:
            kept[key] = change
    yield from kept.values()
