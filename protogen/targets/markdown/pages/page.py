"""A protocol's page: everything that its template prints."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from protogen.model.load import line_load
from protogen.model.meanings import Enum, Flags
from protogen.model.protocol import Protocol
from protogen.targets.emitted import emitted_names
from protogen.targets.escape import markdown
from protogen.targets.markdown.fields.legends import Legend, type_legends
from protogen.targets.markdown.fields.values import type_anchor
from protogen.targets.markdown.frames.framing import frame_views
from protogen.targets.markdown.pages.context import Context
from protogen.targets.markdown.pages.listing import counting, listing, ordered, overloads
from protogen.targets.markdown.pages.message import message_view
from protogen.targets.markdown.pages.record import decision_view, exchange_view, reserved, unknowns
from protogen.targets.markdown.text.code_names import other_names
from protogen.targets.markdown.text.origin import about_line, link, prose
from protogen.targets.markdown.text.table import View
from protogen.targets.markdown.text.words import code, number, plural, rate


def page_view(protocol: Protocol) -> View:
    """Return a protocol's page. It depends on nothing else, so it can be generated alone."""
    context = Context.of(protocol)
    return {
        "title": markdown(protocol.title),
        "about": prose(protocol.about.doc),
        "facts": [fact for fact in _facts(protocol) if fact[1]],
        "link": [*_link_lines(protocol)],
        "frames": frame_views(protocol),
        "seven_bit": protocol.byte_bits == 7,
        "listings": [listing(sender, context) for sender in protocol.senders],
        "counting": counting(protocol),
        "overloads": [*overloads(protocol)],
        "messages": [message_view(context, item) for item in ordered(protocol)],
        "types": [*_shared_tables(context)],
        "names": other_names(emitted_names(protocol)),
        "exchanges": [exchange_view(item, protocol) for item in protocol.exchanges],
        "decisions": [*map(decision_view, protocol.decisions)],
        "unknowns": unknowns(protocol.messages),
        "reserved": reserved(protocol),
    }


def _facts(protocol: Protocol) -> Iterator[tuple[str, str]]:
    """Yield labels and texts that say what the protocol is; a text can be empty."""
    yield "Protocol", code(protocol.name)
    yield "Version", markdown(protocol.version or "")
    yield "Extends", markdown(", ".join(protocol.files[1:]))
    source = protocol.source
    if source:
        yield "Document", markdown(source.document or "")
        yield "Revision", markdown(source.revision or "")
        yield "Source", link(source.url) if source.url else ""
        yield "Licence", markdown(source.license or "")
        yield "Note", markdown(source.note or "")
    yield "Spec hash", code(protocol.spec_hash)


def _link_lines(protocol: Protocol) -> Iterator[str]:
    """Yield paragraphs about the line."""
    line = protocol.link
    stop = plural(line.stop_bits, "stop bit")
    form = f"{line.data_bits} data bits, parity {line.parity}, {stop}"
    if line.baud is None:
        yield f"No rate is given; {form}."
    else:
        yield f"{line.baud} baud, {form}. {_byte_time(line.baud, line.bits_per_byte)}"
    for endpoint in protocol.endpoints:
        load = line_load(protocol, endpoint.name)
        if load is not None:
            name = code(endpoint.name)
            yield f"What {name} sends by itself keeps the line busy for {load.shown} of the time."
    if line.idle_timeout is not None:
        idle = number(line.idle_timeout * 1000)
        yield f"After {idle} ms of silence a receiver treats what it holds as ended."
    about = about_line(line.about)
    if about:
        yield about


def _byte_time(baud: int, bits: int) -> str:
    microseconds = number(Fraction(round(Fraction(bits * 10_000_000, baud)), 10))
    return f"A byte takes {microseconds} µs, {rate(Fraction(baud, bits))} bytes a second."


def _shared_tables(context: Context) -> Iterator[Legend]:
    """Yield the tables of the types that several fields use, in the order of the model."""
    named_types: tuple[Enum | Flags, ...] = (*context.protocol.enums, *context.protocol.flags)
    for named in named_types:
        if named.name in context.shared:
            user = context.users[named.name][0]
            yield from type_legends(user, code(named.name), type_anchor(named))
