"""A schema file -> the resolved protocol, or every problem that stands in the way."""

from __future__ import annotations

import os

import msgspec

from protogen.model.protocol import Protocol
from protogen.passes.context import Context
from protogen.passes.resolve import resolve
from protogen.problems import Problem, Problems, Severity, SourceMap
from protogen.schema.load import load_syntax


class Compilation(msgspec.Struct, frozen=True):
    """Outcome for one schema file. There is a protocol exactly where there is no error."""

    path: str
    protocol: Protocol | None
    problems: tuple[Problem, ...]
    sources: SourceMap

    @property
    def errors(self) -> tuple[Problem, ...]:
        """The problems that are errors."""
        return tuple(item for item in self.problems if item.severity is Severity.ERROR)


def compile_file(
    path: str | os.PathLike[str], *, examples: bool = False, text: str | None = None
) -> Compilation:
    """Compile a schema; with `text`, as if that were what the file holds.

    With `examples`, each example is also decoded and encoded by the Python that would be
    generated; one that does not hold is an error like any other.
    """
    problems = Problems()
    sources = SourceMap()
    protocol = _protocol(path, text, problems, sources)
    if protocol is not None and examples:
        from protogen.examples import verify_examples  # construct is needed only here

        verify_examples(protocol, problems)
    protocol = None if problems.errors else protocol
    return Compilation(os.fspath(path), protocol, tuple(problems), sources)


def _protocol(
    path: str | os.PathLike[str], text: str | None, problems: Problems, sources: SourceMap
) -> Protocol | None:
    loaded = load_syntax(path, problems, sources, text=text)
    if loaded is None:
        return None
    merged = loaded.merged
    context = Context(
        syntax=loaded.shape.syntax,
        data=loaded.data,
        find=merged.find,
        find_key=lambda loc: merged.find(loc, key=True),
        problems=problems,
        files=merged.files,
        doubtful=loaded.shape.doubtful,
        lost=loaded.shape.lost,
        spoilt=loaded.spoilt,
    )
    protocol = resolve(context)
    return None if context.failed else protocol
