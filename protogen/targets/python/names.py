"""Names of generated Python: those of a module, and those of each class in it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from protogen.model.meanings import BitField, Enum, Flags
from protogen.model.messages import Message
from protogen.model.names import unit_suffix
from protogen.model.protocol import Protocol, Sender
from protogen.model.types import Field, Struct
from protogen.runtime.attributes import ARGUMENTS, ATTRIBUTES
from protogen.targets.kept import Kept
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
from protogen.targets.python.spelling import class_name
from protogen.targets.python.words import words_of_files, words_of_modules


class Names:
    """Names of a module: of its classes, and of what it has for each endpoint."""

    def __init__(self, protocol: Protocol) -> None:
        self.files = NameTable(words_of_files())
        """Names of modules."""
        self.file = self.files.add(protocol.name, PROTOCOL)
        """The name of the module that people read."""
        self.module = NameTable(words_of_modules())
        """Names in it."""
        self.unions: dict[str, str] = {}
        """The type of each endpoint's messages."""
        self.parts: dict[str, str] = {}
        """The class of the parts of each sender's frames, where others have others."""
        self.classes: dict[str, str] = {}
        """The class of each message and type."""
        self._name_endpoints(protocol)
        self._name_classes(protocol)
        records: tuple[Struct | Message, ...] = (*protocol.structs, *protocol.messages)
        self.records: Mapping[str, RecordNames] = {
            record.name: RecordNames(record.name, record.fields) for record in records
        }
        self.arguments = _arguments(protocol)
        """Names of the parameters of encoders."""
        self._shown = [_shown(sender) for sender in protocol.senders]

    def _name_endpoints(self, protocol: Protocol) -> None:
        for sender in protocol.senders:
            thing, name, side = endpoint(sender.endpoint), sender.name, sender.endpoint
            for word in ("SENDER", "FORMAT"):
                self.module.add(f"{name.upper()}_{word}", thing)
            self.unions[side] = self.module.add(f"{class_name(side)}Message", thing)
            self.parts[name] = self.module.add(f"{class_name(name)}Parts", thing)

    def _name_classes(self, protocol: Protocol) -> None:
        types: tuple[Enum | Flags | Struct, ...] = (
            *protocol.enums,
            *protocol.flags,
            *protocol.structs,
        )
        for item in types:
            self.classes[item.name] = self.module.add(class_name(item.name), named_type(item.name))
        for record in protocol.messages:
            spelled = class_name(record.name)
            self.classes[record.name] = self.module.add(spelled, message(record.name))

    @property
    def tables(self) -> Iterator[NameTable]:
        """Each scope."""
        yield self.files
        yield self.module
        yield from (record.table for record in self.records.values())
        yield self.arguments
        yield from self._shown


names_of = Kept(Names, most=64)
"""The names of a protocol's module: asked for by the reference, and to print the module."""


def frame_name(sender: str) -> str:
    """The function that describes an endpoint's frame."""
    return f"_{sender}_frame_spec"


def _arguments(protocol: Protocol) -> NameTable:
    """Parameters of encoders. Parts of several senders that are called alike are one of them."""
    given: dict[str, Thing] = {}
    for sender in protocol.senders:
        for item in sender.given_parts:
            given.setdefault(item.name, part(sender.name, item.name))
    table = NameTable(ARGUMENTS)
    for name, thing in given.items():
        table.add(name, thing)
    return table


def _shown(sender: Sender) -> NameTable:
    """Attributes of an endpoint's parts."""
    table = NameTable(ATTRIBUTES)
    for item in sender.frame.shown_parts:
        table.add(item.name, part(sender.name, item.name))
    return table


class RecordNames:
    """Attributes of a message or struct: fields, readings, and runs of bits."""

    def __init__(self, record: str, fields: Sequence[Field]) -> None:
        self.table = NameTable(ATTRIBUTES)
        self._record = record
        self.fields = {
            field.name: self.table.add(field.name, inside(record, "field", field.name))
            for field in fields
        }
        """The attribute of each field."""
        self._readings = {field.name: self._reading(field) for field in fields if field.scaled}
        self._runs = {
            (field.name, item.name): self._run(field, item)
            for field in fields
            for item in field.bit_fields
        }

    def reading(self, field: Field) -> str:
        """The property that is a field's reading."""
        return self._readings[field.name]

    def run(self, field: Field, item: BitField) -> str:
        """The property that is a run of bits."""
        return self._runs[field.name, item.name]

    def _reading(self, field: Field) -> str:
        name = self._beside_fields(f"{field.name}_{unit_suffix(field.unit)}")
        return self.table.add(name, inside(self._record, "reading", field.name))

    def _run(self, field: Field, item: BitField) -> str:
        thing = inside(self._record, "run of bits", field.name, "bits", item.name)
        return self.table.add(self._beside_fields(f"{field.name}_{item.name}"), thing)

    def _beside_fields(self, name: str) -> str:
        """A name that no field has."""
        while name in self.fields:
            name += "_value"
        return name
