"""`protogen lock`: keep resolved protocols in a file, to compare with later."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from protogen.cli.exits import CLEAN, FINDINGS
from protogen.cli.options import SchemaPaths

EXAMPLE = "Example: protogen lock schemas && protogen breaking schemas --against-lock protogen.lock"


def lock(
    schemas: SchemaPaths = None,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="FILE", help="The lock file.")
    ] = Path("protogen.lock"),
    check: Annotated[
        bool, typer.Option("--check", help="Write nothing; exit with 1 if it would change.")
    ] = False,
) -> int:
    """Write what bytes and their meaning depend on, with hashes, to one file.

    For trees without git: `protogen breaking --against-lock` holds schemas against it.
    """
    from protogen.cli.schemas import chosen_schemas, open_protocol
    from protogen.evolution.lock import lock_text

    base = output.resolve().parent
    found = {
        Path(os.path.relpath(file.resolve(), base)).as_posix(): open_protocol(file)
        for file in chosen_schemas(schemas)
    }
    text = lock_text(found)
    if not check:
        output.write_text(text, encoding="utf-8", newline="")
        return CLEAN
    is_current = output.is_file() and output.read_text(encoding="utf-8") == text
    if not is_current:
        typer.echo(f"{output} is not current; run `protogen lock`")
    return CLEAN if is_current else FINDINGS
