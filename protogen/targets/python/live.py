"""The Python target's own output, imported from memory: the only codec that the compiler uses."""

from __future__ import annotations

import itertools
import linecache
import sys
from types import ModuleType

from protogen.model.protocol import Protocol
from protogen.targets.python.emit import kept_source

_NUMBERS = itertools.count()
_IMPORTED: dict[int, tuple[Protocol, ModuleType]] = {}
"""What was imported last, by the protocol's address; a protocol that is kept keeps its own."""
_KEPT = 8


def kept_module(protocol: Protocol) -> ModuleType:
    """The module of a protocol, which is imported once for whoever asks again soon."""
    found = _IMPORTED.get(id(protocol))
    if found is not None and found[0] is protocol:
        return found[1]
    module = module_of(protocol)
    while len(_IMPORTED) >= _KEPT:
        del _IMPORTED[next(iter(_IMPORTED))]
    _IMPORTED[id(protocol)] = (protocol, module)
    return module


def module_of(protocol: Protocol) -> ModuleType:
    """Import the module that would be generated for `protocol`."""
    text = kept_source(protocol)
    name = f"protogen_live_{next(_NUMBERS)}_{protocol.name}"
    filename = f"<generated {protocol.name}>"
    module = ModuleType(name)
    linecache.cache[filename] = (len(text), None, text.splitlines(keepends=True), filename)
    # dataclasses look their module up by name.
    sys.modules[name] = module
    try:
        exec(compile(text, filename, "exec"), module.__dict__)  # noqa: S102 - our own output
    except BaseException:
        del sys.modules[name]
        raise
    return module
