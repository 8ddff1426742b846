"""`protogen schema-json`: the JSON Schema that editors use."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from protogen.cli.exits import CLEAN, FINDINGS

EXAMPLE = "Example: protogen schema-json -o schemas/protogen.schema.json"
FILE = Path("schemas/protogen.schema.json")


def schema_json(
    check: Annotated[
        bool, typer.Option("--check", help="Write nothing; exit with 1 if FILE is not current.")
    ] = False,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help=f"Write to FILE instead of standard output. With --check: {FILE}.",
        ),
    ] = None,
) -> int:
    """Print the JSON Schema that editors use.

    With it they complete, explain and underline. An editor finds it by a first line of the schema
    such as `# yaml-language-server: $schema=protogen.schema.json`.
    """
    from protogen.schema.json_schema import json_schema_text

    text = json_schema_text()
    if check:
        return _check(output or FILE, text)
    if output is None:
        typer.echo(text, nl=False)
    elif _read(output) != text:
        output.write_text(text, encoding="utf-8")
    return CLEAN


def _check(file: Path, text: str) -> int:
    if _read(file) == text:
        return CLEAN
    typer.echo(f"{file} is not current; fix it with: protogen schema-json -o {file}")
    return FINDINGS


def _read(file: Path) -> str | None:
    return file.read_text(encoding="utf-8") if file.is_file() else None
