"""Problems of parts that go into checksums and are not sent."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_framed


def _framed(counts: str, virtual: str, covers: str, messages: str) -> str:
    """A schema with a virtual part in front of its checksum."""
    frame = f"""
        id: {{type: uint8, id: true}}
        length: {{type: uint8, counts: {counts}}}
        payload: {{}}
        extra: {{type: uint8, {virtual}}}
        crc: {{type: uint16, algorithm: CRC-16/MCRF4XX, covers: {covers}}}
        end: {{literal: 0xC0}}
    """
    return with_framed(frame, messages, more="transparency: slip")


_ALL = "id..extra"
_BEAT = "beat: {id: 1, from: robot, parts: {extra: 50}}"

VIRTUAL_PART_CODES: tuple[Code, ...] = (
    Code(
        "PG231",
        "virtual-part-on-the-wire",
        "A part that is not sent stands for bytes",
        """\
A part with `virtual: true` goes into the checksums that cover it, where it is declared among the
parts, and has no bytes on the wire. So no length counts it, and no transparency begins or ends with
it. A run `first..last` with a virtual part inside means the parts of it that are sent.
""",
        _framed("[payload, extra]", "virtual: true", _ALL, _BEAT),
        _framed("payload", "virtual: true", _ALL, _BEAT),
    ),
    Code(
        "PG232",
        "virtual-part-without-value",
        "A message that says not what goes into its checksum",
        """\
A receiver learns the value of a virtual part from the identity of the message. Each message whose
frames have such a part gives it one, `parts: {extra: 50}`, unless the part has a `default`. With a
default, frames of unknown identities are verified with it; without one they can't be verified, and
a receiver takes them for frames with a wrong checksum.
""",
        _framed("payload", "virtual: true", _ALL, "beat: {id: 1, from: robot}"),
        _framed("payload", "virtual: true, default: 0", _ALL, "beat: {id: 1, from: robot}"),
    ),
    Code(
        "PG233",
        "not-a-virtual-value",
        "A value that a message can't give to a part",
        """\
Under `parts`, a message gives values to the virtual parts of its frames, and to no others: what is
sent comes from whoever encodes a frame. A receiver must know the value before it can verify a
frame, and all it knows is the identity: messages that share one, under `overloads`, give the same
values.
""",
        _framed(
            "payload",
            "virtual: true",
            _ALL,
            "beat: {id: 1, from: robot, parts: {extra: 50, length: 4}}",
        ),
        _framed("payload", "virtual: true", _ALL, _BEAT),
    ),
    Code(
        "PG234",
        "virtual-part-without-checksum",
        "A part that is not sent, and that no checksum covers",
        """\
A virtual part is there for the checksums that cover it. One that none covers changes no byte and is
checked by nobody.
""",
        _framed("payload", "virtual: true", "id..payload", _BEAT),
        _framed("payload", "virtual: true", _ALL, _BEAT),
    ),
)
