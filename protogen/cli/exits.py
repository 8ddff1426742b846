"""Exit codes, and what becomes of an error that a command does not handle itself."""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Callable
from functools import wraps
from typing import ParamSpec

import typer

from protogen.errors import UserError

CLEAN = 0
"""Everything is as it should be."""
FINDINGS = 1
"""The command worked and found something wrong."""
USAGE = 2
"""The call is wrong, or a file can't be read or written."""
BUG = 70
"""protogen itself is wrong."""
INTERRUPTED = 130
"""Ctrl-C: 128 and the number of SIGINT."""
BROKEN_PIPE = 141
"""Nobody reads the output any more: 128 and the number of SIGPIPE."""

DEBUG_VARIABLE = "PROTOGEN_DEBUG"
"""Environment variable that asks for the traceback of a bug."""

Arguments = ParamSpec("Arguments")


class UsageError(UserError):
    """A mistake in the call."""


def guarded(command: Callable[Arguments, int]) -> Callable[Arguments, None]:
    """Make ``command``, which returns an exit code, end the process in one of the known ways."""

    @wraps(command)
    def run(*args: Arguments.args, **kwargs: Arguments.kwargs) -> None:
        try:
            code = command(*args, **kwargs)
            sys.stdout.flush()
        except KeyboardInterrupt:
            code = INTERRUPTED
        except typer.Exit:
            raise
        except Exception as error:
            code = explain(error)
        raise typer.Exit(code)

    return run


def explain(error: Exception) -> int:
    """Say what an error means that ends a command; return the exit code."""
    match error:
        case UserError():
            return complain(str(error), error.hint)
        case BrokenPipeError():
            return _lose_output()
        case OSError():
            return complain(_file_trouble(error))
        case _:
            return report_bug(error)


def report_bug(error: Exception) -> int:
    """Say that protogen is at fault, not the user; return the exit code."""
    sys.stderr.write(
        f"protogen: this is a bug in protogen: {type(error).__name__}: {error}\n"
        "It is not your mistake. Please report it where you have protogen from, with the command,\n"
        f"the schema, and what it prints with {DEBUG_VARIABLE}=1.\n"
    )
    if os.environ.get(DEBUG_VARIABLE) == "1":
        traceback.print_exception(error, file=sys.stderr)
    return BUG


def complain(message: str, hint: str | None = None) -> int:
    """Print a user's mistake to standard error; return the exit code for it."""
    from protogen.cli.console import console

    out = console(stderr=True)
    out.print("error:", style="bold red", end=" ")
    out.print(message, markup=False)
    if hint is not None:
        out.print(f"  hint: {hint}", markup=False, style="green")
    return USAGE


def _file_trouble(error: OSError) -> str:
    reason = error.strerror or str(error)
    return f"{error.filename}: {reason}" if error.filename else reason


def _lose_output() -> int:
    """Point standard output at nothing, so that the interpreter's last flush is quiet, too."""
    nothing = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, sys.stdout.fileno())
    return BROKEN_PIPE
