"""A protocol's page: everything that its template prints."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec

from protogen.model.meanings import Enum, Flags
from protogen.model.protocol import Protocol
from protogen.targets.escape import markdown
from protogen.targets.markdown.fields.legends import Legend, type_legends
from protogen.targets.markdown.fields.values import type_anchor
from protogen.targets.markdown.frames.framing import FrameView, frame_views
from protogen.targets.markdown.pages.context import Context
from protogen.targets.markdown.pages.listing import (
    ListingView,
    counting,
    listing,
    ordered,
    overloads,
)
from protogen.targets.markdown.pages.message import MessageView, message_view
from protogen.targets.markdown.pages.record import (
    DecisionView,
    ExchangeView,
    decision_view,
    exchange_view,
    reserved,
    unknowns,
)
from protogen.targets.markdown.pages.top import facts, link_lines
from protogen.targets.markdown.text.origin import prose
from protogen.targets.markdown.text.table import Table
from protogen.targets.markdown.text.words import code


class PageView(msgspec.Struct, frozen=True, kw_only=True):
    """A protocol's page."""

    title: str
    about: tuple[str, ...]
    facts: tuple[tuple[str, str], ...]
    link: tuple[str, ...]
    frames: tuple[FrameView, ...]
    seven_bit: bool
    listings: tuple[ListingView, ...]
    counting: tuple[str, ...]
    overloads: tuple[str, ...]
    messages: tuple[MessageView, ...]
    types: tuple[Legend, ...]
    exchanges: tuple[ExchangeView, ...]
    decisions: tuple[DecisionView, ...]
    unknowns: Table | None
    reserved: Table | None


def page_view(protocol: Protocol) -> PageView:
    """Return a protocol's page. It depends on nothing else, so it can be generated alone."""
    context = Context.of(protocol)
    return PageView(
        title=markdown(protocol.title),
        about=prose(protocol.about.doc),
        facts=tuple(fact for fact in facts(protocol) if fact[1]),
        link=tuple(link_lines(protocol.link)),
        frames=frame_views(protocol),
        seven_bit=protocol.byte_bits == 7,
        listings=tuple(listing(sender, context) for sender in protocol.senders),
        counting=counting(protocol),
        overloads=tuple(overloads(protocol)),
        messages=tuple(message_view(context, item) for item in ordered(protocol)),
        types=tuple(_shared_tables(context)),
        exchanges=tuple(exchange_view(item, protocol) for item in protocol.exchanges),
        decisions=tuple(map(decision_view, protocol.decisions)),
        unknowns=unknowns(protocol.messages),
        reserved=reserved(protocol),
    )


def _shared_tables(context: Context) -> Iterator[Legend]:
    """Yield the tables of the types that several fields use, in the order of the model."""
    named_types: tuple[Enum | Flags, ...] = (*context.protocol.enums, *context.protocol.flags)
    for named in named_types:
        if named.name in context.shared:
            user = context.users[named.name][0]
            yield from type_legends(user, code(named.name), type_anchor(named))
