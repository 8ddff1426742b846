"""Functions for other programs: load a schema, generate files, get a codec."""

from __future__ import annotations

import copyreg
import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

from protogen.compiler import compile_file
from protogen.model.protocol import Protocol
from protogen.problems import Problem, SourceMap, render_text
from protogen.schema.files import schema_files, schema_path
from protogen.targets import DEFAULT_TARGETS, TARGETS
from protogen.targets.output import Report, write_files


class SchemaError(ValueError):
    """A schema has errors. `problems` holds all that were found; the text shows them."""

    def __init__(self, problems: Sequence[Problem], sources: SourceMap) -> None:
        super().__init__("\n".join(render_text(problem, sources) for problem in problems))
        self.problems = tuple(problems)

    def __reduce__(self) -> Any:
        """As it is: Python would make it anew of its text alone."""
        return copyreg.__newobj__, (type(self), *self.args), vars(self)  # type: ignore[attr-defined]


def load(schema: str | os.PathLike[str], *, examples: bool = False) -> Protocol:
    """The resolved protocol of a schema file, or of `library:NAME`.

    With `examples`, its examples are verified as well. Raises SchemaError.
    """
    compilation = compile_file(schema_path(schema), examples=examples)
    if compilation.protocol is None:
        raise SchemaError(compilation.problems, compilation.sources)
    return compilation.protocol


def generate(
    schemas: Iterable[str | os.PathLike[str]],
    output: str | os.PathLike[str] = "generated",
    targets: Iterable[str] | None = None,
) -> dict[str, Report]:
    """Write the files of each target for these schema files, and for those in these folders.

    Without `targets`, these are Python, C and Markdown.
    Returns what was done, by target. Other files in the output stay. Raises SchemaError or
    NoSchemaError before anything is written, and KeyError for a target that there is not.
    """
    protocols = [load(file) for file in schema_files(map(schema_path, schemas))]
    chosen = [TARGETS[name] for name in (DEFAULT_TARGETS if targets is None else targets)]
    return {
        target.name: write_files(target.emit(protocols), Path(output) / target.folder, prune=False)
        for target in chosen
    }


def module_of(protocol: Protocol) -> ModuleType:
    """The Python codec of a protocol, imported from memory."""
    from protogen.live import codec

    return codec.module_of(protocol)
