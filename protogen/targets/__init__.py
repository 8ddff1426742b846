"""The targets: each prints resolved protocols as files. None of them computes anything.

A target is imported when it is asked to print, so that a command which needs none starts fast.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING
from typing import Protocol as Interface

import msgspec

if TYPE_CHECKING:
    from protogen.model.protocol import Protocol
    from protogen.targets.output import File


class Target(Interface):
    """Prints protocols in one language."""

    @property
    def name(self) -> str:
        """Name on the command line."""

    @property
    def folder(self) -> str:
        """The folder for its files, inside the output folder."""

    def emit(self, protocols: Sequence[Protocol]) -> tuple[File, ...]:
        """Return the files for these protocols, in the order of their paths."""


class LazyTarget(msgspec.Struct, frozen=True):
    """A target whose module, which has a function `emit`, is imported at the first use."""

    name: str
    folder: str
    module: str

    def emit(self, protocols: Sequence[Protocol]) -> tuple[File, ...]:
        """Return the files for these protocols, in the order of their paths."""
        files: tuple[File, ...] = import_module(self.module).emit(protocols)
        return tuple(sorted(files, key=lambda file: file.path))


TARGETS: Mapping[str, Target] = MappingProxyType(
    {
        target.name: target
        for target in (
            LazyTarget("python", "python", "protogen.targets.python.emit"),
            LazyTarget("c", "c", "protogen.targets.c.emit"),
            LazyTarget("markdown", "markdown", "protogen.targets.markdown.emit"),
            LazyTarget("typescript", "typescript", "protogen.targets.typescript.emit"),
            LazyTarget("html", "html", "protogen.targets.html.emit"),
        )
    }
)
"""Every target by its name."""

DEFAULT_TARGETS = ("python", "c", "markdown")
"""Those that are printed where none is named: both ends of the wire, and the reference."""

STANDALONE: Target = LazyTarget("python", "python", "protogen.targets.python.standalone")
"""The Python target, with the runtime copied beside each module."""
