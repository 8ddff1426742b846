"""Opens the two versions of each schema that a command compares."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import typer

from protogen.cli.exits import FINDINGS, UsageError, complain
from protogen.copying import replace

if TYPE_CHECKING:
    from protogen.compiler import Compilation
    from protogen.evolution.sources import Version
    from protogen.model.protocol import Protocol
    from protogen.project.read import Project

LAST_COMMIT = "git:HEAD"
"""Default version that a project's schemas are compared with."""
_MOST_NAMES = 3
"""Schemas of OLD that are named where nothing could be compared."""


class Pair(NamedTuple):
    """A schema in two versions; None where there is none."""

    name: str
    old: Protocol | None
    new: Protocol | None


class Pairs(NamedTuple):
    """The schemas of a command line, and those of OLD that have no pair because none was meant."""

    pairs: list[Pair]
    elsewhere: list[str]
    """Paths of schemas that OLD's revision holds outside of what was given."""
    is_first: bool
    """True if OLD is a revision without any schema."""

    @property
    def summary(self) -> str:
        """How many schemas are compared, new and gone."""
        compared = sum(pair.old is not None and pair.new is not None for pair in self.pairs)
        new = sum(pair.old is None for pair in self.pairs)
        gone = sum(pair.new is None for pair in self.pairs)
        schemas = "1 schema" if compared == 1 else f"{compared} schemas"
        return f"compared {schemas}, {new} new, {gone} gone"

    def check_not_empty(self, since: str) -> None:
        """Raise UsageError if OLD has none of the schemas, though it is not the first version."""
        if any(pair.old is not None or self.is_first for pair in self.pairs):
            return
        names = ", ".join(self.elsewhere[:_MOST_NAMES])
        hint = f"it holds {names}: name the one meant as git:REV:PATH" if names else None
        message = f"nothing was compared: {since} holds none of these schemas"
        raise UsageError(message, hint or "name a version that holds them")


@contextmanager
def compared(
    versions: Sequence[str], against: str | None, project: Project | None
) -> Iterator[Pairs]:
    """The versions that a command line means: OLD and NEW, NEW `against` one, or the project's.

    Raises UsageError where it means none. With an error in a schema, prints its problems and ends
    the command.
    """
    with ExitStack() as stack:
        opened = _sides(versions, against, project, stack)
        sides = [(_with_moved(before, after), after) for before, after in opened]
        pairs = [pair for before, after in sides for pair in _paired(before, after)]
        _end_if_broken(sides)
        olds = [before for before, _ in sides]
        elsewhere = [path for old in olds for path in old.elsewhere()]
        held = any(old.compilations for old in olds)
        is_first = not (held or elsewhere) and all(old.revision is not None for old in olds)
        yield Pairs(pairs, elsewhere, is_first)


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

    before, after = ([pair[side] for pair in sides] for side in (0, 1))
    broken = [_broken(versions) for versions in (before, after)]
    print_problems([*broken[0], *broken[1]])
    if broken[0]:
        titles = ", ".join(dict.fromkeys(version.title for version in before))
        message = f"OLD ({titles}) has errors, so nothing can be compared with it"
        hint = "hold NEW against a version that compiles, or against a lock: --against-lock FILE"
        complain(message, hint)
    if any(broken):
        raise typer.Exit(FINDINGS)


def _broken(versions: Sequence[Version]) -> list[Compilation]:
    compilations = (item for version in versions for item in version.compilations.values())
    return [item for item in compilations if item.protocol is None]


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


def _with_moved(before: Version, after: Version) -> Version:
    """OLD with the schemas of its revision that were moved to where NEW has one that it lacks.

    They have the protocol's name, and their old place is empty now. Where OLD has nothing else,
    those beside them that are not in NEW are gone.
    """
    if before.revision is None:
        return before
    now = before.revision.top if after.revision is None else after.revision.folder
    gone = [(path, name) for path, name in before.elsewhere().items() if not (now / path).exists()]
    names = {item.protocol.name for item in before.compilations.values() if item.protocol}
    found = dict(before.compilations)
    folders = set()
    for place, item in after.compilations.items():
        if place in before.compilations or item.protocol is None or item.protocol.name in names:
            continue
        paths = [path for path, name in gone if name == item.protocol.name]
        if len(paths) == 1:
            found[place] = before.compiled(paths[0])
            if place and not before.compilations:
                folders.add(Path(paths[0]).parent)
        elif after.revision is None:
            before.revision.check_no_submodule(Path(item.path))
    kept = {item.protocol.name for item in after.compilations.values() if item.protocol}
    for path, name in gone:
        if Path(path).parent in folders and name not in kept:
            found[path] = before.compiled(path)
    return replace(before, compilations=found)
