"""Check that the keys of a field go together.

The keys about numbers and constants are asked about where their values are.
"""

from __future__ import annotations

from protogen.passes.context import Context, Loc
from protogen.passes.types.declared import VALUE_NAMES, Effective
from protogen.passes.types.sized_arrays import check_size
from protogen.passes.types.terminators import check_until
from protogen.schema.syntax.fields import FieldSyntax

_FORMS = ("type", "fields", "switch")
_STRINGS = ("ascii", "bytes")


def has_one_form(context: Context, item: FieldSyntax, loc: Loc) -> bool:
    """True if the field has just one of a type, fields, or a switch."""
    forms = [key for key in _FORMS if getattr(item, key) is not None]
    if len(forms) == 1:
        return True
    if forms:
        text = f"a field is one of these, not several: {', '.join(forms)}"
    else:
        text = "a field needs a `type`, or `fields` (a struct), or a `switch`"
    context.error_at_key("PG110", loc, text)
    return False


def check_keys(context: Context, name: str, item: Effective) -> None:
    """Report the keys that mean nothing for this kind of field."""
    syntax = item.syntax
    if syntax.switch is not None or syntax.fields is not None or syntax.type in _STRINGS:
        _only_for_integers(context, item)
    if syntax.switch is None and syntax.cases is not None:
        text = f"`cases` are for a switch, and `{name}` is none"
        hint = "name the field that chooses: `switch`"
        context.error_at_key("PG110", item.at("cases"), text, hint)
    if syntax.padding is not None and syntax.type != "ascii":
        text = f"`padding` is for ascii of a fixed size, and `{name}` is none"
        context.error_at_key("PG294", item.at("padding"), text)
    check_size(context, item)
    check_until(context, name, item)
    if syntax.count is not None:
        _count_fits(context, item)
    if syntax.when is not None and syntax.default is not None:
        text = f"`{name}` has no `default`: where it is there, its value has to be given"
        hint = "leave out the `default`"
        context.error_at_key("PG206", item.at("default"), text, hint)
    if any(link.when is not None for link, _ in item.chain[1:]):
        text = "a declared type is there wherever it is used"
        hint = "write `when` where the type is used"
        context.error_at_key("PG206", item.at("when"), text, hint)


def _only_for_integers(context: Context, item: Effective) -> None:
    syntax = item.syntax
    kind = "a switch" if syntax.switch else "a struct" if syntax.fields is not None else syntax.type
    for key in (*VALUE_NAMES, "digits", "code", "chars", "fraction", "case"):
        if key == "code" and syntax.type == "ascii":
            continue
        if getattr(syntax, key) is not None:
            text = f"{key} are for integers, not for {kind}"
            context.error_at_key("PG110", item.at(key), text)


def _count_fits(context: Context, item: Effective) -> None:
    if item.syntax.switch is not None:
        text = "a switch has no `count`"
        hint = "put it in a struct, and count that"
        context.error_at_key("PG110", item.at("count"), text, hint)
    elif item.syntax.type in _STRINGS:
        text = f"the length of {item.syntax.type} is its `size`, in bytes"
        context.error_at_key("PG110", item.at("count"), text)
