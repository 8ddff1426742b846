"""Parts of a frame that the caller gives, as arguments of C."""

from __future__ import annotations

import msgspec

from protogen.c_language.numbers import unsigned_type
from protogen.copying import replace
from protogen.model.identities import Runs
from protogen.model.parts import ChoicePart, IdentityPart, NumberPart
from protogen.targets.c.decoders.groups import in_run
from protogen.targets.c.frame.expressions import wire_bytes
from protogen.targets.c.frame.numbers import has_others, none_of
from protogen.targets.c.spelling import Names

_WORDS = (
    "added before byte capacity code content due frame from full high i index kept length literal "
    "low message payload put result seen size stuffed sum sum_at tail to user wire writer written"
)
_LOCAL = frozenset(_WORDS.split())
"""Names of the functions' own variables."""


class Argument(msgspec.Struct, frozen=True):
    """A part of the frame that the caller gives."""

    name: str
    part: str
    """Name in the schema."""
    type: str
    doc: str
    refused: str
    """The condition of a value out of range; empty where all of the type's are in it."""


def argument_name(part: str, names: Names) -> str:
    """Name of the argument for a part that the caller gives: one for each part."""
    word = part
    while word.endswith("_part"):
        word = word.removesuffix("_part")
    return f"{part}_part" if word in _LOCAL else names.member(part)


def one_of(argument: Argument, part: IdentityPart, runs: Runs) -> Argument:
    """The argument of an identity part of which a message has several values."""
    conditions = [in_run(argument.name, run, part.type) for run in runs]
    is_one = " || ".join(f"({item})" if " && " in item else item for item in conditions)
    return replace(argument, refused=f"!({is_one})" if all(conditions) else "")


def argument_of(part: NumberPart, name: str) -> Argument:
    """The argument of a part, which C knows by this name, or as a member of the message."""
    bits = part.type.width
    conditions = []
    if part.least > 0:
        conditions.append(f"{name} < {part.least}U")
    if part.greatest < (1 << bits) - 1:
        conditions.append(f"{name} > {part.greatest}U")
    if isinstance(part, ChoicePart):
        conditions = [none_of(part, name)]
    elif part.between is not None:
        conditions = [has_others(part, part.between, wire_bytes(part.type, name))]
    type_, refused = unsigned_type(part.type.bits), " || ".join(conditions)
    return Argument(name, part.name, type_, part.about.doc, refused)
