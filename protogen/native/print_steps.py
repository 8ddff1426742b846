"""Steps that print a row as text. `print_source.py` makes C of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import Enum
from fractions import Fraction
from typing import NamedTuple

import msgspec

MAX_INTEGER = 20
"""Characters of an integer of 64 bits with its sign."""
MAX_FLOAT = 40
"""Characters of a float."""


class Place(msgspec.Struct, frozen=True):
    """Location of a number, or of the first byte of something, in a row."""

    depth: int
    """Lists around the record that it is a member of; 0: that is the row."""
    code: str
    """Its type, as NumPy calls it."""
    offset: int
    """Bytes from the start of the record."""


Count = Place | int


class Others(NamedTuple):
    """Texts for the floats that are no finite numbers."""

    nan: str
    infinity: str
    minus_infinity: str


IN_LINES = Others('"nan"', '"inf"', '"-inf"')
"""Texts of JSON lines, which are strict JSON."""
IN_JSON = Others("NaN", "Infinity", "-Infinity")
"""Texts of `json.dumps`."""
IN_CELLS = Others("nan", "inf", "-inf")
"""Texts of `str`."""


class Spelling(Enum):
    """Spellings of characters."""

    JSON = "put_json"
    JSON_ASCII = "put_json_ascii"
    PLAIN = "put_plain"


class Literal(msgspec.Struct, frozen=True):
    """A fixed text."""

    text: str


class Int(msgspec.Struct, frozen=True):
    """An integer; `from_start`: with the offset of the capture's first byte added."""

    place: Place
    from_start: bool = False


class Bool(msgspec.Struct, frozen=True):
    """A bool: `true` or `false`."""

    place: Place


class Float(msgspec.Struct, frozen=True):
    """The shortest decimal that is read as the same float."""

    place: Place
    others: Others


class Physical(msgspec.Struct, frozen=True):
    """The physical value of a raw one, raw x scale + offset, rounded once."""

    place: Place
    scale: Fraction
    offset: Fraction
    special: Sequence[int]
    """Raw values that have none."""
    missing: str
    """Text for those."""
    others: Others


class Name(msgspec.Struct, frozen=True):
    """The text of a number; nothing for a number that has none."""

    place: Place
    texts: Mapping[int, str]


class Characters(msgspec.Struct, frozen=True):
    """Text that lies in the row, padded with NUL.

    `count`: its characters; None: up to the last one that is not NUL.
    """

    place: Place
    room: int
    count: Count | None
    spelling: Spelling


class Hex(msgspec.Struct, frozen=True):
    """Two digits for each of some bytes that lie in the row."""

    place: Place
    count: Count


class Source(Enum):
    """Bytes that lie outside of rows."""

    LINE = "job->line"
    """The bytes of the capture."""
    PAYLOADS = "rows->payloads"
    """The payloads of unknown frames."""


class HexOf(msgspec.Struct, frozen=True):
    """Two digits for each of some bytes that lie elsewhere."""

    source: Source
    start: Place
    size: Place


class Repeat(msgspec.Struct, frozen=True):
    """Steps for each element of a list, with commas between the elements."""

    first: Place
    stride: int
    count: Count
    body: Steps


class Choose(msgspec.Struct, frozen=True):
    """The steps of the case whose value a number has, else those of `rest`."""

    place: Place
    cases: Sequence[tuple[int, Steps]]
    rest: Steps


class Condition(Enum):
    """Facts about a row that are not in it."""

    DIFFERS = "is_odd || (rows->differs != NULL && rows->differs[rows->next])"
    """An encoder makes other bytes of what is printed."""
    TIMED = "rows->times != NULL && rows->timed[rows->next]"
    """The time of the row is known."""


class When(msgspec.Struct, frozen=True):
    """Steps that are taken where a condition holds."""

    condition: Condition
    body: Steps


class Time(msgspec.Struct, frozen=True):
    """The time of the row."""


class Quoted(msgspec.Struct, frozen=True):
    """One value of CSV, in quotes where it needs them."""

    body: Steps


Bounded = Literal | Int | Bool | Float | Physical | Name | Time
"""Steps that print at most so many characters."""
Unbounded = Characters | Hex | HexOf | Repeat | Choose | When | Quoted
Step = Bounded | Unbounded
Steps = Sequence[Step]


def number(place: Place, others: Others) -> Step:
    """The step that prints a number of any type."""
    if place.code == "?":
        return Bool(place)
    return Float(place, others) if place.code.startswith("f") else Int(place)


def max_size(step: Bounded) -> int:
    """The most characters that a step prints."""
    match step:
        case Literal(text=text):
            return len(text.encode())
        case Int() | Time():
            return MAX_INTEGER
        case Bool():
            return len("false")
        case Float() | Physical():
            return MAX_FLOAT
        case Name(texts=texts):
            return max((len(text.encode()) for text in texts.values()), default=0)
