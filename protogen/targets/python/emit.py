"""Prints one module for each protocol."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePosixPath

from protogen.model.protocol import Protocol
from protogen.targets.banner import PYTHON, banner
from protogen.targets.output import File
from protogen.targets.printing import environment
from protogen.targets.python.fast.view import fast_view
from protogen.targets.python.kept import Kept
from protogen.targets.python.module import Module, view
from protogen.targets.python.wrapping import docstring

RUNTIME = "protogen.runtime"


def emit(protocols: Sequence[Protocol]) -> tuple[File, ...]:
    """The modules of these protocols, and the package that holds them."""
    modules = [_file(protocol) for protocol in protocols]
    if not protocols:
        return ()
    package = File(
        PurePosixPath("__init__.py"),
        '# SPDX-License-Identifier: 0BSD\n"""Codecs of serial protocols, one module each."""\n',
        banner(PYTHON, protocols),
        shared=True,
    )
    return (package, *modules)


def _file(protocol: Protocol) -> File:
    path = PurePosixPath(f"{protocol.name}.py")
    return File(path, kept_source(protocol), banner(PYTHON, [protocol]))


def source(protocol: Protocol, runtime: str = RUNTIME) -> str:
    """The text of a protocol's module; `runtime` is where it imports the runtime from."""
    module = view(protocol)
    return (
        environment("protogen.targets.python")
        .get_template("module.py.j2")
        .render(
            module=module,
            fast=fast_view(protocol, module.arguments),
            runtime=runtime,
            encode_doc=docstring(_encode_doc(module), 4),
            encoder_doc=docstring(_encoder_doc(module), 8),
        )
    )


kept_source = Kept(source, most=64)
"""The text of a protocol's module, printed once: examples are verified by what is then written."""


def _encode_doc(module: Module) -> list[str]:
    errors = (
        "Raises EncodeError where a value is missing or out of range; with `strict=False` only "
        "where it does not fit the wire."
    )
    return ["The frame of a message.", " ".join(filter(None, [module.arguments_doc, errors]))]


def _encoder_doc(module: Module) -> list[str]:
    if not module.counts:
        return ["The next frame."]
    return ["The next frame. A given counter is used once and does not change the count."]
