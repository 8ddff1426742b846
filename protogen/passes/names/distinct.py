"""Check that no message and declared type have one name: other names are made of it."""

from __future__ import annotations

from protogen.passes.context import Context
from protogen.passes.draft import Draft

_RENAME = "rename one of them"


def check_distinct_names(context: Context, _draft: Draft) -> None:
    """Messages are called like no declared type."""
    for name in context.syntax.messages:
        if name in context.syntax.types:
            loc = ("messages", name)
            context.error_at_key("PG107", loc, f"a type is called `{name}` too", _RENAME)
