"""`protogen import`: definitions of other tools, as schemas."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from protogen.cli.command import Command
from protogen.cli.exits import CLEAN, USAGE, UsageError, guarded
from protogen.cli.options import Quiet

if TYPE_CHECKING:
    from protogen.importing.remarks import Imported

GROUP = typer.Typer(
    name="import",
    help="Make schemas of the definitions of other tools.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
)

Definitions = Annotated[
    Path, typer.Argument(metavar="DIR", help="The folder of the definitions, or one file.")
]
Output = Annotated[
    Path, typer.Option("--output", "-o", metavar="DIR", help="The folder of the schemas.")
]
Force = Annotated[bool, typer.Option("--force", help="Overwrite files that are in the way.")]


@GROUP.callback()
def _formats() -> None:
    """Keep the name of the format on the command line, also while there is one alone."""


@GROUP.command(cls=Command, epilog="Example: protogen import sbp libsbp/spec -o schemas")
@guarded
def sbp(
    definitions: Definitions,
    output: Output,
    split: Annotated[
        bool, typer.Option("--split", help="Make a schema for each package, not one for all.")
    ] = False,
    force: Force = False,
    quiet: Quiet = False,
) -> int:
    """Make a schema of definitions of the Swift Navigation Binary Protocol.

    Reads the YAML files of libsbp in a folder, or one of them, with those that they include. The
    schema has their messages, structs, names of values, units and docs. What is not in it as it is
    defined is listed with the reason. A file that was made or changed by hand is not overwritten.
    """
    from protogen.cli.schemas import print_found
    from protogen.importing.remarks import Remark
    from protogen.importing.sbp.packages import read_packages
    from protogen.importing.sbp.schemas import import_packages
    from protogen.problems import Problems, SourceMap

    problems, sources = Problems(), SourceMap()
    remarks: list[Remark] = []
    packages = read_packages(definitions, problems, sources, remarks)
    if packages is None:
        print_found(problems, sources)
        return USAGE
    imported = import_packages(packages, remarks, split=split)
    if not imported.schemas:
        raise UsageError(f"`{definitions}` defines no message")
    _write(imported, output, force=force, quiet=quiet)
    return CLEAN


@GROUP.command(cls=Command, epilog="Example: protogen import mavlink common.xml -o schemas")
@guarded
def mavlink(
    definitions: Definitions,
    output: Output,
    wire: Annotated[
        Literal["1", "2"], typer.Option("--wire", help="The version of the protocol.")
    ] = "2",
    force: Force = False,
    quiet: Quiet = False,
) -> int:
    """Make schemas of definitions of MAVLink.

    Reads an XML file of messages, or those of a folder, with the files that they include. Each
    becomes a schema, which extends that of a file that it includes. They have messages, enums,
    units and docs. What is not in them as it is defined is listed with the reason. A file that was
    made or changed by hand is not overwritten.
    """
    from protogen.importing.mavlink.dialects import read_dialects
    from protogen.importing.mavlink.frames import Wire
    from protogen.importing.mavlink.schemas import import_dialects

    imported = import_dialects(read_dialects(definitions), Wire(wire))
    if not imported.schemas:
        raise UsageError(f"`{definitions}` defines no message")
    _write(imported, output, force=force, quiet=quiet)
    return CLEAN


def _write(imported: Imported, folder: Path, *, force: bool, quiet: bool) -> None:
    """Write schemas and say what is in them, and what is not."""
    from protogen.importing.writing import foreign_files, path_of, write_schema

    foreign = [] if force else foreign_files(imported.schemas, folder)
    if foreign:
        names = ", ".join(f"`{file}`" for file in foreign)
        hint = "move it away, or overwrite it with --force"
        raise UsageError(f"{names}: not made by an import, or changed since", hint)
    for schema in imported.schemas:
        verb = "wrote" if write_schema(schema, folder) else "is there already:"
        if not quiet:
            counts = f"{_count(schema.messages, 'message')}, {_count(schema.types, 'type')}"
            typer.echo(f"{verb} {path_of(schema, folder)}: {counts}")
    for remark in imported.remarks:
        typer.echo(f"{remark.kind}: {remark.name} ({remark.span}): {remark.reason}")
    if not quiet:
        others = f", {_count(imported.others, 'other file')} passed over" if imported.others else ""
        typer.echo(f"{_count(imported.files, 'file')} of definitions read{others}")
        typer.echo(f"next: protogen check {folder}")


def _count(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"
