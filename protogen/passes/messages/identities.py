"""Check that a receiver can tell the messages of each sender apart."""

from __future__ import annotations

from collections import defaultdict

from protogen.model.messages import Message
from protogen.passes.context import Context
from protogen.passes.draft import Draft
from protogen.passes.messages.identity import Identity
from protogen.passes.messages.overloads import Overloads


def check_identities(context: Context, draft: Draft) -> None:
    """Messages of one sender differ in identity, or an overload says how they are told apart."""
    overloads = Overloads(context)
    for sender in draft.senders:
        shared = (group for group in _by_identity(draft, sender) if len(group) > 1)
        found = [overloads.resolve(sender, group) for group in shared]
        draft.overloads[sender] = [overload for overload in found if overload is not None]
    overloads.check_asked(draft)


def _by_identity(draft: Draft, sender: str) -> list[list[Message]]:
    groups: dict[Identity, list[Message]] = defaultdict(list)
    for message in draft.sent_by(sender):
        groups[message.identity].append(message)
    return list(groups.values())
