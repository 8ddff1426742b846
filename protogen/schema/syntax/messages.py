"""Messages with their examples, and overloads."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag

from protogen.schema.syntax.base import (
    ByteForm,
    ByteNumber,
    Character,
    Count,
    Name,
    PartValue,
    PartValueForm,
    RateText,
    SourceRef,
    Syntax,
    Text,
)
from protogen.schema.syntax.fields import FieldRef
from protogen.schema.syntax.names import (
    EndpointName,
    FormName,
    Kind,
    PartName,
    Ref,
    ValuesByField,
)
from protogen.schema.syntax.octets import Octets
from protogen.schema.syntax.parts import ByteOrder, PartRun, RawRange

Reason = Literal[
    "noise", "checksum", "length", "stuffing", "truncated", "size", "encoding", "value"
]
"""Reason why bytes are no frame."""


class Contradiction(Syntax):
    """Contradiction between an example of the document and the schema; checked to be just that."""

    fails: Literal[Reason, "values", "unknown"] = Field(
        description="The decoder's reason, `values` where it decodes to other values than the "
        "document prints (give `reads`), or `unknown` where its identity is another's."
    )
    why: Text = Field(
        description="What the document says elsewhere, and why the schema follows it."
    )
    reads: ValuesByField | None = Field(
        None, description="With fails: values, what the schema reads in these bytes."
    )


class Example(Syntax):
    """Bytes and the values that they mean."""

    frame: Octets | None = Field(None, description="The whole frame as on the wire.")
    content: Octets | None = Field(
        None, description="What a document prints without delimiters and checksum."
    )
    covers: PartRun | None = Field(None, description="The parts that `content` holds.")
    sender: Annotated[Name, Ref(Kind.ENDPOINT)] | None = Field(
        None, description="Who sends it, where the message has several senders."
    )
    form: FormName | None = Field(
        None, description="The form of its frame, where several begin alike."
    )
    values: ValuesByField | None = Field(
        None,
        description="Field values: raw numbers, enum names, lists, mappings for structs.",
    )
    parts: dict[Annotated[Name, Ref(Kind.PART)], PartValue] | None = Field(
        None,
        description="Values of frame parts that matter, such as a number or a counter.",
    )
    contradicts: Contradiction | None = Field(
        None, description="The example differs from the schema, in this way."
    )
    doc: Text | None = Field(None, description="What the example shows.")
    source: SourceRef | None = Field(None, description="Where it is printed.")


_Names = Annotated[list[Name], Field(min_length=1, json_schema_extra={"uniqueItems": True})]


def one_or_several(thing: str) -> BeforeValidator:
    """Let one name stand for a list of it; `thing` says, with its article, what has the name."""
    word = thing.rsplit(maxsplit=1)[-1]

    def listed(value: Any) -> Any:
        found = tuple(value) if isinstance(value, list | tuple) else (value,)
        if not found:
            raise ValueError(f"expected {thing}, or a list of {word}s")
        names = [name for name in found if isinstance(name, str)]
        if len(set(names)) < len(names):
            raise ValueError(f"{thing} stands here twice")
        return found

    return BeforeValidator(listed, json_schema_input_type=Name | _Names)


Senders = Annotated[tuple[EndpointName, ...], one_or_several("an endpoint")]
"""One endpoint or several."""

Forms = Annotated[tuple[FormName, ...], one_or_several("a form")]
"""One form of frame or several."""


class IdentityRange(Syntax):
    """All values from the first to the last."""

    range: RawRange = Field(description="The first and the last of several values.")


def _to_values(value: Any) -> Any:
    """One value stands for a list of one."""
    values = tuple(value) if isinstance(value, list | tuple) else (value,)
    if not values:
        raise ValueError("expected a value, or a list of values")
    return values


def _value_or_range(value: Any) -> str:
    return "range" if isinstance(value, dict | IdentityRange) else "value"


_IdentityValue = Annotated[
    Annotated[PartValue, Tag("value")] | Annotated[IdentityRange, Tag("range")],
    Discriminator(_value_or_range),
]
_IdentityForm = PartValueForm | IdentityRange

IdentityValues = Annotated[
    tuple[_IdentityValue, ...],
    BeforeValidator(
        _to_values,
        json_schema_input_type=_IdentityForm | Annotated[list[_IdentityForm], Field(min_length=1)],
    ),
]
"""Values of an identity part that all mean one message; the first is the one that is sent."""


def _to_identity(value: Any) -> Any:
    """One value, or several, stand for the only identity part, which the passes know."""
    is_range = isinstance(value, dict) and set(value) == {"range"}
    if isinstance(value, dict) and not (is_range and isinstance(value["range"], list)):
        return value
    return {"": value}


Identity = Annotated[
    dict[PartName, IdentityValues],
    BeforeValidator(
        _to_identity, json_schema_input_type=IdentityValues | dict[Name, IdentityValues]
    ),
]
"""Identity: a value or several, or a mapping of part to these."""


def _to_separator(value: Any) -> Any:
    return {"byte": value} if isinstance(value, int | str) else value


def _text_or_mapping(value: Any) -> str:
    return "text" if isinstance(value, str) else "mapping"


class Separator(Syntax):
    """The byte between the fields of a message."""

    byte: ByteNumber = Field(description="The separator.")
    in_front: bool = Field(False, description="One stands in front of the first field too.")


Separated = Annotated[
    Separator,
    BeforeValidator(_to_separator, json_schema_input_type=ByteForm | Character | Separator),
]
"""A byte or character, or a mapping."""


class MessageSyntax(Syntax):
    """One message: who sends it, how it is told apart, and its fields."""

    id: Identity | None = Field(
        None,
        description="Identity: a number or characters, or one for each identity part; a list or "
        "a range where there are several.",
    )
    from_: Senders = Field(alias="from", description="The endpoint that sends it, or a list.")
    forms: Forms | None = Field(
        None, description="The forms of frame that carry it, where not all of its sender's do."
    )
    parts: dict[Annotated[Name, Ref(Kind.PART)], PartValue] | None = Field(
        None,
        description="Values of the frame's virtual parts in frames of this message.",
    )
    rate: RateText | None = Field(
        None,
        description="How often it is sent by itself: `50 Hz`, a number in Hz, or the time between, "
        "such as `20 ms`.",
    )
    title: Text | None = Field(None, description="Name of the message in the document.")
    summary: Text | None = Field(None, description="One line that says what the message is.")
    doc: Text | None = Field(None, description="What a reader should know.")
    source: SourceRef | None = Field(None, description="Where the message is written down.")
    byte_order: ByteOrder | None = Field(None, description="Byte order of its fields.")
    separator: Separated | None = Field(
        None,
        description="A byte that stands between the fields, which are text: decimal, hexadecimal, "
        "ascii and closed char, and structs and arrays of them.",
    )
    fields: Annotated[
        Annotated[Literal["unspecified"], Tag("text")]
        | Annotated[dict[Name, FieldRef], Tag("mapping")],
        Discriminator(_text_or_mapping),
    ] = Field(
        default_factory=dict,
        description="Fields in wire order, or `unspecified`: the document does not say.",
    )
    renamed_from: Name | None = Field(
        None, description="The message's name in the version before: only the name changed."
    )
    min_size: Count | None = Field(None, description="Least payload size if unspecified.")
    max_size: Count | None = Field(None, description="Greatest payload size if unspecified.")
    examples: dict[Name, Example] | None = Field(
        None, description="Named examples: bytes and the values that they mean."
    )


class Overload(Syntax):
    """Messages of one sender that share an identity."""

    messages: tuple[Annotated[Name, Ref(Kind.MESSAGE, missing="PG154")], ...] = Field(
        strict=False, description="The messages that share it."
    )
    by: Literal["size", "undecidable"] = Field(
        description="How a receiver tells them apart: by payload size, or not at all."
    )
    yields: Annotated[Name, Ref(Kind.MESSAGE)] | None = Field(
        None, description="If undecidable, the message that a decoder yields."
    )
    decision: Annotated[Name, Ref(Kind.DECISION, missing="PG165")] | None = Field(
        None, description="The decision that accepts it."
    )
    doc: Text | None = Field(None, description="What a reader should know.")
    source: SourceRef | None = Field(None, description="Where it is written down.")
