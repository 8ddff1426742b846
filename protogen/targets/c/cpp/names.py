"""Names of the namespace that a protocol has in C++, and of the values of its enums."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from protogen.c_language.words import foreign_words, headers
from protogen.model.meanings import Enum, Flags
from protogen.model.protocol import Protocol
from protogen.model.types import Field
from protogen.targets import naming
from protogen.targets.c.spelling import from_sender
from protogen.targets.kept import Kept
from protogen.targets.naming import OWN, PROTOCOL, NameTable, Thing, endpoint, named_type

_OWN = """
buffer bytes count counters decode detail dispatch encode encoded event_kind frame frame_room
framed has load message message_of name raw reason result send
"""
"""What each namespace has."""
_OF_A_SENDER = "decoder event parts"
_OF_FORMS = "decoder event form"
_GLOBAL = "std posix protogen"
"""Namespaces that are somebody else's."""


class CppNames:
    """Names of a protocol in C++. Structs keep the members that they have in C."""

    def __init__(self, protocol: Protocol) -> None:
        outside = NameTable((*foreign_words(), *headers(), *_GLOBAL.split()))
        self.space = outside.add(protocol.name, PROTOCOL)
        """The namespace."""
        self._inside = NameTable((*foreign_words(), *_OWN.split()))
        self._values: dict[str, NameTable] = {}
        """Scopes of the values of enums and of flags, by the names of these."""
        self._outside = outside
        for thing, words in _claimed(protocol):
            self.of(thing, *words)
        for enum in protocol.enums:
            self.values(enum)
        for flags in protocol.flags:
            self.values(flags)

    @property
    def tables(self) -> tuple[NameTable, ...]:
        """All scopes."""
        return (self._outside, self._inside, *self._values.values())

    def of(self, thing: Thing, *words: str) -> str:
        """A type or a function of the namespace."""
        return self._inside.add("_".join(words), thing)

    def values(self, item: Enum | Flags) -> tuple[str, ...]:
        """The names of an enum's values, or of flags, in their order."""
        table = self._values.setdefault(item.name, NameTable(foreign_words()))
        if isinstance(item, Enum):
            things = [(naming.value(item.name, it.name), it.name) for it in item.values]
        else:
            things = [(naming.flag(item.name, it.name), it.name) for it in item.bits]
        return tuple(table.add(name, thing) for thing, name in things)

    def messages(self, names: Sequence[str]) -> tuple[str, ...]:
        """The values of the enum of all messages, of which the last one says that there is none."""
        table = self._values.setdefault("", NameTable((*foreign_words(), "none")))
        return tuple(table.add(name, naming.message(name)) for name in names)

    def forms(self, name: str, forms: Sequence[str]) -> tuple[str, ...]:
        """The values of the enum of an endpoint's forms of frame, where `none` is another one."""
        table = self._values.setdefault(f"{name} form", NameTable((*foreign_words(), "none")))
        return tuple(table.add(form, endpoint(name)) for form in forms)


def _claimed(protocol: Protocol) -> Iterator[tuple[Thing, tuple[str, ...]]]:
    """Everything that the namespace has, whatever is chosen to be printed."""
    for sender in protocol.senders:
        suffix = from_sender(sender.name)
        yield OWN, (f"frame{suffix}",)
        yield OWN, (f"send{suffix}",)
        for word in _OF_A_SENDER.split():
            yield endpoint(sender.endpoint), (sender.name, word)
    for name in dict.fromkeys(item.endpoint for item in protocol.senders if not item.is_only_form):
        for word in _OF_FORMS.split():
            yield endpoint(name), (name, word)
    for name in (*(it.name for it in protocol.enums), *(it.name for it in protocol.flags)):
        yield named_type(name), (name,)
    for struct in protocol.structs:
        if struct.holds_values:
            yield named_type(struct.name), (struct.name,)
            yield from _of_fields(struct.name, struct.fields)
    for message in protocol.messages:
        yield naming.message(message.name), (message.name,)
        yield from _of_fields(message.name, message.fields)


def _of_fields(record: str, fields: Sequence[Field]) -> Iterator[tuple[Thing, tuple[str, ...]]]:
    for field in fields:
        if field.scaled and field.integer is not None:
            thing = naming.inside(record, "field", field.name)
            yield thing, (record, field.name, "physical")
            yield thing, (record, field.name, "raw")


cpp_names = Kept(CppNames, most=64)
"""Names that are asked for twice: once to list those that are escaped, and once to print them."""
