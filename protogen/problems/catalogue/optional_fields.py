"""Problems of fields at the end of a message that may be left out."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_fields, with_payload

_STATUS = """\
status:
  id: 1
  from: robot
  fields: {angle: uint16, speed: {type: uint16, optional: true}}
"""

OPTIONAL_FIELD_CODES: tuple[Code, ...] = (
    Code(
        "PG287",
        "behind-optional",
        "A field behind one that may be left out",
        """\
A field with `optional: true` is there if the payload goes on where it would begin. If it is left
out, nothing can stand behind it, so all fields behind it have `optional: true` as well.
""",
        with_fields("""
            angle: uint16
            speed: {type: uint16, optional: true}
            current: uint16
        """),
        with_fields("""
            angle: uint16
            speed: {type: uint16, optional: true}
            current: {type: uint16, optional: true}
        """),
    ),
    Code(
        "PG288",
        "misplaced-optional",
        "An `optional` that nothing could tell",
        """\
The end of a message's payload, or of a region, says whether a field with `optional: true` is
there. So it is a field of the message itself, or of a struct or a case behind which nothing stands,
not one in an array; it has a byte at least where it is there; and nothing else says whether it is
there, or what it is then: neither `when` nor `const` nor `default`. Fields that come and go
together are one struct that is optional.
""",
        with_fields("""
            more: {fields: {speed: uint16, current: {type: uint16, optional: true}}}
            angle: uint16
        """),
        with_fields("""
            angle: uint16
            more: {fields: {speed: uint16, current: {type: uint16, optional: true}}}
        """),
    ),
    Code(
        "PG289",
        "optional-without-end",
        "An optional field where nothing says where the payload ends",
        """\
A receiver tells by the end of the payload whether an optional field is there. Where the frame has
neither a length part nor an end, the payload ends where its fields do, and nothing tells a field
that was left out from one that is still to come.
""",
        with_payload("", _STATUS, length=False),
        with_payload("", _STATUS),
    ),
)
