"""An event in one line: for people, or as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from protogen.model.messages import given_parts
from protogen.model.reading.readings import quoted, readings
from protogen.runtime.attributes import attribute
from protogen.runtime.values import as_dict

if TYPE_CHECKING:
    from protogen.model.protocol import Protocol, Sender

Segment = tuple[str, str]
"""Text and its rich style."""

_MOST_BYTES = 32
"""Bytes of a span without meaning that are shown."""
_ORDER = ("offset", "size", "event", "message", "sender", "form", "parts", "fields")


def json_line(event: Any, **facts: Any) -> str:
    """Return the event as one line of JSON, with `facts` such as its time in front."""
    line = event.as_json()
    ordered = facts | {key: line.pop(key) for key in _ORDER if key in line}
    return json.dumps({**ordered, **line}, ensure_ascii=False)


class EventLines:
    """Writes events as readable lines of text."""

    def __init__(self, protocol: Protocol, *, show_sender: bool) -> None:
        self._plans = {message.name: message.plan for message in protocol.messages}
        self._given_parts = {
            (_key(sender), message.name): [p.name for p in given_parts(sender.frame, message)]
            for sender in protocol.senders
            for message in sender.messages
        }
        names = [*self._plans, "unknown", "invalid"]
        self._name_width = max(map(len, names))
        self._sender_width = max(map(len, protocol.sending)) if show_sender else 0

    def segments(self, event: Any) -> list[Segment]:
        """Return the line of an event, in pieces with their styles: offset, name, values."""
        line = [(f"{event.offset:>8}  ", "dim")]
        if self._sender_width:
            line.append((f"{event.sender:<{self._sender_width}}  ", ""))
        match event.kind:
            case "message":
                line += self._message(event)
            case "unknown":
                line += self._unknown(event)
            case _:
                line += self._invalid(event)
        return line

    def text(self, event: Any) -> str:
        """Return the line of an event without styles."""
        return "".join(text for text, _ in self.segments(event)).rstrip()

    def _name(self, name: str, style: str) -> Segment:
        return f"{name:<{self._name_width}} ", style

    def _message(self, event: Any) -> Iterator[Segment]:
        name = event.message.NAME
        yield self._name(name, "bold cyan")
        for part in self._given_parts[(event.sender, event.form), name]:
            yield from _value(f"@{part}", _part(getattr(event.parts, attribute(part))))
        for field, text in readings(self._plans[name], event.message.to_dict()):
            yield from _value(field, text)

    def _unknown(self, event: Any) -> Iterator[Segment]:
        yield self._name("unknown", "bold yellow")
        for part, value in as_dict(event.parts).items():
            yield from _value(f"@{part}", _part(value))
        yield from _value("payload", f"hex:{event.payload.hex().upper()}")

    def _invalid(self, event: Any) -> Iterator[Segment]:
        yield self._name("invalid", "bold red")
        why = f"{event.reason}: {event.problem}" if event.problem else event.reason
        yield f" {why}", "red"
        yield f"  {_shortened(event.raw)}", ""


def _key(sender: Sender) -> tuple[str, str]:
    """Return endpoint and form as events name them."""
    return sender.endpoint, "" if sender.is_only_form else sender.form


def _part(value: int | str) -> str:
    return quoted(value) if isinstance(value, str) else str(value)


def _value(name: str, text: str) -> Iterator[Segment]:
    yield f" {name}=", ""
    yield text, "bold"


def _shortened(data: bytes) -> str:
    shown = data[:_MOST_BYTES].hex(" ").upper()
    return f"{shown} ... {len(data)} bytes" if len(data) > _MOST_BYTES else shown
