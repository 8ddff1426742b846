"""Problems of the case of a switch for all values that no other case has."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_fields

SWITCH_CASE_CODES: tuple[Code, ...] = (
    Code(
        "PG270",
        "two-cases-called-else",
        "A value that is called as the case of all others",
        """\
`else` under `cases` is the case of all values that no other case has. Where one of the selector's
values has that name, a reader can't tell which of the two is meant.
""",
        with_fields("""
            kind: {type: uint8, values: {when: 1, else: 2}}
            value: {switch: kind, cases: {when: uint16, else: uint8}}
        """),
        with_fields("""
            kind: {type: uint8, values: {when: 1, otherwise: 2}}
            value: {switch: kind, cases: {when: uint16, else: uint8}}
        """),
    ),
    Code(
        "PG271",
        "only-case-else",
        "A switch that has no case but that of all values",
        """\
`else` is the case of all values that no other case has. Without another case nothing is chosen, and
the field always is what `else` says.
""",
        with_fields("""
            kind: uint8
            value: {switch: kind, cases: {else: uint16}}
        """),
        with_fields("""
            kind: uint8
            value: uint16
        """),
    ),
    Code(
        "PG272",
        "else-never-chosen",
        "A case of all other values, and there are none",
        """\
All values that an encoder allows the selector have a case of their own: those in its range, or the
names of a closed enum. So `else` would never be sent.
""",
        with_fields("""
            kind: {type: uint8, values: {level: 1, name: 2}, closed: true}
            value: {switch: kind, cases: {level: uint16, name: uint8, else: uint32}}
        """),
        with_fields("""
            kind: {type: uint8, values: {level: 1, name: 2}}
            value: {switch: kind, cases: {level: uint16, name: uint8, else: uint32}}
        """),
    ),
)
