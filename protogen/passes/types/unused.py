"""Problems of fields that stand in no frame.

Types that no message uses, and messages whose frame could not be resolved, are in no model. They
are checked all the same, so that a run reports what it can.
"""

from __future__ import annotations

from protogen.copying import replace
from protogen.passes.context import Context
from protogen.passes.draft import Draft
from protogen.passes.types.fields import FieldBuilder
from protogen.passes.types.named_types import NamedTypes
from protogen.passes.types.separators import is_for_separators
from protogen.passes.types.setting import nowhere
from protogen.passes.types.type_names import Layout
from protogen.schema.syntax.fields import FieldSyntax
from protogen.schema.syntax.messages import MessageSyntax
from protogen.schema.syntax.protocol import ALL_SENDERS


def check_unused(context: Context, draft: Draft) -> None:
    """Resolve what is left over, for its problems only."""
    used = set(draft.used_types)
    for name, message in context.syntax.messages.items():
        if name not in draft.messages and not isinstance(message.fields, str):
            builder = FieldBuilder(context, NamedTypes(context))
            setting = nowhere(_layout(context, message), name)
            builder.fields(message.fields, ("messages", name, "fields"), setting)
            used |= builder.followed
    for name in context.syntax.types:
        if name not in used:
            builder = FieldBuilder(context, NamedTypes(context))
            setting = nowhere(_layout_of_type(context, name), name)
            builder.field(name, FieldSyntax(type=name), ("types", name), setting)
            used |= builder.followed


def _layout(context: Context, message: MessageSyntax | None) -> Layout:
    senders = message.from_ if message else (ALL_SENDERS, *context.syntax.endpoints)
    orders = [message.byte_order] if message else []
    orders += [context.byte_order(sender) for sender in senders]
    known = [order for order in orders if order is not None]
    separator = message.separator if message is not None else None
    return Layout(
        byte_bits=context.syntax.byte_bits,
        byte_order=known[0] if known else None,
        separator=None if separator is None else separator.byte,
    )


def _layout_of_type(context: Context, name: str) -> Layout:
    """The layout of a type that no message uses; if it is text, it may be for separated fields."""
    layout = _layout(context, None)
    if not is_for_separators(context.syntax.types[name], context.syntax.types):
        return layout
    separators = (message.separator for message in context.syntax.messages.values())
    first = next((item.byte for item in separators if item is not None), None)
    return replace(layout, separator=first)
