"""`protogen rules`: what `protogen breaking` looks for."""

from __future__ import annotations

from protogen.cli.exits import CLEAN

EXAMPLE = "Example: protogen rules"


def rules() -> int:
    """List the rules of changes: category, what changed, and what to do instead."""
    from protogen.cli.console import console, print_table
    from protogen.evolution.rules import RULES

    rows = [[rule.name, rule.category.value, rule.about, rule.fix] for rule in RULES]
    print_table(console(), ("rule", "category", "what changed", "what to do"), rows)
    return CLEAN
