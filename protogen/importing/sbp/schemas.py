"""Packages -> schemas: their types and messages, in the frame that the library has for SBP."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from protogen.importing.names import snake_case, unique
from protogen.importing.remarks import Imported, Kind, Remark, Schema
from protogen.importing.sbp.fields import fields_of
from protogen.importing.sbp.packages import Packages
from protogen.importing.sbp.spec import Definition, Package
from protogen.importing.sbp.structs import Place, Structs
from protogen.importing.schema_text import (
    Commented,
    Data,
    Number,
    joined,
    paragraphs,
    schema_text,
)
from protogen.library import library_file
from protogen.passes.types.type_names import COMMON_NAMES
from protogen.problems import Problems, SourceMap
from protogen.schema.text.document import read_document
from protogen.schema.text.nodes import to_data

LARGEST_PAYLOAD = 255
_LARGEST_ID = 0xFFFF
_PREFIX = "MSG_"
_WHOLE = "sbp"
_DECISION = "preamble_in_data"


def import_packages(packages: Packages, remarks: list[Remark], *, split: bool) -> Imported:
    """Return one schema of all packages; with `split`, one of each that has messages."""
    return _Import(packages, remarks).run(split=split)


@cache
def _library() -> Data:
    """The library's schema of SBP, whose frame is that of every message."""
    file = library_file("sbp")
    assert file is not None
    document = read_document(file, Problems(), SourceMap())
    assert document is not None
    data: Data = to_data(document.root)
    return data


class _Import:
    def __init__(self, packages: Packages, remarks: list[Remark]) -> None:
        self._packages = packages
        self._remarks = remarks
        self._names = _names(packages.by_file.values())
        self._structs = Structs(packages, self._names)
        self._types: dict[str, dict[str, Any]] = {}
        """Types of the schema by name."""
        self._messages: dict[str, dict[str, Any]] = {}
        """Messages by file."""

    def run(self, *, split: bool) -> Imported:
        self._read()
        files = [file for file, messages in self._messages.items() if messages]
        if split:
            names: dict[str, str] = {}
            for file in files:
                name = snake_case(self._packages.by_file[file].name)
                names[unique(name, names)] = file
            schemas = [self._package_schema(name, file) for name, file in names.items()]
        else:
            schemas = [self._whole_schema(files)] if files else []
        count = len(self._packages.by_file)
        remarks = tuple(sorted(self._remarks, key=_place))
        return Imported(tuple(schemas), count, self._packages.others, remarks)

    # --- definitions --------------------------------------------------------------------------

    def _read(self) -> None:
        identities: dict[int, str] = {}
        for file, package in self._packages.by_file.items():
            self._messages[file] = {}
            for definition in _rendered(package, self._remarks):
                if definition.id is None:
                    self._read_type(file, definition)
                elif self._fits(file, definition, identities):
                    identities[definition.id] = definition.name
                    name = self._names[file, definition.name]
                    self._messages[file][name] = self._message(file, definition)

    def _read_type(self, file: str, struct: Definition) -> None:
        doc = _doc(struct, struct.short_desc, struct.desc)
        fields = fields_of(struct, file, self._structs, self._remarks)
        self._structs.extent(file, struct)
        body = {"doc": doc} if doc else {}
        self._types[self._names[file, struct.name]] = {
            **body,
            "source": _source(file, struct),
            "fields": fields,
        }

    def _message(self, file: str, message: Definition) -> dict[str, Any]:
        summary = " ".join(paragraphs(message.short_desc).split())
        repeats = paragraphs(message.desc).rstrip(".") == summary.rstrip(".")
        doc = _doc(message, "" if repeats else message.desc)
        fields = fields_of(message, file, self._structs, self._remarks)
        return {
            "id": Number(f"0x{message.id:04X}"),
            "from": "device",
            "title": message.name,
            **({"summary": summary} if summary else {}),
            **({"doc": doc} if doc else {}),
            "source": _source(file, message),
            **({"fields": fields} if fields else {}),
        }

    def _fits(self, file: str, message: Definition, identities: Mapping[int, str]) -> bool:
        """True if the frame can carry a message, and tell it from those before."""
        reason = self._misfit(file, message, identities)
        if reason is not None:
            self._remarks.append(Remark(Kind.LEFT_OUT, message.name, reason, message.span))
        return reason is None

    def _misfit(self, file: str, message: Definition, identities: Mapping[int, str]) -> str | None:
        assert message.id is not None
        if not 0 <= message.id <= _LARGEST_ID:
            return f"the id {message.id} does not fit in two bytes"
        if message.id in identities:
            return f"{identities[message.id]} has the id 0x{message.id:04X}, too"
        least = self._structs.extent(file, message).least
        if least > LARGEST_PAYLOAD:
            return f"it has {least} bytes, and a payload has {LARGEST_PAYLOAD} at most"
        return None

    # --- schemas ------------------------------------------------------------------------------

    def _whole_schema(self, files: Sequence[str]) -> Schema:
        """Return the schema of all messages, by package, and of all types."""
        messages: dict[str, Any] = {}
        for file in files:
            messages |= self._with_heading(file, self._messages[file])
        about = {"title": _library()["title"]}
        return self._schema(_WHOLE, about, self._types, messages)

    def _package_schema(self, name: str, file: str) -> Schema:
        """Return the schema of the messages of one package, with the types that they need."""
        package = self._packages.by_file[file]
        doc = paragraphs(package.desc)
        about = {"title": f"{_library()['title']}: {package.name}", **({"doc": doc} if doc else {})}
        messages = self._messages[file]
        return self._schema(name, about, self._needed(messages), messages, file)

    def _schema(
        self, name: str, about: Data, types: Data, messages: Data, file: str = ""
    ) -> Schema:
        root = {
            "protocol": name,
            **about,
            **{key: _library()[key] for key in ("endpoints", "byte_order", "frame")},
            **({"types": types} if types else {}),
            "messages": messages,
            "decisions": {_DECISION: _library()["decisions"][_DECISION]},
        }
        return Schema(name, schema_text(root, self._head(file)), len(messages), len(types))

    def _with_heading(self, file: str, messages: Mapping[str, Any]) -> dict[str, Any]:
        """Return messages with what their package is about above the first of them."""
        package = self._packages.by_file[file]
        heading = f"{package.name}: {paragraphs(package.desc)}".rstrip(": ")
        first = next(iter(messages))
        return {**messages, first: Commented(heading, messages[first])}

    def _needed(self, messages: Mapping[str, Any]) -> dict[str, Any]:
        """Return the types that messages need, themselves or in other types."""
        needed: set[str] = set()
        waiting = [messages]
        while waiting:
            found = {name for name in _types_in(waiting.pop()) if name in self._types}
            waiting += [self._types[name] for name in found - needed]
            needed |= found
        return {name: body for name, body in self._types.items() if name in needed}

    def _head(self, file: str) -> str:
        """Return the comment at the head of the schema of a file, or of all of them."""
        missing = [
            f"{item.name}: {item.reason}."
            for item in sorted(self._remarks, key=_place)
            if item.kind is Kind.LEFT_OUT and file in ("", item.span.file)
        ]
        title = "Messages of SBP, made by `protogen import sbp`."
        return "\n".join([title, *(["", "Left out:", *missing] if missing else [])])


