"""Docstrings: what the schema says of a thing, its units and bounds, and where that is written."""

from __future__ import annotations

from protogen.model.messages import Message
from protogen.model.origin import About
from protogen.model.protocol import Link, Protocol
from protogen.model.types import Field
from protogen.targets import descriptions
from protogen.targets.escape import python_docstring


def escaped(texts: list[str]) -> list[str]:
    """Paragraphs for the inside of a docstring."""
    return [python_docstring(text) for text in texts]


def message(item: Message) -> list[str]:
    """Docstring of a message."""
    return escaped(descriptions.of_message(item))


def named(name: str, item: About) -> list[str]:
    """Docstring of an enum, a set of flags or a struct."""
    return escaped(descriptions.of_named(name, item))


def field(item: Field, *, is_computed: bool = False) -> list[str]:
    """Docstring of a field, with its unit and bounds."""
    facts = descriptions.facts_of(item, "None", is_computed=is_computed)
    return escaped(descriptions.of_field(item, facts))


def module(protocol: Protocol) -> list[str]:
    """Docstring of a protocol's module."""
    line = descriptions.of_link(protocol.link)
    lines = [line + _silence(protocol.link)] if line else []
    lines += [
        f"Frames of {sender.name} end after {sender.frame.silence.text} of silence: call "
        f"`Decoder.idle` then."
        for sender in protocol.senders
        if sender.frame.silence is not None
    ]
    return escaped([*descriptions.of_protocol(protocol), *lines])


def _silence(link: Link) -> str:
    if link.idle_timeout is None:
        return "."
    silence = float(link.idle_timeout * 1000)
    return f"; call `Decoder.flush` after {silence:g} ms of silence."
