"""Prints one module for each protocol."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import PurePosixPath

import msgspec

from protogen.model.protocol import Protocol
from protogen.targets.banner import PYTHON, banner
from protogen.targets.kept import Kept
from protogen.targets.output import File
from protogen.targets.printing import environment
from protogen.targets.python.engine.view import engine_view
from protogen.targets.python.module import Module, view
from protogen.targets.python.names import names_of
from protogen.targets.python.wrapping import docstring

RUNTIME = "protogen.runtime"


def emit(protocols: Sequence[Protocol]) -> tuple[File, ...]:
    """The modules of these protocols, and the package that holds them."""
    if not protocols:
        return ()
    package = File(
        PurePosixPath("__init__.py"),
        '# SPDX-License-Identifier: 0BSD\n"""Codecs of serial protocols, one module each."""\n',
        banner(PYTHON, protocols),
        shared=True,
    )
    return (package, *(file for protocol in protocols for file in _files(protocol)))


def _files(protocol: Protocol) -> Iterator[File]:
    text, first_line = kept_source(protocol), banner(PYTHON, [protocol])
    yield File(PurePosixPath(f"{names_of(protocol).file}.py"), text.module, first_line)
    yield File(PurePosixPath(f"{codec_name(protocol)}.py"), text.codec, first_line)


class Source(msgspec.Struct, frozen=True):
    """The text of a protocol's two modules."""

    module: str
    """The module for people: messages, and the functions and classes that they call."""
    codec: str
    """The machine text, which it imports."""


def codec_name(protocol: Protocol) -> str:
    """Name of the module of machine text."""
    return f"_{protocol.name}_codec"


def source(protocol: Protocol, runtime: str = RUNTIME, *, is_package: bool = False) -> Source:
    """The text of a protocol's modules; `runtime` is where they import the runtime from.

    With `is_package`, the module that people read is a package, which holds the other.
    """
    module = view(protocol)
    given = {
        "module": module,
        "fast": engine_view(protocol, module.kinds),
        "runtime": runtime,
        "codec": codec_name(protocol),
        "is_package": is_package,
        "encode_doc": docstring(_encode_doc(module), 4),
        "encoder_doc": docstring(_encoder_doc(module), 8),
    }
    templates = environment("protogen.targets.python")
    return Source(
        module=templates.get_template("module.py.j2").render(given),
        codec=templates.get_template("codec.py.j2").render(given),
    )


kept_source = Kept(source, most=64)
"""The text of a protocol's modules, printed once: examples are verified by what is then written."""


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
