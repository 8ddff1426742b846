"""Names of generated Python: those of a module, and those of each class in it."""

from __future__ import annotations

from collections.abc import Iterator

from protogen.model.messages import Message
from protogen.model.protocol import Protocol, Sender
from protogen.model.types import Struct
from protogen.runtime.attributes import ARGUMENTS, ATTRIBUTES
from protogen.targets.kept import Kept
from protogen.targets.module_names import ModuleNames, RecordNames
from protogen.targets.naming import NameTable, Thing, part
from protogen.targets.python.words import words_of_files, words_of_modules


class ClassNames(RecordNames):
    """Attributes of a message or struct."""

    def __init__(self, record: Struct | Message) -> None:
        super().__init__(record, ATTRIBUTES)

    def _beside_fields(self, name: str, thing: Thing) -> str:
        while name in self.fields:
            name += "_value"
        return self.table.add(name, thing)


class Names(ModuleNames[ClassNames]):
    """Names of a module: of its classes, and of what it has for each endpoint."""

    def __init__(self, protocol: Protocol) -> None:
        super().__init__(protocol, words_of_files(), words_of_modules(), ATTRIBUTES)
        self.arguments = _arguments(protocol)
        """Names of the parameters of encoders."""

    def _name_sender(self, sender: Sender, thing: Thing) -> None:
        for word in ("SENDER", "FORMAT"):
            self.module.add(f"{sender.name.upper()}_{word}", thing)
        super()._name_sender(sender, thing)

    def _record_names(self, record: Struct | Message) -> ClassNames:
        return ClassNames(record)

    @property
    def tables(self) -> Iterator[NameTable]:
        """Each scope."""
        yield from super().tables
        yield self.arguments


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
