"""Prints one module for each protocol."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePosixPath

from protogen.model.protocol import Protocol
from protogen.targets.banner import PYTHON, banner
from protogen.targets.output import File
from protogen.targets.printing import environment
from protogen.targets.python.fast.view import fast_view
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


_PRINTED: dict[int, tuple[Protocol, str]] = {}
"""What was printed last, by the protocol's address; a protocol that is kept keeps its own."""
_KEPT = 64


def kept_source(protocol: Protocol) -> str:
    """The text of a protocol's module, which is printed once for whoever asks again.

    To verify a schema's examples takes the module that is then written.
    """
    found = _PRINTED.get(id(protocol))
    if found is not None and found[0] is protocol:
        return found[1]
    text = source(protocol)
    while len(_PRINTED) >= _KEPT:
        del _PRINTED[next(iter(_PRINTED))]
    _PRINTED[id(protocol)] = (protocol, text)
    return text


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
