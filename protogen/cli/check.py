"""`protogen check`: problems, examples and the framing analysis of schemas."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from protogen.cli.collecting import without_garbage_collection
from protogen.cli.console import echo_json
from protogen.cli.exits import CLEAN, FINDINGS
from protogen.cli.options import Quiet, SchemaPaths
from protogen.cli.schemas import chosen_schemas, compile_files, each_once

if TYPE_CHECKING:
    from protogen.compiler import Compilation
    from protogen.problems import Problem

EXAMPLE = "Example: protogen check schemas"


def check(
    schemas: SchemaPaths = None,
    format: Annotated[
        Literal["text", "json", "github"],
        typer.Option(help="How to print: for people, programs, or GitHub Actions."),
    ] = "text",
    quiet: Quiet = False,
) -> int:
    """Report problems, verify examples, analyse framing.

    Every problem of every schema is reported. Exits with 0 if there is nothing to fix, 1 if there
    is.
    """
    with without_garbage_collection():
        compilations = compile_files(chosen_schemas(schemas), "checking")
        match format:
            case "text":
                _print_text(compilations, quiet=quiet)
            case "json":
                _print_json(compilations, quiet=quiet)
            case "github":
                _print_github(compilations)
    return FINDINGS if any(map(_has_findings, compilations)) else CLEAN


def _has_findings(compilation: Compilation) -> bool:
    from protogen.problems import Severity

    return any(problem.severity is not Severity.NOTE for problem in compilation.problems)


def _print_text(compilations: Sequence[Compilation], *, quiet: bool) -> None:
    from protogen.cli.analysis import print_analysis
    from protogen.cli.console import console
    from protogen.problems import render_rich

    out = console()
    shown = 0
    for compilation, problems in each_once(compilations):
        for problem in problems:
            out.print(render_rich(problem, compilation.sources))
        shown += len(problems)
        if compilation.protocol is not None and not quiet:
            print_analysis(out, compilation.path, compilation.protocol)
    if shown or not quiet:
        out.print(_summary(len(compilations), shown), style="bold")


def _summary(files: int, problems: int) -> str:
    return f"{_counted(files, 'schema')}, {_counted(problems, 'problem')}"


def _counted(number: int, thing: str) -> str:
    return f"{number or 'no'} {thing}{'' if number == 1 else 's'}"


def _print_json(compilations: Sequence[Compilation], *, quiet: bool) -> None:
    from protogen.cli.analysis import analysis
    from protogen.problems import to_json

    report: dict[str, object] = {"problems": to_json(_distinct(compilations))}
    if not quiet:
        report["protocols"] = [
            analysis(compilation.path, compilation.protocol)
            for compilation in compilations
            if compilation.protocol is not None
        ]
    echo_json(report)


def _print_github(compilations: Sequence[Compilation]) -> None:
    from protogen.problems import to_github

    for problem in _distinct(compilations):
        typer.echo(to_github(problem))


def _distinct(compilations: Sequence[Compilation]) -> tuple[Problem, ...]:
    return tuple(problem for _, problems in each_once(compilations) for problem in problems)
