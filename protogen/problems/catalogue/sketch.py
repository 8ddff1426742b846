"""Small complete schemas around the lines that an example of the catalogue is about.

The lines may be indented, as they stand in the catalogue.
"""

from __future__ import annotations

from textwrap import dedent, indent

_HEAD = """\
protocol: demo
endpoints: {host: Host computer, robot: Robot}
byte_order: little
"""

_FRAME = """\
frame: {id: {type: uint8, id: true}, payload: {}, end: {literal: 0xC0}}
transparency: slip
"""

_MESSAGE = """\
messages:
  gyro:
    id: 1
    from: robot
"""

_FIELDS = "    fields: {angle: uint16}\n"


def with_keys(keys: str) -> str:
    """A schema of one message, with these further keys at its root."""
    return _HEAD + _FRAME + _MESSAGE + _FIELDS + _lines(keys, 0)


def with_message(keys: str) -> str:
    """A schema whose only message has an identity, a sender and these keys."""
    return _HEAD + _FRAME + _MESSAGE + _lines(keys, 4)


def with_fields(fields: str, *, more: str = "") -> str:
    """A schema whose only message has these fields; `more` are keys of the root."""
    return _HEAD + _FRAME + _lines(more, 0) + _MESSAGE + "    fields:\n" + _lines(fields, 6)


def with_messages(messages: str, *, more: str = "") -> str:
    """A schema with these messages; `more` are keys of the root."""
    return _HEAD + _FRAME + "messages:\n" + _lines(messages, 2) + _lines(more, 0)


def with_frame(parts: str, *, more: str = "") -> str:
    """A schema whose frame has these parts; `more` are keys of the root."""
    return _HEAD + "frame:\n" + _lines(parts, 2) + _lines(more, 0) + _MESSAGE + _FIELDS


def with_payload(keys: str, messages: str, *, length: bool = True, more: str = "") -> str:
    """A schema whose frame has a payload with these keys, and a length if it says so."""
    parts = [
        *(["length: {type: uint8, counts: payload}"] if length else []),
        "id: {type: uint8, id: true}",
        f"payload: {{{keys}}}",
        "crc: {type: uint16, algorithm: CRC-16/KERMIT, covers: id..payload}",
    ]
    return with_framed("".join(f"{part}\n" for part in parts), messages, more=more)


def with_framed(parts: str, messages: str, *, more: str = "") -> str:
    """A schema whose frame has these parts, with these messages; `more` are keys of the root."""
    frame = "frame:\n" + _lines(parts, 2)
    return _HEAD + frame + _lines(more, 0) + "messages:\n" + _lines(messages, 2)


def _lines(text: str, depth: int) -> str:
    written = dedent(text).strip("\n ")
    return indent(written, " " * depth) + "\n" if written else ""
