"""Context of the passes: the syntax tree, the places of its nodes, and where problems go."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any

import msgspec

from protogen.model.origin import NOTHING, About, Source
from protogen.model.types import ByteOrder
from protogen.passes.framing.written_frames import Loc, WrittenFrame, written_frames
from protogen.problems import Problem, Problems, Span
from protogen.problems.problem import Note
from protogen.schema.scopes import at
from protogen.schema.syntax.base import Source as SourceSyntax
from protogen.schema.syntax.protocol import ALL_SENDERS, ProtocolSyntax

__all__ = ["Context", "Find", "Loc", "Tally", "about", "source_of"]

_CERTAIN = frozenset(
    {"PG104", "PG105", "PG106", "PG108", "PG120", "PG123", "PG134", "PG143", "PG165"}
)
"""Problems of a single word or number: they are no consequence of what is missing around it."""

_OF_ONE_FIELD = frozenset(
    {"PG110", "PG112", "PG113", "PG114", "PG115"} | {f"PG{number}" for number in range(220, 226)}
)
"""Problems of one field and its declared type: what is missing in other fields has no part in."""
_OF_REFERENCES = frozenset({"PG116", "PG117", "PG121", "PG270", "PG271", "PG272"})
"""Problems of a field with another one that it names."""

Find = Callable[[Loc], Span]


class Tally(msgspec.Struct):
    """Number of errors found, the same problem counted each time."""

    errors: int = 0
    in_examples: int = 0
    """Number of errors that concern examples only."""


class Context(msgspec.Struct, frozen=True, dict=True):
    """One schema on its way through the passes."""

    syntax: ProtocolSyntax
    data: Any
    """Data that the syntax tree was made of."""
    find: Find
    """The place of a value."""
    find_key: Find
    """The place of the key of a value."""
    problems: Problems
    files: tuple[str, ...]
    doubtful: frozenset[Loc] = frozenset()
    """Items of which not everything could be read: what seems wrong with them may be no more than
    a consequence, so it is not reported."""
    lost: frozenset[Loc] = frozenset()
    """Names of which is not known what they mean; a key of the root stands for all its names."""
    spoilt: bool = False
    """True if more than some examples could not be read."""
    places: dict[str, Loc] = msgspec.field(default_factory=dict)
    """Where messages and named types are, those inside of fields by their first use."""
    tally: Tally = msgspec.field(default_factory=Tally)

    def error(self, code: str, loc: Loc, message: str, hint: str | None = None) -> None:
        """Report a problem at a value."""
        self._report(Problem.of(code, self.find(loc), message, hint), loc)

    def error_inside(
        self, code: str, loc: Loc, place: tuple[int, int], message: str, hint: str | None = None
    ) -> None:
        """Report a problem at so many characters of a text, behind so many others."""
        span = self.find(loc)
        start, width = place
        # What is quoted or goes over several lines does not show how far in it is.
        written = at(self.data, loc)
        if isinstance(written, str) and span.end_column - span.column == len(written):
            span = Span.at(span.file, span.line, span.column + start, max(1, width))
        self._report(Problem.of(code, span, message, hint), loc)

    def warning(self, code: str, loc: Loc, message: str, hint: str) -> None:
        """Report what can be read, but may be meant otherwise; it stops nothing."""
        self.problems.add(code, self.find(loc), message, hint)

    def error_at_key(
        self,
        code: str,
        loc: Loc,
        message: str,
        hint: str | None = None,
        note: Note | None = None,
    ) -> None:
        """Report a problem at the key of a value; a note says what else there is to see."""
        self._report(
            Problem.of(code, self.find_key(loc), message, hint, [note] if note else ()), loc
        )

    def _report(self, problem: Problem, loc: Loc) -> None:
        self.tally.errors += 1
        self.tally.in_examples += loc[0] == "messages" and loc[2:3] == ("examples",)
        if problem.code in _CERTAIN or not self._is_doubtful(problem.code, loc):
            self.problems.extend([problem])

    def _is_doubtful(self, code: str, loc: Loc) -> bool:
        """True if the problem may only follow from something that could not be read."""
        if any(loc[:steps] in self.doubtful for steps in range(4, len(loc) + 1)):
            return True
        if loc[0] == "messages" and loc[2:3] == ("fields",):
            if code in _OF_ONE_FIELD:
                return False
            if code in _OF_REFERENCES:
                return loc[:3] in self.doubtful
        return loc[:2] in self.doubtful

    def is_lost(self, key: str, name: str) -> bool:
        """True if `name` may be written under this key of the root, but could not be read.

        What is refused as a name, such as `LeftMotor`, stands for the name it should have been.
        """
        names = (_letters(str(loc[1])) for loc in self.lost if loc[0] == key and len(loc) > 1)
        return (key,) in self.lost or _letters(name) in names

    @cached_property
    def frames(self) -> Mapping[str, WrittenFrame]:
        """The frames as they are written, by the names of their senders."""
        return dict(written_frames(self.syntax))

    def byte_order(self, sender: str) -> ByteOrder | None:
        """Byte order that the protocol states for a sender."""
        orders = self.syntax.byte_order
        return orders.get(sender, orders.get(ALL_SENDERS))

    @property
    def failed(self) -> bool:
        """True if there is an error so far, but for examples, which nothing depends on."""
        return self.spoilt or self.tally.errors > self.tally.in_examples


def _letters(name: str) -> str:
    return "".join(filter(str.isalnum, name)).casefold()


def source_of(syntax: SourceSyntax | None) -> Source | None:
    """The model's form of a source."""
    return None if syntax is None else Source(**dict(syntax))


def about(doc: str | None, source: SourceSyntax | None, span: Span | None = None) -> About:
    """Text for readers about a thing, and where it stands."""
    if doc is None and source is None and span is None:
        return NOTHING
    return About(doc=(doc or "").strip(), source=source_of(source), span=span)
