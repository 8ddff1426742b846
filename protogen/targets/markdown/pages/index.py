"""The index over all protocols."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec

from protogen.model.protocol import Protocol
from protogen.targets.escape import markdown
from protogen.targets.markdown.pages.fidelity import page_link
from protogen.targets.markdown.text.table import Table, table
from protogen.targets.markdown.text.words import code, listed


class IndexView(msgspec.Struct, frozen=True, kw_only=True):
    """The protocols, and the dialects of theirs."""

    protocols: Table | None
    dialects: Table | None


def index_view(protocols: Sequence[Protocol]) -> IndexView:
    """Return the tables of the index."""
    documents = [protocol for protocol in protocols if len(protocol.files) == 1]
    dialects = [protocol for protocol in protocols if len(protocol.files) > 1]
    return IndexView(protocols=_table(documents), dialects=_table(dialects))


def _table(protocols: Sequence[Protocol]) -> Table | None:
    if not protocols:
        return None
    header = ("Protocol", "Title", "Extends", "Senders", "Messages", "Document")
    return table(header, (_row(protocol) for protocol in protocols))


def _row(protocol: Protocol) -> tuple[str, ...]:
    return (
        page_link(protocol),
        markdown(protocol.title),
        markdown(", ".join(protocol.files[1:])),
        listed([code(sender.name) for sender in protocol.senders]),
        str(len(protocol.messages)),
        markdown(protocol.source.document or "") if protocol.source else "",
    )
