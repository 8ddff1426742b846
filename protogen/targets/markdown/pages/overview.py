"""Pages over all protocols: the index, and counts of what each schema says of its document.

Each protocol has a section of its own. Its heading and the blank lines stay, so git merges branches
that change different schemas; rows of one table would be neighbours, and conflict.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from protogen.model.protocol import Protocol
from protogen.targets.escape import markdown
from protogen.targets.markdown.fields.paths import fields_inside
from protogen.targets.markdown.text.anchors import example_anchor
from protogen.targets.markdown.text.table import View
from protogen.targets.markdown.text.words import code, listed, sentence


def index_view(protocols: Sequence[Protocol]) -> View:
    """Return the index."""
    return {"protocols": [_section(protocol, _facts(protocol)) for protocol in protocols]}


def fidelity_view(protocols: Sequence[Protocol]) -> View:
    """Return the page of counts, why some have no examples, and the contradictions it counts."""
    return {"protocols": [_section(protocol, _counts(protocol)) for protocol in protocols]}


def _section(protocol: Protocol, facts: Iterator[tuple[str, str]]) -> View:
    return {
        "link": f"[{protocol.name}]({protocol.name}.md)",
        "title": sentence(markdown(protocol.title)),
        "facts": [fact for fact in facts if fact[1]],
    }


def _document(protocol: Protocol) -> str:
    return markdown(protocol.source.document or "") if protocol.source else ""


def _facts(protocol: Protocol) -> Iterator[tuple[str, str]]:
    """Yield labels and texts; a text can be empty."""
    yield "Extends", markdown(", ".join(protocol.files[1:]))
    yield "Document", _document(protocol)
    yield "Senders", listed([code(name) for name in protocol.sending])
    yield "Messages", str(len(protocol.messages))


def _counts(protocol: Protocol) -> Iterator[tuple[str, str]]:
    """Yield labels and texts; a text can be empty."""
    specified = [message for message in protocol.messages if not message.unspecified]
    named = [field for message in specified for field in fields_inside(message.plan.steps)]
    examples = sum(len(message.examples) for message in protocol.messages)
    contradictions = [*_contradictions(protocol)]
    unspecified = len(protocol.messages) - len(specified)
    yield "Document", _document(protocol)
    yield "Messages", f"{len(protocol.messages)}, {unspecified} unspecified"
    yield "Fields", f"{len(named)}, {sum(field.unknown for field in named)} unknown"
    yield "Examples", f"{examples - len(contradictions)} verified, {len(contradictions)} contradict"
    if not examples and protocol.source:
        # A bare 0 would read as if examples had been left out.
        yield "Why no examples", sentence(markdown(protocol.source.note or ""))
    yield from (("Contradicts", text) for text in contradictions)
    yield "Decisions", str(len(protocol.decisions))


def _contradictions(protocol: Protocol) -> Iterator[str]:
    """Yield each example that contradicts the schema, as a link, and why it does."""
    for message in protocol.messages:
        for example in message.examples:
            if example.contradicts is not None:
                anchor = example_anchor(message.name, example.name)
                why = sentence(markdown(example.contradicts.why))
                yield f"[{message.name}, {example.name}]({protocol.name}.md#{anchor}): {why}"
