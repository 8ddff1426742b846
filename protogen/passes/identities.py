"""Can a receiver tell the messages of each sender apart, and does nothing reserved come back?"""

from __future__ import annotations

from collections import defaultdict
from itertools import combinations

from protogen.model.messages import Message
from protogen.model.messages import Overload as OverloadModel
from protogen.passes.context import Context, Loc, about
from protogen.passes.draft import Draft
from protogen.passes.identity import Identity, IdentityReader
from protogen.passes.names import check_endpoint
from protogen.problems import hint_for
from protogen.schema.syntax.messages import Overload
from protogen.schema.syntax.protocol import ReservedIdentity


def check_identities(context: Context, draft: Draft) -> None:
    """Messages of one sender differ in identity, or an overload says how they are told apart."""
    _overloads_name_messages(context)
    for sender in draft.senders:
        draft.overloads[sender] = []
        for identity, messages in _by_identity(draft, sender).items():
            if len(messages) > 1:
                _shared(context, draft, sender, identity, messages)
    _used(context, draft)
    _reserved(context, draft)


def _by_identity(draft: Draft, sender: str) -> dict[Identity, list[Message]]:
    groups: dict[Identity, list[Message]] = defaultdict(list)
    for message in draft.sent_by(sender):
        groups[message.identity].append(message)
    return groups


def _shared(
    context: Context, draft: Draft, sender: str, identity: Identity, messages: list[Message]
) -> None:
    names = {message.name for message in messages}
    for name, overload in context.syntax.overloads.items():
        if names <= set(overload.messages):
            _decidable(context, name, overload, messages)
            draft.overloads[sender].append(_overload(name, overload, sender, identity, messages))
            return
    first, *others = messages
    for other in others:
        context.error_at_key(
            "PG150",
            ("messages", other.name),
            f"`{other.name}` has the same identity as `{first.name}`, and both come from {sender}",
            "change one, or say under `overloads` how a receiver tells them apart",
        )


def _overload(
    name: str, overload: Overload, sender: str, identity: Identity, messages: list[Message]
) -> OverloadModel:
    return OverloadModel(
        name=name,
        sender=sender,
        identity=identity,
        messages=tuple(message.name for message in messages),
        yields=overload.yields if overload.by == "undecidable" else None,
        decision=overload.decision,
        about=about(overload.doc, overload.source),
    )


def _decidable(context: Context, name: str, overload: Overload, messages: list[Message]) -> None:
    loc: Loc = ("overloads", name)
    if overload.by == "undecidable":
        if overload.yields not in overload.messages:
            text = "an undecidable overload `yields` one of its messages"
            context.error_at_key("PG154", loc, text)
        return
    for one, other in combinations(messages, 2):
        if one.sizes.meets(other.sizes):
            text = f"`{one.name}` ({one.sizes} bytes) and `{other.name}` ({other.sizes} bytes)"
            context.error(
                "PG153",
                (*loc, "by"),
                f"{text} can have the same size, so it does not tell them apart",
                "bound their sizes, or write `by: undecidable` and `yields`",
            )


def _overloads_name_messages(context: Context) -> None:
    known = context.syntax.messages
    for name, overload in context.syntax.overloads.items():
        for index, message in enumerate(overload.messages):
            if message not in known:
                loc: Loc = ("overloads", name, "messages", index)
                text = f"there is no message `{message}`"
                context.error("PG154", loc, text, hint_for(message, known))


def _used(context: Context, draft: Draft) -> None:
    used = {overload.name for group in draft.overloads.values() for overload in group}
    for name, overload in context.syntax.overloads.items():
        if name not in used and set(overload.messages) <= set(draft.messages):
            text = "these messages do not share an identity, so there is nothing to tell apart"
            context.error_at_key("PG154", ("overloads", name), text)


def _reserved(context: Context, draft: Draft) -> None:
    """Identities, field names and values that may not come back."""
    for index, entry in enumerate(context.syntax.reserved.identities):
        _reserved_identity(context, draft, ("reserved", "identities", index), entry)
    for name, fields in context.syntax.reserved.fields.items():
        _reserved_fields(context, draft, name, fields)
    for path, values in context.syntax.reserved.values.items():
        _reserved_values(context, draft, path, values)


def _reserved_identity(context: Context, draft: Draft, loc: Loc, entry: ReservedIdentity) -> None:
    if not check_endpoint(context, entry.from_, (*loc, "from")) or entry.from_ not in draft.frames:
        return
    reader = IdentityReader(context, loc, "the reserved identity")
    identity = reader.read(entry.id, draft.frames[entry.from_])
    for message in draft.sent_by(entry.from_):
        if message.identity == identity:
            text = f"the identity of `{message.name}` is reserved"
            note = (context.find(loc), "reserved here")
            context.error_at_key("PG156", ("messages", message.name), text, note=note)


def _reserved_fields(context: Context, draft: Draft, name: str, fields: tuple[str, ...]) -> None:
    message = draft.messages.get(name)
    for field in message.fields if message else ():
        if field.name in fields:
            loc: Loc = ("messages", name, "fields", field.name)
            context.error_at_key("PG156", loc, f"the field name `{field.name}` is reserved")


def _reserved_values(context: Context, draft: Draft, path: str, values: tuple[int, ...]) -> None:
    """`path` is MESSAGE.FIELD, or the name of a declared type."""
    enum_name = path.replace(".", "_")
    for enum in draft.named.enums:
        if enum.name not in (path, enum_name):
            continue
        for entry in enum.values:
            if entry.value in values:
                text = f"`{entry.name}` = {entry.value} is reserved in `{path}`"
                context.error_at_key("PG156", ("reserved", "values", path), text)
