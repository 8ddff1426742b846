"""What a script needs of its modules: declarations that nothing reaches are left out.

Modules are those of the bench and what `tsc` prints: each statement begins at the first column,
and a declaration has no effect besides its name. So one that is not needed can go.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from posixpath import dirname, join, normpath

_IMPORT = re.compile(
    r"^(?P<kind>import|export)\s+(?:\*\s+as\s+(?P<whole>\w+)|\{(?P<names>[^}]*)\})"
    r'\s+from\s+"(?P<path>[^"]+)";[^\S\n]*\n?',
    re.MULTILINE,
)
_STATEMENT = re.compile(r"^(?=[\w$/])", re.MULTILINE)
_DECLARED = re.compile(
    r"(?P<export>export )?(?:async )?(?:function\*?|class|const|let) (?P<name>[\w$]+)"
)
_REMARK = re.compile(r"^\s*(?:/?\*|//).*$", re.MULTILINE)
_WORD = re.compile(r"[\w$]+")


@dataclass(frozen=True)
class Statement:
    """A statement of a module."""

    text: str
    """Without the word `export`."""
    name: str
    """What it declares; empty: nothing, or several names."""
    words: frozenset[str]


@dataclass(frozen=True)
class Imported:
    """A name that is another module's."""

    path: str
    name: str
    """Its name there; empty: the module itself."""


@dataclass(frozen=True)
class Module:
    """A module, taken apart."""

    imports: Mapping[str, Imported]
    passed_on: Mapping[str, Imported]
    """What it exports of others."""
    statements: tuple[Statement, ...]
    exports: frozenset[str]

    @cached_property
    def declared(self) -> Mapping[str, Sequence[Statement]]:
        """The statements that declare each name."""
        found: dict[str, list[Statement]] = {}
        for item in self.statements:
            found.setdefault(item.name, []).append(item)
        return found


@dataclass
class Needed:
    """What is needed of a module."""

    module: Module
    names: set[str] = field(default_factory=set)
    """Of what it declares and imports."""
    given: set[str] = field(default_factory=set)
    """Of what it exports, and what else others take of it."""

    def statements(self) -> Iterator[Statement]:
        """The statements that are needed, in their order."""
        for item in self.module.statements:
            if not item.name or item.name in self.names:
                yield item


def needed(
    modules: Mapping[str, str], entry: str, taken: Mapping[str, Collection[str]]
) -> dict[str, Needed]:
    """What the module `entry` needs of all; each stands behind those that it imports.

    `taken` names what is taken of modules that others take whole.
    """
    marking = _Marking(modules, taken)
    whole = marking.of(entry)
    for item in whole.module.statements:
        whole.names.add(item.name)
        marking.reach(entry, item)
    order: dict[str, Needed] = {}
    _arrange(entry, marking.found, order, ())
    return order


class _Marking:
    """Marks what is reached."""

    def __init__(self, modules: Mapping[str, str], taken: Mapping[str, Collection[str]]) -> None:
        self.modules = modules
        self.taken = taken
        self.found: dict[str, Needed] = {}

    def of(self, path: str) -> Needed:
        """What is needed of a module; what it does besides declaring is."""
        if path not in self.found:
            self.found[path] = Needed(_parsed(path, self.modules[path]))
            for item in self.found[path].module.statements:
                if not item.name:
                    self.reach(path, item)
        return self.found[path]

    def give(self, path: str, name: str) -> None:
        """Mark what a module gives to others."""
        own = self.of(path)
        own.given.add(name)
        passed = own.module.passed_on.get(name)
        if passed:
            self.give(passed.path, passed.name)
        else:
            self.mark(path, name, "")

    def mark(self, path: str, name: str, text: str) -> None:
        """Mark a name inside of a module, which stands in that text."""
        own = self.of(path)
        imported = own.module.imports.get(name)
        if imported and not imported.name:
            own.names.add(name)
            self.members(name, text, imported.path)
        elif name not in own.names:
            own.names.add(name)
            if imported:
                self.give(imported.path, imported.name)
            for item in own.module.declared.get(name, ()):
                self.reach(path, item)

    def members(self, name: str, text: str, path: str) -> None:
        """Mark what the text takes of a module that is imported whole."""
        found = re.findall(rf"\b{name}\b(?:\.(\w+))?", text)
        if path in self.taken:
            found = [*self.taken[path]]
        elif "" in found:
            found = sorted(self.of(path).module.exports)
        for member in found:
            self.give(path, member)

    def reach(self, path: str, statement: Statement) -> None:
        """Mark all that a statement names."""
        module = self.of(path).module
        for word in statement.words:
            if word in module.declared or word in module.imports:
                self.mark(path, word, statement.text)


def _arrange(
    path: str, found: Mapping[str, Needed], order: dict[str, Needed], around: tuple[str, ...]
) -> None:
    """Put a module behind those of which it needs something."""
    assert path not in around, f"{path} imports itself by {around}"
    if path in order:
        return
    own = found[path]
    used = [item for name, item in own.module.imports.items() if name in own.names]
    used += [item for name, item in own.module.passed_on.items() if name in own.given]
    for item in used:
        _arrange(item.path, found, order, (*around, path))
    order[path] = own


@lru_cache(256)
def _parsed(path: str, text: str) -> Module:
    imports: dict[str, Imported] = {}
    passed_on: dict[str, Imported] = {}
    for found in _IMPORT.finditer(text):
        target = normpath(join(dirname(path), found["path"]))
        if found["whole"]:
            imports[found["whole"]] = Imported(target, "")
            continue
        names = [item.strip() for item in found["names"].split(",") if item.strip()]
        for item in names:
            own, _, other = item.partition(" as ")
            (imports if found["kind"] == "import" else passed_on)[other or own] = Imported(
                target, own
            )
    own = [*map(_statement, _STATEMENT.split(_IMPORT.sub("", text)))]
    exports = {item.name for item, is_exported in own if is_exported}
    return Module(
        imports, passed_on, tuple(item for item, _ in own), frozenset(exports | passed_on.keys())
    )


def _statement(text: str) -> tuple[Statement, bool]:
    """A statement, and whether it is exported."""
    declared = _DECLARED.match(text)
    name = declared["name"] if declared else ""
    is_exported = declared is not None and declared["export"] is not None
    text = text.removeprefix("export ") if is_exported else text
    assert not text.startswith("export "), f"{text} exports in a way not known here"
    words = frozenset(_WORD.findall(_REMARK.sub("", text)))
    return Statement(text, name, words - {name}), is_exported
