"""Names of generated TypeScript: those of a module, and those of each record in it."""

from __future__ import annotations

from protogen.model.messages import Message
from protogen.model.names import unit_suffix
from protogen.model.protocol import Protocol, Sender
from protogen.model.types import Field, Struct
from protogen.targets.kept import Kept
from protogen.targets.module_names import ModuleNames, RecordNames
from protogen.targets.naming import NameTable, Thing, inside, message, named_type
from protogen.targets.typescript.literals import camel

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

_LOCALS = """
r w m v rt at f data size content view place filled due values known end given counts name bytes
wire i byte sum
"""
"""What generated functions have themselves."""


class MemberNames(RecordNames):
    """Members of a message or struct, and the functions that show them in another way."""

    def __init__(self, module: NameTable, record: Struct | Message) -> None:
        self._module = module
        super().__init__(record, ("__proto__", "message")[: 1 + isinstance(record, Message)])

    def raw(self, field: Field) -> str:
        """The function that gives the raw value of a physical one."""
        own = f"{field.name}_from_{unit_suffix(field.unit)}"
        return self._beside_fields(own, inside(self._record, "reading", field.name))

    def _reading(self, field: Field) -> str:
        found = super()._reading(field)
        self.raw(field)
        return found

    def _beside_fields(self, name: str, thing: Thing) -> str:
        return self._module.add(camel(f"{self._record}_{name}"), thing)


class Names(ModuleNames[MemberNames]):
    """Names of a module."""

    def __init__(self, protocol: Protocol) -> None:
        self.frames: dict[str, str] = {}
        """The function that gives each sender's frame."""
        self.inputs: dict[str, str] = {}
        """The type of what an encoder takes for each message and struct."""
        self.functions: dict[str, tuple[str, str, str]] = {}
        """What reads and what writes the payload of each message, and its plan."""
        words = f"{_RESERVED} {_GLOBALS} {_OWN}".split()
        super().__init__(protocol, ("runtime", "index", "package"), words, ("__proto__",))

    def _name_sender(self, sender: Sender, thing: Thing) -> None:
        super()._name_sender(sender, thing)
        self.frames[sender.name] = self.module.add(f"{camel(sender.name)}Frame", thing)

    def _name_types(self, protocol: Protocol) -> None:
        super()._name_types(protocol)
        things = [(item.name, named_type(item.name)) for item in protocol.structs]
        things += [(item.name, message(item.name)) for item in protocol.messages]
        for name, thing in things:
            self.inputs[name] = self.module.add(f"{self.types[name]}Input", thing)
        for record in protocol.messages:
            thing, own = message(record.name), self.types[record.name]
            words = ("read", "write", "planOf")
            read, write, plan = (self.module.add(f"{word}{own}", thing) for word in words)
            self.functions[record.name] = read, write, plan

    def _record_names(self, record: Struct | Message) -> MemberNames:
        return MemberNames(self.module, record)


def locals_table() -> NameTable:
    """Names of a function's own variables."""
    return NameTable(f"{_RESERVED} {_GLOBALS} {_LOCALS}".split())


names_of = Kept(Names, most=64)
"""The names of a protocol's module."""
