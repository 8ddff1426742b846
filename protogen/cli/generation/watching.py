"""`protogen generate --watch`: runs again when something that a run read has changed."""

from __future__ import annotations

import time
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec
import typer

from protogen.cli.exits import CLEAN, explain
from protogen.cli.generation.generating import Mode, Reads, generate_once, planned_now
from protogen.cli.generation.plan import Given
from protogen.errors import UserError

if TYPE_CHECKING:
    from protogen.project.watch import States


def generate_and_watch(given: Given, mode: Mode) -> int:
    """Generate now and after each change. Ctrl-C ends it; problems in files do not.

    A call that is wrong from the start ends it as well: no change of a file could fix that.
    """
    from protogen.project.watch import wait_for_change

    watch = _Watch(given, mode)
    try:
        watch.run()
        watch.say(f"watching {len(watch.before)} files, Ctrl-C ends it")
        while True:
            changed = wait_for_change(watch.before, watch.files)
            watch.say(f"changed: {', '.join(map(str, changed))}")
            watch.run_again()
    except KeyboardInterrupt:
        return CLEAN


class _Watch(msgspec.Struct):
    """Files that are watched, and how they were before the last run."""

    given: Given
    mode: Mode
    reads: Reads = msgspec.field(default_factory=Reads)
    before: States = msgspec.field(default_factory=dict)

    def say(self, text: str) -> None:
        """Print what happens."""
        if not self.mode.quiet:
            typer.echo(text)

    def files(self) -> set[Path]:
        """Return what may change the outcome, as it is now: schemas come and go."""
        plan = planned_now(self.given, self.mode) or self.reads.plan
        named: Iterable[Path] = () if plan is None else (*plan.schemas, *plan.pages)
        return {*self.reads.files, *self.reads.missing, *named}

    def run(self) -> None:
        """Generate. What changes meanwhile is a change for the next look."""
        from protogen.project.watch import states

        begin = time.time_ns()
        before = states(self.files())
        reads = Reads()
        try:
            generate_once(self.given, self.mode, reads)
        finally:
            self._remember(before, reads, begin)

    def run_again(self) -> None:
        """Generate after a change, whatever is wrong."""
        try:
            self.run()
        except BrokenPipeError:
            raise  # Nobody watches any more.
        except (UserError, OSError) as error:
            explain(error)

    def _remember(self, before: States, reads: Reads, begin: int) -> None:
        from protogen.project.watch import settled, states

        if reads.plan is None:  # Nothing was read but the settings: the rest is as it was.
            reads.files |= self.reads.files
            reads.missing |= self.reads.missing
            reads.plan = self.reads.plan
        self.reads = reads
        schemas = set() if reads.plan is None else set(reads.plan.schemas)
        # What was read for the first time is known as it is now, unless it changed meanwhile; and
        # so is what was written.
        first = settled(states(reads.files - before.keys() - reads.written), begin)
        fresh = {**first, **states(reads.written)}
        watched = self.files() | schemas
        self.before = {path: {**before, **fresh}.get(path) for path in watched}
