"""Modules that carry their runtime along, so that only construct has to be installed.

Each protocol becomes a package: its module, and beside it a copy of the runtime.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from importlib.abc import Traversable
from importlib.resources import files
from pathlib import PurePosixPath

from protogen.model.protocol import Protocol
from protogen.targets.banner import PYTHON, banner
from protogen.targets.output import File
from protogen.targets.python.emit import RUNTIME, source
from protogen.targets.python.names import names_of

_COPY = "_runtime"
_NOQA = re.compile(r"  # noqa\b(?!: S102).*$", re.MULTILINE)
"""They name rules of this project; elsewhere a linter reports them as unused. S102, which is about
`exec`, is a rule everywhere."""
_IMPORT = re.compile(rf"^(\s*from ){re.escape(RUNTIME)}(\.| )", re.MULTILINE)


def emit(protocols: Sequence[Protocol]) -> tuple[File, ...]:
    """A package for each protocol."""
    return tuple(file for protocol in protocols for file in _package(protocol))


def _package(protocol: Protocol) -> tuple[File, ...]:
    first_line = banner(PYTHON, [protocol])
    folder = PurePosixPath(names_of(protocol).file)
    text = source(protocol, runtime=f".{_COPY}", is_package=True)
    copies = [
        File(folder / _COPY / name, "# SPDX-License-Identifier: 0BSD\n" + copied, first_line)
        for name, copied in _runtime()
    ]
    return (
        File(folder / "__init__.py", text.module, first_line),
        File(folder / "_codec.py", text.codec, first_line),
        *copies,
    )


def _runtime() -> list[tuple[PurePosixPath, str]]:
    """The modules of the runtime, importing each other as neighbours."""
    return [
        (path, _relative(_NOQA.sub("", text), path))
        for path, text in _modules(files(RUNTIME), PurePosixPath())
    ]


def _modules(folder: Traversable, path: PurePosixPath) -> Iterator[tuple[PurePosixPath, str]]:
    """The texts of the modules in a folder and in those inside of it."""
    for item in sorted(folder.iterdir(), key=lambda item: item.name):
        if item.is_dir():
            yield from _modules(item, path / item.name)
        elif item.name.endswith(".py"):
            yield path / item.name, item.read_text("utf-8")


def _relative(text: str, module: PurePosixPath) -> str:
    """`from protogen.runtime.framing.frame import ...` -> `from .frame import ...`."""
    dots = "." * len(module.parts)
    return _IMPORT.sub(lambda found: f"{found[1]}{dots}" + (" " if found[2] == " " else ""), text)
