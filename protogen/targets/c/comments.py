"""Documentation comments: what the schema says of a thing, and where that is written."""

from __future__ import annotations

import textwrap

from protogen.model.fields import Field
from protogen.model.messages import Message
from protogen.model.origin import About, Source
from protogen.model.protocol import Link, Protocol
from protogen.model.types import Array, Float, Integer, Type
from protogen.targets.c.lines import WIDTH
from protogen.targets.escape import c_comment, paragraphs


def comment(texts: list[str], indent: int = 0) -> tuple[str, ...]:
    """A documentation comment of these paragraphs, without the indent of its lines."""
    escaped = [c_comment(text) for text in texts if text]
    if len(escaped) == 1 and indent + len(escaped[0]) + 7 <= WIDTH:
        return (f"/** {escaped[0]} */",)
    lines = ["/**"]
    for number, text in enumerate(escaped):
        if number:
            lines.append(" *")
        lines += [f" * {line}" for line in _wrapped(text, WIDTH - indent - 3)]
    return (*lines, " */")


def _wrapped(text: str, room: int) -> list[str]:
    return textwrap.wrap(text, room, break_long_words=False, break_on_hyphens=False) or [""]


def sentence(text: str) -> str:
    """The text with a full stop at its end."""
    return text if text.endswith((".", "!", "?", ":")) else f"{text}."


def place(source: Source | None) -> str:
    """Where something is written, as ` (line 18)`; nothing where the schema does not say."""
    if source is None:
        return ""
    words = [source.document or "", _lines(source.lines), source.section or ""]
    said = ", ".join(word for word in words if word)
    return f" ({said})" if said else ""


def _lines(lines: str | None) -> str:
    if lines is None:
        return ""
    return f"line {lines}" if lines.isdigit() else f"lines {lines}"


def about(summary: str, item: About) -> list[str]:
    """A summary with its place, then what else there is to know."""
    first, *rest = paragraphs(summary) or ("",)
    return [sentence(first.rstrip(".") + place(item.source)), *rest, *paragraphs(item.doc)]


def of_message(item: Message) -> list[str]:
    """What a message is."""
    return about(item.summary or item.title or item.name, item.about)


def of_named(name: str, item: About) -> list[str]:
    """What an enum, a set of flags or a struct is."""
    first, *rest = paragraphs(item.doc) or (words(name),)
    return [sentence(first.rstrip(".") + place(item.source)), *rest]


def words(name: str) -> str:
    """A name as words."""
    return name.replace("_", " ").capitalize()


def of_field(item: Field) -> list[str]:
    """What a field means, with its unit and bounds."""
    plain = "Not said by the document" if item.unknown else words(item.name)
    texts = paragraphs(item.about.doc) or (plain,)
    facts = [sentence(texts[0]).rstrip("."), *_facts(item)]
    lead = ", ".join(fact for fact in facts if fact)
    return [sentence(lead + place(item.about.source)), *texts[1:]]


def _facts(item: Field) -> list[str]:
    element = element_of(item.type)
    facts = [_step(item)]
    if (isinstance(element, Integer) and not _has_names(element)) or (
        isinstance(element, Float) and item.ranged
    ):
        facts.append(f"{item.least}..{item.greatest}")
    if isinstance(item.type, Array):
        facts.append(f"{item.type.extent.counts} elements")
    return [*facts, *(f"{value.value} = {value.name}" for value in item.special)]


def _has_names(type_: Integer) -> bool:
    return bool(type_.enum or type_.flags or type_.bit_fields or type_.role == "bool")


def element_of(type_: Type) -> Type:
    """The type of an array's elements, or the type itself."""
    return element_of(type_.element) if isinstance(type_, Array) else type_


def _step(item: Field) -> str:
    """The step of a raw value, such as `1/16 deg`."""
    if not item.scaled:
        return item.unit or ""
    step = "" if item.scale == 1 else f"{item.scale} "
    offset = f" from {item.offset}" if item.offset else ""
    return f"{step}{item.unit or 'units'}{offset}"


def of_protocol(protocol: Protocol) -> list[str]:
    """What the protocol is."""
    title = sentence(paragraphs(protocol.title)[0] if protocol.title else protocol.name)
    return [title, *paragraphs(protocol.about.doc), *_line(protocol.link)]


def _line(link: Link) -> list[str]:
    if link.baud is None:
        return []
    parity = "no parity" if link.parity == "none" else f"{link.parity} parity"
    stop = "1 stop bit" if link.stop_bits == 1 else f"{link.stop_bits} stop bits"
    return [f"{link.baud} baud, {link.data_bits} data bits, {parity}, {stop}."]
