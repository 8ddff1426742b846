"""The Python target's own output, imported from memory: the only codec that the compiler uses."""

from __future__ import annotations

import itertools
import linecache
import sys
from types import ModuleType

from protogen.model.protocol import Protocol
from protogen.targets.python.emit import kept_source
from protogen.targets.python.kept import Kept

_NUMBERS = itertools.count()


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


kept_module = Kept(module_of, most=8)
"""The module of a protocol, imported once for whoever asks again soon."""
