"""Exchanges: sequences of messages, and requests with what answers them."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from protogen.schema.syntax.base import (
    Duration,
    Int,
    Name,
    OnlyTrue,
    ShortForm,
    SourceRef,
    Syntax,
    Text,
)
from protogen.schema.syntax.messages import one_or_several
from protogen.schema.syntax.names import ExampleName, Kind, Matched, Ref

MessageName = Annotated[Name, Ref(Kind.MESSAGE, missing="PG164")]
"""A message of an exchange."""


class Step(Syntax):
    """One message of an exchange."""

    message: MessageName = Field(description="The message.")
    example: ExampleName | None = Field(None, description="Which of its examples is sent.")
    doc: Text | None = Field(None, description="What happens here.")
    source: SourceRef | None = Field(None, description="Where it is printed.")


StepRef = Annotated[Step, BeforeValidator(ShortForm("message"), json_schema_input_type=Name | Step)]
"""A step; a bare text names the message."""

MessageNames = Annotated[tuple[MessageName, ...], one_or_several("a message")]
"""One message or several."""


def _same_name(value: Any) -> Any:
    """One name stands for what both messages call so."""
    return {value: value} if isinstance(value, str) else value


Match = Annotated[
    dict[Annotated[Name, Matched(("request",))], Annotated[Name, Matched(("reply", "refusal"))]],
    Field(min_length=1),
    BeforeValidator(_same_name, json_schema_input_type=Name | dict[Name, Name]),
    Matched(("request", "reply", "refusal")),
]
"""Parts or fields of the request, with those of the reply that are equal; or one name of both."""


class Exchange(Syntax):
    """A sequence of messages, or a request with what answers it."""

    title: Text | None = Field(None, description="Name of the exchange.")
    steps: tuple[StepRef, ...] | None = Field(
        None, strict=False, description="The messages in order, where it is a sequence."
    )
    request: MessageNames | None = Field(
        None, description="The message that asks, or a list of those that are answered alike."
    )
    reply: MessageNames | None = Field(
        None, description="The message that answers, or a list of which any does."
    )
    refusal: MessageNames | None = Field(
        None, description="The message that says no, or a list of which any does."
    )
    match: Match | None = Field(
        None,
        description="Part or field of the request, such as a counter, to that of its reply with "
        "the same value; without it, order tells which request a reply is of.",
    )
    unmatched_refusal: OnlyTrue | None = Field(
        None, description="A refusal has no such value: it is of the only request that waits."
    )
    timeout: Duration | None = Field(
        None, description="After how long a request is taken for lost: 100 ms."
    )
    retries: Annotated[Int, Field(ge=0, le=100)] | None = Field(
        None, description="How often it is then sent again, the same bytes."
    )
    doc: Text | None = Field(None, description="What the exchange does.")
    source: SourceRef | None = Field(None, description="Where it is written down.")
