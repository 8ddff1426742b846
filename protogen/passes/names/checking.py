"""Check that names are no directives of `extends`, and that everything named exists.

What a language reserves does not matter here: targets escape such names (`targets/naming.py`).
"""

from __future__ import annotations

from collections.abc import Mapping

from protogen.passes.context import Context, Loc
from protogen.passes.draft import Draft
from protogen.passes.names.references import check_references
from protogen.passes.types.type_names import is_builtin
from protogen.schema.dialects.directives import DIRECTIVES
from protogen.schema.syntax.fields import FieldSyntax
from protogen.schema.syntax.protocol import Frame

_NAMED_KEYS = ("endpoints", "types", "messages", "decisions", "exchanges")


def check_names(context: Context, draft: Draft) -> None:
    """Directives and unknown names; finds the senders."""
    syntax = context.syntax
    check_references(context)
    for key in _NAMED_KEYS:
        for name in getattr(syntax, key):
            _usable(context, name, (key, name))
    for sender, frame in syntax.frame.items():
        _parts(context, frame, ("frame", sender))
    for form, item in (syntax.forms or {}).items():
        _usable(context, form, ("forms", form))
        _parts(context, item.frame, ("forms", form, "frame"))
    for name, declared in syntax.types.items():
        if is_builtin(name):
            context.error_at_key("PG107", ("types", name), f"`{name}` is a built-in type")
        _inside_field(context, declared, ("types", name))
    for name, message in syntax.messages.items():
        if not isinstance(message.fields, str):
            _fields(context, message.fields, ("messages", name, "fields"))
    if not syntax.messages:
        context.error("PG157", ("messages",), "the protocol has no messages")
    draft.carried = _carried(context)
    draft.senders = tuple(name for name, messages in draft.carried.items() if messages)


def _carried(context: Context) -> dict[str, frozenset[str]]:
    """The messages that each sender's frame carries."""
    messages = context.syntax.messages
    if context.syntax.forms is not None:
        frames = context.frames.items()
        return {
            sender: frozenset(name for name, item in messages.items() if frame.carries(item))
            for sender, frame in frames
        }
    return {
        endpoint: frozenset(name for name, item in messages.items() if endpoint in item.from_)
        for endpoint in context.syntax.endpoints
    }


def _usable(context: Context, name: str, loc: Loc) -> None:
    if name in DIRECTIVES:
        text = f"`{name}` is a directive of `extends`"
        context.error_at_key("PG106", loc, text, f"another name, such as `{name}_value`")


def _parts(context: Context, frame: Frame, loc: Loc) -> None:
    for name, item in frame.items():
        _usable(context, name, (*loc, name))
        for own in item.bits or {}:
            _usable(context, own, (*loc, name, "bits", own))


def _fields(context: Context, fields: Mapping[str, FieldSyntax], loc: Loc) -> None:
    for name, item in fields.items():
        _usable(context, name, (*loc, name))
        _inside_field(context, item, (*loc, name))


def _inside_field(context: Context, item: FieldSyntax, loc: Loc) -> None:
    """The names that stand inside of a field, those of its cases included."""
    for key in ("flags", "special", "values"):
        for entry in getattr(item, key) or ():
            _usable(context, entry, (*loc, key, entry))
    for name, bits in (item.bits or {}).items():
        _usable(context, name, (*loc, "bits", name))
        for entry in bits.values or ():
            _usable(context, entry, (*loc, "bits", name, "values", entry))
    _fields(context, item.fields or {}, (*loc, "fields"))
    for key, case in (item.cases or {}).items():
        _inside_field(context, case, (*loc, "cases", key))
