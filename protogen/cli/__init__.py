"""The command line. This module only registers the commands; each has a module of its own.

Nothing heavy is imported here or at the top of a command's module: a command imports what it needs
when it runs, so that `--help` and completion are quick.
"""

from __future__ import annotations

import io
import sys
from typing import Annotated

import typer

from protogen.cli import check, fmt, fuzz, init, native, schema_json
from protogen.cli.command import Command
from protogen.cli.evolution import breaking, diff, lock, rules
from protogen.cli.exits import guarded
from protogen.cli.generation import generate, size
from protogen.cli.wire import convert, decode, encode, explain

app = typer.Typer(
    name="protogen",
    help="A compiler for serial protocols: one YAML file in, codecs and documents out.",
    epilog="Example: protogen check schemas && protogen generate schemas -o generated",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)

app.command("init", cls=Command, epilog=init.EXAMPLE)(guarded(init.init))
app.command("check", cls=Command, epilog=check.EXAMPLE)(guarded(check.check))
app.command("generate", cls=Command, epilog=generate.EXAMPLE)(guarded(generate.generate))
app.command("fmt", cls=Command, epilog=fmt.EXAMPLE)(guarded(fmt.fmt))
app.command("decode", cls=Command, epilog=decode.EXAMPLE)(guarded(decode.decode))
app.command("encode", cls=Command, epilog=encode.EXAMPLE)(guarded(encode.encode))
app.command("convert", cls=convert.ConvertCommand, epilog=convert.EXAMPLE)(guarded(convert.convert))
app.command("explain", cls=Command, epilog=explain.EXAMPLE)(guarded(explain.explain))
app.command("fuzz", cls=Command, epilog=fuzz.EXAMPLE)(guarded(fuzz.fuzz))
app.command("diff", cls=Command, epilog=diff.EXAMPLE)(guarded(diff.diff))
app.command("breaking", cls=Command, epilog=breaking.EXAMPLE)(guarded(breaking.breaking))
app.command("lock", cls=Command, epilog=lock.EXAMPLE)(guarded(lock.lock))
app.command("rules", cls=Command, epilog=rules.EXAMPLE)(guarded(rules.rules))
app.command("size", cls=Command, epilog=size.EXAMPLE)(guarded(size.size))
native_app = typer.Typer(
    help="Compiled decoders that read captures fast: build them ahead, find them, remove them.",
    no_args_is_help=True,
)
native_app.command("build", cls=Command, epilog=native.BUILD_EXAMPLE)(guarded(native.build))
native_app.command("path", cls=Command, epilog=native.PATH_EXAMPLE)(guarded(native.path))
native_app.command("clean", cls=Command, epilog=native.CLEAN_EXAMPLE)(guarded(native.clean))
app.add_typer(native_app, name="native")
app.command("schema-json", cls=Command, epilog=schema_json.EXAMPLE)(
    guarded(schema_json.schema_json)
)


def _print_version(asked: bool) -> None:
    if asked:
        from protogen.version import VERSION

        typer.echo(f"protogen {VERSION}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version and exit."
        ),
    ] = False,
) -> None:
    pass


def main() -> None:
    """Run the command line."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        # A character that the terminal's encoding lacks is no reason to stop.
        sys.stdout.reconfigure(errors="backslashreplace")
    app()
