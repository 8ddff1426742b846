"""Marks on the keys of the syntax classes: names that refer to what the schema declares.

Pydantic and the JSON Schema ignore them. `references` walks a document by them, so a key whose type
is one of these needs nothing else to be followed.
"""

from __future__ import annotations

from enum import Enum
from typing import Annotated, Any

import msgspec
from pydantic import Field

from protogen.schema.expressions import GREATEST_LENGTH
from protogen.schema.syntax.base import Name, Text, TypeForm, written_as


class Kind(Enum):
    """Kinds of things that a schema declares by name."""

    ENDPOINT = "endpoint"
    PART = "part"
    TYPE = "type"
    FIELD = "field"
    VALUE = "value"
    MESSAGE = "message"
    EXAMPLE = "example"
    FORM = "form"
    DECISION = "decision"


class Ref(msgspec.Struct, frozen=True):
    """Mark of a value, or of the keys of a mapping: the name of something of this kind."""

    kind: Kind
    of: str | None = None
    """Key beside it that names the owner: the message of an example, the switch of a case."""
    missing: str | None = None
    """Code of the problem where nothing has the name; None: the passes ask for more than that."""


class Formula(msgspec.Struct, frozen=True):
    """Mark of an expression over fields, in front of this one or around it."""


class Member(msgspec.Struct, frozen=True):
    """Mark of a field of the elements of the array whose key holds the mapping around it."""


class NumberPath(msgspec.Struct, frozen=True):
    """Mark of values that are MESSAGE.FIELD, or a part of some frame."""


class FieldPath(msgspec.Struct, frozen=True):
    """Mark of keys that are MESSAGE.FIELD, or a declared type."""


class FieldValues(msgspec.Struct, frozen=True):
    """Mark of a mapping that mirrors the fields of the message around it."""


class BySender(msgspec.Struct, frozen=True):
    """Mark of a mapping from endpoints to what may also stand there once, for all of them."""


class Matched(msgspec.Struct, frozen=True):
    """Mark of a part or field of the messages that the keys `of` of the exchange around name."""

    of: tuple[str, ...]


Mark = Ref | Formula | Member | NumberPath | FieldPath | FieldValues | Matched | BySender

EndpointName = Annotated[Name, Ref(Kind.ENDPOINT, missing="PG108")]
"""An endpoint."""

SenderKey = Annotated[str, Ref(Kind.ENDPOINT, missing="PG108")]
"""An endpoint, as the key of what is stated for each sender."""

PartName = Annotated[str, Ref(Kind.PART)]
"""A part of the frame, or a run `first..last` of them."""

TypeName = Annotated[Text, written_as(TypeForm), Ref(Kind.TYPE, missing="PG104")]
"""A built-in type, or one declared under `types`."""

ExpressionText = Annotated[
    Text, written_as(Annotated[str, Field(min_length=1, max_length=GREATEST_LENGTH)]), Formula()
]
"""An expression over fields in front: `count`, `n - 2`, `header.flags.has_gps`."""

MemberText = Annotated[
    Text, written_as(Annotated[str, Field(min_length=1, max_length=GREATEST_LENGTH)]), Member()
]
"""A field of an element, or bits of one: `is_last`, `head.flags.last`."""

FormName = Annotated[Name, Ref(Kind.FORM, missing="PG170")]
"""A form of frame."""

ExampleName = Annotated[Name, Ref(Kind.EXAMPLE, of="message", missing="PG164")]
"""An example of the message that the key beside it names."""

CaseKey = Annotated[Any, Ref(Kind.VALUE, of="switch")]
"""A value of the field that the key beside it names."""

FieldPathKey = Annotated[Text, FieldPath()]
"""MESSAGE.FIELD, or a declared type."""

ValuesByField = Annotated[dict[Name, Any], FieldValues()]
"""Values of a message's fields."""
