"""Check that everything exists that a schema names.

Where a name has to fit as well (a part its frame, a value its field), the pass that knows asks.
"""

from __future__ import annotations

from typing import cast

from protogen.passes.context import Context, Loc
from protogen.passes.types.type_names import COMMON_NAMES, integer_width, is_builtin, type_hint
from protogen.problems import hint_for
from protogen.schema.references import Reference, references
from protogen.schema.scopes import keys_at
from protogen.schema.syntax.names import Kind

_BUILT_IN = frozenset(COMMON_NAMES)


def check_references(context: Context) -> None:
    """Report each name of nothing that the schema declares, and the one that may be meant."""
    for found in references(context.data):
        if found.missing is None or (found.kind is Kind.TYPE and found.name in _BUILT_IN):
            continue
        if not found.declarations(context.data):
            _check(context, found, found.missing)


def _check(context: Context, found: Reference, code: str) -> None:
    scope, name = found.scopes[0], getattr(found.name, "text", str(found.name))
    declared = [str(key) for key in keys_at(context.data, scope)]
    text, hint = f"there is no {found.kind.value} `{name}`", hint_for(name, declared)
    match found.kind:
        case Kind.TYPE if is_builtin(name):
            text = f"integers are 1 to 64 bits wide, not {integer_width(name)}"
            code, hint = "PG105", None
        case Kind.TYPE:
            hint = type_hint(name, declared)
        case Kind.DECISION if hint is None:
            keys = "question: ..., document: ..., choice: ..., because: ..."
            hint = f"add it: `decisions: {{{name}: {{{keys}}}}}`"
        case Kind.EXAMPLE:
            message = str(scope[1])
            if message not in context.syntax.messages:
                return
            text = f"`{message}` has no example `{name}`"
    if not context.is_lost(str(scope[0]), name):
        report = context.error_at_key if found.spot.at_key else context.error
        report(code, cast(Loc, found.spot.place), text, hint)
