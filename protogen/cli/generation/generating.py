"""One run of `protogen generate`, from finding the project's file to writing."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from protogen.cli.collecting import without_garbage_collection
from protogen.cli.exits import CLEAN, FINDINGS, USAGE
from protogen.cli.generation.jobs import Job, check, print_diff, say_current, write, write_depfile
from protogen.cli.generation.plan import Given, Plan, plan
from protogen.cli.schemas import compile_files, print_found, print_problems
from protogen.errors import UserError
from protogen.targets.side_by_side import emit_all

if TYPE_CHECKING:
    from protogen.compiler import Compilation
    from protogen.problems import Problems, SourceMap
    from protogen.project.blocks import Page
    from protogen.project.read import Project
    from protogen.project.record import Keeper


class Mode(msgspec.Struct, frozen=True):
    """Use of the files that a run makes."""

    check: bool = False
    diff: bool = False
    quiet: bool = False
    depfile: Path | None = None
    use_project: bool = True

    @property
    def writes(self) -> bool:
        """True if files are written."""
        return not self.check and not self.diff


class Reads(msgspec.Struct):
    """Files that a run depends on, as far as it came: for `--watch`."""

    files: set[Path] = msgspec.field(default_factory=set)
    """Files that were read or looked for, other than those of the plan."""
    plan: Plan | None = None
    missing: set[Path] = msgspec.field(default_factory=set)
    """Files that schemas extend and that were not there."""
    written: set[Path] = msgspec.field(default_factory=set)
    """Files that are read and written, which are known as they are now."""


def generate_once(given: Given, mode: Mode, reads: Reads) -> int:
    """Carry out what the command line and the project's file ask for; return the exit code."""
    from protogen.problems import Problems, SourceMap

    problems, sources = Problems(), SourceMap()
    project = _project(problems, sources, reads) if mode.use_project else None
    planned = None if problems.errors else plan(given, project, problems)
    print_found(problems, sources)
    if planned is None or problems.errors:
        return USAGE
    reads.plan = planned
    keeper = _keeper(planned, project, mode)
    record = keeper.current() if keeper is not None else None
    if keeper is not None and record is not None:
        reads.files |= {keeper.root / path for path in record.inputs}
        if not mode.quiet and not mode.diff:
            say_current(record, keeper.root, checking=mode.check)
        return CLEAN
    with without_garbage_collection():
        return _compile_and_act(planned, mode, keeper, reads)


def planned_now(given: Given, mode: Mode) -> Plan | None:
    """Return what a run would do now; None where it would only report problems."""
    from protogen.problems import Problems, SourceMap

    problems = Problems()
    try:
        project = _project(problems, SourceMap(), Reads()) if mode.use_project else None
        planned = plan(given, project, problems)
    except (UserError, OSError):
        return None
    return None if problems.errors else planned


def _project(problems: Problems, sources: SourceMap, reads: Reads) -> Project | None:
    from protogen.project.find import find_project

    file = find_project()
    if file is None:
        return None
    from protogen.project.read import read_project

    reads.files.add(file)
    return read_project(file, problems, sources)


def _keeper(planned: Plan, project: Project | None, mode: Mode) -> Keeper | None:
    """Return what remembers the run; without a project there is no place to do so."""
    if project is None or mode.depfile is not None:
        return None
    from protogen.project.record import Keeper

    return Keeper(project.folder, planned.options, planned.schemas, planned.pages)


def _compile_and_act(planned: Plan, mode: Mode, keeper: Keeper | None, reads: Reads) -> int:
    # Pages show the examples as verified, so they are verified before anything is written.
    compilations = compile_files(planned.schemas, "compiling")
    print_problems(compilations)
    reads.files |= {Path(file) for item in compilations for file in item.sources.files}
    protocols = [item.protocol for item in compilations if item.protocol is not None]
    if len(protocols) < len(compilations):
        reads.missing |= _bases(compilations) - reads.files
        return FINDINGS
    pages = _fill(planned, compilations)
    if pages is None:
        return FINDINGS
    emitters = planned.emitters()
    jobs = [
        Job(files, planned.output / item.folder, planned.prune)
        for item, files in zip(emitters, emit_all(emitters, protocols), strict=True)
    ]
    if mode.depfile is not None:
        write_depfile(mode.depfile, jobs, compilations)
    code = _act(jobs, pages, mode)
    reads.written |= {page.path for page in pages if mode.writes and not page.is_current}
    is_silent = not any(item.problems for item in compilations)
    if keeper is not None and mode.writes and code == CLEAN and is_silent:
        made = [(job.files, job.folder, job.prune) for job in jobs]
        filled = {page.path: page.new.decode("utf-8").removeprefix("\ufeff") for page in pages}
        keeper.keep([item.sources for item in compilations], made, filled)
    return code


def _bases(compilations: Sequence[Compilation]) -> set[Path]:
    """Return the files that schemas with errors extend, whether they are there or not."""
    from protogen.problems import Problems
    from protogen.schema.text.document import parse_document
    from protogen.schema.text.nodes import ScalarNode

    found: set[Path] = set()
    for item in compilations:
        for file in item.sources.files if item.protocol is None else ():
            document = parse_document(item.sources.text(file) or "", file, Problems())
            base = document.root.child("extends") if document is not None else None
            if isinstance(base, ScalarNode) and isinstance(base.value, str):
                found.add(Path(os.path.normpath(Path(file).parent / base.value)))
    return found


def _fill(planned: Plan, compilations: Sequence[Compilation]) -> list[Page] | None:
    """Return the pages with their blocks filled; None where something is wrong with a block."""
    if not planned.pages:
        return []
    from protogen.problems import Problems, SourceMap
    from protogen.project.contents import fill_pages

    problems, sources = Problems(), SourceMap()
    protocols = [item.protocol for item in compilations if item.protocol is not None]
    pages = fill_pages(planned.pages, protocols, planned.references, problems, sources)
    print_found(problems, sources)
    return None if problems.errors else pages


def _act(jobs: Sequence[Job], pages: Sequence[Page], mode: Mode) -> int:
    if mode.diff:
        return print_diff(jobs, pages)
    if mode.check:
        return check(jobs, pages, quiet=mode.quiet)
    return write(jobs, pages, quiet=mode.quiet)
