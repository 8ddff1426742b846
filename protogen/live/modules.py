"""Generated modules that are imported from memory."""

from __future__ import annotations

import importlib
import itertools
import linecache
import marshal
import sys
from collections.abc import Mapping
from importlib.abc import InspectLoader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import CodeType, ModuleType

import msgspec

_NUMBERS = itertools.count()


class Module(msgspec.Struct, frozen=True):
    """A module that no file holds: its text, and its code as `marshal` writes it."""

    text: str
    code: bytes


Modules = Mapping[str, Module]
"""The modules of a protocol by name, first the one that people read."""


def compiled(texts: Mapping[str, str]) -> Modules:
    """Compile the modules of a protocol, which import each other by these names."""
    return {
        name: Module(text, marshal.dumps(compile(text, _origin(name), "exec", dont_inherit=True)))
        for name, text in texts.items()
    }


def import_modules(modules: Modules) -> ModuleType:
    """Import the modules of a protocol, in a package of their own; returns the first."""
    package = f"protogen_live_{next(_NUMBERS)}"
    finder = _Finder(package, {f"{package}.{name}": item for name, item in modules.items()})
    sys.meta_path.append(finder)
    try:
        return importlib.import_module(f"{package}.{next(iter(modules))}")
    except BaseException:
        for name in finder.names:
            sys.modules.pop(name, None)
        raise
    finally:
        sys.meta_path.remove(finder)


def _origin(name: str) -> str:
    return f"<generated {name.rpartition('.')[2]}>"


class _Finder(MetaPathFinder, InspectLoader):
    """Finds modules that are in memory, and the package around them, which is empty."""

    def __init__(self, package: str, modules: Modules) -> None:
        self._package = package
        self._modules = modules

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all modules that it finds."""
        return (self._package, *self._modules)

    def find_spec(
        self, fullname: str, path: object = None, target: object = None
    ) -> ModuleSpec | None:
        """The module of that name, if it is here."""
        if fullname not in self.names:
            return None
        origin = _origin(fullname)
        text = self.get_source(fullname)
        linecache.cache[origin] = (len(text), None, text.splitlines(keepends=True), origin)
        return ModuleSpec(fullname, self, origin=origin, is_package=self.is_package(fullname))

    def is_package(self, fullname: str) -> bool:
        """True for the package, which holds nothing itself."""
        return fullname == self._package

    def get_source(self, fullname: str) -> str:
        """Text of the module."""
        return "" if self.is_package(fullname) else self._modules[fullname].text

    def get_code(self, fullname: str) -> CodeType:
        """Code of the module."""
        if self.is_package(fullname):
            return compile("", _origin(fullname), "exec")
        code: CodeType = marshal.loads(self._modules[fullname].code)  # noqa: S302 - our own
        return code
