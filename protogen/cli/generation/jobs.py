"""Files that are to stand somewhere: writing them, checking them, or printing what is different."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec
import typer

from protogen.cli.exits import CLEAN, FINDINGS, USAGE

if TYPE_CHECKING:
    from protogen.compiler import Compilation
    from protogen.project.blocks import Page
    from protogen.project.record import Record
    from protogen.targets.output import File, Report


class Job(msgspec.Struct, frozen=True):
    """The files of one target, and the folder that they go to."""

    files: tuple[File, ...]
    folder: Path
    prune: bool


def print_diff(jobs: Sequence[Job], pages: Sequence[Page]) -> int:
    """Print what writing would change, as a unified diff."""
    from protogen.targets.output import diff_files, diff_text

    changes = [diff_files(job.files, job.folder, prune=job.prune) for job in jobs]
    changes += [
        diff_text(page.path, page.old.decode("utf-8"), page.new.decode("utf-8")) for page in pages
    ]
    typer.echo("".join(changes), nl=False)
    return FINDINGS if any(changes) else CLEAN


def check(jobs: Sequence[Job], pages: Sequence[Page], *, quiet: bool) -> int:
    """Print which files are not as they should be."""
    from protogen.targets.output import check_files

    differences = [
        f"{job.folder / item.path}: {item.state}{f', {item.reason}' if item.reason else ''}"
        for job in jobs
        for item in check_files(job.files, job.folder, prune=job.prune)
    ]
    differences += [f"{page.path}: stale" for page in pages if not page.is_current]
    for line in differences:
        typer.echo(line)
    if not differences and not quiet:
        _print_current(sum(len(job.files) for job in jobs) + len(pages))
    return FINDINGS if differences else CLEAN


def write(jobs: Sequence[Job], pages: Sequence[Page], *, quiet: bool) -> int:
    """Write what is not as it should be, and say what was done."""
    from protogen.project.blocks import write_page
    from protogen.targets.output import write_files

    refused = False
    for job in jobs:
        report = write_files(job.files, job.folder, prune=job.prune)
        for item in report.refused:
            typer.echo(f"{job.folder / item.path}: not written, {item.reason}", err=True)
        _say(_report(job.folder, report), quiet=quiet)
        refused = refused or bool(report.refused)
    for page in pages:
        if not page.is_current:
            write_page(page)
            _say([f"wrote {page.path}"], quiet=quiet)
    return USAGE if refused else CLEAN


def write_depfile(path: Path, jobs: Sequence[Job], compilations: Sequence[Compilation]) -> None:
    """Write a rule of make: the generated files depend on the schemas and those they extend."""
    made = [str(job.folder / file.path) for job in jobs for file in job.files]
    read = dict.fromkeys(file for item in compilations for file in item.sources.files)
    path.parent.mkdir(parents=True, exist_ok=True)
    rule = f"{_joined(made)}: {_joined(read)}\n"
    path.write_text(rule, encoding="utf-8", newline="\n")


def say_current(record: Record, root: Path, *, checking: bool) -> None:
    """Print what `check` or `write` would, where there is nothing to do."""
    if checking:
        _print_current(sum(made.files for made in record.made) + record.pages)
        return
    for made in record.made:
        typer.echo(_unchanged(root / made.folder, made.written))


def _say(lines: Sequence[str] | Iterator[str], *, quiet: bool) -> None:
    if not quiet:
        for line in lines:
            typer.echo(line)


def _print_current(files: int) -> None:
    typer.echo(f"{files} files are current")


def _report(folder: Path, report: Report) -> Iterator[str]:
    yield from (f"wrote {folder / path}" for path in report.written)
    yield from (f"removed {folder / path}" for path in report.removed)
    if report.unchanged:
        yield _unchanged(folder, report.unchanged)


def _unchanged(folder: Path, files: int) -> str:
    return f"unchanged in {folder}: {files}"


def _joined(paths: Iterable[str]) -> str:
    """Paths in a rule: `$` stands twice, and a backslash in front of a blank or `#`."""
    doubled = (path.replace("$", "$$") for path in paths)
    escaped = (path.replace(" ", "\\ ").replace("#", "\\#") for path in doubled)
    return " \\\n  ".join(escaped)
