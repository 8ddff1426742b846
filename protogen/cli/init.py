"""`protogen init`: a first schema, to be changed."""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path
from typing import Annotated

import typer

from protogen.cli.exits import CLEAN, UsageError
from protogen.cli.generation.plan import SCHEMAS
from protogen.starter.framings import Framing, extending_schema, starter_schema

EXAMPLE = "Example: protogen init motor --framing cobs"
NAME = "my_protocol"
_SUFFIX = ".yaml"
_GREATEST_NAME = 64


def init(
    name: Annotated[
        str | None,
        typer.Argument(metavar="NAME", help=f"The protocol's name, in snake case. Default: {NAME}"),
    ] = None,
    framing: Annotated[
        Framing | None,
        typer.Option(help=f"How a receiver finds a frame. Default: {Framing.COBS.value}"),
    ] = None,
    base: Annotated[
        str | None,
        typer.Option("--from", metavar="library:NAME", help="A schema of the library to extend."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE", help="The new file. Default: NAME.yaml"),
    ] = None,
) -> int:
    """Write a small schema to begin with.

    It compiles as it is, and its comments say what is what. With `--from` it extends a schema of
    the library, such as `library:ubx`, and states only what your device does differently. Beside it
    goes the JSON Schema with which editors complete and explain. On a terminal, asks for what was
    not given. A file that is there already is never overwritten.
    """
    asks = sys.stdin.isatty() and sys.stdout.isatty()
    known = _library_name(base)
    if known is not None and framing is not None:
        raise UsageError("--from and --framing exclude each other", "the base has its own frame")
    chosen_name = _checked(name or (_ask_name() if asks else f"my_{known}" if known else NAME))
    file = output or Path(chosen_name + _SUFFIX)
    if known is None:
        chosen_framing = framing or (_ask_framing() if asks else Framing.COBS)
        _write_schema(file, starter_schema(chosen_name, chosen_framing, str(file)))
    else:
        _write_schema(file, extending_schema(chosen_name, known, str(file)))
    _write_json_schema(file.parent)
    typer.echo(f"next: protogen check {file}")
    _tell_of_project(file)
    return CLEAN


def _tell_of_project(file: Path) -> None:
    """Say what makes the schema one of the project's, where it is not."""
    from protogen.cli.schemas import open_project
    from protogen.project.find import OWN_FILE
    from protogen.project.schemas import schemas_below

    project = open_project()
    if project is None and file.resolve().is_relative_to(SCHEMAS.resolve()):
        return  # Where `generate` looks by itself.
    if project is None:
        line = f'schemas = ["{file.as_posix()}"]'
        typer.echo(f"for a bare `protogen generate`, write to {OWN_FILE}: {line}")
        return
    known = (known.resolve() for known in schemas_below(project.folder, project.settings.schemas))
    if file.resolve() not in known:
        name = Path(os.path.relpath(file.resolve(), project.folder.resolve())).as_posix()
        typer.echo(f'for a bare `protogen generate`, add "{name}" to `schemas` in {project.file}')


def _ask_name() -> str:
    from rich.prompt import Prompt

    from protogen.cli.console import console

    return Prompt.ask("Name of the protocol", default=NAME, console=console())


def _ask_framing() -> Framing:
    from rich.prompt import Prompt

    from protogen.cli.console import console, print_table

    out = console()
    print_table(out, ("framing", ""), [(item.value, item.summary) for item in Framing])
    named = {item.value: item for item in Framing}
    default = Framing.COBS.value
    choices = list(named)
    return named[
        Prompt.ask("Framing", choices=choices, show_choices=False, default=default, console=out)
    ]


def _checked(name: str) -> str:
    """Return a name that a protocol may have. Raises UsageError with one that is close."""
    from protogen.schema.syntax.base import NAME_PATTERN

    if not re.fullmatch(NAME_PATTERN, name) or len(name) > _GREATEST_NAME:
        close = "_".join(re.findall(r"[a-z0-9]+", name.lower())).lstrip("0123456789_")
        hint = f"did you mean `{close[:_GREATEST_NAME]}`?" if close else None
        raise UsageError(f"`{name}` is no lower snake case name", hint)
    return name


def _library_name(written: str | None) -> str | None:
    """Return the name of a schema of the library. Raises NoSchemaError if there is none."""
    from protogen.library import PREFIX
    from protogen.schema.files import schema_path

    if written is None:
        return None
    name = written.removeprefix(PREFIX)
    return schema_path(PREFIX + name).stem


def _write_schema(file: Path, text: str) -> None:
    try:
        with file.open("x", encoding="utf-8", newline="") as stream:
            stream.write(text)
    except FileExistsError:
        hint = "give another NAME, or another file with --output"
        raise UsageError(f"there is a file `{file}` already; it was left alone", hint) from None
    typer.echo(f"wrote {file}")


def _write_json_schema(folder: Path) -> None:
    from protogen.schema.json_schema import FILE_NAME, json_schema_text

    file = folder / FILE_NAME
    if not file.exists():
        file.write_text(json_schema_text(), encoding="utf-8", newline="")
        typer.echo(f"wrote {file}")
