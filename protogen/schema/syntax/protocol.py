"""The root of a schema."""

from __future__ import annotations

from collections.abc import Set
from functools import cache
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from protogen.schema.syntax.base import (
    Duration,
    Int,
    Name,
    RawNumber,
    ShortForm,
    Source,
    SourceRef,
    Syntax,
    Text,
    written_as,
)
from protogen.schema.syntax.exchanges import Exchange
from protogen.schema.syntax.fields import FieldRef
from protogen.schema.syntax.forms import Form, keys_of, models_inside
from protogen.schema.syntax.messages import (
    Identity,
    MessageSyntax,
    Overload,
    Senders,
)
from protogen.schema.syntax.names import (
    BySender,
    EndpointName,
    FieldPathKey,
    Kind,
    Ref,
    SenderKey,
)
from protogen.schema.syntax.parts import (
    ByteOrder,
    Part,
    PartRun,
    TransparencyRef,
    TransparencySyntax,
)


class Link(Syntax):
    """The line that the frames travel on."""

    baud: Int | None = Field(None, gt=0, description="Bits per second on the line.")
    data_bits: Int = Field(8, ge=5, le=9, description="Data bits of a character.")
    parity: Literal["none", "even", "odd", "mark", "space"] = Field(
        "none", description="Parity bit of a character."
    )
    stop_bits: Literal[1, 2] = Field(1, description="Stop bits of a character.")
    idle_timeout: Duration | None = Field(
        None,
        description="After how long a silence a receiver should call flush: 20 ms.",
    )
    doc: Text | None = Field(None, description="What a reader should know.")
    source: SourceRef | None = Field(None, description="Where it is written down.")


class Endpoint(Syntax):
    """A named side of the link."""

    title: Text = Field(description="What it is.")
    doc: Text | None = Field(None, description="What a reader should know.")


EndpointRef = Annotated[
    Endpoint,
    BeforeValidator(ShortForm("title"), json_schema_input_type=Text | Endpoint),
]


class Decision(Syntax):
    """Choice where the document says nothing, or two things."""

    question: Text = Field(description="What the document leaves open.")
    document: Text = Field(description="What the document says about it, in own words.")
    choice: Text = Field(description="What the schema does.")
    because: Text = Field(description="Why.")
    source: SourceRef | None = Field(None, description="The places in question.")


class ReservedIdentity(Syntax):
    """An identity that may not come back."""

    from_: EndpointName = Field(alias="from", description="The endpoint that sent it.")
    id: Identity = Field(description="The identity.")
    doc: Text | None = Field(None, description="What it was.")


class Reserved(Syntax):
    """Identities, names and values that may not come back with another meaning."""

    identities: tuple[ReservedIdentity, ...] = Field(
        (), strict=False, description="Identities of deleted messages."
    )
    fields: dict[
        Annotated[Name, Ref(Kind.MESSAGE)], Annotated[tuple[Name, ...], Field(strict=False)]
    ] = Field(
        default_factory=dict,
        description="Message to the field names it may not use again.",
    )
    values: dict[FieldPathKey, Annotated[tuple[RawNumber, ...], Field(strict=False)]] = Field(
        default_factory=dict,
        description="MESSAGE.FIELD or type to raw values not to use again.",
    )


Frame = Annotated[dict[Name, Part], Field(max_length=64)]
"""Parts in wire order."""

_FrameForm = Annotated[Frame, Field(json_schema_extra={"required": ["payload"]})]


class FrameForm(Syntax):
    """One of several forms of frame that are on one line."""

    from_: Senders | None = Field(
        None, alias="from", description="The endpoints that send it; without it all of them."
    )
    title: Text | None = Field(None, description="Title for people.")
    doc: Text | None = Field(None, description="What a reader should know.")
    source: SourceRef | None = Field(None, description="Where it is written down.")
    frame: Annotated[dict[Name, Part], Field(max_length=64), written_as(_FrameForm)] = Field(
        description="The parts of a frame in wire order."
    )
    transparency: TransparencyRef | None = Field(
        None, description="What keeps delimiters out of the frame."
    )
    max_frame: Annotated[Int, Field(ge=1)] | None = Field(
        None, description="Bytes on the wire that no frame of the form exceeds."
    )
    behind: Annotated[Name, Ref(Kind.DECISION, missing="PG143")] | None = Field(
        None,
        description="The decision that accepts that bytes can be a frame of this form and of one "
        "above, which then wins.",
    )


ALL_SENDERS = ""
"""Key of what is written once for every sender."""


def _for_all(value: Any) -> Any:
    return {ALL_SENDERS: value} if isinstance(value, str) else value


def _limit_for_all(value: Any) -> Any:
    return value if isinstance(value, dict) else {ALL_SENDERS: value}


_LimitForm = Annotated[int, Field(ge=1)]

