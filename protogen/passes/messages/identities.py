"""Check that a receiver can tell the messages of each sender apart, by identity or overload."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from itertools import combinations

from protogen.model.identities import Identities
from protogen.model.messages import Message
from protogen.model.messages import Overload as OverloadModel
from protogen.model.parts import IdentityPart
from protogen.passes.context import Context, Loc, about
from protogen.passes.draft import Draft
from protogen.schema.syntax.messages import Overload


def check_identities(context: Context, draft: Draft) -> None:
    """Messages of one sender differ in identity, or an overload says how they are told apart."""
    overloads = _Overloads(context)
    for sender in draft.senders:
        groups: dict[Identities, list[Message]] = defaultdict(list)
        for message in draft.sent_by(sender):
            groups[message.told_by].append(message)
        if sender in draft.frames:
            parts = draft.frames[sender].identity
            _check_overlaps(context, sender, parts, [group[0] for group in groups.values()])
        shared = (group for group in groups.values() if len(group) > 1)
        found = [overloads.resolve(sender, group) for group in shared]
        draft.overloads[sender] = [overload for overload in found if overload is not None]
    overloads.check_asked(draft)


def _check_overlaps(
    context: Context, sender: str, parts: Sequence[IdentityPart], messages: Sequence[Message]
) -> None:
    """No message with several identities has one of another's."""
    if all(message.identities is None for message in messages):
        return
    for one, other in combinations(messages, 2):
        if one.identities is None and other.identities is None:
            continue
        both = one.told_by.meet(other.told_by)
        if both is not None:
            shown = Identities.only(both).shown(parts)
            context.error_at_key(
                "PG191",
                ("messages", other.name),
                f"`{other.name}` and `{one.name}` both have the identity {shown}, and both come "
                f"from {sender}",
                "take it out of one of them; a range can be written as several",
            )


class _Overloads:
    """The overloads of a schema, asked for by the messages that they are about."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._written = context.syntax.overloads
        self._asked: set[str] = set()
        self._listing: dict[str, list[str]] = defaultdict(list)
        for name, overload in self._written.items():
            self._messages_differ(name, overload)
            for message in dict.fromkeys(overload.messages):
                self._listing[message].append(name)

    def _messages_differ(self, name: str, overload: Overload) -> None:
        for index, message in enumerate(overload.messages):
            if message in self._context.syntax.messages and message in overload.messages[:index]:
                loc: Loc = ("overloads", name, "messages", index)
                self._context.error("PG154", loc, f"`{message}` stands here twice")

    def resolve(self, sender: str, messages: Sequence[Message]) -> OverloadModel | None:
        """Rule for messages of one sender and identity; None where that is reported."""
        names = [message.name for message in messages]
        listing = dict.fromkeys(name for message in names for name in self._listing[message])
        about_some = [name for name in listing if len(self._left_out(name, names)) < len(names) - 1]
        self._asked.update(about_some)
        about_all = [name for name in about_some if not self._left_out(name, names)]
        for name in about_all[1:]:
            text = f"`{about_all[0]}` says already how these messages are told apart"
            self._context.error_at_key("PG154", ("overloads", name), text)
        if about_all:
            return self._resolved(about_all[0], sender, messages)
        for name in about_some:
            others = ", ".join(f"`{other}`" for other in self._left_out(name, names))
            text = f"{others} shares the identity of these messages, and is not listed"
            self._context.error_at_key("PG154", ("overloads", name), text)
        if not about_some:
            self._same_identity(sender, names)
        return None

    def _left_out(self, name: str, messages: Iterable[str]) -> list[str]:
        listed = set(self._written[name].messages)
        return [message for message in messages if message not in listed]

    def _same_identity(self, sender: str, names: Sequence[str]) -> None:
        for other in names[1:]:
            self._context.error_at_key(
                "PG150",
                ("messages", other),
                f"`{other}` has the same identity as `{names[0]}`, and both come from {sender}",
                "change one, or say under `overloads` how a receiver tells them apart",
            )

    def _resolved(self, name: str, sender: str, messages: Sequence[Message]) -> OverloadModel:
        overload = self._written[name]
        if overload.by == "undecidable":
            self._yields_fits(name, overload, messages)
        else:
            self._sizes_differ(name, overload, messages)
        return OverloadModel(
            name=name,
            sender=sender,
            identity=messages[0].identity,
            messages=tuple(message.name for message in messages),
            yields=overload.yields if overload.by == "undecidable" else None,
            decision=overload.decision,
            about=about(overload.doc, overload.source),
        )

    def _yields_fits(self, name: str, overload: Overload, messages: Sequence[Message]) -> None:
        """A receiver reads each of the messages as the one that is yielded."""
        loc: Loc = ("overloads", name)
        sizes = {message.name: message.sizes for message in messages}
        if overload.yields not in sizes:
            text = "an undecidable overload `yields` one of its messages"
            self._context.error_at_key("PG154", loc, text)
            return
        for other in messages:
            if not sizes[overload.yields].holds(other.sizes):
                text = f"`{other.name}` can have other sizes than `{overload.yields}`, "
                text = f"{text}and a receiver would refuse these"
                hint = "yield the message that takes every size, or write `by: size`"
                self._context.error("PG154", (*loc, "yields"), text, hint)

    def _sizes_differ(self, name: str, overload: Overload, messages: Sequence[Message]) -> None:
        loc: Loc = ("overloads", name)
        if overload.yields is not None:
            text = "`yields` is for messages that nothing tells apart: `by: undecidable`"
            self._context.error_at_key("PG154", (*loc, "yields"), text)
        clashes = list(_clashes(messages))
        if clashes:
            one, other = clashes[0]
            count = len(clashes) - 1
            more = f", and so can {count} more of these messages" if count else ""
            text = f"`{one.name}` ({one.sizes} bytes) and `{other.name}` ({other.sizes} bytes)"
            self._context.error(
                "PG153",
                (*loc, "by"),
                f"{text} can have the same size{more}, so it does not tell them apart",
                "bound their sizes, or write `by: undecidable` and `yields`",
            )

    def check_asked(self, draft: Draft) -> None:
        """Report the overloads of messages that do not share an identity."""
        known = draft.messages.keys() - draft.unidentified
        for name, overload in self._written.items():
            if name not in self._asked and known >= set(overload.messages):
                text = "these messages do not share an identity, so there is nothing to tell apart"
                self._context.error_at_key("PG154", ("overloads", name), text)


def _clashes(messages: Sequence[Message]) -> Iterable[tuple[Message, Message]]:
    """Each message that can have a size of an earlier one, with the first such one."""
    fixed: dict[int, Message] = {}
    varying: list[Message] = []
    for message in messages:
        size = message.sizes.fixed
        earlier: list[Message] = varying
        if size is None:
            earlier = [*varying, *fixed.values()]
        elif size in fixed:
            earlier = [fixed[size]]
        clash = next((item for item in earlier if item.sizes.meets(message.sizes)), None)
        if clash is not None:
            yield clash, message
        if size is None:
            varying.append(message)
        else:
            fixed.setdefault(size, message)
