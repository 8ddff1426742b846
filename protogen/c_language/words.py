"""Words that nothing in C may be called, where the name of the protocol does not stand in front."""

from __future__ import annotations

_C = """
auto break case char const continue default do double else enum extern float for goto if inline int
long register restrict return short signed sizeof static struct switch typedef union unsigned void
volatile while bool true false nullptr alignas alignof thread_local static_assert typeof constexpr
errno asm main stdin stdout stderr assert null offsetof
"""

_CPP = """
alignas alignof and and_eq asm bitand bitor bool catch char8_t char16_t char32_t class co_await
co_return co_yield compl concept consteval constexpr constinit const_cast decltype delete
dynamic_cast explicit export false friend mutable namespace new noexcept not not_eq nullptr operator
or or_eq private protected public reinterpret_cast requires static_assert static_cast template this
thread_local throw true try typeid typename using virtual wchar_t xor xor_eq
"""
"""Words of C++, which the headers are for as well."""

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


def headers() -> list[str]:
    """Headers of C, in place of which compilers would find a protocol's own."""
    return _HEADERS.split()


def foreign_words() -> list[str]:
    """Reserved words, and what else is not for a schema's names."""
    return " ".join((_C, _CPP, _GNU_MACROS, _TYPES)).split()
