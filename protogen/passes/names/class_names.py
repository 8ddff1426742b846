"""Check that no two things come to the same name in generated code.

Targets write `m_1` and `m1` as `M1`. Messages, named types and what a module needs itself share one
set of such names.
"""

from __future__ import annotations

from protogen.passes.context import Context, Loc
from protogen.passes.draft import Draft

ROOT_NAMES = frozenset(
    {
        "protocol", "encode", "decode", "decoder", "encoder", "messages", "message", "parts",
        "sender", "not_implemented", "encode_error", "decode_error",
    }
)  # fmt: skip
"""Names that generated modules use themselves, which a type or message would hide.

`NotImplemented` is what the comparisons of their dataclasses return. No other builtin that is
written like a class stands in them, so that a message may well be called `warning`.
"""

_RENAME = "rename one of them; types inside of fields are called after message and field"


def check_class_names(context: Context, draft: Draft) -> None:
    """Every message and named type has a class of its own."""
    messages: dict[str, Loc] = {name: ("messages", name) for name in context.syntax.messages}
    types = context.places | {name: ("types", name) for name in context.syntax.types}
    for name, loc in messages.items():
        if name in types:
            context.error_at_key("PG107", loc, f"a type is called `{name}` too", _RENAME)
    own = (f"{sender}_{word}" for sender in draft.senders for word in ("parts", "message"))
    generated = {_pascal(name) for name in (*ROOT_NAMES, *own)}
    classes: dict[str, str] = {}
    for name, loc in (types | messages).items():
        other = classes.setdefault(_pascal(name), name)
        if _pascal(name) in generated:
            text = f"`{name}` would be `{_pascal(name)}`, which generated code uses itself"
            context.error_at_key("PG106", loc, text, f"another name, such as `{name}_data`")
        elif other != name:
            text = f"`{name}` and `{other}` are both `{_pascal(name)}` in generated code"
            context.error_at_key("PG107", loc, text, _RENAME)


def _pascal(name: str) -> str:
    return "".join(word.capitalize() for word in name.split("_"))
