"""Finds and compiles the schemas that a command was given."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from protogen.cli.exits import FINDINGS, USAGE, UsageError
from protogen.schema.files import schema_files, schema_path

if TYPE_CHECKING:
    from protogen.compiler import Compilation
    from protogen.model.messages import Message
    from protogen.model.protocol import Protocol, Sender
    from protogen.problems import Problem, Problems, SourceMap
    from protogen.project.read import Project


def open_protocol(path: Path) -> Protocol:
    """Return the protocol of a schema.

    With an error in the schema, prints its problems and ends the command.
    """
    return protocol_of(compile_schema(path))


def compile_schema(path: Path) -> Compilation:
    """Compile a schema, or one of the library. Raises UsageError if it is not there."""
    from protogen.compiler import compile_file

    path = schema_path(path)
    if not path.is_file():
        raise UsageError(f"there is no schema `{path}`")
    return compile_file(path)


def protocol_of(compilation: Compilation) -> Protocol:
    """Return what a schema was compiled to. With an error in it, prints and ends the command."""
    if compilation.protocol is None:
        print_problems([compilation])
        raise typer.Exit(FINDINGS)
    return compilation.protocol


def compile_files(files: Collection[Path], title: str) -> list[Compilation]:
    """Compile schemas and verify their examples, with a progress bar."""
    from protogen.cli.progress import progress
    from protogen.compiler import compile_file

    compilations: list[Compilation] = []
    with progress(title, len(files)) as advance:
        for file in files:
            compilations.append(compile_file(file, examples=True))
            advance(1)
    return compilations


def open_project() -> Project | None:
    """Return the project around the working directory, if there is one.

    With a mistake in its file, prints the problems and ends the command.
    """
    from protogen.problems import Problems, SourceMap
    from protogen.project.find import find_project
    from protogen.project.read import read_project

    file = find_project()
    if file is None:
        return None
    problems, sources = Problems(), SourceMap()
    project = read_project(file, problems, sources)
    _end_if_wrong(problems, sources)
    return project


def chosen_schemas(paths: Sequence[Path] | None) -> tuple[Path, ...]:
    """Return the schemas at paths; without any, those of the project around."""
    return schema_files(map(schema_path, paths)) if paths else own_schemas()


def own_schemas() -> tuple[Path, ...]:
    """Return the schemas of the project around the working directory.

    Raises UsageError where there is no project. With a setting that leads nowhere, prints the
    problem and ends the command.
    """
    from protogen.problems import Problems, SourceMap
    from protogen.project.schemas import named_paths

    project = open_project()
    if project is None:
        message = "no schema is named, and there is no protogen.toml that names some"
        raise UsageError(message, "name one, or a folder of them")
    problems, sources = Problems(), SourceMap()
    sources.add(str(project.file), project.text)
    found = schema_files(named_paths(project, "schemas", project.settings.schemas, problems))
    _end_if_wrong(problems, sources)
    return found


def _end_if_wrong(problems: Problems, sources: SourceMap) -> None:
    if problems.errors:
        print_found(problems, sources)
        raise typer.Exit(USAGE)


def print_found(problems: Iterable[Problem], sources: SourceMap) -> None:
    """Print problems to standard error, with their source lines."""
    found = tuple(problems)
    if not found:
        return
    from protogen.cli.console import console
    from protogen.problems import render_rich

    out = console(stderr=True)
    for problem in found:
        out.print(render_rich(problem, sources))


def print_problems(compilations: Iterable[Compilation]) -> None:
    """Print every problem of schemas to standard error, once."""
    for compilation, problems in each_once(compilations):
        print_found(problems, compilation.sources)


def each_once(
    compilations: Iterable[Compilation],
) -> Iterator[tuple[Compilation, tuple[Problem, ...]]]:
    """Yield each with its own problems: those of a base are found again by each dialect."""
    seen: set[Problem] = set()
    for compilation in compilations:
        found = tuple(item for item in dict.fromkeys(compilation.problems) if item not in seen)
        seen.update(found)
        yield compilation, found


def find_sender(protocol: Protocol, name: str) -> Sender:
    """Return the sender called ``name``. Raises UsageError that lists those that there are."""
    from protogen.problems import hint_for

    names = [sender.name for sender in protocol.senders]
    if name in names:
        return protocol.sender(name)
    message = f"`{protocol.name}` has no sender `{name}`; it has {', '.join(names)}"
    raise UsageError(message, hint_for(name, names))


def find_senders(protocol: Protocol, name: str) -> tuple[Sender, ...]:
    """Return the endpoint called ``name`` as a sender, in each form of its frames.

    A name such as `vesc_long` stands for one form alone. Raises UsageError otherwise.
    """
    from protogen.problems import hint_for

    found = tuple(item for item in protocol.senders if name in (item.endpoint, item.name))
    if found:
        return found
    names = tuple(dict.fromkeys((*protocol.sending, *(item.name for item in protocol.senders))))
    message = f"`{protocol.name}` has no sender `{name}`; it has {', '.join(names)}"
    raise UsageError(message, hint_for(name, names))


def find_message(protocol: Protocol, name: str) -> Message:
    """Return the message called ``name``. Raises UsageError with what was probably meant."""
    names = [message.name for message in protocol.messages]
    check_known("message", [name], names, protocol.name)
    return protocol.message(name)


def check_known(kind: str, given: Iterable[str] | None, names: list[str], protocol: str) -> None:
    """Raise UsageError with what was probably meant where a protocol has no such name."""
    from protogen.problems import hint_for

    for name in given or ():
        if name not in names:
            hint = hint_for(name, names) or f"it has {', '.join(names)}"
            raise UsageError(f"`{protocol}` has no {kind} `{name}`", hint)
