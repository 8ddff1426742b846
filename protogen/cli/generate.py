"""`protogen generate`: writes codecs and references."""

from __future__ import annotations

import gc
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from protogen.cli import c_options
from protogen.cli.exits import CLEAN, FINDINGS, USAGE, UsageError
from protogen.cli.options import Quiet
from protogen.cli.schemas import print_problems, schema_files

if TYPE_CHECKING:
    from protogen.compiler import Compilation
    from protogen.targets import Target
    from protogen.targets.output import File, Report

EXAMPLE = "Example: protogen generate schemas -o generated --target python"
SCHEMAS = Path("schemas")
OUTPUT = Path("generated")
_PYTHON = "python"


@dataclass(frozen=True, slots=True)
class Job:
    """The files of one target, and the folder that they go to."""

    files: tuple[File, ...]
    folder: Path
    prune: bool
    """Whether other files of ours in the folder are stale: not if only some schemas were named."""


def generate(  # noqa: PLR0913 - each option is one argument
    schemas: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="SCHEMA", help="Schema files, or folders of them. Default: schemas."
        ),
    ] = None,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="The folder for all targets.")
    ] = OUTPUT,
    target: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Only this target; may be repeated. Default: all."),
    ] = None,
    check: Annotated[
        bool, typer.Option("--check", help="Write nothing; exit with 1 if a file is not current.")
    ] = False,
    diff: Annotated[
        bool, typer.Option("--diff", help="Write nothing; print what would change.")
    ] = False,
    standalone: Annotated[
        bool,
        typer.Option("--standalone", help="Python that carries its runtime along."),
    ] = False,
    c_style: c_options.Style = None,
    events: c_options.Events = None,
    only: c_options.Only = None,
    sender: c_options.Senders = None,
    c_stubs: c_options.Stubs = False,
    depfile: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Also write what was read, in the form that make and ninja take."
        ),
    ] = None,
    quiet: Quiet = False,
) -> int:
    """Write a codec and a reference for each schema.

    Nothing is written if a schema has an error or one of its examples does not hold.
    Files that are current are not touched. Where only folders of schemas are given, files that were
    generated once and no longer are get removed; where single schemas are given, other files stay.
    """
    paths = schemas or [SCHEMAS]
    choice = c_options.Choice(c_style, events, only, sender, c_stubs)
    targets = _targets(target, choice, standalone=standalone)
    with _without_garbage_collection():
        return _run(paths, targets, output, _Mode(check, diff, quiet, depfile))


@dataclass(frozen=True, slots=True)
class _Mode:
    check: bool
    diff: bool
    quiet: bool
    depfile: Path | None


@contextmanager
def _without_garbage_collection() -> Iterator[None]:
    """The model only grows and holds no cycles: looking for garbage would find none."""
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


def _run(paths: Sequence[Path], targets: Sequence[Target], output: Path, mode: _Mode) -> int:
    compilations = _compile(schema_files(paths))
    protocols = [item.protocol for item in compilations if item.protocol is not None]
    if len(protocols) < len(compilations):
        return FINDINGS
    prune = all(path.is_dir() for path in paths)
    jobs = [Job(item.emit(protocols), output / item.folder, prune) for item in targets]
    if mode.depfile is not None:
        _write_depfile(mode.depfile, jobs, compilations)
    if mode.diff:
        return _print_diff(jobs)
    return _check(jobs, quiet=mode.quiet) if mode.check else _write(jobs, quiet=mode.quiet)


def _targets(
    names: Sequence[str] | None, choice: c_options.Choice, *, standalone: bool
) -> list[Target]:
    from protogen.problems import hint_for
    from protogen.targets import TARGETS, LazyTarget

    for name in names or ():
        if name not in TARGETS:
            message = f"there is no target `{name}`; there are {', '.join(TARGETS)}"
            raise UsageError(message, hint_for(name, TARGETS))
    targets = {name: TARGETS[name] for name in names or TARGETS}
    if standalone and _PYTHON not in targets:
        raise UsageError(f"--standalone is for the target {_PYTHON}")
    if standalone:
        folder = targets[_PYTHON].folder
        targets[_PYTHON] = LazyTarget(_PYTHON, folder, "protogen.targets.python.standalone")
    if not choice.is_default:
        if c_options.NAME not in targets:
            raise UsageError("--c-style, --events, --only, --sender and --c-stubs are for C")
        targets[c_options.NAME] = c_options.ChosenC(choice)
    return list(targets.values())


def _compile(files: Sequence[Path]) -> list[Compilation]:
    """Compile the schemas and print their problems.

    Pages show the examples as verified, so they are verified before anything is written.
    """
    from protogen.cli.progress import progress
    from protogen.compiler import compile_file

    compilations: list[Compilation] = []
    with progress("compiling", len(files)) as advance:
        for file in files:
            compilations.append(compile_file(file, examples=True))
            advance(1)
    print_problems(compilations)
    return compilations


def _write_depfile(path: Path, jobs: Sequence[Job], compilations: Sequence[Compilation]) -> None:
    """Write a rule of make: the generated files depend on the schemas and those they extend."""
    made = [str(job.folder / file.path) for job in jobs for file in job.files]
    read = dict.fromkeys(file for item in compilations for file in item.sources.files)
    path.parent.mkdir(parents=True, exist_ok=True)
    rule = f"{_joined(made)}: {_joined(read)}\n"
    path.write_text(rule, encoding="utf-8", newline="\n")


def _joined(paths: Iterable[str]) -> str:
    """Paths in a rule: `$` stands twice, and a backslash in front of a blank or `#`."""
    doubled = (path.replace("$", "$$") for path in paths)
    escaped = (path.replace(" ", "\\ ").replace("#", "\\#") for path in doubled)
    return " \\\n  ".join(escaped)


def _print_diff(jobs: Sequence[Job]) -> int:
    from protogen.targets.output import diff_files

    changes = [diff_files(job.files, job.folder, prune=job.prune) for job in jobs]
    typer.echo("".join(changes), nl=False)
    return FINDINGS if any(changes) else CLEAN


def _check(jobs: Sequence[Job], *, quiet: bool) -> int:
    from protogen.targets.output import check_files

    differences = [
        f"{job.folder / item.path}: {item.state}{f', {item.reason}' if item.reason else ''}"
        for job in jobs
        for item in check_files(job.files, job.folder, prune=job.prune)
    ]
    for line in differences:
        typer.echo(line)
    if not differences and not quiet:
        typer.echo(f"{sum(len(job.files) for job in jobs)} files are current")
    return FINDINGS if differences else CLEAN


def _write(jobs: Sequence[Job], *, quiet: bool) -> int:
    from protogen.targets.output import write_files

    refused = False
    for job in jobs:
        report = write_files(job.files, job.folder, prune=job.prune)
        for item in report.refused:
            typer.echo(f"{job.folder / item.path}: not written, {item.reason}", err=True)
        if not quiet:
            for line in _report(job.folder, report):
                typer.echo(line)
        refused = refused or bool(report.refused)
    return USAGE if refused else CLEAN


def _report(folder: Path, report: Report) -> Iterator[str]:
    yield from (f"wrote {folder / path}" for path in report.written)
    yield from (f"removed {folder / path}" for path in report.removed)
    if report.unchanged:
        yield f"unchanged in {folder}: {report.unchanged}"
