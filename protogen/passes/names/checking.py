"""Check that every target can use the names, and that everything named exists."""

from __future__ import annotations

from collections.abc import Mapping

from protogen.passes.context import Context, Loc
from protogen.passes.draft import Draft
from protogen.passes.names.references import check_references
from protogen.passes.names.reserved_words import (
    DIRECTIVES,
    languages_reserving,
)
from protogen.passes.types.type_names import is_builtin
from protogen.schema.syntax.fields import FieldSyntax
from protogen.schema.syntax.protocol import Frame

_NAMED_KEYS = ("endpoints", "types", "messages", "decisions", "exchanges")


def check_names(context: Context, draft: Draft) -> None:
    """Reserved words and unknown names; finds the senders."""
    syntax = context.syntax
    check_references(context)
    _usable(context, syntax.protocol, ("protocol",), at_value=True)
    for key in _NAMED_KEYS:
        for name in getattr(syntax, key):
            _usable(context, name, (key, name))
    for sender, frame in syntax.frame.items():
        _parts(context, frame, ("frame", sender))
    for name, declared in syntax.types.items():
        if is_builtin(name):
            context.error_at_key("PG107", ("types", name), f"`{name}` is a built-in type")
        _inside_field(context, declared, ("types", name))
    for name, message in syntax.messages.items():
        if not isinstance(message.fields, str):
            _fields(context, message.fields, ("messages", name, "fields"))
    if not syntax.messages:
        context.error("PG157", ("messages",), "the protocol has no messages")
    sending = {sender for message in syntax.messages.values() for sender in message.from_}
    draft.senders = tuple(name for name in syntax.endpoints if name in sending)


def _usable(context: Context, name: str, loc: Loc, *, at_value: bool = False) -> None:
    languages = languages_reserving(name)
    if languages:
        report = context.error if at_value else context.error_at_key
        text = f"`{name}` is a reserved word of {', '.join(languages)}"
        report("PG106", loc, text, f"another name, such as `{name}_value`")


def _usable_as_value(context: Context, name: str, loc: Loc) -> None:
    """Names of values stand behind that of their enum in every language: `X_MODE_NONE`."""
    if name in DIRECTIVES:
        _usable(context, name, loc)


def _parts(context: Context, frame: Frame, loc: Loc) -> None:
    for name in frame:
        _usable(context, name, (*loc, name))


def _fields(context: Context, fields: Mapping[str, FieldSyntax], loc: Loc) -> None:
    for name, item in fields.items():
        _usable(context, name, (*loc, name))
        _inside_field(context, item, (*loc, name))


def _inside_field(context: Context, item: FieldSyntax, loc: Loc) -> None:
    """The names that stand inside of a field, those of its cases included."""
    for key in ("flags", "special"):
        for entry in getattr(item, key) or ():
            _usable(context, entry, (*loc, key, entry))
    for entry in item.values or ():
        _usable_as_value(context, entry, (*loc, "values", entry))
    for name, bits in (item.bits or {}).items():
        _usable(context, name, (*loc, "bits", name))
        for entry in bits.values or ():
            _usable_as_value(context, entry, (*loc, "bits", name, "values", entry))
    _fields(context, item.fields or {}, (*loc, "fields"))
    for key, case in (item.cases or {}).items():
        _inside_field(context, case, (*loc, "cases", key))
