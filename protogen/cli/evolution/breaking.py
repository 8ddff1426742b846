"""`protogen breaking`: a gate for changes that affect the other end of the wire."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

import typer

from protogen.cli.console import console, echo_json
from protogen.cli.evolution.diff import print_findings
from protogen.cli.exits import CLEAN, FINDINGS, UsageError
from protogen.cli.options import Against, Versions
from protogen.cli.schemas import open_project

if TYPE_CHECKING:
    from collections.abc import Sequence

    from protogen.evolution.compare import Comparison
    from protogen.evolution.findings import Finding, Gate
    from protogen.model.protocol import Protocol
    from protogen.project.read import Project

EXAMPLE = "Example: protogen breaking schemas --against git:main"


def breaking(
    versions: Versions = None,
    against: Against = None,
    against_lock: Annotated[
        str | None,
        typer.Option(metavar="FILE", help="A lock that NEW is held against; see `protogen lock`."),
    ] = None,
    use: Annotated[
        list[str] | None,
        typer.Option(metavar="RULE", help="Rules or categories that count. Default: WIRE, VALUE."),
    ] = None,
    except_: Annotated[
        list[str] | None, typer.Option("--except", metavar="RULE", help="Rules that do not count.")
    ] = None,
    ignore: Annotated[
        list[str] | None,
        typer.Option(
            metavar="[RULE=]PLACE",
            help="Places that do not count: gyro.*, or rn1.gyro.*.",
        ),
    ] = None,
    format: Annotated[
        Literal["text", "json", "github"],
        typer.Option(help="For people, programs, or GitHub Actions."),
    ] = "text",
) -> int:
    """Refuse changes that the other end of the wire would misread or lose.

    Each finding has a rule, who is affected and how, and a frame that shows it. Exits with 0 if
    nothing is broken, 1 if something is.

    With nothing given, in a project: its schemas, against those of the last commit (git:HEAD); a
    gate for pull requests names the branch that they go to, as in --against git:origin/main.
    """
    from protogen.cli.evolution.versions import LAST_COMMIT, compared

    project = open_project()
    gate = _gate(project, use or [], except_ or [], ignore or [])
    held = f"lock:{against_lock}" if against_lock is not None else against
    since = held or (versions[0] if versions else LAST_COMMIT)
    reports: list[tuple[str, Comparison, list[Finding]]] = []
    with compared(versions or (), held, project) as schemas:
        schemas.check_not_empty(since)
        for name, old, new in schemas.pairs:
            if old is not None:
                comparison, found = _judged(name, old, new, gate)
                reports.append((name, comparison, found))
        _report(format, reports)
    stopped = any(found for _, _, found in reports)
    if format == "text" and not stopped:
        words = "nothing is broken" if versions else f"nothing is broken since {since}"
        console().print(words, style="bold")
    typer.echo(schemas.summary, err=format != "text")
    for pattern in gate.unused([comparison for _, comparison, _ in reports]):
        typer.echo(f"warning: `{pattern}` is to be ignored and matches no change", err=True)
    return FINDINGS if stopped else CLEAN


def _report(format: str, reports: Sequence[tuple[str, Comparison, list[Finding]]]) -> None:
    from protogen.evolution.report import as_json, shared
    from protogen.evolution.version_step import advice, step_of

    if format == "json":
        listed = [
            {"schema": name, "needs": step_of(comparison.changes).value}
            | as_json(comparison, found)
            for name, comparison, found in reports
        ]
        echo_json(listed)
        return
    out = console()
    for name, comparison, found, others in shared(reports):
        if format == "github":
            _print_github(comparison, found, name)
            continue
        print_findings(out, comparison, found, name)
        if others:
            out.print(f"  the same in {', '.join(others)}", style="dim")
    for name, comparison, found in reports:
        words = advice(comparison) if found or comparison.new.version is not None else None
        if words is not None and format == "text":
            out.print(f"{name}: {words}")


def _judged(
    name: str, old: Protocol, new: Protocol | None, gate: Gate
) -> tuple[Comparison, list[Finding]]:
    from protogen.evolution.findings import findings, gone

    return gone(old, name, gate) if new is None else findings(old, new, gate)


def _gate(project: Project | None, use: list[str], except_: list[str], ignore: list[str]) -> Gate:
    """Selection of rules: the command line over the project's file."""
    from protogen.evolution.findings import Gate
    from protogen.evolution.rules import BY_NAME, Category
    from protogen.problems import hint_for

    places: dict[str, list[str]] = {}
    for item in ignore:
        rule, equals, place = item.rpartition("=")
        places.setdefault(rule if equals else "*", []).append(place)
    if project is not None:
        settings = project.settings.breaking
        use = use or list(settings.use)
        except_ = except_ or list(settings.except_)
        for name, patterns in settings.ignore.items():
            places.setdefault(name, []).extend(patterns)
    gate = Gate(tuple(use) or Gate().use, tuple(except_), places)
    for name in gate.unknown():
        known = [*BY_NAME, *(category.value for category in Category)]
        message = f"there is no rule `{name}`"
        raise UsageError(message, hint_for(name, known) or "protogen rules lists them")
    return gate


def _print_github(comparison: Comparison, found: list[Finding], name: str) -> None:
    from protogen.evolution.places import places_of
    from protogen.evolution.report import title
    from protogen.evolution.revisions import path_in_repository

    for item in found:
        span = places_of(comparison, item.change).new
        where = [f"file={path_in_repository(file)}" for file in comparison.new.files[:1]]
        if span is not None:
            where = [f"file={path_in_repository(span.file)}", f"line={span.line}"]
        properties = ",".join([*where, f"title={item.rule.name}"])
        lines = [f"{name}: {title(item)}", *(witness.words for witness in item.witnesses)]
        typer.echo(f"::error {properties}::{'%0A'.join(lines)}")
