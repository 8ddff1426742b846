"""Bytes that payloads can hold.

Where fields are text, few bytes can stand for them, and a delimiter that is none of these can't
occur in a payload. Nothing is said of other fields: each of their bytes may be any.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from protogen.model.constants import constant_bytes
from protogen.model.messages import Message
from protogen.model.nesting import holds_whole_bytes, inner_types
from protogen.model.types import (
    Between,
    Field,
    Integer,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
    is_text,
)
from protogen.passes.proofs.wire_code import EVERY_BYTE, SEVEN_BITS, ByteSet

_NOTHING: ByteSet = frozenset()


def payload_alphabet(byte_bits: int, messages: Sequence[Message], *, is_cut: bool) -> ByteSet:
    """The bytes that payloads of these messages can hold.

    Nothing is said of what newer senders have behind the fields of payloads that are cut.
    """
    fields = [field for message in messages for field in message.fields if not field.part]
    if byte_bits == 7:
        whole = any(holds_whole_bytes(field.type) for field in fields)
        return EVERY_BYTE if whole else SEVEN_BITS
    if is_cut or not any(map(_holds_text, (field.type for field in fields))):
        return EVERY_BYTE
    # Where no payload has a byte, nothing is known of those of unknown identities.
    return _of_fields(fields) or EVERY_BYTE


def fields_with(messages: Sequence[Message], values: ByteSet, byte_bits: int) -> tuple[str, ...]:
    """The fields, as `message.field`, that can hold one of these bytes."""
    open_fields = []
    for message in messages:
        for field in message.fields:
            held = _of_field(field)
            if byte_bits == 7 and not holds_whole_bytes(field.type):
                held &= SEVEN_BITS
            if not field.part and not held.isdisjoint(values):
                open_fields.append(f"{message.name}.{field.name}")
    return tuple(open_fields)


def _holds_text(type_: Type) -> bool:
    is_between = isinstance(type_, Text) and isinstance(type_.extent, Between)
    is_coded = isinstance(type_, Text) and not type_.form.is_plain
    is_told = is_between or is_coded or is_text(type_)
    return is_told or any(map(_holds_text, inner_types(type_)))


def _of_fields(fields: Iterable[Field]) -> ByteSet:
    return _NOTHING.union(*map(_of_field, fields))


def _of_field(field: Field) -> ByteSet:
    is_char = isinstance(field.type, Integer) and field.type.role == "char"
    if field.const is not None and (is_char or isinstance(field.type, Text | Octets)):
        return frozenset(constant_bytes(field))
    return _of(field.type)


def _of(type_: Type) -> ByteSet:
    match type_:
        case Integer() if type_.text is not None:
            return frozenset(type_.characters)
        case Text(extent=Between() as extent):
            return frozenset(extent.alphabet)
        case Integer(role="char", enum=enum) if enum is not None and enum.closed:
            return frozenset(item.value for item in enum.values)
        case Text():
            return type_.form.alphabet
        case Struct(packed=None):
            return _of_fields(type_.fields)
        case Switch() if type_.rest is not None:
            return EVERY_BYTE
        case _ if inner := inner_types(type_):
            return _NOTHING.union(*map(_of, inner))
    return EVERY_BYTE
