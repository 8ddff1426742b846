"""A sender's frames: what they are made of, and how a receiver cuts them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from protogen.model.protocol import Protocol, Sender
from protogen.model.sizes import SizeSet
from protogen.targets.emitted import emitted_names
from protogen.targets.escape import markdown
from protogen.targets.markdown.frames.packet import frame_diagram
from protogen.targets.markdown.frames.parts import (
    frame_table,
    transparency_table,
    transparency_text,
)
from protogen.targets.markdown.pages.context import by_frame, sender_code
from protogen.targets.markdown.text.origin import about_line
from protogen.targets.markdown.text.table import View
from protogen.targets.markdown.text.words import capital, listed, plural, sentence

Sentences = tuple[str, ...]

_AMBIGUITY = {
    True: "A receiver would cut frames with some values elsewhere; encoders refuse these values.",
    False: "None: a receiver cuts every frame where it ends.",
}

_CUT_OFF = "Encoders refuse values whose frame would be longer."


def frame_views(protocol: Protocol) -> tuple[View, ...]:
    """Return a view for each different frame, in the order of the senders."""
    return tuple(_view(senders, protocol) for senders in by_frame(protocol.senders))


def _view(senders: Sequence[Sender], protocol: Protocol) -> View:
    frame = senders[0].frame
    payload = senders[0].framing.payload
    for sender in senders[1:]:
        payload |= sender.framing.payload
    transparency = frame.transparency
    return {
        "title": f"Frames from {_titles(senders, protocol)}",
        "table": frame_table(frame, payload, emitted_names(protocol)),
        "diagram": frame_diagram(frame, payload),
        "transparency": transparency_text(transparency) if transparency else (),
        "replacements": transparency_table(transparency) if transparency else None,
        "properties": _shared_properties(senders),
    }


def _titles(senders: Sequence[Sender], protocol: Protocol) -> str:
    if len(senders) == 1:
        return sender_title(senders[0], protocol)
    return listed([sender_code(sender) for sender in senders])


def sender_title(sender: Sender, protocol: Protocol) -> str:
    """Return a sender's name and what it is."""
    titles = {endpoint.name: endpoint.title for endpoint in protocol.endpoints}
    return f"{sender_code(sender)}, {markdown(titles[sender.endpoint])}"


def _shared_properties(senders: Sequence[Sender]) -> tuple[tuple[str, str], ...]:
    """Return what senders have in common, label by label; what differs names the sender."""
    columns = [dict(_properties(sender)) for sender in senders]
    return tuple(
        (label, _merged(senders, [column[label] for column in columns])) for label in columns[0]
    )


def _merged(senders: Sequence[Sender], texts: Sequence[Sentences]) -> str:
    """Join what is said of all senders, then what is said of some only."""
    common = [text for text in texts[0] if all(text in others for others in texts)]
    for sender, own in zip(senders, texts, strict=True):
        rest = [text for text in own if text not in common]
        if rest:
            common.append(f"From {sender_code(sender)}: {' '.join(rest)}")
    return " ".join(common)


def _properties(sender: Sender) -> Iterator[tuple[str, Sentences]]:
    framing = sender.framing
    sizes = plural(SizeSet.between(framing.least, framing.greatest), "byte")
    sync = "Yes." if framing.self_synchronising else "No."
    yield "Start", (_said(framing.finds_start),)
    silence = sender.frame.silence
    doc = about_line(silence.about) if silence is not None else ""
    yield "End", tuple(filter(None, (_said(framing.finds_end), doc)))
    yield "Self-synchronising", (f"{sync} {_said(framing.why_synchronising)}".strip(),)
    refused = (_CUT_OFF,) if framing.is_cut_off else ()
    yield "Frame size", (f"{sizes} on the wire.", *refused)
    yield "Overhead", (_overhead(sender),)
    undetected = tuple(map(_said, framing.undetected)) or ("None.",)
    yield "Single-byte errors that go unnoticed", undetected
    yield "Ambiguity", (_AMBIGUITY[framing.cut_ambiguous],)


def _overhead(sender: Sender) -> str:
    code_bytes = sender.frame.code_size
    overhead = plural(sender.framing.overhead + SizeSet.exactly(code_bytes), "byte")
    if code_bytes:
        return f"{overhead} besides the payload, with the first COBS code byte."
    return f"{overhead} besides the payload, before any stuffing or encoding."


def _said(text: str) -> str:
    return capital(sentence(markdown(text)))
