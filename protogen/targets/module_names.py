"""Names of a generated module, and of the records in it, that several languages have alike."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache
from typing import Generic, TypeVar

from protogen.model.meanings import BitField, Enum, Flags
from protogen.model.messages import Message
from protogen.model.names import unit_suffix
from protogen.model.protocol import Protocol, Sender
from protogen.model.types import Field, Struct
from protogen.targets.naming import (
    PROTOCOL,
    NameTable,
    Thing,
    endpoint,
    inside,
    message,
    named_type,
    part,
)


@lru_cache(4096)
def pascal(name: str) -> str:
    """`move_manual` is `MoveManual`."""
    return "".join(word[:1].upper() + word[1:] for word in name.split("_"))


class RecordNames(ABC):
    """Members of a message or struct: fields, physical values, and runs of bits."""

    def __init__(self, record: Struct | Message, words: Iterable[str]) -> None:
        self.table = NameTable(words)
        self._record = record.name
        self.fields = {
            field.name: self.table.add(field.name, inside(record.name, "field", field.name))
            for field in record.fields
        }
        """The member of each field."""
        self._readings = {
            field.name: self._reading(field) for field in record.fields if field.scaled
        }
        self._runs = {
            (field.name, item.name): self._run(field, item)
            for field in record.fields
            for item in field.bit_fields
        }

    def reading(self, field: Field) -> str:
        """What gives a field's physical value."""
        return self._readings[field.name]

    def run(self, field: Field, item: BitField) -> str:
        """What gives a run of bits."""
        return self._runs[field.name, item.name]

    def _reading(self, field: Field) -> str:
        own = f"{field.name}_{unit_suffix(field.unit)}"
        return self._beside_fields(own, inside(self._record, "reading", field.name))

    def _run(self, field: Field, item: BitField) -> str:
        thing = inside(self._record, "run of bits", field.name, "bits", item.name)
        return self._beside_fields(f"{field.name}_{item.name}", thing)

    @abstractmethod
    def _beside_fields(self, name: str, thing: Thing) -> str:
        """The name of what shows a field in another way."""


RecordT = TypeVar("RecordT", bound=RecordNames)


class ModuleNames(ABC, Generic[RecordT]):
    """Names of a module: of its types, and of what it has for each endpoint."""

    def __init__(
        self, protocol: Protocol, files: Iterable[str], words: Iterable[str], members: Iterable[str]
    ) -> None:
        self.files = NameTable(files)
        """Names of modules."""
        self.file = self.files.add(protocol.name, PROTOCOL)
        """The name of the module."""
        self.module = NameTable(words)
        """Names in it."""
        self.unions: dict[str, str] = {}
        """The type of each endpoint's messages."""
        self.parts: dict[str, str] = {}
        """The type of the parts of each sender's frames."""
        self.types: dict[str, str] = {}
        """The type of each message and named type."""
        for sender in protocol.senders:
            self._name_sender(sender, endpoint(sender.endpoint))
        self._name_types(protocol)
        records: tuple[Struct | Message, ...] = (*protocol.structs, *protocol.messages)
        self.records: Mapping[str, RecordT] = {it.name: self._record_names(it) for it in records}
        self._shown = {sender.name: NameTable(members) for sender in protocol.senders}
        for sender in protocol.senders:
            for item in sender.frame.shown_parts:
                self.shown(sender.name, item.name)

    def _name_sender(self, sender: Sender, thing: Thing) -> None:
        side = sender.endpoint
        self.unions[side] = self.module.add(f"{pascal(side)}Message", thing)
        self.parts[sender.name] = self.module.add(f"{pascal(sender.name)}Parts", thing)

    def _name_types(self, protocol: Protocol) -> None:
        types: tuple[Enum | Flags | Struct, ...] = (
            *protocol.enums,
            *protocol.flags,
            *protocol.structs,
        )
        for item in types:
            self.types[item.name] = self.module.add(pascal(item.name), named_type(item.name))
        for record in protocol.messages:
            self.types[record.name] = self.module.add(pascal(record.name), message(record.name))

    @abstractmethod
    def _record_names(self, record: Struct | Message) -> RecordT:
        """The names of a message or struct."""

    def shown(self, sender: str, name: str) -> str:
        """The member of an event's parts."""
        return self._shown[sender].add(name, part(sender, name))

    @property
    def tables(self) -> Iterator[NameTable]:
        """Each scope."""
        yield self.files
        yield self.module
        yield from (record.table for record in self.records.values())
        yield from self._shown.values()
