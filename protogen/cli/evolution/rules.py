"""`protogen rules`: what `protogen breaking` looks for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

import typer

from protogen.cli.exits import CLEAN, UsageError

if TYPE_CHECKING:
    from protogen.evolution.rules import Rule

EXAMPLE = "Example: protogen rules field-scale"


def rules(
    name: Annotated[str | None, typer.Argument(help="A rule to explain with an example.")] = None,
    format: Annotated[
        Literal["text", "json"], typer.Option(help="For people, or for programs.")
    ] = "text",
) -> int:
    """List the rules of changes, or explain one: a schema before and after, and a frame."""
    from protogen.cli.console import console, echo_json, print_table
    from protogen.evolution.rules import RULES

    chosen = RULES if name is None else (_rule(name),)
    if format == "json":
        echo_json([_as_json(rule, explain=name is not None) for rule in chosen])
    elif name is None:
        rows = [[rule.name, rule.category.value, rule.about, rule.fix] for rule in RULES]
        print_table(console(), ("rule", "category", "what changed", "what to do"), rows)
    else:
        _explain(chosen[0])
    return CLEAN


def _rule(name: str) -> Rule:
    from protogen.evolution.rules import BY_NAME
    from protogen.problems import hint_for

    if name not in BY_NAME:
        message = f"there is no rule `{name}`"
        raise UsageError(message, hint_for(name, [*BY_NAME]) or "protogen rules lists them")
    return BY_NAME[name]


def _as_json(rule: Rule, *, explain: bool) -> dict[str, object]:
    from protogen.evolution.examples import example_of
    from protogen.evolution.report import as_json

    entry: dict[str, object] = {
        "rule": rule.name,
        "category": rule.category.value,
        "about": rule.about,
        "fix": rule.fix,
        "shown_by_frames": rule.by_frame,
    }
    if explain:
        example = example_of(rule.name)
        findings = as_json(*example.findings())["findings"]
        entry |= {"before": example.before, "after": example.after, "findings": findings}
    return entry


def _explain(rule: Rule) -> None:
    from protogen.cli.console import console
    from protogen.cli.evolution.diff import print_findings
    from protogen.evolution.examples import example_of

    out = console()
    out.print(rule.name, style="bold cyan", end=" ")
    out.print(f"{rule.category.value}: {rule.about}")
    out.print(f"what to do: {rule.fix}")
    out.print()
    example = example_of(rule.name)
    for line in example.steps():
        style = {"-": "red", "+": "green"}.get(line[:1])
        out.print(line, style=style, markup=False, highlight=False)
    out.print()
    print_findings(out, *example.findings())
