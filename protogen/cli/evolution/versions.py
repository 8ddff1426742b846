"""Opens the two versions of each schema that a command compares."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import typer

from protogen.cli.exits import FINDINGS, UsageError

if TYPE_CHECKING:
    from protogen.evolution.sources import Version
    from protogen.model.protocol import Protocol
    from protogen.project.read import Project

LAST_COMMIT = "git:HEAD"
"""Default version that a project's schemas are compared with."""


class Pair(NamedTuple):
    """A schema in two versions; None where there is none."""

    name: str
    old: Protocol | None
    new: Protocol | None


@contextmanager
def compared(
    versions: Sequence[str], against: str | None, project: Project | None
) -> Iterator[list[Pair]]:
    """The versions that a command line means: OLD and NEW, NEW `against` one, or the project's.

    Raises UsageError where it means none. With an error in a schema, prints its problems and ends
    the command.
    """
    with ExitStack() as stack:
        sides = list(_sides(versions, against, project, stack))
        _end_if_broken(sides)
        yield [pair for before, after in sides for pair in _paired(before, after)]


def _sides(
    versions: Sequence[str], against: str | None, project: Project | None, stack: ExitStack
) -> Iterator[tuple[Version, Version]]:
    from protogen.evolution.sources import opened, opened_project

    if not versions and project is not None:
        patterns = project.settings.schemas
        after = stack.enter_context(opened_project(project.folder, patterns))
        given = against or LAST_COMMIT
        yield stack.enter_context(opened_project(project.folder, patterns, given)), after
    elif against is not None and versions:
        for new in versions:
            yield _same(new, against, stack)
    elif len(versions) == 2:
        after = stack.enter_context(opened(versions[1]))
        yield stack.enter_context(opened(versions[0], Path(versions[1]))), after
    else:
        message = "give OLD and NEW, or NEW with --against"
        hint = "protogen breaking schemas --against git:main; in a project, give nothing"
        raise UsageError(message, hint)


def _same(new: str, against: str, stack: ExitStack) -> tuple[Version, Version]:
    """A file or a folder in two versions. It may be new in a revision, or gone since, not both."""
    from protogen.evolution.sources import names_no_path, opened

    follows = names_no_path(against)
    after = stack.enter_context(opened(new, may_lack=follows))
    is_there = follows and bool(after.compilations)
    before = stack.enter_context(opened(against, Path(new), may_lack=is_there))
    return before, after


def _end_if_broken(sides: Sequence[tuple[Version, Version]]) -> None:
    """Print the problems of schemas with errors, if there are any, and end the command."""
    from protogen.cli.schemas import print_problems

    compilations = (item for pair in sides for side in pair for item in side.compilations.values())
    broken = [item for item in compilations if item.protocol is None]
    if broken:
        print_problems(broken)
        raise typer.Exit(FINDINGS)


def _paired(before: Version, after: Version) -> Iterator[Pair]:
    """The schemas of both sides by their paths; one that was moved, by the protocol's name."""
    old = {name: item.protocol for name, item in before.compilations.items()}
    new = {name: item.protocol for name, item in after.compilations.items()}
    fresh = {item.name: name for name, item in new.items() if item and name not in old}
    for name, protocol in old.items():
        moved = fresh.pop(protocol.name, None) if protocol and name not in new else None
        there = name if moved is None else moved
        yield Pair(there or after.title, protocol, new.pop(there, None))
    for name, protocol in new.items():
        yield Pair(name or after.title, None, protocol)
