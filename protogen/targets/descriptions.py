"""Docs and sources of things, as plain paragraphs.

Each language makes its comments or docstrings of them.
"""

from __future__ import annotations

from functools import lru_cache

from protogen.model.messages import Message
from protogen.model.origin import About, Source
from protogen.model.presence import Conditional, Trailing
from protogen.model.protocol import Link, Protocol
from protogen.model.types import Array, Field, Marked, Text
from protogen.targets.escape import paragraphs


def sentence(text: str) -> str:
    """The text with a full stop at its end."""
    return text if text.endswith((".", "!", "?", ":")) else f"{text}."


@lru_cache(4096)
def words(name: str) -> str:
    """A name as words."""
    return name.replace("_", " ").capitalize()


def of_message(item: Message) -> list[str]:
    """Summary and doc of a message."""
    first, *rest = paragraphs(item.summary or item.title or item.name) or ("",)
    return [_placed(first, item.about), *rest, *paragraphs(item.about.doc)]


def of_named(name: str, item: About) -> list[str]:
    """Doc of an enum, a set of flags or a struct."""
    first, *rest = paragraphs(item.doc) or (words(name),)
    return [_placed(first, item), *rest]


def of_field(item: Field, facts: list[str]) -> list[str]:
    """Doc of a field, with facts such as its unit and bounds; empty ones are left out."""
    plain = "Not said by the document" if item.unknown else words(item.name)
    first, *rest = paragraphs(item.about.doc) or (plain,)
    part = f"the part {item.part} of the frame" if item.part else ""
    lead = ", ".join(fact for fact in (sentence(first).rstrip("."), *facts, part) if fact)
    return [sentence(lead + _place(item.about.source)), *rest]


def facts_of(item: Field, nothing: str, *, is_computed: bool) -> list[str]:
    """What a program has to know of a field's value; `nothing` is that of one that is not there."""
    facts = [step_of(item)]
    if item.integer is not None and not names_values(item):
        facts.append(range_of(item))
    facts += extent_of(item) + specials_of(item)
    if item.const is not None:
        facts.append("constant")
    match item.presence:
        case Conditional(condition=condition):
            facts.append(f"{nothing} unless {condition.text}")
        case Trailing():
            facts.append(f"{nothing} if it is left out")
        case None:
            pass
    if is_computed:
        facts.append("computed where it is left out")
    return facts


def of_protocol(protocol: Protocol) -> list[str]:
    """Title and doc of the protocol."""
    title = sentence(paragraphs(protocol.title)[0] if protocol.title else protocol.name)
    return [title, *paragraphs(protocol.about.doc)]


def of_link(link: Link) -> str:
    """The line's settings, without a full stop; nothing where the schema does not say."""
    if link.baud is None:
        return ""
    parity = "no parity" if link.parity == "none" else f"{link.parity} parity"
    stop = "1 stop bit" if link.stop_bits == 1 else f"{link.stop_bits} stop bits"
    return f"{link.baud} baud, {link.data_bits} data bits, {parity}, {stop}"


def step_of(item: Field) -> str:
    """The step of a raw value, such as `1/16 deg`; the unit alone where it is not scaled."""
    if not item.scaled:
        return item.unit or ""
    step = "" if item.scale == 1 else f"{item.scale} "
    offset = f" from {item.offset}" if item.offset else ""
    return f"{step}{item.unit or 'units'}{offset}"


def extent_of(item: Field) -> list[str]:
    """Number of elements of an array, and what says which is the last; padding of a text."""
    if isinstance(item.type, Text) and not item.type.form.is_plain:
        return [f"text of at most {item.type.extent.counts} characters: {item.type.form.label}"]
    if not isinstance(item.type, Array):
        return []
    extent = item.type.extent
    last = [f"the last by {extent.mark.label}"] if isinstance(extent, Marked) else []
    return [f"{extent.counts} elements", *last]


def range_of(item: Field) -> str:
    """Raw values that an encoder allows, such as `0..255`."""
    if item.ranged or item.integer is None:
        return f"{item.least}..{item.greatest}"
    return f"{item.integer.least}..{item.integer.greatest}"


def specials_of(item: Field) -> list[str]:
    """The special values of a field."""
    return [f"{value.value} = {value.name}" for value in item.special]


def names_values(item: Field) -> bool:
    """True if the values of a field, or its bits, have names that say what they are."""
    integer = item.integer
    return integer is not None and bool(
        integer.enum or integer.flags or integer.bit_fields or integer.role == "bool"
    )


def _placed(first: str, item: About) -> str:
    return sentence(first.rstrip(".") + _place(item.source))


def _place(source: Source | None) -> str:
    """Source of a thing, as ` (line 18)`; nothing where the schema does not say."""
    if source is None:
        return ""
    said = [source.document or "", _lines(source.lines), source.section or ""]
    shown = ", ".join(word for word in said if word)
    return f" ({shown})" if shown else ""


def _lines(lines: str | None) -> str:
    if lines is None:
        return ""
    return f"line {lines}" if lines.isdigit() else f"lines {lines}"
