"""Spelling of the schema's names and numbers in C."""

from __future__ import annotations

from collections import ChainMap
from functools import cache, lru_cache

from protogen.model.names import free_name
from protogen.model.types import Float, NumberType, counting_bits, storage_bits
from protogen.targets.naming import NameTable, Thing

_INT_MAX = 0x7FFF
"""The greatest `int` that every target has."""


class Names:
    """File-scope names, and what each of them stands for.

    The schema's names are words that C does not reserve, but two of them, joined with others, can
    come to the same (`robot` with `mode_idle`, `robot_mode` with `idle`). Such a schema is refused.
    """

    def __init__(self, prefix: str, writer: str = "", writing: str = "") -> None:
        self.prefix = prefix
        self.writer = writer
        """The parameters of functions that send byte by byte."""
        self.writing = writing
        """Arguments with which these hand the writer on."""
        self.tags = NameTable()
        """Structs, enums and unions, which C knows by these words."""
        self.others = NameTable()
        """Functions, variables, typedefs, macros and named values."""
        self.members = NameTable()
        """Members and parameters, none of which may hide one of the others."""
        self.files = NameTable()

    def copy(self) -> Names:
        """Names that others can be added to without a change of these."""
        names = Names(self.prefix, self.writer, self.writing)
        names.tags, names.others = self.tags.copy(), self.others.copy()
        names.members, names.files = self.members.copy(), self.files.copy()
        return names

    def claim_tag(self, thing: Thing, *words: str) -> str:
        """A struct or an enum: `rn1_gyro`."""
        return self.tags.add(self._joined(words), thing)

    def claim(self, thing: Thing, *words: str) -> str:
        """A function: `rn1_gyro_encode`."""
        return self.others.add(self._joined(words), thing)

    def claim_macro(self, thing: Thing, *words: str) -> str:
        """A macro or a named value: `RN1_GYRO_PAYLOAD_SIZE`."""
        return self.others.add(self._joined(words).upper(), thing)

    def claim_type(self, thing: Thing, *words: str) -> str:
        """A typedef, which in C++ no struct may be called like."""
        return self.others.add(self.tags.add(self._joined(words), thing), thing)

    def claim_helper(self, *words: str) -> str:
        """A function of the source, which gets a number where its name is taken."""
        taken = ChainMap(self.others.things, self.members.things)
        return self.others.add(free_name(self._joined(words), taken))

    def _joined(self, words: tuple[str, ...]) -> str:
        return "_".join((self.prefix, *words))


def from_sender(name: str) -> str:
    """The suffix that tells the functions for a sender from those for others of the message."""
    return f"_from_{name}"


def handler_name(message: str) -> str:
    """What a message's handler is called behind the protocol's name."""
    return f"on_{message}"


# --- types --------------------------------------------------------------------------------------


@cache
def unsigned_type(bits: int) -> str:
    """The smallest unsigned type of so many bits."""
    return f"uint{storage_bits(bits)}_t"


@lru_cache(maxsize=1024)
def integer_type(type_: NumberType) -> str:
    """The type of a member that holds such integers."""
    if type_.role == "bool":
        return "bool"
    return f"{'' if type_.signed else 'u'}int{storage_bits(type_.bits)}_t"


def counting_type(greatest: int) -> str:
    """The type of a number of elements or bytes."""
    return f"uint{counting_bits(greatest)}_t"


@lru_cache(maxsize=1024)
def layout_name(type_: NumberType) -> str:
    """The name of a layout on the wire: `u14le`, `s32be`, `f32le`, `u7`."""
    order = "" if type_.size == 1 else f"{type_.byte_order[0]}e"
    kind = "f" if isinstance(type_, Float) else "s" if type_.signed else "u"
    return f"{kind}{type_.bits}{order}"


# --- numbers ------------------------------------------------------------------------------------


def number(value: int) -> str:
    """A signed constant."""
    if -_INT_MAX <= value <= _INT_MAX:
        return str(value)
    if value == -(1 << 63):
        return f"(-{(1 << 63) - 1}LL - 1)"
    suffix = "L" if -(1 << 31) < value < 1 << 31 else "LL"
    return f"{value}{suffix}"


def unsigned(value: int) -> str:
    """An unsigned constant in decimal digits."""
    return f"{value}{_suffix(value)}"


def hexadecimal(value: int, digits: int = 2) -> str:
    """An unsigned constant in hexadecimal digits."""
    return f"0x{value:0{digits}X}{_suffix(value)}"


def _suffix(value: int) -> str:
    if value <= 0xFFFF:
        return "U"
    return "UL" if value <= 0xFFFFFFFF else "ULL"


def constant(value: int, type_: NumberType) -> str:
    """A constant to compare with a value of that type."""
    return number(value) if type_.signed else unsigned(value)