def _names(packages: Collection[Package]) -> dict[Place, str]:
    """Return a name of its own for every message and every struct; messages come first."""
    names: dict[Place, str] = {}
    taken: set[str] = set()
    found = [(package.file, item) for package in packages for item in _of_protocol(package)]
    for file, definition in sorted(found, key=lambda pair: pair[1].id is None):
        is_message = definition.id is not None
        base = definition.name.removeprefix(_PREFIX) if is_message else definition.name
        others = taken if is_message else {*taken, *COMMON_NAMES}
        name = unique(snake_case(base), others, None if is_message else "type")
        taken.add(name)
        names[file, definition.name] = name
    return names


def _of_protocol(package: Package) -> Iterator[Definition]:
    """Yield what a package adds to the protocol."""
    if package.is_rendered:
        yield from (item for item in package.definitions if not item.is_basic)


def _rendered(package: Package, remarks: list[Remark]) -> Iterator[Definition]:
    """Yield what a package adds to the protocol, and remark on what it shows besides."""
    yield from _of_protocol(package)
    if not package.is_rendered:
        reason = f"{Path(package.file).name} is only for readers (render_source: false)"
        shown = (item for item in package.definitions if not item.is_basic)
        remarks += [Remark(Kind.LEFT_OUT, item.name, reason, item.span) for item in shown]


def _types_in(value: Any) -> Iterator[str]:
    """Yield the types that fields have."""
    if isinstance(value, Commented):
        yield from _types_in(value.value)
    elif isinstance(value, str):
        yield value
    elif isinstance(value, Mapping):
        fields = value.get("fields")
        if isinstance(fields, Mapping):
            for field in fields.values():
                yield field["type"] if isinstance(field, Mapping) else field
        else:
            for item in value.values():
                yield from _types_in(item)


def _doc(definition: Definition, *texts: str) -> str:
    """Return texts as paragraphs, and what replaces a definition that is out of use."""
    docs = [*map(paragraphs, texts)]
    if definition.replaced_by:
        docs.append(f"Replaced by {', '.join(definition.replaced_by)}.")
    return joined(docs)


def _source(file: str, definition: Definition) -> dict[str, Any]:
    first, last = definition.span.line, definition.last_line
    lines = str(first) if first == last else f"{first}-{last}"
    return {"document": Path(file).name, "lines": lines}


def _place(remark: Remark) -> Any:
    return remark.span
