"""Problems of a file as such: bytes, characters and YAML."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code

DOCUMENT_CODES: tuple[Code, ...] = (
    Code(
        "PG001",
        "unreadable-file",
        "A file can't be read",
        """\
The file does not exist, is a folder, or may not be read. The message has the reason that
the operating system gives.
""",
        """\
protogen check schemas/rn2.yaml     # there is no such file
""",
        """\
protogen check schemas/rn1.yaml
""",
        compiles=False,
    ),
    Code(
        "PG002",
        "not-utf8",
        "A file is not UTF-8",
        """\
Schemas are UTF-8, with or without a byte order mark. The place is that of the first byte
that does not fit. Most editors can save a file with another encoding.
""",
        """\
unit: "\\xB0C"       # the degree sign as the single byte B0, as Latin-1 writes it
""",
        """\
unit: "°C"          # the degree sign as the two bytes C2 B0
""",
        compiles=False,
    ),
    Code(
        "PG003",
        "file-too-large",
        "A file is larger than 8 MiB",
        """\
A schema of a thousand messages takes about a fifteenth of that. A larger file is most likely
not a schema; if it is one, split it along its protocols.
""",
        """\
# 8388609 bytes or more
""",
        """\
# 8388608 bytes or fewer
""",
        compiles=False,
    ),
    Code(
        "PG004",
        "yaml-syntax",
        "The text is not YAML",
        """\
The file can't be taken apart into mappings, lists and scalars, or it holds a character that
YAML does not allow. Nothing more can be said of it until this is fixed. A frequent cause
is a text that holds `: ` or ` #` and has no quotes around it.
""",
        """\
title: Motor board: the link
""",
        """\
title: "Motor board: the link"
""",
    ),
    Code(
        "PG005",
        "tab",
        "A tab outside of a comment",
        """\
YAML does not allow tabs in indentation, and parsers disagree about tabs elsewhere, so a
schema holds none. Indent with spaces. A tab that belongs to a text is written `\\t` between
double quotes.
""",
        """\
link:
\tbaud: 115200
""",
        """\
link:
  baud: 115200
""",
    ),
    Code(
        "PG006",
        "duplicate-key",
        "A key stands twice in one mapping",
        """\
Only one of the two values could be used, and a reader can't know which. Keys are compared
by value: `0x1B` and `27` are the same key.
""",
        """\
link: {baud: 9600, parity: none, baud: 115200}
""",
        """\
link: {baud: 115200, parity: none}
""",
    ),
    Code(
        "PG007",
        "too-many-values",
        "A file holds too many values",
        """\
With its aliases written out, a file may hold 1000000 values, and an alias may not stand
inside of what it repeats. A few lines of aliases of aliases (an *alias bomb*) would
otherwise fill any memory.
""",
        """\
a: &a [0, 0, 0, 0, 0, 0, 0, 0, 0, 0]
b: &b [*a, *a, *a, *a, *a, *a, *a, *a, *a, *a]
c: &c [*b, *b, *b, *b, *b, *b, *b, *b, *b, *b]
d: &d [*c, *c, *c, *c, *c, *c, *c, *c, *c, *c]
e: &e [*d, *d, *d, *d, *d, *d, *d, *d, *d, *d]
f: &f [*e, *e, *e, *e, *e, *e, *e, *e, *e, *e]
""",
        """\
a: &a [0, 0, 0, 0, 0, 0, 0, 0, 0, 0]
b: &b [*a, *a, *a, *a, *a, *a, *a, *a, *a, *a]
""",
    ),
    Code(
        "PG008",
        "not-one-document",
        "A file holds no document, or several",
        """\
One file describes one protocol. A file that holds nothing but comments describes none; a
line `---` in the middle of a file begins a second document.
""",
        """\
protocol: rn1
---
protocol: rn2
""",
        """\
protocol: rn1
""",
    ),
    Code(
        "PG009",
        "bad-key",
        "A key is not a name or an integer",
        """\
The key of a mapping is a name, an integer or a boolean. Lists, mappings, fractions and
nothing at all are no keys. A name that YAML reads as something else, such as `null` or
`1.5`, needs quotes.
""",
        """\
values: {null: 0, ready: 1}
""",
        """\
values: {nothing: 0, ready: 1}
""",
    ),
    Code(
        "PG010",
        "too-deep",
        "Values are nested too deeply",
        """\
Mappings and lists may stand inside each other 64 deep, aliases written out. No schema needs
a quarter of that.
""",
        f"value: {'[' * 64}{']' * 64}\n",
        f"value: {'[' * 63}{']' * 63}\n",
    ),
    Code(
        "PG011",
        "tag",
        "A YAML tag is not allowed",
        """\
A schema has no tags (`!name`, `!!str`): what a value means follows from its key. Take the
tag away; a text that looks like a number needs quotes.
""",
        """\
revision: !!str 1.10
""",
        """\
revision: "1.10"
""",
    ),
    Code(
        "PG012",
        "merge-key",
        "The merge key `<<` is not allowed",
        """\
`<<` was a proposal for YAML 1.1 and is no part of YAML 1.2, and editors treat it
differently. An alias repeats a whole value. A schema that differs from another one in a few
places `extends` it.
""",
        """\
link: &link {baud: 9600}
other: {<<: *link, parity: none}
""",
        """\
link: {baud: 9600}
other: {baud: 9600, parity: none}
""",
    ),
)
