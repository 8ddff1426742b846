"""`protogen generate`: writes codecs and references."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from protogen.cli.exits import UsageError
from protogen.cli.generation import c_options
from protogen.cli.generation.generating import Mode, Reads, generate_once
from protogen.cli.generation.plan import Given
from protogen.cli.options import Quiet

EXAMPLE = "Example: protogen generate schemas -o generated --target python"


def generate(  # noqa: PLR0913 - each option is one argument
    schemas: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="SCHEMA",
            help="Schema files, folders of them, or library:NAME. Default: those of protogen.toml,"
            " or schemas.",
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="DIR",
            help="The folder for all targets. Default: generated.",
        ),
    ] = None,
    target: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Only this target: python, c, markdown, typescript or html; may be repeated. "
            "Default: the first three.",
        ),
    ] = None,
    check: Annotated[
        bool, typer.Option("--check", help="Write nothing; exit with 1 if a file is not current.")
    ] = False,
    diff: Annotated[
        bool,
        typer.Option("--diff", help="Write nothing; print what would change, exit with 1 if any."),
    ] = False,
    watch: Annotated[
        bool, typer.Option("--watch", help="Generate again whenever a schema changes.")
    ] = False,
    standalone: Annotated[
        bool | None,
        typer.Option(
            "--standalone/--no-standalone",
            help="Python that carries its runtime along.",
            show_default=False,
        ),
    ] = None,
    c_style: c_options.Style = None,
    events: c_options.Events = None,
    only: c_options.Only = None,
    sender: c_options.Senders = None,
    c_stubs: c_options.Stubs = None,
    c_hpp: c_options.Hpp = None,
    depfile: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Also write what was read, in the form that make and ninja take."
        ),
    ] = None,
    no_project: Annotated[
        bool, typer.Option("--no-project", help="Read no protogen.toml.")
    ] = False,
    quiet: Quiet = False,
) -> int:
    """Write a codec and a reference for each schema.

    Nothing is written if a schema has an error or one of its examples does not hold.
    Files that are current are not touched. Where only folders of schemas are given, files that were
    generated once and no longer are get removed; where single schemas are given, other files stay.

    What is not given comes from the nearest protogen.toml, or [tool.protogen] in pyproject.toml.
    There, only a run without schemas removes files; one without targets, too, fills marked blocks.
    """
    choice = c_options.Choice(c_style, events, only, sender, c_stubs, c_hpp)
    given = Given(schemas, output, target, standalone, choice)
    mode = Mode(check, diff, quiet, depfile, use_project=not no_project)
    if not watch:
        return generate_once(given, mode, Reads())
    if not mode.writes:
        raise UsageError("--watch writes; --check and --diff do not")
    from protogen.cli.generation.watching import generate_and_watch

    return generate_and_watch(given, mode)
