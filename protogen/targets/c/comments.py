"""Documentation comments of C."""

from __future__ import annotations

from protogen.model.extents import Fixed
from protogen.model.presence import Conditional
from protogen.model.protocol import Protocol
from protogen.model.types import Field, Float, Text
from protogen.targets import descriptions
from protogen.targets.c.lines import WIDTH
from protogen.targets.escape import c_comment
from protogen.targets.folding import block_comment


def comment(texts: list[str], indent: int = 0) -> tuple[str, ...]:
    """A documentation comment of these paragraphs, without the indent of its lines."""
    escaped = [c_comment(text) for text in texts if text]
    return block_comment(escaped, WIDTH - indent, at_hyphens=False)


def of_field(item: Field, macros: str) -> list[str]:
    """Meaning of a field, with its unit and bounds; `macros` begin the names of its values."""
    facts = [descriptions.step_of(item), macros]
    is_number = item.integer is not None or (isinstance(item.element, Float) and item.ranged)
    if is_number and not descriptions.names_values(item):
        facts.append(descriptions.range_of(item))
    facts += descriptions.extent_of(item) + descriptions.specials_of(item)
    if isinstance(item.type, Text):
        facts.append(_end_of(item.type))
    if isinstance(item.presence, Conditional):
        facts.append(f"sent only if {item.presence.condition.text}")
    return descriptions.of_field(item, facts)


def _end_of(type_: Text) -> str:
    """What is behind a text in its array."""
    if isinstance(type_.extent, Fixed):
        return "NUL behind a shorter text only"
    return "no NUL behind it"


def of_protocol(protocol: Protocol) -> list[str]:
    """Title of the protocol, and the settings of its line."""
    line = descriptions.of_link(protocol.link)
    return [*descriptions.of_protocol(protocol), *([f"{line}."] if line else [])]
