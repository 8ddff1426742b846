"""The Python target's own output, imported from memory: the only codec that the compiler uses."""

from __future__ import annotations

from types import ModuleType

from protogen.live.modules import Modules, compiled, import_modules
from protogen.model.protocol import Protocol
from protogen.targets.kept import Kept
from protogen.targets.python.emit import codec_name, kept_source
from protogen.targets.python.names import names_of


def modules_of(protocol: Protocol) -> Modules:
    """Compile the modules that would be generated for `protocol`."""
    text = kept_source(protocol)
    return compiled({names_of(protocol).file: text.module, codec_name(protocol): text.codec})


def module_of(protocol: Protocol) -> ModuleType:
    """Import the modules that would be generated for `protocol`; the one that people read."""
    return import_modules(modules_of(protocol))


kept_module = Kept(module_of, most=8)
"""The module of a protocol, imported once for whoever asks again soon."""
