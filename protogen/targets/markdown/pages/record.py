"""Records of the document: exchanges, decisions, and what it does not say."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from protogen.model.identities import Identities
from protogen.model.messages import Exchange, Message, Step
from protogen.model.protocol import Decision, Protocol, ReservedIdentity
from protogen.targets.escape import markdown
from protogen.targets.markdown.fields.paths import fields_inside, named_fields
from protogen.targets.markdown.text.anchors import example_anchor, message_link
from protogen.targets.markdown.text.origin import about_line, place
from protogen.targets.markdown.text.table import Table, View, table
from protogen.targets.markdown.text.words import (
    code,
    hex_bytes,
    number,
    plural,
    sentence,
    sentences,
)

_MOST_BYTES = 24
"""Bytes of an exchange's step that are printed."""


def exchange_view(exchange: Exchange, protocol: Protocol) -> View:
    """Return a sequence of messages with the bytes of their examples, or a request as rows."""
    return {
        "title": markdown(exchange.title or exchange.name),
        "about": about_line(exchange.about),
        "table": _request(exchange) if exchange.requests else _sequence(exchange, protocol),
    }


def _sequence(exchange: Exchange, protocol: Protocol) -> Table:
    rows = [_step(index, step, protocol) for index, step in enumerate(exchange.steps, 1)]
    return table(("Step", "From", "Message", "Example", "Bytes", "What happens"), rows)


def _request(exchange: Exchange) -> Table:
    rows = [("Request", _any_of(exchange.requests)), ("Reply", _any_of(exchange.replies))]
    if exchange.refusals:
        rows.append(("Refusal", _any_of(exchange.refusals)))
    rows.append(("Told by", _told_by(exchange)))
    if exchange.timeout is not None:
        rows.append(("Timeout", f"{number(exchange.timeout * 1000)} ms"))
    if exchange.retries:
        rows.append(("Retries", str(exchange.retries)))
    return table(("What", "Which"), rows)


def _any_of(messages: Iterable[str]) -> str:
    return " or ".join(map(message_link, messages))


def _told_by(exchange: Exchange) -> str:
    """Return what tells which request a reply is of."""
    if not exchange.match:
        return "their order: one request waits at a time"
    pairs = (
        f"the same {code(one)}" if one == other else f"{code(other)}, equal to {code(one)}"
        for one, other in exchange.match
    )
    refusal = "" if exchange.is_refusal_matched else "; a refusal is of the request that waits"
    return f"{' and '.join(pairs)}{refusal}"


def _step(index: int, step: Step, protocol: Protocol) -> tuple[str, ...]:
    message = protocol.message(step.message)
    examples = {example.name: example for example in message.examples}
    example = examples.get(step.example) if step.example else None
    sender = protocol.sender(example.sender).endpoint if example else message.senders[0]
    shown = data = ""
    if example:
        shown = f"[{example.name}](#{example_anchor(message.name, example.name)})"
        data = code(_cut(hex_bytes(example.bytes)))
    about = about_line(step.about)
    return (str(index), code(sender), message_link(message.name), shown, data, about)


def _cut(text: str) -> str:
    room = 3 * _MOST_BYTES
    return text if len(text) <= room else f"{text[:room]}..."


def decision_view(decision: Decision) -> View:
    """Return a decision as sentences."""
    return {
        "name": decision.name,
        "question": sentence(markdown(decision.question)),
        "document": sentence(markdown(decision.document)),
        "choice": sentence(markdown(decision.choice)),
        "because": sentence(markdown(decision.because)),
        "source": place(decision.source),
    }


def reserved(protocol: Protocol) -> Table | None:
    """Return what may not come back with another meaning; None if nothing is reserved."""
    item = protocol.reserved
    rows = [
        *(_reserved_identity(protocol, identity) for identity in item.identities),
        *(
            (f"field names of {code(entry.message)}", ", ".join(map(code, entry.names)), "")
            for entry in item.fields
        ),
        *(
            (f"values of {code(entry.path)}", ", ".join(map(str, entry.values)), "")
            for entry in item.values
        ),
    ]
    return table(("What", "Reserved", "What it was"), rows) if rows else None


def _reserved_identity(protocol: Protocol, item: ReservedIdentity) -> tuple[str, ...]:
    parts = protocol.forms(item.sender)[0].frame.identity
    each = zip(parts, item.told_by.runs, strict=True)
    named = (f"{part.name} {Identities((runs,)).shown([part])}" for part, runs in each)
    what = sentence(markdown(item.doc)) if item.doc else ""
    return f"identity, from {code(item.sender)}", code(", ".join(named)), what


def unknowns(messages: Iterable[Message]) -> Table | None:
    """Return what the document does not say; None if it says everything."""
    rows = [row for message in messages for row in _unknown_rows(message)]
    return table(("Message", "Field", "What is known", "Where"), rows) if rows else None


def _unknown_rows(message: Message) -> Iterator[tuple[str, ...]]:
    if message.unspecified:
        known = f"{plural(message.sizes, 'byte')} of payload"
        yield message_link(message.name), "all", known, place(message.about.source)
        return
    if not any(field.unknown for field in fields_inside(message.plan.steps)):
        return
    for path, field in named_fields(message.plan.steps):
        if field.unknown:
            known = sentences(plural(field.type.sizes, "byte"), markdown(field.about.doc))
            yield message_link(message.name), code(path.shown), known, place(field.about.source)
