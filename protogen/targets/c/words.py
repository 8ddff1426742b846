"""Words that nothing in C may be called, where the name of the protocol does not stand in front."""

from __future__ import annotations

from collections.abc import Iterator

from protogen.passes.names.reserved_words import CPP, C
from protogen.targets.naming import Thing

_GNU_MACROS = """
linux unix i386 sun sparc mips vax hpux pdp11 bfin mc68000 mc68010 mc68020 mc68030 mc68040 mc68060
"""
"""What compilers define beside the standard, each for some system, unless they are told not to."""

_TYPES = """
int8_t int16_t int32_t int64_t uint8_t uint16_t uint32_t uint64_t size_t
"""
"""Types that generated code uses. A member called like one would be another type in C++."""

_HEADERS = """
assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign
stdarg stdatomic stdbool stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar
wchar wctype
"""


def headers() -> Iterator[str]:
    """Headers of C, in place of which compilers would find a protocol's own."""
    return (f"{name}.h" for name in _HEADERS.split())


def foreign_words() -> Iterator[tuple[str, Thing]]:
    """Each word, with what it is."""
    kinds = {
        "is a reserved word of C++": CPP,
        "is a reserved word of C": C,
        "is a macro of some C compilers": _GNU_MACROS,
        "is a type of C's standard library": _TYPES,
    }
    for what, words in kinds.items():
        thing = Thing(what)
        for word in words.split():
            yield word, thing
