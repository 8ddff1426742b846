"""An event in one line: for people, or as JSON."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from protogen.model.readings import readings

if TYPE_CHECKING:
    from rich.text import Text

    from protogen.model.protocol import Protocol

_MOST_BYTES = 32
"""Bytes of a span without meaning that are shown."""
_ORDER = ("offset", "size", "event", "message", "sender", "parts", "fields")


def json_line(event: Any) -> str:
    """Return the event as one line of JSON."""
    line = event.as_json()
    ordered = {key: line.pop(key) for key in _ORDER if key in line}
    return json.dumps({**ordered, **line}, ensure_ascii=False)


class EventLines:
    """Writes events as readable lines of text."""

    def __init__(self, protocol: Protocol, *, show_sender: bool) -> None:
        self._fields = {message.name: message.fields for message in protocol.messages}
        self._caller_parts = {
            sender.name: [part.name for part in sender.frame.caller_parts]
            for sender in protocol.senders
        }
        names = [*self._fields, "unknown", "invalid"]
        self._name_width = max(map(len, names))
        self._sender_width = max(map(len, self._caller_parts)) if show_sender else 0

    def line(self, event: Any) -> Text:
        """Return the line of an event: offset, name, values."""
        from rich.text import Text

        line = Text()
        line.append(f"{event.offset:>8}  ", style="dim")
        if self._sender_width:
            line.append(f"{event.sender:<{self._sender_width}}  ")
        match event.kind:
            case "message":
                self._message(line, event)
            case "unknown":
                self._unknown(line, event)
            case _:
                self._invalid(line, event)
        line.rstrip()
        return line

    def _name(self, line: Text, name: str, style: str) -> None:
        line.append(f"{name:<{self._name_width}}  ", style=style)

    def _message(self, line: Text, event: Any) -> None:
        name = event.message.NAME
        self._name(line, name, "bold cyan")
        for part in self._caller_parts[event.sender]:
            self._value(line, f"@{part}", str(getattr(event.parts, part)))
        for field, text in readings(self._fields[name], event.message.to_dict()):
            self._value(line, field, text)

    def _unknown(self, line: Text, event: Any) -> None:
        self._name(line, "unknown", "bold yellow")
        for part, value in asdict(event.parts).items():
            self._value(line, f"@{part}", str(value))
        self._value(line, "payload", f"hex:{event.payload.hex().upper()}")

    def _value(self, line: Text, name: str, text: str) -> None:
        line.append(f"{name}=")
        line.append(f"{text} ", style="bold")

    def _invalid(self, line: Text, event: Any) -> None:
        self._name(line, "invalid", "bold red")
        why = f"{event.reason}: {event.problem}" if event.problem else event.reason
        line.append(f"{why}  ", style="red")
        line.append(_shortened(event.raw))


def _shortened(data: bytes) -> str:
    shown = data[:_MOST_BYTES].hex(" ").upper()
    return f"{shown} ... {len(data)} bytes" if len(data) > _MOST_BYTES else shown
