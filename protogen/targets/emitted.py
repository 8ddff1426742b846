"""Names that generated code has in place of a schema's: those that a language or a target takes.

All are decided before anything is written, in the table of names of each target.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from protogen.model.protocol import Protocol
from protogen.runtime.attributes import argument, attribute
from protogen.targets.c.cpp.names import cpp_names
from protogen.targets.c.protocol_names import names_of as names_of_c
from protogen.targets.kept import Kept
from protogen.targets.naming import NameTable, Thing
from protogen.targets.python.names import names_of as names_of_python
from protogen.targets.typescript.names import names_of as names_of_typescript

ByLanguage = Mapping[str, tuple[str, ...]]
"""Names in generated code, by its language."""


class EmittedNames:
    """The escaped names of a protocol."""

    def __init__(self, protocol: Protocol) -> None:
        self._c = names_of_c(protocol)
        python = names_of_python(protocol)
        found: dict[Thing, dict[str, tuple[str, ...]]] = {}
        _add(found, "C", (self._c.files, self._c.tags, self._c.others, self._c.members))
        _add(found, "C++", cpp_names(protocol).tables)
        _add(found, "Python", python.tables)
        _add(found, "TypeScript", names_of_typescript(protocol).tables)
        self.escapes: Mapping[Thing, ByLanguage] = found
        """Those of each thing that has some."""

    def field(self, name: str) -> ByLanguage:
        """The member and the attribute of fields of that name, where they have another."""
        return _others(name, {"C": self._c.member(name), "Python": attribute(name)})

    def part(self, name: str) -> ByLanguage:
        """The same for parts, which are arguments as well."""
        in_python = next((n for n in (attribute(name), argument(name)) if n != name), name)
        return _others(name, {"C": self._c.member(name), "Python": in_python})


def _others(name: str, names: Mapping[str, str]) -> ByLanguage:
    return {language: (other,) for language, other in names.items() if other != name}


def _add(
    found: dict[Thing, dict[str, tuple[str, ...]]], language: str, tables: Iterable[NameTable]
) -> None:
    for thing, names in (item for table in tables for item in table.escaped.items()):
        known = found.setdefault(thing, {})
        known[language] = tuple(dict.fromkeys((*known.get(language, ()), *names)))


emitted_names = Kept(EmittedNames, most=64)
"""The escaped names of a protocol."""
