"""Programs for `protogen.native.printer`: steps that print rows, put together piece by piece."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from protogen.native.printer import CODES, Kind, Operand, Script, Step

JSON, JSON_ASCII, PLAIN = range(3)
"""Tables of how characters are spelled: as JSON lines have them, as JSON in ASCII, as they are."""
QUOTED = ('"nan"', '"inf"', '"-inf"')
"""What JSON lines have for NaN, infinity and minus infinity."""


@dataclass(frozen=True, slots=True)
class Place:
    """Where a number lies, seen from wherever it is asked for."""

    depth: int
    """How many lists are around the record that it is a member of."""
    code: str
    """Its type, as NumPy calls it."""
    offset: int
    """Bytes, in that record."""

    def seen(self, depth: int) -> Operand:
        """The operand of a step that has so many lists around it."""
        return operand(self.code, self.offset, self.depth - depth - 1)


def operand(code: str, offset: int = 0, source: int = -1) -> Operand:
    """A number of this type; `source` as in `Operand`, by default the record at hand."""
    return Operand(source, CODES.index("u1" if code == "?" else code), offset)


class Programs:
    """Gathers the programs of a script."""

    def __init__(self) -> None:
        self._steps: list[Step] = []
        self._pool = bytearray()
        self._texts: dict[tuple[str, ...], int] = {}
        self._spans: list[tuple[int, int]] = []
        self._choices: list[tuple[int, int]] = []
        self._pending = ""

    @property
    def here(self) -> int:
        """The number of the next step, which others may go on at."""
        self._flush()
        return len(self._steps)

    def script(self, special: bytes = bytes(256)) -> Script:
        """All programs."""
        escapes = [
            [_json(chr(it), is_ascii=False) for it in range(256)],
            [_json(chr(it), is_ascii=True) for it in range(256)],
            [chr(it).encode() for it in range(256)],
        ]
        pool = bytes(self._pool)
        return Script(self._steps, pool, self._spans, self._choices, escapes, special)

    # --- steps ------------------------------------------------------------------------------------

    def text(self, text: str) -> None:
        """A fixed text."""
        self._pending += text

    def number(self, place: Operand, code: str, others: tuple[str, str, str] = QUOTED) -> None:
        """An integer, `true` or `false`, or a float; `others` as `QUOTED`."""
        if code == "?":
            self.name(place, ("false", "true"))
        elif code.startswith("f"):
            self.step(Kind.FLOAT, b=self._named(others), x=place)
        else:
            self.step(Kind.INTEGER, x=place)

    def name(self, place: Operand, texts: Sequence[str]) -> None:
        """One of several texts, by its number; nothing where the number is none of theirs."""
        self.step(Kind.NAME, b=self._named(tuple(texts)), c=len(texts), x=place)

    def step(
        self,
        kind: Kind,
        a: int = 0,
        b: int = 0,
        c: int = 0,
        x: Operand = Operand(),  # noqa: B008
        y: Operand = Operand(),  # noqa: B008
    ) -> int:
        """A step; its number."""
        place = self.here
        self._steps.append(Step(kind, a, b, c, x, y))
        return place

    def end(self) -> None:
        """The end of a program."""
        self.step(Kind.END)

    def when(self, kind: Kind, place: Operand, body: Callable[[], None]) -> None:
        """`body` only where a number is not 0 (`IF`), or where that is so or the row is odd."""
        start = self.step(kind, x=place)
        body()
        self._steps[start] = self._steps[start]._replace(a=self.here)

    def listed(
        self,
        first: Operand,
        stride: int,
        count: Operand | int,
        body: Callable[[], None],
        beside: int = -1,
    ) -> None:
        """`body` for each element, with commas between them; `beside` is a column of bytes."""
        if isinstance(count, int):
            start = self.step(Kind.FIXED, beside, stride, x=first, y=Operand(offset=count))
        else:
            start = self.step(Kind.LIST, beside, stride, x=first, y=count)
        body()
        self.step(Kind.NEXT)
        self._steps[start] = self._steps[start]._replace(c=self.here)

    def choose(
        self,
        selector: Operand,
        cases: Sequence[tuple[int, Callable[[], None]]],
        rest: Callable[[], None],
    ) -> None:
        """The body of the case whose value the selector has."""
        start = self.step(Kind.SWITCH, x=selector)
        starts, ends = [], []
        for body in (*(body for _, body in cases), rest):
            starts.append(self.here)
            body()
            ends.append(self.step(Kind.JUMP))
        first = len(self._choices)
        self._choices += [(value, at) for (value, _), at in zip(cases, starts[:-1], strict=True)]
        step = self._steps[start]
        self._steps[start] = step._replace(a=first, b=len(cases), c=starts[-1])
        for place in ends:
            self._steps[place] = self._steps[place]._replace(a=self.here)

    # --- texts ------------------------------------------------------------------------------------

    def _flush(self) -> None:
        if self._pending:
            place, size = self._stored(self._pending)
            self._pending = ""
            self._steps.append(Step(Kind.TEXT, b=place, c=size))

    def _named(self, texts: tuple[str, ...]) -> int:
        if texts not in self._texts:
            self._texts[texts] = len(self._spans)
            self._spans += [self._stored(text) for text in texts]
        return self._texts[texts]

    def _stored(self, text: str) -> tuple[int, int]:
        data = text.encode()
        self._pool += data
        return len(self._pool) - len(data), len(data)


def _json(character: str, *, is_ascii: bool) -> bytes:
    return json.dumps(character, ensure_ascii=is_ascii)[1:-1].encode()


def needs_quotes(writer: Callable[[str], str], characters: Iterable[str]) -> bytes:
    """For each byte of UTF-8, 1 if a value that has it is put in quotes by `writer`."""
    special = bytearray(256)
    for character in characters:
        if writer(character).startswith('"'):
            for byte in character.encode():
                special[byte] = 1
    return bytes(special)
