"""Names of generated Python: those of a module, and those of each class in it."""

from __future__ import annotations

import keyword
from collections.abc import Collection, Iterator, Sequence

from protogen.model.meanings import BitField, Enum, Flags
from protogen.model.messages import Message
from protogen.model.names import unit_suffix
from protogen.model.protocol import Protocol
from protogen.model.types import Field, Integer, Struct
from protogen.targets.naming import (
    OWN,
    NameTable,
    Thing,
    endpoint,
    inside,
    message,
    named_type,
    part,
)
from protogen.targets.python.spelling import class_name

_OWN = """
EncodeError DecodeError SPEC_HASH VERSION MESSAGES PROTOCOL Parts Sender Encoder Decoder encode
decode
"""
_ATTRIBUTES = "violations to_dict from_dict to_payload from_payload parse_payload"
"""Attributes of generated messages and structs, which a field of the name would hide."""
_ARGUMENTS = "message sender strict engine"
"""Arguments of a generated encoder beside the parts whose values the caller gives."""

_RESERVED = dict.fromkeys(keyword.kwlist, Thing("is a reserved word of Python"))
_USED = Thing("is a name that generated code uses itself")


def tables_of(protocol: Protocol) -> Iterator[NameTable]:
    """Each scope of a module."""
    yield _module(protocol)
    records: tuple[Struct | Message, ...] = (*protocol.structs, *protocol.messages)
    yield from (_attributes(record.name, record.fields) for record in records)
    yield _arguments(protocol)


def _table(own: str, used: Thing) -> NameTable:
    """The words of Python, and those that generated code uses there."""
    table = NameTable()
    table.things |= _RESERVED
    table.things |= dict.fromkeys(own.split(), used)
    return table


def _module(protocol: Protocol) -> NameTable:
    table = _table(_OWN, OWN)
    for sender in protocol.senders:
        thing = endpoint(sender.endpoint)
        for word in (f"{sender.name.upper()}_SENDER", f"{sender.name.upper()}_FORMAT"):
            table.add(word, thing)
        for word in (union_name(sender.endpoint), parts_name(sender.name)):
            table.add(word, thing)
        table.add(frame_name(sender.name), thing)
    types: tuple[Enum | Flags | Struct, ...] = (*protocol.enums, *protocol.flags, *protocol.structs)
    for item in types:
        table.add(class_name(item.name), named_type(item.name))
    for record in protocol.messages:
        table.add(class_name(record.name), message(record.name))
    return table


def _arguments(protocol: Protocol) -> NameTable:
    """Parameters of encoders. Parts of several senders that are called alike are one of them."""
    given: dict[str, Thing] = {}
    for sender in protocol.senders:
        for item in sender.frame.caller_parts:
            given.setdefault(item.name, part(sender.name, item.name))
    has_forms = any(not sender.is_only_form for sender in protocol.senders)
    table = _table(f"{_ARGUMENTS} form" if has_forms else _ARGUMENTS, _USED)
    for name, thing in given.items():
        table.add(name, thing)
    return table


def union_name(sender: str) -> str:
    """The type of an endpoint's messages."""
    return f"{class_name(sender)}Message"


def parts_name(sender: str) -> str:
    """The class of the parts of an endpoint's frames, where others have others."""
    return f"{class_name(sender)}Parts"


def frame_name(sender: str) -> str:
    """The function that describes an endpoint's frame."""
    return f"_{sender}_frame_spec"


# --- attributes -----------------------------------------------------------------------------------


def _attributes(record: str, fields: Sequence[Field]) -> NameTable:
    """The attributes of a message or struct: fields, readings, and runs of bits."""
    table = _table(_ATTRIBUTES, _USED)
    taken = frozenset(field.name for field in fields)
    for field in fields:
        table.add(field.name, inside(record, "field", field.name))
    for field in fields:
        if field.scaled:
            table.add(physical_name(field, taken), inside(record, "reading", field.name))
        for item in field.type.bit_fields if isinstance(field.type, Integer) else ():
            thing = inside(record, "run of bits", field.name, "bits", item.name)
            table.add(bits_name(field, item, taken), thing)
    return table


def physical_name(field: Field, taken: Collection[str]) -> str:
    """The property that is a field's reading."""
    return _free(f"{field.name}_{unit_suffix(field.unit)}", taken)


def bits_name(field: Field, item: BitField, taken: Collection[str]) -> str:
    """The property that is a run of bits."""
    return _free(f"{field.name}_{item.name}", taken)


def _free(name: str, taken: Collection[str]) -> str:
    """A name that no field has."""
    while name in taken:
        name += "_value"
    return name
