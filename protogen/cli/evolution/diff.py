"""`protogen diff`: what changed between two versions of a schema."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from protogen.cli.console import console, echo_json
from protogen.cli.exits import CLEAN, FINDINGS
from protogen.cli.options import Against, Versions
from protogen.cli.schemas import open_project

if TYPE_CHECKING:
    from rich.console import Console

    from protogen.evolution.compare import Comparison
    from protogen.evolution.findings import Finding

EXAMPLE = "Example: protogen diff git:main:schemas/rn1.yaml schemas/rn1.yaml"


def diff(
    versions: Versions = None,
    against: Against = None,
    format: Annotated[
        Literal["text", "markdown", "json", "html"],
        typer.Option(help="For people, a changelog entry, for programs, or a page."),
    ] = "text",
) -> int:
    """Say what changed between two versions, and show it with frames.

    Resolved protocols are compared, never text: comments and the order of keys are no change. Exits
    with 0 if nothing changed, 1 if something did.

    With nothing given, in a project: its schemas, against those of the last commit (git:HEAD).
    """
    from protogen.cli.evolution.versions import compared
    from protogen.evolution.findings import findings
    from protogen.evolution.report import as_json, markdown

    changed = False
    reports: list[dict[str, Any]] = []
    pages: list[tuple[str, str | tuple[Comparison, list[Finding]]]] = []
    out = console()
    with compared(versions or (), against, open_project()) as schemas:
        for name, before, after in schemas.pairs:
            if before is None or after is None:
                changed = True
                words = "is new" if before is None else "is gone"
                reports.append({"schema": name, "text": words})
                if format == "html":
                    pages.append((name, f"{name} {words}"))
                elif format != "json":
                    out.print(f"{name} {words}")
                continue
            comparison, found = findings(before, after)
            changed = changed or bool(found)
            if format == "json":
                reports.append({"schema": name} | as_json(comparison, found))
            elif format == "html":
                pages.append((name, (comparison, found)))
            elif format == "markdown":
                typer.echo(markdown(comparison, found))
            else:
                print_findings(out, comparison, found, name)
    if format == "json":
        echo_json(reports)
    elif format == "html":
        from protogen.evolution.page import page

        typer.echo(page(pages), nl=False)
    return FINDINGS if changed else CLEAN


def print_findings(
    out: Console, comparison: Comparison, found: list[Finding], schema: str | None = None
) -> None:
    """Print findings by schema and message, with their witnesses."""
    from protogen.evolution.findings import SHOWN_BY_FRAMES, Verdict
    from protogen.evolution.report import by_subject, place, title

    for subject, items in by_subject(found):
        heading = subject or comparison.new.name
        out.print(heading if schema is None else f"{schema}: {heading}", style="bold cyan")
        for item in items:
            style = {"WIRE": "bold red", "VALUE": "red", "SOURCE": "yellow"}.get(item.category)
            out.print(f"  {item.category}", style=style, end=" ")
            out.print(f"[{item.rule.name}] {title(item)}")
            where = place(comparison, item)
            if where:
                out.print(f"    at {where}", style="dim")
            if item.category in SHOWN_BY_FRAMES:
                out.print(f"    affects {item.affected}: {item.harm}")
            if item.verdict is not Verdict.PROVED:
                out.print(f"    {item.verdict}: no frame was found that shows it: no proof")
            for witness in item.witnesses:
                out.print(f"    {witness.words}")
            if item.category not in ("NONE",):
                out.print(f"    fix: {item.rule.fix}", style="green")
    if not found:
        out.print(f"{comparison.new.name}: no change", style="bold")
