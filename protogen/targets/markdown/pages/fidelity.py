"""Counts of what each schema says of its document."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import msgspec

from protogen.copying import field_names
from protogen.model.messages import Example, Message
from protogen.model.protocol import Protocol
from protogen.targets.escape import markdown
from protogen.targets.markdown.fields.walk import named_fields
from protogen.targets.markdown.text.anchors import example_anchor
from protogen.targets.markdown.text.table import Table, table
from protogen.targets.markdown.text.words import sentence


class Counts(msgspec.Struct, frozen=True, kw_only=True):
    """Counts for one protocol or all."""

    messages: int
    unspecified: int
    fields: int
    unknown: int
    verified: int
    contradicting: int
    decisions: int


_TITLES = {
    "messages": "Messages",
    "unspecified": "of them unspecified",
    "fields": "Fields",
    "unknown": "of them unknown",
    "verified": "Examples verified",
    "contradicting": "Examples that contradict",
    "decisions": "Decisions",
}


class FidelityView(msgspec.Struct, frozen=True, kw_only=True):
    """The page of counts, why some have no examples, and the contradictions that it counts."""

    documents: Table | None
    dialects: Table | None
    without_examples: tuple[str, ...]
    contradictions: tuple[str, ...]


def count(protocol: Protocol) -> Counts:
    """Count what a protocol says."""
    specified = [message for message in protocol.messages if not message.unspecified]
    named = [field for message in specified for _, field in named_fields(message.plan.steps)]
    examples = [example for _, example in _examples(protocol)]
    contradicting = sum(example.contradicts is not None for example in examples)
    return Counts(
        messages=len(protocol.messages),
        unspecified=len(protocol.messages) - len(specified),
        fields=len(named),
        unknown=sum(field.unknown for field in named),
        verified=len(examples) - contradicting,
        contradicting=contradicting,
        decisions=len(protocol.decisions),
    )


def fidelity_view(protocols: Sequence[Protocol]) -> FidelityView:
    """Return the page's tables, documents and dialects apart."""
    documents = [protocol for protocol in protocols if len(protocol.files) == 1]
    dialects = [protocol for protocol in protocols if len(protocol.files) > 1]
    return FidelityView(
        documents=_table(documents),
        dialects=_table(dialects),
        without_examples=tuple(line for protocol in protocols for line in _missing(protocol)),
        contradictions=tuple(line for protocol in protocols for line in _contradictions(protocol)),
    )


def page_link(protocol: Protocol) -> str:
    """Return a link to a protocol's page."""
    return f"[{protocol.name}]({protocol.name}.md)"


def _table(protocols: Sequence[Protocol]) -> Table | None:
    if not protocols:
        return None
    header = ("Protocol", "Document", *(_TITLES[name] for name in field_names(Counts)))
    return table(header, (_row(protocol) for protocol in protocols))


def _row(protocol: Protocol) -> tuple[str, ...]:
    counts = count(protocol)
    document = protocol.source.document if protocol.source else None
    numbers = {name: str(getattr(counts, name)) for name in field_names(Counts)}
    if any(_missing(protocol)):
        # A bare 0 would read as if examples had been left out.
        numbers["verified"] += " ([why](#without-examples))"
    return (page_link(protocol), markdown(document or ""), *numbers.values())


def _missing(protocol: Protocol) -> Iterator[str]:
    """Yield what the schema notes of its document, where that gave it no example."""
    note = protocol.source.note if protocol.source else None
    if note and not any(_examples(protocol)):
        yield f"{page_link(protocol)}: {sentence(markdown(note))}"


def _contradictions(protocol: Protocol) -> Iterator[str]:
    for message, example in _examples(protocol):
        if example.contradicts is not None:
            anchor = example_anchor(message.name, example.name)
            names = f"{protocol.name}, {message.name}, {example.name}"
            why = sentence(markdown(example.contradicts.why))
            yield f"[{names}]({protocol.name}.md#{anchor}): {why}"


def _examples(protocol: Protocol) -> Iterator[tuple[Message, Example]]:
    for message in protocol.messages:
        for example in message.examples:
            yield message, example
