"""Pages over all protocols: the index, and counts of what each schema says of its document."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from protogen.model.messages import Example, Message
from protogen.model.protocol import Protocol
from protogen.targets.escape import markdown
from protogen.targets.markdown.fields.paths import named_fields
from protogen.targets.markdown.text.anchors import example_anchor
from protogen.targets.markdown.text.table import View, table
from protogen.targets.markdown.text.words import code, listed, sentence

_INDEX = ("Protocol", "Title", "Extends", "Senders", "Messages", "Document")
_COUNTS = (
    "Protocol",
    "Document",
    "Messages",
    "of them unspecified",
    "Fields",
    "of them unknown",
    "Examples verified",
    "Examples that contradict",
    "Decisions",
)


def index_view(protocols: Sequence[Protocol]) -> View:
    """Return the index."""
    return _tables(_INDEX, _index_row, protocols)


def fidelity_view(protocols: Sequence[Protocol]) -> View:
    """Return the page of counts, why some have no examples, and the contradictions it counts."""
    return {
        **_tables(_COUNTS, _count_row, protocols),
        "without_examples": [line for protocol in protocols for line in _missing(protocol)],
        "contradictions": [line for protocol in protocols for line in _contradictions(protocol)],
    }


def _tables(
    header: Sequence[str],
    row: Callable[[Protocol], Sequence[str]],
    protocols: Sequence[Protocol],
) -> View:
    """Return the tables of documents and of dialects, without those that have no rows."""
    documents = [row(protocol) for protocol in protocols if len(protocol.files) == 1]
    dialects = [row(protocol) for protocol in protocols if len(protocol.files) > 1]
    groups = {"documents": documents, "dialects": dialects}
    return {name: table(header, rows) if rows else None for name, rows in groups.items()}


def _page_link(protocol: Protocol) -> str:
    return f"[{protocol.name}]({protocol.name}.md)"


def _document(protocol: Protocol) -> str:
    return markdown(protocol.source.document or "") if protocol.source else ""


def _index_row(protocol: Protocol) -> tuple[str, ...]:
    return (
        _page_link(protocol),
        markdown(protocol.title),
        markdown(", ".join(protocol.files[1:])),
        listed([code(sender.name) for sender in protocol.senders]),
        str(len(protocol.messages)),
        _document(protocol),
    )


def _count_row(protocol: Protocol) -> tuple[str, ...]:
    specified = [message for message in protocol.messages if not message.unspecified]
    named = [field for message in specified for _, field in named_fields(message.plan.steps)]
    examples = [example for _, example in _examples(protocol)]
    contradicting = sum(example.contradicts is not None for example in examples)
    # A bare 0 would read as if examples had been left out.
    why = " ([why](#without-examples))" if any(_missing(protocol)) else ""
    return (
        _page_link(protocol),
        _document(protocol),
        str(len(protocol.messages)),
        str(len(protocol.messages) - len(specified)),
        str(len(named)),
        str(sum(field.unknown for field in named)),
        f"{len(examples) - contradicting}{why}",
        str(contradicting),
        str(len(protocol.decisions)),
    )


def _missing(protocol: Protocol) -> Iterator[str]:
    """Yield what the schema notes of its document, where that gave it no example."""
    note = protocol.source.note if protocol.source else None
    if note and not any(_examples(protocol)):
        yield f"{_page_link(protocol)}: {sentence(markdown(note))}"


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
