"""The Python target's own output, imported from memory: the only codec that the compiler uses."""

from __future__ import annotations

import importlib
import itertools
import linecache
import sys
from collections.abc import Mapping
from importlib.abc import InspectLoader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import CodeType, ModuleType

from protogen.model.protocol import Protocol
from protogen.targets.python.emit import codec_name, kept_source
from protogen.targets.python.kept import Kept

_NUMBERS = itertools.count()


def module_of(protocol: Protocol) -> ModuleType:
    """Import the modules that would be generated for `protocol`; the one that people read."""
    text = kept_source(protocol)
    package = f"protogen_live_{next(_NUMBERS)}"
    names = [package, f"{package}.{protocol.name}", f"{package}.{codec_name(protocol)}"]
    finder = _Finder(dict(zip(names, ("", text.module, text.codec), strict=True)))
    sys.meta_path.append(finder)
    try:
        return importlib.import_module(names[1])
    except BaseException:
        for name in names:
            sys.modules.pop(name, None)
        raise
    finally:
        sys.meta_path.remove(finder)


class _Finder(MetaPathFinder, InspectLoader):
    """Finds modules whose text is in memory; the first of them is a package."""

    def __init__(self, texts: Mapping[str, str]) -> None:
        self._texts = texts
        self._package = next(iter(texts))

    def find_spec(
        self, fullname: str, path: object = None, target: object = None
    ) -> ModuleSpec | None:
        """The module of that name, if its text is here."""
        if fullname not in self._texts:
            return None
        origin = f"<generated {fullname.rpartition('.')[2]}>"
        text = self._texts[fullname]
        linecache.cache[origin] = (len(text), None, text.splitlines(keepends=True), origin)
        return ModuleSpec(fullname, self, origin=origin, is_package=fullname == self._package)

    def is_package(self, fullname: str) -> bool:
        """True for the package, which holds nothing itself."""
        return fullname == self._package

    def get_source(self, fullname: str) -> str:
        """Text of the module."""
        return self._texts[fullname]

    def get_code(self, fullname: str) -> CodeType:
        """Code of the module."""
        origin = f"<generated {fullname.rpartition('.')[2]}>"
        return self.source_to_code(self._texts[fullname], origin)


kept_module = Kept(module_of, most=8)
"""The module of a protocol, imported once for whoever asks again soon."""
