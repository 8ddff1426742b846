"""Docstrings: what the schema says of a thing, its units and bounds, and where that is written."""

from __future__ import annotations

from protogen.model.fields import Field
from protogen.model.messages import Message
from protogen.model.origin import About, Source
from protogen.model.protocol import Link, Protocol
from protogen.model.types import Array, Integer, Type
from protogen.targets.escape import paragraphs, python_docstring


def escaped(texts: list[str]) -> list[str]:
    """Paragraphs for the inside of a docstring."""
    return [python_docstring(text) for text in texts]


def place(source: Source | None) -> str:
    """Where something is written, as `(line 18)`; nothing where the schema does not say."""
    if source is None:
        return ""
    words = [source.document or "", _lines(source.lines), source.section or ""]
    said = ", ".join(word for word in words if word)
    return f" ({said})" if said else ""


def _lines(lines: str | None) -> str:
    if lines is None:
        return ""
    return f"line {lines}" if lines.isdigit() else f"lines {lines}"


def sentence(text: str) -> str:
    """The text with a full stop at its end."""
    return text if text.endswith((".", "!", "?", ":")) else f"{text}."


def about(summary: str, item: About) -> list[str]:
    """A summary with its place, then what else there is to know."""
    first, *rest = paragraphs(summary) or ("",)
    lead = sentence(first.rstrip(".") + place(item.source))
    return escaped([lead, *rest, *paragraphs(item.doc)])


def message(item: Message) -> list[str]:
    """What a message is."""
    return about(item.summary or item.title or item.name, item.about)


def named(name: str, item: About) -> list[str]:
    """What an enum, a set of flags or a struct is."""
    first, *rest = paragraphs(item.doc) or (name.replace("_", " ").capitalize(),)
    return escaped([sentence(first.rstrip(".") + place(item.source)), *rest])


def field(item: Field) -> list[str]:
    """What a field means, with its unit and bounds."""
    texts = paragraphs(item.about.doc) or (_plain_name(item),)
    facts = [sentence(texts[0]).rstrip("."), *_facts(item)]
    lead = sentence(", ".join(fact for fact in facts if fact) + place(item.about.source))
    return escaped([lead, *texts[1:]])


def _plain_name(item: Field) -> str:
    if item.unknown:
        return "Not said by the document"
    return item.name.replace("_", " ").capitalize()


def _facts(item: Field) -> list[str]:
    facts = [unit_of_raw(item)]
    if isinstance(element_of(item.type), Integer) and not _named_values(item):
        facts.append(f"{item.least}..{item.greatest}")
    if isinstance(item.type, Array):
        facts.append(f"{item.type.extent.counts} elements")
    facts += [f"{value.value} = {value.name}" for value in item.special]
    if item.const is not None:
        facts.append("constant")
    return facts


def _named_values(item: Field) -> bool:
    element = element_of(item.type)
    return isinstance(element, Integer) and bool(
        element.enum or element.flags or element.bit_fields or element.role == "bool"
    )


def element_of(type_: Type) -> Type:
    """The type of an array's elements, or the type itself."""
    return type_.element if isinstance(type_, Array) else type_


def unit_of_raw(item: Field) -> str:
    """The step of a raw value, such as `1/16 deg`."""
    if not item.scaled:
        return item.unit or ""
    step = "" if item.scale == 1 else f"{item.scale} "
    offset = f" from {item.offset}" if item.offset else ""
    return f"{step}{item.unit or 'units'}{offset}"


def module(protocol: Protocol) -> list[str]:
    """What the protocol is, for the module's docstring."""
    title = sentence(paragraphs(protocol.title)[0] if protocol.title else protocol.name)
    texts = [title, *paragraphs(protocol.about.doc)]
    line = _line(protocol.link)
    if line:
        texts.append(line)
    return escaped(texts)


def _line(link: Link) -> str:
    if link.baud is None:
        return ""
    parity = "no parity" if link.parity == "none" else f"{link.parity} parity"
    stop = "1 stop bit" if link.stop_bits == 1 else f"{link.stop_bits} stop bits"
    text = f"{link.baud} baud, {link.data_bits} data bits, {parity}, {stop}"
    if link.idle_timeout is None:
        return f"{text}."
    silence = float(link.idle_timeout * 1000)
    return f"{text}; call `Decoder.flush` after {silence:g} ms of silence."
