"""`protogen fmt`: the canonical layout of schemas."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from protogen.cli.exits import CLEAN, FINDINGS, explain
from protogen.cli.options import Quiet
from protogen.cli.schemas import own_schemas, print_problems
from protogen.schema.files import schema_files

EXAMPLE = "Example: protogen fmt schemas --check"


class ChangedMeaningError(Exception):
    """A layout that says something else than the text did: never the user's fault."""


def fmt(
    schemas: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="[SCHEMA]",
            help="Schema files, or folders of them. Default: the project's schemas.",
        ),
    ] = None,
    check: Annotated[
        bool,
        typer.Option("--check", help="Write nothing; exit with 1 if a file is laid out otherwise."),
    ] = False,
    quiet: Quiet = False,
) -> int:
    """Lay schemas out in the canonical form.

    Indentation, spaces, quotes, the order of keys and the length of lines change; comments stay
    where they belong, and lined up columns stay lined up. The protocol stays the same, which is
    proved for each file before it is written. A file with errors is reported and left alone.
    """
    files = schema_files(schemas) if schemas else own_schemas()
    return max((_lay_out(file, check=check, quiet=quiet) for file in files), default=CLEAN)


def _lay_out(file: Path, *, check: bool, quiet: bool) -> int:
    """Lay out one file and return an exit code; whatever fails keeps no other file from it."""
    try:
        change = _change(file)
        if change is None:
            return FINDINGS
        before, after = change
        if before == after:
            return CLEAN
        _finish(file, after, check=check, quiet=quiet)
    except Exception as error:
        return explain(error)
    return FINDINGS if check else CLEAN


def _change(file: Path) -> tuple[str, str] | None:
    """Return the text of a schema and how it is laid out; None where it has errors."""
    from protogen.compiler import compile_file
    from protogen.layout.formatting import format_text
    from protogen.layout.meaning import same_meaning

    compilation = compile_file(file)
    if compilation.protocol is None:
        print_problems([compilation])
        return None
    before = file.read_bytes().decode("utf-8")
    after = format_text(before)
    if before != after and not same_meaning(file, before, after):
        raise ChangedMeaningError(f"{file} would mean something else; it was left alone")
    return before, after


def _finish(file: Path, text: str, *, check: bool, quiet: bool) -> None:
    if check:
        typer.echo(f"{file}: would be laid out anew; fix it with: protogen fmt {file}")
        return
    file.write_bytes(text.encode("utf-8"))
    if not quiet:
        typer.echo(f"laid out {file}")
