"""One message as a page shows it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from protogen.capture.layout import struct_sizes
from protogen.model.frame import Frame
from protogen.model.framing import MessageFraming
from protogen.model.messages import Message, Overload
from protogen.model.protocol import Sender
from protogen.model.sizes import SizeSet
from protogen.targets.emitted import EmittedNames, emitted_names
from protogen.targets.escape import markdown
from protogen.targets.markdown.fields.legends import legends
from protogen.targets.markdown.fields.paths import named_fields
from protogen.targets.markdown.fields.rows import message_table
from protogen.targets.markdown.fields.values import Anchors
from protogen.targets.markdown.frames.packet import message_diagram
from protogen.targets.markdown.frames.parts import identity_values
from protogen.targets.markdown.pages.context import Context, by_frame, sender_code
from protogen.targets.markdown.pages.example import example_view
from protogen.targets.markdown.text.anchors import decision_link, message_anchor, message_link
from protogen.targets.markdown.text.origin import about_line, place, prose
from protogen.targets.markdown.text.table import View
from protogen.targets.markdown.text.words import how_often, listed, plural, rate, sentence


def identity_text(frame: Frame, message: Message) -> str:
    """Print an identity as it is on the wire: the value of each part."""
    pairs = zip(frame.identity, message.told_by.runs, strict=True)
    return " ".join(identity_values(part, runs) for part, runs in pairs)


def message_view(context: Context, message: Message) -> View:
    """Return the section of a message."""
    senders = context.protocol.senders_of(message)
    anchors = Anchors(message_anchor(message.name), context.shared)
    identity = identity_text(senders[0].frame, message)
    return {
        "anchor": message_anchor(message.name),
        "title": f"{identity} {message.name}".strip(),
        "summary": _summary(message),
        "facts": [*_facts(context, message)],
        "notes": (*_notes(senders, message), *prose(message.about.doc)),
        "layouts": [*_layouts(senders, message, anchors, emitted_names(context.protocol))],
        "legends": [
            legend
            for path, field in named_fields(message.plan.steps)
            for legend in legends(field, path, anchors)
        ],
        "examples": [example_view(context.protocol, message, item) for item in message.examples],
    }


def _summary(message: Message) -> str:
    """Return the document's title, where it is another name, and the summary."""
    title = "" if message.title == message.name else f"**{markdown(message.title)}**"
    summary = sentence(markdown(message.summary))
    return ": ".join(text for text in (title, summary) if text)


# --- facts --------------------------------------------------------------------------------------


def _facts(context: Context, message: Message) -> Iterator[str]:
    if message.rate is not None:
        yield f"sent {how_often(message.rate)}"
    groups: dict[MessageFraming, list[str]] = {}
    for sender in context.protocol.senders_of(message):
        framing = context.framings[sender.name, message.name]
        groups.setdefault(framing, []).append(sender_code(sender))
    for framing, names in groups.items():
        yield f"From {listed(names)}"
        sizes = SizeSet.between(framing.least, framing.greatest)
        yield f"{plural(sizes, 'byte')} on the wire"
        if framing.per_second is not None:
            yield f"{rate(framing.per_second)} a second"
    yield f"payload {plural(message.sizes, 'byte')}"
    structs = struct_sizes(message)
    if structs is not None:
        yield _struct_size(*structs)
    source = place(message.about.source)
    if source:
        yield source


def _struct_size(natural: int, small: int) -> str:
    size = f"C struct {plural(SizeSet.exactly(natural), 'byte')}"
    return size if natural == small else f"{size} ({small} on AVR)"


def _notes(senders: Iterable[Sender], message: Message) -> Iterator[str]:
    if message.unspecified:
        yield "The document does not say what the payload holds."
    trimmed = [sender_code(it) for it in senders if it.plan.is_trimmed and message.sizes.greatest]
    if trimmed:
        yield f"{listed(trimmed)} leaves out zero bytes at the end of the payload."
    if message.can_be_cut and any(it.plan.is_cut for it in senders):
        yield "Bytes behind these fields, which a newer sender may have, are left."
    for sender in senders:
        for overload in sender.overloads:
            if message.name in overload.messages:
                yield overload_text(overload, message.name)


def overload_text(overload: Overload, name: str = "") -> str:
    """Say how messages of one identity are told apart, as seen from the message `name`."""
    others = [message_link(other) for other in overload.messages if other != name]
    opening = "Shares its identity with " if name else "One identity for "
    return about_line(overload.about, f"{opening}{listed(others)}. {_told_apart(overload)}")


def _told_apart(overload: Overload) -> str:
    if overload.yields is None:
        return "The payload's size tells them apart."
    decision = f", see {decision_link(overload.decision)}" if overload.decision else ""
    return (
        "Nothing on the wire tells them apart; "
        f"a receiver yields {message_link(overload.yields)}{decision}."
    )


# --- layout -------------------------------------------------------------------------------------


def _layouts(
    senders: Iterable[Sender], message: Message, anchors: Anchors, emitted: EmittedNames
) -> Iterator[View]:
    """Yield a layout for each different frame of the senders."""
    groups = by_frame(senders)
    for group in groups:
        frame = group[0].frame
        names = [sender_code(sender) for sender in group]
        yield {
            "caption": f"From {listed(names)}:" if len(groups) > 1 else "",
            "table": message_table(frame, message, anchors, emitted),
            "diagram": message_diagram(frame, message),
        }
