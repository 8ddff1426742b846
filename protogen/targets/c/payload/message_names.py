"""Names of what is printed of a message, and its macros."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec

from protogen.c_language.numbers import hexadecimal
from protogen.model.messages import Message
from protogen.model.parts import IdentityPart
from protogen.model.protocol import Sender
from protogen.targets import naming
from protogen.targets.c.named import Macro, claim_fields
from protogen.targets.c.payload.accessors import claim_accessor, is_readable
from protogen.targets.c.payload.in_place import claim_in_place
from protogen.targets.c.payload.written_places import is_written_in_place
from protogen.targets.c.spelling import Names, from_sender

_FUNCTIONS = "check load validate refused measure store put encode decode"


def claim_message(names: Names, item: Message) -> dict[str, str]:
    """The names of its struct, of its value among the messages, and of its payload's functions."""
    thing = naming.message(item.name)
    called = {word: names.claim(thing, item.name, word) for word in _FUNCTIONS.split()}
    called["tag"] = names.claim_tag(thing, item.name)
    called["constant"] = names.claim_macro(thing, "message", item.name)
    return called


def claim_init(names: Names, item: Message) -> str:
    """The macro with the initial values of its struct."""
    return names.claim_macro(naming.message(item.name), item.name, "init")


class FrameNames(msgspec.Struct, frozen=True):
    """The names of the functions that make a message's frames, and of their macros."""

    function: str
    """The function that fills a buffer."""
    send: str
    """The function that hands over byte after byte."""
    max: str
    """The macro for the greatest frame."""
    room: str
    """The macro for the bytes of a buffer that suffice for every frame."""
    begin: str
    """The function that begins a frame in its buffer; of a message that is written in its place."""
    end: str
    """The function that ends it."""
    suffix: str
    """What tells them from those of other senders."""


def claim_frame(names: Names, item: Message, suffix: str) -> FrameNames:
    """The names of a message's frames; `suffix` tells those of other senders apart."""
    message, is_begun = item.name, is_written_in_place(item)
    thing, words = naming.message(message), f"{message}{suffix}"
    return FrameNames(
        begin=names.claim(thing, message, f"begin{suffix}") if is_begun else "",
        end=names.claim(thing, message, f"end{suffix}") if is_begun else "",
        function=names.claim(thing, message, f"frame{suffix}"),
        send=names.claim(thing, message, f"send{suffix}"),
        max=names.claim_macro(thing, words, "frame_max"),
        room=names.claim_macro(thing, words, "frame_room"),
        suffix=suffix,
    )


def claim_handler(names: Names, message: str, suffix: str) -> str:
    """The name of the function for a message that was received."""
    return names.claim(naming.message(message), f"on_{message}{suffix}")


def claim_all(names: Names, item: Message, senders: Sequence[Sender]) -> None:
    """Every name that comes of a message, whatever is chosen to be printed."""
    others = [from_sender(sender.name) for sender in senders] if len(senders) > 1 else []
    for suffix in ("", *others):
        claim_handler(names, item.name, suffix)
        claim_frame(names, item, suffix)
    claim_message(names, item)
    claim_init(names, item)
    constants_of(item, senders[0], names)
    claim_fields(names, item.name, item.fields)
    for step in item.plan.steps:
        if is_readable(step):
            claim_accessor(names, item.name, step.name)
    if is_written_in_place(item):
        claim_in_place(names, item)


def constants_of(item: Message, sender: Sender, names: Names) -> tuple[Macro, ...]:
    """The macros of a message itself: identity, sizes and hash."""
    sizes, parts = item.sizes, sender.frame.identity
    values = {
        ("id",) if len(parts) == 1 else ("id", part.name): _identity_value(part, value)
        for part, value in zip(parts, item.identity, strict=True)
    }
    if sizes.fixed is not None:
        values["payload_size",] = f"{sizes.fixed}U"
    values["payload_min",] = f"{sizes.least}U"
    values["payload_max",] = f"{sizes.greatest}U"
    values["spec_hash",] = f'"{item.spec_hash}"'
    thing = naming.message(item.name)
    return tuple(
        Macro(names.claim_macro(thing, item.name, *words), value) for words, value in values.items()
    )


def _identity_value(part: IdentityPart, value: int) -> str:
    """The number, or the character that it is."""
    if part.type.is_text and part.type.size > 1:
        return f"{hexadecimal(value)}{_comment(str(part.shown(value)))}"
    is_text = (
        part.type.role in ("char", "ascii") and 0x20 < value < 0x7F and chr(value) not in "'\\?"
    )
    return f"'{chr(value)}'" if is_text else hexadecimal(value)


def _comment(text: str) -> str:
    """The characters of an identity, where they can stand in a comment."""
    plain = all(character.isalnum() or character in " -_." for character in text)
    return f" /**< `{text}` */" if plain and text.isascii() else ""
