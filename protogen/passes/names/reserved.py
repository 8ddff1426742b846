"""Check that nothing comes back that is reserved."""

from __future__ import annotations

from protogen.model.protocol import Reserved, ReservedIdentity, ReservedNames, ReservedValues
from protogen.passes.context import Context, Loc
from protogen.passes.draft import Draft
from protogen.passes.messages.identity_reader import IdentityReader
from protogen.schema.syntax.protocol import ReservedIdentity as IdentitySyntax


def resolve_reserved(context: Context, draft: Draft) -> None:
    """Identities, field names and values that may not come back."""
    reserved = context.syntax.reserved
    identities = (
        _identity(context, draft, ("reserved", "identities", index), entry)
        for index, entry in enumerate(reserved.identities)
    )
    draft.reserved = Reserved(
        identities=tuple(item for item in identities if item is not None),
        fields=tuple(
            ReservedNames(message=name, names=names) for name, names in reserved.fields.items()
        ),
        values=tuple(
            ReservedValues(path=path, values=values) for path, values in reserved.values.items()
        ),
    )
    for name, fields in reserved.fields.items():
        _fields(context, draft, name, fields)
    for path, values in reserved.values.items():
        _values(context, draft, path, values)


def _identity(
    context: Context, draft: Draft, loc: Loc, entry: IdentitySyntax
) -> ReservedIdentity | None:
    own = [name for name in draft.frames if context.frames[name].endpoint == entry.from_]
    if not own:
        return None
    reader = IdentityReader(context, loc, "the reserved identity")
    identities = reader.read(entry.id, draft.frames[own[0]])
    if identities is None:
        return None
    sent = {message.name: message for name in own for message in draft.sent_by(name)}
    for message in sent.values():
        if message.told_by.meet(identities) is not None:
            text = f"the identity of `{message.name}` is reserved"
            note = (context.find(loc), "reserved here")
            context.error_at_key("PG156", ("messages", message.name), text, note=note)
    return ReservedIdentity(
        sender=entry.from_,
        identity=identities.first,
        identities=identities if identities.count > 1 else None,
        doc=entry.doc or "",
    )


def _fields(context: Context, draft: Draft, name: str, fields: tuple[str, ...]) -> None:
    message = draft.messages.get(name)
    for field in message.fields if message else ():
        if field.name in fields:
            loc: Loc = ("messages", name, "fields", field.name)
            context.error_at_key("PG156", loc, f"the field name `{field.name}` is reserved")


def _values(context: Context, draft: Draft, path: str, values: tuple[int, ...]) -> None:
    """`path` is MESSAGE.FIELD, or the name of a declared type."""
    declared, inside = context.syntax.types, path.replace(".", "_")
    for enum in draft.named.enums:
        is_meant = enum.name == path if enum.name in declared else enum.name.rstrip("_") == inside
        if not is_meant:
            continue
        for entry in enum.values:
            if entry.value in values:
                text = f"`{entry.name}` = {entry.value} is reserved in `{path}`"
                context.error_at_key("PG156", ("reserved", "values", path), text)
