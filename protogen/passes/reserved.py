"""Does something come back that is reserved?"""

from __future__ import annotations

from protogen.passes.context import Context, Loc
from protogen.passes.draft import Draft
from protogen.passes.identity import IdentityReader
from protogen.passes.names import check_endpoint
from protogen.schema.syntax.protocol import ReservedIdentity


def check_reserved(context: Context, draft: Draft) -> None:
    """Identities, field names and values that may not come back."""
    reserved = context.syntax.reserved
    for index, entry in enumerate(reserved.identities):
        _identity(context, draft, ("reserved", "identities", index), entry)
    for name, fields in reserved.fields.items():
        _fields(context, draft, name, fields)
    for path, values in reserved.values.items():
        _values(context, draft, path, values)


def _identity(context: Context, draft: Draft, loc: Loc, entry: ReservedIdentity) -> None:
    if not check_endpoint(context, entry.from_, (*loc, "from")) or entry.from_ not in draft.frames:
        return
    reader = IdentityReader(context, loc, "the reserved identity")
    identity = reader.read(entry.id, draft.frames[entry.from_])
    for message in draft.sent_by(entry.from_):
        if message.identity == identity:
            text = f"the identity of `{message.name}` is reserved"
            note = (context.find(loc), "reserved here")
            context.error_at_key("PG156", ("messages", message.name), text, note=note)


def _fields(context: Context, draft: Draft, name: str, fields: tuple[str, ...]) -> None:
    message = draft.messages.get(name)
    for field in message.fields if message else ():
        if field.name in fields:
            loc: Loc = ("messages", name, "fields", field.name)
            context.error_at_key("PG156", loc, f"the field name `{field.name}` is reserved")


def _values(context: Context, draft: Draft, path: str, values: tuple[int, ...]) -> None:
    """`path` is MESSAGE.FIELD, or the name of a declared type."""
    enum_name = path.replace(".", "_")
    for enum in draft.named.enums:
        if enum.name not in (path, enum_name):
            continue
        for entry in enum.values:
            if entry.value in values:
                text = f"`{entry.name}` = {entry.value} is reserved in `{path}`"
                context.error_at_key("PG156", ("reserved", "values", path), text)
