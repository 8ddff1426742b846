"""Check that no message and type have one name: they share one set of names in every language."""

from __future__ import annotations

from protogen.passes.context import Context
from protogen.passes.draft import Draft

_RENAME = "rename one of them; types inside of fields are called after message and field"


def check_distinct_names(context: Context, _draft: Draft) -> None:
    """Messages are called like no type, be it declared or written in a field."""
    types = context.places.keys() | context.syntax.types.keys()
    for name in context.syntax.messages:
        if name in types:
            loc = ("messages", name)
            context.error_at_key("PG107", loc, f"a type is called `{name}` too", _RENAME)
