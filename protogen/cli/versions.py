"""Opens the two versions of a schema that a command compares."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from protogen.cli.exits import FINDINGS, UsageError

if TYPE_CHECKING:
    from protogen.evolution.sources import Version
    from protogen.model.protocol import Protocol


@contextmanager
def both(old: str, new: str) -> Iterator[list[tuple[str, Protocol | None, Protocol | None]]]:
    """The protocols of each schema: a name, the old one and the new one, None where there is none.

    With an error in a schema, prints its problems and ends the command.
    """
    from protogen.cli.schemas import print_problems
    from protogen.evolution.sources import NoVersionError, opened

    try:
        with ExitStack() as stack:
            after = stack.enter_context(opened(new))
            before = stack.enter_context(opened(old, Path(new)))
            broken = [
                compilation
                for version in (before, after)
                for compilation in version.compilations.values()
                if compilation.protocol is None
            ]
            if broken:
                print_problems(broken)
                raise typer.Exit(FINDINGS)
            yield list(_paired(before, after))
    except NoVersionError as error:
        raise UsageError(str(error)) from None


def _paired(
    before: Version, after: Version
) -> Iterator[tuple[str, Protocol | None, Protocol | None]]:
    names = dict.fromkeys([*before.compilations, *after.compilations])
    for name in names:
        old, new = before.compilations.get(name), after.compilations.get(name)
        yield (
            name or after.title,
            None if old is None else old.protocol,
            None if new is None else new.protocol,
        )
