"""The command line. This module only names the commands; each has a module of its own.

A command's module is imported when the command is asked for. Nothing heavy is imported at the top
of any of them either: a command imports what it needs when it runs, so that `--help` is quick.
"""

from __future__ import annotations

import gc
import io
import os
import sys
from importlib import import_module
from typing import Annotated, Any

import typer
from typer.core import TyperGroup
from typer.main import get_command

from protogen.cli.command import Command
from protogen.cli.exits import guarded

_MODULES = {
    "init": "init",
    "import": "importing",
    "check": "check",
    "generate": "generation.generate",
    "fmt": "fmt",
    "decode": "wire.decode",
    "encode": "wire.encode",
    "convert": "wire.convert",
    "explain": "wire.explain",
    "open": "opening",
    "monitor": "line.monitor",
    "send": "line.send",
    "record": "line.record",
    "tap": "line.tap",
    "replay": "line.replay",
    "simulate": "line.simulate",
    "serve": "line.serve",
    "fuzz": "fuzz",
    "diff": "evolution.diff",
    "breaking": "evolution.breaking",
    "lock": "evolution.lock",
    "rules": "evolution.rules",
    "size": "generation.size",
    "schema-json": "schema_json",
    "native": "native",
}
"""Module of each command, in the order of the help."""


class _Commands(TyperGroup):
    """Commands whose modules are imported when somebody asks for them."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        self.commands = dict.fromkeys(_MODULES)  # type: ignore[assignment]

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return a command by its name, or None if there is no such command."""
        return _command(cmd_name) if cmd_name in _MODULES else None


def _command(name: str) -> Any:
    module = import_module(f"protogen.cli.{_MODULES[name]}")
    if hasattr(module, "GROUP"):
        return get_command(module.GROUP)
    single = typer.Typer(add_completion=False, rich_markup_mode=None)
    cls = getattr(module, "CLASS", Command)
    run = getattr(module, name.replace("-", "_"))
    single.command(name, cls=cls, epilog=module.EXAMPLE)(guarded(run))
    return get_command(single)


app = typer.Typer(
    name="protogen",
    cls=_Commands,
    help="A compiler for serial protocols: one YAML file in, codecs and documents out.",
    epilog="Example: protogen check schemas && protogen generate schemas -o generated",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
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


def _start_again_in_utf8() -> None:
    """Start again in Python's UTF-8 mode where the locale says that names of files are ASCII.

    Else names with other characters could not be written, nor found by what files say of them.
    """
    is_utf8 = sys.getfilesystemencoding() == "utf-8"
    if not is_utf8 and os.environ.get("PYTHONUTF8") != "1":
        os.execve(sys.executable, sys.orig_argv, {**os.environ, "PYTHONUTF8": "1"})  # noqa: S606


def main() -> None:
    """Run the command line."""
    _start_again_in_utf8()
    if isinstance(sys.stdout, io.TextIOWrapper):
        # A character that the terminal's encoding lacks is no reason to stop.
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        app()
    finally:
        gc.freeze()  # At its end, Python would look for garbage in all that was made.
