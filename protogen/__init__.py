"""protogen: a compiler for serial protocols.

One YAML file describes a protocol; from it come the codecs for both ends of the wire and the
documents that people read.

    import protogen

    protocol = protogen.load("schemas/rn1.yaml")           # the resolved model
    protogen.generate(["schemas"], "generated")            # all targets
    module = protogen.module_of(protocol)                  # its Python codec, from memory
    small = protogen.select(protocol, messages=["gyro"])   # what a small receiver takes of it
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from protogen.version import VERSION

if TYPE_CHECKING:
    from protogen.api import SchemaError, generate, load, module_of
    from protogen.compiler import Compilation, compile_file
    from protogen.passes.selection import select
    from protogen.problems import Problem
    from protogen.schema.files import NoSchemaError

__version__ = VERSION

__all__ = [
    "Compilation",
    "NoSchemaError",
    "Problem",
    "SchemaError",
    "__version__",
    "compile_file",
    "generate",
    "load",
    "module_of",
    "select",
]

_HOMES = {
    "Compilation": "protogen.compiler",
    "NoSchemaError": "protogen.schema.files",
    "Problem": "protogen.problems",
    "SchemaError": "protogen.api",
    "compile_file": "protogen.compiler",
    "generate": "protogen.api",
    "load": "protogen.api",
    "module_of": "protogen.api",
    "select": "protogen.passes.selection",
}


def __getattr__(name: str) -> Any:
    """Import a public name when it is first asked for: generated code needs none of them."""
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(home), name)
