"""Frames from the lines that events give as JSON."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from protogen.runtime.errors import EncodeError
from protogen.runtime.framing.assembly import encode_frame
from protogen.runtime.framing.frame import IdentityPart, ToldPart
from protogen.runtime.framing.sender import SenderSpec, with_held
from protogen.runtime.identities import Identity
from protogen.runtime.payload.number import Characters, given_number

_EVENTS = ("message", "unknown", "invalid")


def encode_line(sender: SenderSpec[Any, Any], line: Mapping[str, Any]) -> bytes:
    """The bytes that one line of decoder output stands for.

    `raw`, where the line has it, is taken as it is. Raises EncodeError with the path of what is
    missing or wrong in the line.
    """
    event = line.get("event", "message")
    if event not in _EVENTS:
        raise EncodeError("event", f"{event!r} is none of {', '.join(_EVENTS)}")
    if "raw" in line:
        return _bytes(line, "raw")
    if event == "message":
        return _encode_message(sender, line)
    if event == "unknown":
        identity, given = split_parts(sender, _parts(line))
        return encode_frame(sender, identity, _bytes(line, "payload"), given, strict=False)
    raise EncodeError("event", f"{event!r} without raw bytes can't be sent")


def _encode_message(sender: SenderSpec[Any, Any], line: Mapping[str, Any]) -> bytes:
    name = line.get("message")
    message = sender.named(str(name))
    if message is None:
        raise EncodeError("message", f"{sender.name} sends no message called {name!r}")
    fields = _mapping(line, "fields")
    try:
        record = message.from_dict(fields)
        payload = record.to_payload(strict=False)
    except EncodeError as error:
        raise error.inside("fields") from None
    parts = _parts(line) if "parts" in line else {}
    identity, given = sender.choose_identity(message, with_held(record, parts))
    carried = sender.layout.payload.trimmed(payload)
    return encode_frame(sender, identity, carried, given, strict=False)


def split_parts(
    sender: SenderSpec[Any, Any], parts: Mapping[str, Any]
) -> tuple[Identity, dict[str, Any]]:
    """The identity among the parts of an unknown frame, and the other parts."""
    identity = sender.layout.identity
    names = [part.name for part in identity]
    others = {name: value for name, value in parts.items() if name not in names}
    return tuple(_identifying(part, parts.get(part.name)) for part in identity), others


def _identifying(part: IdentityPart | ToldPart, value: Any) -> int:
    try:
        return given_number(part.number, value)
    except EncodeError as error:
        if isinstance(part.number, Characters) and value is not None:
            raise error.inside(part.name) from None
        problem = "an unknown frame needs the number of each identity part"
        raise EncodeError(part.name, problem) from None


def _parts(line: Mapping[str, Any]) -> Mapping[str, Any]:
    """The values of a frame's parts. To JSON, unlike Python, true and false are no numbers."""
    parts = _mapping(line, "parts")
    for name, value in parts.items():
        if isinstance(value, bool):
            raise EncodeError(str(name), f"must be an integer, not {value!r}")
    return parts


def _mapping(line: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    found = line.get(key)
    if not isinstance(found, Mapping):
        raise EncodeError(key, f"must be a mapping, not {found!r}")
    return found


def _bytes(line: Mapping[str, Any], key: str) -> bytes:
    try:
        return bytes.fromhex(line[key])
    except (KeyError, TypeError, ValueError):
        raise EncodeError(key, "must be hexadecimal digits") from None
