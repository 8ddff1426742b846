"""Dialects -> schemas: one of each file, which extends that of a file that it includes.

A schema extends one other. Where a file includes several, its schema extends the one that holds
most of them, and has what is defined in the others itself.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import msgspec

from protogen.importing.mavlink.crc_extra import crc_extra
from protogen.importing.mavlink.dialects import Dialects
from protogen.importing.mavlink.enums import Enums
from protogen.importing.mavlink.fields import fields_of
from protogen.importing.mavlink.frames import (
    ENDPOINT,
    LARGEST_PAYLOAD,
    Wire,
    decisions,
    message_data,
    protocol_data,
)
from protogen.importing.mavlink.identifiers import identifier
from protogen.importing.mavlink.spec import Dialect, Message
from protogen.importing.mavlink.texts import life_text, summary_and_doc
from protogen.importing.names import snake_case, unique
from protogen.importing.remarks import DefinitionError, Imported, Kind, Remark, Schema
from protogen.importing.schema_text import joined, schema_text
from protogen.importing.writing import SUFFIX
from protogen.passes.types.type_names import COMMON_NAMES
from protogen.problems.span import Span


def import_dialects(dialects: Dialects, wire: Wire) -> Imported:
    """Return a schema of each file, those in front that others extend."""
    run = _Import(dialects, wire)
    schemas = [schema for file in dialects.by_file if (schema := run.schema(file)) is not None]
    remarks = sorted(set(run.remarks), key=lambda remark: (remark.span, remark.reason))
    return Imported(tuple(schemas), len(dialects.by_file), 0, tuple(remarks))


class _Known(msgspec.Struct, frozen=True):
    """What a schema says, with those that it extends."""

    name: str
    enums: Enums
    names: frozenset[str]
    """Names of types and messages."""
    messages: dict[int, Message]
    by_name: dict[str, Message]


class _Import:
    def __init__(self, dialects: Dialects, wire: Wire) -> None:
        self.remarks: list[Remark] = []
        self._dialects = dialects
        self._wire = wire
        self._known: dict[str, _Known] = {}
        """What the schemas say, by file."""

    def schema(self, file: str) -> Schema | None:
        """Return the schema of a file; those of the files that it includes are made already.

        Returns None if there is no message in it.
        """
        base = self._base(file)
        known = None if base is None else self._known[base]
        above = set() if base is None else set(self._dialects.closure(base))
        name = unique(snake_case(_stem(file)), [item.name for item in self._known.values()])
        part = _Part(name, known, self._wire, self.remarks)
        for item in self._dialects.closure(file):
            if item not in above:
                part.add(self._dialects.by_file[item])
        if part.is_empty:
            reason = f"it has no message for MAVLink {self._wire}"
            self.remarks.append(Remark(Kind.LEFT_OUT, Path(file).name, reason, Span.of_file(file)))
            return None
        self._known[file] = part.known()
        return part.schema(self._dialects.by_file[file])

    def _base(self, file: str) -> str | None:
        """Return the included file whose schema the one of a file extends."""
        included = [item for item in self._dialects.included[file] if item in self._known]
        if not included:
            return None
        return max(included, key=lambda item: len(self._dialects.closure(item)))


class _Part:
    """What a schema adds to the one that it extends."""

    def __init__(self, name: str, base: _Known | None, wire: Wire, remarks: list[Remark]) -> None:
        self._name = name
        self._base = base
        self._wire = wire
        self._remarks = remarks
        self._enums = Enums(base.enums if base else None, remarks)
        self._ids = dict(base.messages) if base else {}
        self._by_name = dict(base.by_name) if base else {}
        self._taken = set(base.names) if base else set()
        self._dialects: list[Dialect] = []
        self._messages: list[tuple[Message, Dialect]] = []
        self._types: dict[str, Any] = {}
        self._message_names: dict[str, str] = {}

    def add(self, dialect: Dialect) -> None:
        """Add what a file defines."""
        self._dialects.append(dialect)
        for enum in dialect.enums:
            self._enums.add(enum, dialect.file)
        for message in dialect.messages:
            self._check(message)
            if self._fits(message):
                self._messages.append((message, dialect))

    @property
    def is_empty(self) -> bool:
        """True if there is no message in the schema, and none that it extends."""
        return self._base is None and not self._messages

    def known(self) -> _Known:
        """Return what is known to a schema that extends this one."""
        for message, _ in self._messages:
            for field in self._wire.fields(message):
                enum = field.attributes.get("enum", "").strip()
                if enum:
                    self._enums.use(enum, field.type, field.span)
            name = unique(identifier(message.name), self._taken, "message")
            self._message_names[message.name] = name
            self._taken.add(name)
        taken = self._taken | set(COMMON_NAMES)
        self._types = self._enums.types(taken)
        names = frozenset(self._taken | set(self._types))
        return _Known(self._name, self._enums, names, self._ids, self._by_name)

    def _check(self, message: Message) -> None:
        """Raise DefinitionError if another message has the id or the name."""
        for other in (self._ids.get(message.id), self._by_name.get(message.name)):
            if other is not None:
                place = f"{Path(other.span.file).name}:{other.span.line}"
                text = f"the message {other.name} has the id {other.id}, in {place}"
                hint = "ids and names stand once, in all files that include each other"
                raise DefinitionError(message.span, text, hint)
        self._ids[message.id] = message
        self._by_name[message.name] = message

    def _fits(self, message: Message) -> bool:
        """True if the frame can carry a message."""
        size = sum(field.wire_size for field in self._wire.fields(message))
        reason = None
        if message.id > self._wire.largest_id:
            reason = f"the id {message.id} does not fit in the byte that MAVLink 1 has for it"
        elif size > LARGEST_PAYLOAD:
            reason = f"it has {size} bytes, and a payload has {LARGEST_PAYLOAD} at most"
        if reason is not None:
            self._remarks.append(Remark(Kind.LEFT_OUT, message.name, reason, message.span))
        return reason is None

    # --- schema -------------------------------------------------------------------------------

    def schema(self, dialect: Dialect) -> Schema:
        """Return the schema."""
        messages = {
            self._message_names[message.name]: self._message(message, owner)
            for message, owner in self._messages
        }
        about = {"title": f"MAVLink {self._wire}, {_stem(dialect.file)}"}
        if dialect.number:
            about["doc"] = f"Dialect {dialect.number}."
        if self._base is None:
            root = {"protocol": self._name, **about, **protocol_data(self._wire)}
        else:
            base = f"{self._base.name}{SUFFIX}"
            root = {"protocol": self._name, "extends": base, **about}
        root |= {"types": self._types} if self._types else {}
        root |= {"messages": messages} if messages else {}
        root |= {"decisions": decisions()} if self._base is None else {}
        text = schema_text(root, self._head(dialect))
        return Schema(self._name, text, len(messages), len(self._types))

    def _message(self, message: Message, owner: Dialect) -> dict[str, Any]:
        summary, rest = summary_and_doc(message.text)
        fields = self._wire.fields(message)
        doc = joined([rest, life_text(message.life), *self._orders(message)])
        data = fields_of(message, fields, owner.version, self._enums, self._remarks)
        return {
            "id": message.id,
            "from": ENDPOINT,
            "title": message.name,
            **({"summary": summary} if summary else {}),
            **({"doc": doc} if doc else {}),
            "source": _source(owner.file, message),
            **message_data(crc_extra(message)),
            **({"fields": data} if data else {}),
        }

    def _orders(self, message: Message) -> list[str]:
        """Return sentences on the order of fields in the definition, and on extensions."""
        sent = [field.name for field in self._wire.fields(message)]
        written = [field.name for field in message.fields if field.name in sent]
        later = [field.name for field in message.fields if field.is_extension]
        texts = [f"Defined in the order {', '.join(written)}."] if written != sent else []
        if later and self._wire is Wire.V1:
            return [*texts, f"MAVLink 2 has besides: {', '.join(later)}."]
        return [*texts, f"Extensions: {', '.join(later)}."] if later else texts

    def _head(self, dialect: Dialect) -> str:
        """Return the comment at the head of the schema."""
        lines = [f"MAVLink {self._wire}, made by `protogen import mavlink`."]
        others = [Path(item.file).name for item in self._dialects if item is not dialect]
        if others:
            lines += ["", f"What {', '.join(others)} defines is in it, too."]
        files = {item.file for item in self._dialects}
        missing = [
            f"{item.name}: {item.reason}."
            for item in sorted(set(self._remarks), key=lambda item: (item.span, item.reason))
            if item.kind is Kind.LEFT_OUT and item.span.file in files
        ]
        return "\n".join([*lines, *(["", "Left out:", *missing] if missing else [])])


def _stem(file: str) -> str:
    return Path(file).stem


def _source(file: str, message: Message) -> dict[str, Any]:
    first, last = message.span.line, message.last_line
    lines = str(first) if first == last else f"{first}-{last}"
    return {"document": Path(file).name, "lines": lines}