_MARKS: dict[str, frozenset[str]] = {
    "frame": frozenset({"payload"}),
    "transparency": frozenset(TransparencySyntax.model_fields),
}
"""Keys by which a frame or a transparency shows what it is, also under a misspelled endpoint."""


def is_by_sender(schema: Any, key: str) -> bool:
    """True if what the data of a schema have under a key is keyed by endpoints."""
    value, endpoints = schema.get(key), _keys(schema.get("endpoints"))
    keys = _keys(value)
    if key not in _MARKS or not keys:
        return bool(keys)
    marks = _MARKS[key]
    if keys <= endpoints or keys & marks:
        return keys <= endpoints
    named = bool(keys & endpoints)
    return any(_keys(item) & marks or (named and isinstance(item, str)) for item in value.values())


def _keys(value: Any) -> Set[Any]:
    return value.keys() if isinstance(value, dict) else frozenset()


class ProtocolSyntax(Syntax):
    """One YAML file: a serial protocol, completely."""

    protocol: Name = Field(description="Name of the protocol: modules and files are called so.")
    extends: Text | None = Field(
        None,
        description="The schema that this one changes: its path from this file, or library:NAME.",
    )
    title: Text | None = Field(None, description="Title for people.")
    doc: Text | None = Field(None, description="What a reader should know first.")
    version: Text | None = Field(None, description="Version of the schema.")
    source: Source | None = Field(None, description="The document that the schema transcribes.")
    link: Link = Field(default_factory=Link, description="The line: baud rate and so on.")
    endpoints: dict[Name, EndpointRef] = Field(description="The named sides of the link.")
    byte_order: Annotated[
        dict[SenderKey, ByteOrder],
        BeforeValidator(_for_all, json_schema_input_type=ByteOrder | dict[Name, ByteOrder]),
        BySender(),
    ] = Field(
        default_factory=dict,
        description="Order of the bytes of a number: little or big, for all or for each sender.",
    )
    byte_bits: Literal[7, 8] = Field(
        8, description="Bits that a payload byte carries; with 7 its highest bit is 0."
    )
    frame: Annotated[
        dict[SenderKey, Frame],
        written_as(_FrameForm | dict[Name, _FrameForm]),
        BySender(),
    ] = Field(
        description="The parts of a frame in wire order; one frame for all, or one per sender."
    )
    forms: Annotated[dict[Name, FrameForm], Field(min_length=1, max_length=16)] | None = Field(
        None,
        description="Several forms of frame on one line, instead of `frame`: an encoder takes the "
        "first that fits, a decoder all of them.",
    )
    transparency: Annotated[
        dict[SenderKey, TransparencyRef],
        written_as(TransparencyRef | dict[Name, TransparencyRef]),
        BySender(),
    ] = Field(
        default_factory=dict,
        description="What keeps delimiters out of the frame; for all or per sender.",
    )
    max_frame: Annotated[
        dict[SenderKey, Annotated[Int, Field(ge=1)]],
        BeforeValidator(_limit_for_all, json_schema_input_type=_LimitForm | dict[Name, _LimitForm]),
        BySender(),
    ] = Field(
        default_factory=dict,
        description="Bytes on the wire that no frame exceeds; for all or per sender.",
    )
    content_covers: PartRun | None = Field(
        None,
        description="What the `content` of examples holds where they do not say it.",
    )
    types: dict[Name, FieldRef] = Field(
        default_factory=dict, description="Named types: enums, flags, structs."
    )
    messages: dict[Name, MessageSyntax] = Field(description="The messages.")
    overloads: dict[Name, Overload] = Field(
        default_factory=dict,
        description="Messages of one sender that share an identity.",
    )
    exchanges: dict[Name, Exchange] = Field(
        default_factory=dict,
        description="Named sequences of messages, and requests with their replies.",
    )
    decisions: dict[Name, Decision] = Field(
        default_factory=dict,
        description="What was decided where the document leaves it open.",
    )
    reserved: Reserved = Field(
        default_factory=Reserved,
        description="What may not come back with another meaning.",
    )

    @model_validator(mode="before")
    @classmethod
    def _split_by_sender(cls, data: Any) -> Any:
        if not isinstance(data, dict):
            return data
        if data.get("forms") is not None:
            data = {"frame": {}, **data}
        shared = (
            key for key in _MARKS if data.get(key) is not None and not is_by_sender(data, key)
        )
        return {**data, **{key: {ALL_SENDERS: data[key]} for key in shared}}


SCHEMA = Form(models=[ProtocolSyntax])
"""Form of a whole schema."""


@cache
def keyed_by_names() -> frozenset[object]:
    """Keys anywhere in a schema whose mappings have names for keys."""
    return frozenset(
        key
        for model in models_inside(SCHEMA)
        for key, form in keys_of(model).items()
        if form.names is not None
    )
