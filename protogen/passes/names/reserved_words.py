"""Words that a name can't be, because a language that targets print has taken them."""

from __future__ import annotations

import keyword

C = """
auto break case char const continue default do double else enum extern float for goto if inline int
long register restrict return short signed sizeof static struct switch typedef union unsigned void
volatile while bool true false nullptr alignas alignof thread_local static_assert typeof constexpr
errno asm main stdin stdout stderr assert null offsetof
"""

CPP = """
alignas alignof and and_eq asm bitand bitor bool catch char8_t char16_t char32_t class co_await
co_return co_yield compl concept consteval constexpr constinit const_cast decltype delete
dynamic_cast explicit export false friend mutable namespace new noexcept not not_eq nullptr operator
or or_eq private protected public reinterpret_cast requires static_assert static_cast template this
thread_local throw true try typeid typename using virtual wchar_t xor xor_eq
"""

_JAVASCRIPT = """
arguments await break case catch class const continue debugger default delete do else enum eval
export extends false finally for function if implements import in instanceof interface let new null
package private protected public return static super switch this throw true try typeof undefined
var void while with yield
"""

DIRECTIVES = frozenset({"rename", "remove", "replace", "after", "before"})
"""Words of `extends`, which would be taken for directives where a name stands."""

_LANGUAGES: dict[str, frozenset[str]] = {
    "C": frozenset(C.split()),
    "C++": frozenset(CPP.split()),
    "Python": frozenset(word for word in keyword.kwlist if word.islower()) | {"self"},
    "JavaScript": frozenset(_JAVASCRIPT.split()),
    "protogen": DIRECTIVES,
}


def languages_reserving(name: str) -> tuple[str, ...]:
    """The languages in which `name` can't be used, in a fixed order."""
    return tuple(language for language, words in _LANGUAGES.items() if name in words)
