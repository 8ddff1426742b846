"""`protogen native`: the compiled decoders that read captures."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

import typer

from protogen.cli.command import Command
from protogen.cli.exits import CLEAN, UsageError, guarded
from protogen.cli.options import SchemaPaths
from protogen.convert.formats import OutputFormat

if TYPE_CHECKING:
    from protogen.convert.columns.tables import Tables

GROUP = typer.Typer(
    name="native",
    help="Compiled decoders that read captures fast: build them ahead, find them, remove them.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
)


@GROUP.command(cls=Command, epilog="Example: protogen native build schemas")
@guarded
def build(schemas: SchemaPaths = None) -> int:
    """Compile what reads captures of these schemas fast, ahead of its first use.

    Uses the compiler that CC names, else one on the PATH, else that of the package ziglang.
    Libraries are kept in a cache that only you can write to; what is there already is not compiled
    again.
    """
    from protogen.cli.schemas import chosen_schemas, open_protocol
    from protogen.convert.columns.tables import tables_of
    from protogen.live.rows import driver_of
    from protogen.native.build import build as build_library
    from protogen.native.errors import NativeError

    protocols = [open_protocol(file) for file in chosen_schemas(schemas)]
    try:
        for protocol in protocols:
            for sender in protocol.senders:
                built = build_library(driver_of(protocol, sender))
                name = f"{protocol.name} {sender.name}"
                _say(name, is_new=built.is_new)
                _build_printers(name, tables_of(protocol, sender))
    except NativeError as error:
        raise UsageError(str(error), "captures can still be read in Python") from None
    return CLEAN


def _build_printers(name: str, tables: Tables) -> None:
    """Compile what prints rows as text."""
    from protogen.convert.writers.printer_library import built_printer
    from protogen.native.print_steps import UnprintableError

    for format in filter(lambda it: it.is_printed, OutputFormat):
        with suppress(UnprintableError):
            built = built_printer(tables, format)
            _say(f"{name} to {format.value}", is_new=built.is_new)


def _say(what: str, *, is_new: bool) -> None:
    typer.echo(f"{what}: {'compiled' if is_new else 'is there'}")


@GROUP.command(cls=Command, epilog="Example: du -sh $(protogen native path)")
@guarded
def path() -> int:
    """Print the folder that the compiled libraries are kept in."""
    from protogen.native.cache import cache_folder

    typer.echo(str(cache_folder()))
    return CLEAN


@GROUP.command(cls=Command, epilog="Example: protogen native clean")
@guarded
def clean() -> int:
    """Remove all compiled libraries. They are compiled again when they are used."""
    from protogen.native.cache import clean as clean_cache

    count = clean_cache()
    typer.echo(f"removed {count} {'library' if count == 1 else 'libraries'}")
    return CLEAN
