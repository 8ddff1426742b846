"""Names of generated TypeScript: those of a module, and those of each record in it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from protogen.model.meanings import BitField, Enum, Flags
from protogen.model.messages import Message
from protogen.model.names import unit_suffix
from protogen.model.protocol import Protocol, Sender
from protogen.model.types import Field, Struct
from protogen.targets.kept import Kept
from protogen.targets.naming import (
    PROTOCOL,
    NameTable,
    endpoint,
    inside,
    message,
    named_type,
    part,
)

_RESERVED = """
abstract any arguments as asserts async await bigint boolean break case catch class const continue
debugger declare default delete do else enum eval export extends false finally for from function get
if implements import in infer instanceof interface is keyof let module namespace never new null
number object of package private protected public readonly require return set static string super
switch symbol this throw true try type typeof undefined unique unknown var void while with yield
"""
"""Words of the language."""

_GLOBALS = """
Array AsyncGenerator AsyncIterable BigInt Boolean DataView Error Infinity Iterable Map Math NaN
Number Object Omit Pick RangeError Readonly Record Set String Symbol TransformStream Uint8Array
"""
"""Names of the language that generated code uses."""

_OWN = """
Decoder DecodeError EncodeError Encoder Event InvalidEvent Message MessageEvent MessageInput
EncodeOptions DecodeOptions GivenParts SenderName Senders UnknownEvent SPEC_HASH decode
decoderStream encode events jsonLine rt protocol
"""
"""What a module has itself."""

_LOCALS = "r w m rt at"
"""What generated functions have themselves."""


class Names:
    """Names of a module."""

    def __init__(self, protocol: Protocol) -> None:
        self.files = NameTable(("runtime", "index", "package"))
        self.file = self.files.add(protocol.name, PROTOCOL)
        """The name of the module."""
        self.module = NameTable(f"{_RESERVED} {_GLOBALS} {_OWN}".split())
        """Names in it."""
        self.unions: dict[str, str] = {}
        """The type of each endpoint's messages."""
        self.parts: dict[str, str] = {}
        """The type of the parts of each sender's frames."""
        self.types: dict[str, str] = {}
        """The type of each message and named type."""
        self.inputs: dict[str, str] = {}
        """The type of what an encoder takes for each message and struct."""
        self.frames: dict[str, str] = {}
        """The function that gives each sender's frame."""
        self.functions: dict[str, tuple[str, str, str]] = {}
        """What reads and what writes the payload of each message, and its plan."""
        self._name_endpoints(protocol)
        self._name_types(protocol)
        self._name_functions(protocol)
        records: tuple[Struct | Message, ...] = (*protocol.structs, *protocol.messages)
        self.records: Mapping[str, RecordNames] = {
            record.name: RecordNames(self.module, record) for record in records
        }
        self._shown = {sender.name: _shown(sender) for sender in protocol.senders}

    def _name_endpoints(self, protocol: Protocol) -> None:
        for sender in protocol.senders:
            thing, side = endpoint(sender.endpoint), sender.endpoint
            self.unions[side] = self.module.add(f"{pascal(side)}Message", thing)
            self.parts[sender.name] = self.module.add(f"{pascal(sender.name)}Parts", thing)
            self.frames[sender.name] = self.module.add(f"{camel(sender.name)}Frame", thing)

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
        for struct in protocol.structs:
            own = f"{self.types[struct.name]}Input"
            self.inputs[struct.name] = self.module.add(own, named_type(struct.name))
        for record in protocol.messages:
            own = f"{self.types[record.name]}Input"
            self.inputs[record.name] = self.module.add(own, message(record.name))

    def _name_functions(self, protocol: Protocol) -> None:
        for record in protocol.messages:
            thing, own = message(record.name), self.types[record.name]
            words = ("read", "write", "planOf")
            read, write, plan = (self.module.add(f"{word}{own}", thing) for word in words)
            self.functions[record.name] = read, write, plan

    def shown(self, sender: str, name: str) -> str:
        """The member of an event's parts."""
        return self._shown[sender].get(name, name)

    @property
    def tables(self) -> Iterator[NameTable]:
        """Each scope."""
        yield self.files
        yield self.module
        yield from (record.table for record in self.records.values())


def _shown(sender: Sender) -> Mapping[str, str]:
    table = NameTable(("__proto__",))
    return {
        item.name: table.add(item.name, part(sender.name, item.name))
        for item in sender.frame.shown_parts
    }


class RecordNames:
    """Members of a message or struct, and the functions that show them in another way."""

    def __init__(self, module: NameTable, record: Struct | Message) -> None:
        words = ("message",) if isinstance(record, Message) else ()
        self.table = NameTable(("__proto__", *words))
        self.fields = {
            field.name: self.table.add(field.name, inside(record.name, "field", field.name))
            for field in record.fields
        }
        """The member of each field."""
        self._module = module
        self._record = record.name
        self._readings = {f.name: self._reading(f) for f in record.fields if f.scaled}
        self._runs = {
            (field.name, item.name): self._run(field, item)
            for field in record.fields
            for item in field.bit_fields
        }

    def reading(self, field: Field) -> tuple[str, str]:
        """The functions that give a field's physical value, and the raw value of one."""
        return self._readings[field.name]

    def run(self, field: Field, item: BitField) -> str:
        """The function that gives a run of bits."""
        return self._runs[field.name, item.name]

    def _reading(self, field: Field) -> tuple[str, str]:
        thing, unit = inside(self._record, "reading", field.name), unit_suffix(field.unit)
        own = f"{self._record}_{field.name}"
        return (
            self._module.add(camel(f"{own}_{unit}"), thing),
            self._module.add(camel(f"{own}_from_{unit}"), thing),
        )

    def _run(self, field: Field, item: BitField) -> str:
        thing = inside(self._record, "run of bits", field.name, "bits", item.name)
        return self._module.add(camel(f"{self._record}_{field.name}_{item.name}"), thing)


def pascal(name: str) -> str:
    """`move_manual` is `MoveManual`."""
    return "".join(word[:1].upper() + word[1:] for word in name.split("_"))


def camel(name: str) -> str:
    """`move_manual` is `moveManual`."""
    found = pascal(name)
    return found[:1].lower() + found[1:]


def locals_table() -> NameTable:
    """Names of a function's own variables."""
    return NameTable(f"{_RESERVED} {_GLOBALS} {_LOCALS}".split())


def fields_of(names: Names, record: str, fields: Sequence[Field]) -> dict[str, str]:
    """The members of a record, by the names of its fields."""
    return {field.name: names.records[record].fields[field.name] for field in fields}


names_of = Kept(Names, most=64)
"""The names of a protocol's module."""
