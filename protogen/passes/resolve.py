"""The passes in order, and the model that they make."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import PurePath

from protogen.copying import replace
from protogen.model.messages import Message
from protogen.model.protocol import Endpoint, Link, Protocol, Sender
from protogen.passes.context import Context, about, source_of
from protogen.passes.draft import Draft
from protogen.passes.framing.analysis import analyse_framing
from protogen.passes.framing.cutting import check_cut
from protogen.passes.framing.forms import check_forms
from protogen.passes.framing.frame_plan import plan_frame
from protogen.passes.framing.frames import resolve_frames
from protogen.passes.framing.told_parts import check_told
from protogen.passes.framing.transparencies import check_codes
from protogen.passes.framing.trimming import check_trimmed
from protogen.passes.messages.building import resolve_messages
from protogen.passes.messages.examples import attach_examples
from protogen.passes.messages.exchanges import resolve_exchanges
from protogen.passes.messages.identities import check_identities
from protogen.passes.messages.part_fields import check_part_fields
from protogen.passes.messages.rates import check_load
from protogen.passes.messages.virtual_values import check_shared_values
from protogen.passes.names.checking import check_names
from protogen.passes.names.decisions import resolve_decisions
from protogen.passes.names.distinct import check_distinct_names
from protogen.passes.names.numbers import check_numbers
from protogen.passes.names.reserved import resolve_reserved
from protogen.passes.spec_hash import Hashes
from protogen.passes.types.named_types import NamedTypes
from protogen.passes.types.unused import check_unused

Pass = Callable[[Context, Draft], None]

PASSES: tuple[Pass, ...] = (
    check_names,
    check_numbers,
    resolve_decisions,
    resolve_frames,
    check_codes,
    resolve_messages,
    check_unused,
    check_distinct_names,
    check_identities,
    check_shared_values,
    check_told,
    check_part_fields,
    check_trimmed,
    check_cut,
    resolve_reserved,
    attach_examples,
    resolve_exchanges,
    analyse_framing,
    check_forms,
    check_load,
)
"""Each pass asks one question, reports what is wrong, and leaves something to go on with."""


def resolve(context: Context) -> Protocol | None:
    """The model of a schema, or None if a pass found an error."""
    draft = Draft(named=NamedTypes(context))
    for ask in PASSES:
        ask(context, draft)
    return None if context.failed else _assemble(context, draft)


def _assemble(context: Context, draft: Draft) -> Protocol:
    syntax = context.syntax
    hashes = Hashes()
    messages = {
        name: replace(message, spec_hash=hashes.message(message))
        for name, message in draft.messages.items()
    }
    protocol = Protocol(
        name=syntax.protocol,
        title=syntax.title or syntax.protocol,
        version=syntax.version,
        source=source_of(syntax.source),
        about=about(syntax.doc, None),
        files=tuple(PurePath(file).name for file in context.files),
        link=_link(context),
        byte_bits=syntax.byte_bits,
        endpoints=tuple(
            Endpoint(name=name, title=item.title, doc=item.doc or "")
            for name, item in syntax.endpoints.items()
        ),
        senders=tuple(_sender(context, draft, messages, name) for name in draft.senders),
        enums=draft.named.enums,
        flags=draft.named.flags,
        structs=draft.named.structs,
        messages=tuple(messages.values()),
        exchanges=draft.exchanges,
        decisions=draft.decisions,
        reserved=draft.reserved,
        spec_hash="",
    )
    return replace(protocol, spec_hash=hashes.protocol(protocol))


def _link(context: Context) -> Link:
    link = context.syntax.link
    return Link(
        baud=link.baud,
        data_bits=link.data_bits,
        parity=link.parity,
        stop_bits=link.stop_bits,
        idle_timeout=link.idle_timeout,
        about=about(link.doc, link.source),
    )


def _sender(context: Context, draft: Draft, hashed: Mapping[str, Message], name: str) -> Sender:
    frame, framing, overloads = draft.frames[name], draft.framings[name], draft.overloads[name]
    messages = tuple(hashed[message.name] for message in draft.sent_by(name))
    written = context.frames[name]
    return Sender(
        name=name,
        form=written.form,
        is_only_form=written.is_only,
        behind=written.behind,
        frame=frame,
        framing=framing,
        messages=messages,
        overloads=tuple(overloads),
        plan=plan_frame(frame, framing, messages, overloads),
    )
