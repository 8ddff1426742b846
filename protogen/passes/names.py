"""Can every target use the names, and does each name that is referred to exist?"""

from __future__ import annotations

from collections.abc import Mapping

from protogen.passes.context import Context, Loc
from protogen.passes.draft import Draft
from protogen.passes.reserved_words import languages_reserving
from protogen.passes.type_names import is_builtin
from protogen.problems import hint_for
from protogen.schema.syntax.fields import FieldSyntax

ROOT_NAMES = frozenset(
    {"protocol", "encode", "decode", "decoder", "encoder", "messages", "message"}
)
"""Names that generated modules use themselves, which a type or message would hide."""


def check_names(context: Context, draft: Draft) -> None:
    """Reserved words and unknown endpoints; finds the senders."""
    syntax = context.syntax
    _usable(context, syntax.protocol, ("protocol",), at_value=True)
    for key in ("endpoints", "types", "messages", "decisions", "exchanges"):
        for name in getattr(syntax, key):
            _usable(context, name, (key, name))
    for sender, frame in syntax.frame.items():
        for name in frame:
            _usable(context, name, ("frame", sender, name))
    for name, declared in syntax.types.items():
        _type_name(context, name)
        _field_names(context, {name: declared}, ("types",))
    for name, message in syntax.messages.items():
        if not isinstance(message.fields, str):
            _field_names(context, message.fields, ("messages", name, "fields"))
    _message_names(context)
    draft.senders = _senders(context)


def _usable(context: Context, name: str, loc: Loc, *, at_value: bool = False) -> None:
    languages = languages_reserving(name)
    if languages:
        report = context.error if at_value else context.error_at_key
        text = f"`{name}` is a reserved word of {', '.join(languages)}"
        report("PG106", loc, text, f"another name, such as `{name}_` with a word behind it")


def _field_names(context: Context, fields: Mapping[str, FieldSyntax], loc: Loc) -> None:
    for name, item in fields.items():
        here = (*loc, name)
        _usable(context, name, here)
        for key in ("values", "flags", "bits", "special"):
            for entry in getattr(item, key) or ():
                _usable(context, entry, (*here, key, entry))
        if item.fields:
            _field_names(context, item.fields, (*here, "fields"))
        for case, inner in (item.cases or {}).items():
            if inner.fields:
                _field_names(context, inner.fields, (*here, "cases", case, "fields"))


def _type_name(context: Context, name: str) -> None:
    if is_builtin(name):
        context.error_at_key("PG107", ("types", name), f"`{name}` is a built-in type")


def _message_names(context: Context) -> None:
    for name in context.syntax.messages:
        if name in ROOT_NAMES:
            text = f"`{name}` is a name that generated code uses itself"
            context.error_at_key("PG106", ("messages", name), text)
        if name in context.syntax.types:
            text = f"a type is called `{name}` too"
            context.error_at_key("PG107", ("messages", name), text)
    if not context.syntax.messages:
        context.error("PG157", ("messages",), "the protocol has no messages")


def _senders(context: Context) -> tuple[str, ...]:
    """The endpoints that send something, in the order of the schema."""
    endpoints = context.syntax.endpoints
    sending: set[str] = set()
    for name, message in context.syntax.messages.items():
        for index, sender in enumerate(message.from_):
            if sender in endpoints:
                sending.add(sender)
                continue
            loc: Loc = ("messages", name, "from", index)
            text = f"there is no endpoint `{sender}`"
            context.error("PG108", loc, text, hint_for(sender, endpoints))
    _keys_are_endpoints(context)
    return tuple(name for name in endpoints if name in sending)


def _keys_are_endpoints(context: Context) -> None:
    endpoints = context.syntax.endpoints
    for key in ("byte_order", "transparency"):
        for sender in getattr(context.syntax, key):
            if sender and sender not in endpoints:
                text = f"there is no endpoint `{sender}`"
                context.error_at_key("PG108", (key, sender), text, hint_for(sender, endpoints))
