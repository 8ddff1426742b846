"""Small functions that codecs share, each printed only where it is used."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from fractions import Fraction
from math import inf

import msgspec

from protogen.c_language.expressions import floored
from protogen.c_language.numbers import (
    constant,
    hexadecimal,
    integer_type,
    layout_name,
    unsigned_type,
)
from protogen.model.expressions import ArithmeticOperator
from protogen.model.floats import float_within
from protogen.model.payload_plan import FloatStep
from protogen.model.types import Float, NumberType, storage_bits
from protogen.targets.c.lines import Lines, function
from protogen.targets.c.payload.float_bounds import float_literal, float_order
from protogen.targets.c.payload.number_bytes import (
    cut,
    joined,
    parted,
    sign_extended,
    stored_type,
    widened,
)
from protogen.targets.c.spelling import Names

_AT = "const uint8_t *at"
_SHORT = 2
"""Bytes of numbers that are written where they stand, and not by a call."""

_LOAD_RUN = """\
size_t i = 0;
#if {upper}_SSE2
const size_t eights = count & ~(size_t)7U; /* The compiler sees that this is no more than count. */
for (; i < eights; i += 8U) {{
    const void *const from = &at[2U * i];
    const __m128i pairs = _mm_loadu_si128((const __m128i *)from);
    const __m128i low = _mm_and_si128(pairs, _mm_set1_epi16(0x7F));
    const __m128i next = _mm_srli_epi16(pairs, 1);
    const __m128i high = _mm_and_si128(next, _mm_set1_epi16(0x3F80));
    _mm_storeu_si128((__m128i *)(void *)&numbers[i], _mm_or_si128(low, high));
}}
#endif
for (; i < count; i++) {{
    numbers[i] = {load}(&at[2U * i]);
}}
"""
_REINTERPRET = """\
{target} value;
unsigned char *to = (unsigned char *)&value;
const unsigned char *from = (const unsigned char *)&given;
for (size_t i = 0; i < sizeof value; i++) {{
    to[i] = from[i];
}}
return value;
"""
_FLOAT64_ORDER = """\
const uint64_t bits = {bits}(value);
return (bits & {top}) != 0U ? ~bits : bits | {top};
"""
_WRITE_BYTES = """\
const uint8_t *bytes = (const uint8_t *)from;
for (size_t i = 0; i < size; i++) {{
    {prefix}_write({writing}, bytes[i]);
}}
"""
_COPY = """\
uint8_t *target = (uint8_t *)to;
const uint8_t *source = (const uint8_t *)from;
while (size > 0U) {
    size--;
    target[size] = source[size];
}
"""
_IS_SEVEN_BIT = """\
const uint8_t *bytes = (const uint8_t *)at;
uint8_t all = 0U;
for (size_t i = 0; i < size; i++) {
    all |= bytes[i];
}
return all <= 0x7FU;
"""
_TEXT_SIZE = """\
const uint8_t *bytes = (const uint8_t *)at;
size_t length = 0U;
while (length < size && bytes[length] != end) {
    length++;
}
return length;
"""
_ALL_BITS = """\
{kind} all = 0U;
for (size_t i = 0; i < count; i++) {{
    all |= numbers[i];
}}
return all;
"""
_MISSING = """\
if (need != NULL) {{
    *need = due;
}}
return {upper}_ERROR_SIZE;
"""


class _Helper(msgspec.Struct):
    """A function that was asked for."""

    name: str
    result: str
    arguments: tuple[str, ...]
    body: Lines
    is_public: bool = False
    """True if an inline function of the header calls it."""
    is_short: bool = False
    """True if it is put where it is called, which takes no more room than the call."""
    is_everywhere: bool = False
    """False if only code calls it that is left out where structs lie in memory as on the wire."""

    def text(self, words: str) -> str:
        """The definition."""
        return function(f"{words} {self.result} {self.name}", self.arguments, self.body)


class Helpers:
    """The helpers that were asked for, in the order in which they have to be printed."""

    def __init__(self, names: Names) -> None:
        self._names = names
        self._upper = names.prefix.upper()
        self._helpers: dict[str, _Helper] = {}
        self._is_public = False
        self._is_left_out = False
        self.floats: set[int] = set()
        """Bits of the floats that were asked for."""
        self.has_vectors = False
        """True if some function has a way for SSE2."""

    @property
    def writer(self) -> str:
        """The parameter that takes bytes one by one."""
        return self._names.writer

    def member(self, name: str) -> str:
        """The member for a field or a case."""
        return self._names.member(name)

    @property
    def texts(self) -> tuple[str, ...]:
        """The definitions of the functions that only the source calls."""
        inline = f"{self._upper}_INLINE"
        found = [item for item in self._helpers.values() if not item.is_public]
        texts = [item.text(inline if item.is_short else "static") for item in found]
        unless = f"#if !{self._upper}_AS_IN_MEMORY"
        return tuple(
            text if item.is_everywhere else f"{unless}\n{text}\n#endif"
            for item, text in zip(found, texts, strict=True)
        )

    @property
    def public_texts(self) -> tuple[str, ...]:
        """The definitions of those that inline functions of the header call as well."""
        found = (item for item in self._helpers.values() if item.is_public)
        return tuple(item.text("static inline") for item in found)

    @contextmanager
    def public(self) -> Iterator[None]:
        """Helpers asked for meanwhile are called by inline functions of the header."""
        self._is_public = True
        yield
        self._is_public = False

    @contextmanager
    def left_out(self, is_image: bool) -> Iterator[None]:
        """Code printed meanwhile is left out where a struct lies in memory as on the wire."""
        self._is_left_out = is_image
        yield
        self._is_left_out = False

    def helper(
        self,
        key: str,
        result: str,
        arguments: tuple[str, ...],
        body: str | Iterable[str],
        *,
        is_short: bool = False,
    ) -> str:
        """The name of a helper, which is added where it is not there yet."""
        if key not in self._helpers:
            lines = Lines()
            lines.add(*(body.splitlines() if isinstance(body, str) else body))
            name = self._names.claim_helper(key)
            self._helpers[key] = _Helper(name, result, arguments, lines, is_short=is_short)
        found = self._helpers[key]
        found.is_public |= self._is_public
        found.is_everywhere |= not self._is_left_out
        return found.name

    # --- reading --------------------------------------------------------------------------------

    def load(self, type_: NumberType) -> str:
        """The function that reads a number of more than one byte, or of a part of one."""
        if isinstance(type_, Float):
            bits = f"{self.load(type_.unsigned)}(at)"
            result = self.float_type(type_)
            body: Iterable[str] = [f"return {self._reinterpret(type_, from_bits=True)}({bits});"]
        elif type_.signed and _is_pair(type_):
            result, body = integer_type(type_), _signed_pair(type_)
        elif type_.signed:
            raw = f"{self.load(type_.unsigned)}(at)" if type_.size > 1 else "at[0]"
            result, body = integer_type(type_), sign_extended(type_, raw)
        else:
            type_ = widened(type_)
            result, body = integer_type(type_), _joined(type_)
        return self.helper(f"load_{layout_name(type_)}", result, (_AT,), body)

    def extended(self, type_: NumberType, raw: str) -> str:
        """The signed number that has these bits."""
        body = sign_extended(type_, "raw")
        arguments = (f"{unsigned_type(type_.bits)} raw",)
        name = self.helper(f"extend_s{type_.bits}", integer_type(type_), arguments, body)
        return f"{name}({raw})"

    def loads_runs(self, type_: NumberType) -> bool:
        """True if an array of such numbers is read by a function of its own."""
        if type_.signed or self._is_public:
            return False
        return _is_pair(type_) and type_.byte_order == "little"

    def load_run(self, type_: NumberType) -> str:
        """The function that reads an array of numbers of two seven-bit bytes."""
        self.has_vectors = True
        body = _LOAD_RUN.format(upper=self._upper, load=self.load(type_))
        arguments = (f"{integer_type(type_)} *numbers", _AT, "size_t count")
        return self.helper(f"load_{layout_name(type_)}_run", "void", arguments, body)

    # --- arithmetic -------------------------------------------------------------------------------

    def floored(self, operator: ArithmeticOperator, type_: NumberType) -> str:
        """The function that divides by a number above 0, rounding down, or gives what remains."""
        kind = integer_type(type_)
        body = [f"return ({kind})({floored(operator, 'number', 'by')});"]
        key = f"{'quotient' if operator == '//' else 'remainder'}{type_.bits}"
        return self.helper(key, kind, (f"{kind} number", f"{kind} by"), body)

    # --- floats ---------------------------------------------------------------------------------

    def float_type(self, type_: Float) -> str:
        """The type of a member that holds such floats."""
        self.floats.add(type_.bits)
        return "float" if type_.bits == 32 else f"{self._names.prefix}_float64"

    def _reinterpret(self, type_: Float, *, from_bits: bool) -> str:
        key = f"float{type_.bits}_of" if from_bits else f"bits{type_.bits}_of"
        source, target = unsigned_type(type_.bits), self.float_type(type_)
        if not from_bits:
            source, target = target, source
        body = _REINTERPRET.format(target=target)
        return self.helper(key, target, (f"{source} given",), body)

    def bits_of_float(self, type_: Float) -> str:
        """The function that gives the bits of a float."""
        return self._reinterpret(type_, from_bits=False)

    def float_tests(self, step: FloatStep, expression: str) -> list[str]:
        """Conditions that hold for floats in the range of a step."""
        least, greatest = step.field.least, step.field.greatest
        if step.type.bits == 64:
            return self._float64_tests(step.type, expression, least, greatest)
        low = [] if least is None else [f"{expression} >= {float_literal(least, up=True)}"]
        if greatest is None:
            return low
        return [*low, f"{expression} <= {float_literal(greatest, up=False)}"]

    def _float64_tests(
        self, type_: Float, expression: str, least: Fraction | None, greatest: Fraction | None
    ) -> list[str]:
        """By the bits, which are in the order of the numbers: not every target has a double."""
        body = _FLOAT64_ORDER.format(bits=self.bits_of_float(type_), top=hexadecimal(1 << 63))
        value = f"{self.float_type(type_)} value"
        order = self.helper("float64_order", "uint64_t", (value,), body)
        low = -inf if least is None else float_within(least, 64, up=True)
        high = inf if greatest is None else float_within(greatest, 64, up=False)
        bounds = float_order(low or -0.0), float_order(high or 0.0)
        return [
            f"{order}({expression}) {sign} {hexadecimal(bound, 16)}"
            for sign, bound in zip((">=", "<="), bounds, strict=True)
        ]

    # --- writing --------------------------------------------------------------------------------

    def store(self, type_: NumberType) -> str:
        """The function that writes an unsigned number."""
        layout = cut(type_)
        arguments = ("uint8_t *at", f"{stored_type(type_)} value")
        body = _stored(layout)
        name, is_short = f"store_{layout_name(layout)}", layout.size <= _SHORT
        return self.helper(name, "void", arguments, body, is_short=is_short)

    def write(self, type_: NumberType) -> str:
        """The function that hands an unsigned number to a writer, byte by byte."""
        layout, names = cut(type_), self._names
        body = _written(layout, f"{names.prefix}_write({names.writing}")
        arguments = (names.writer, f"{unsigned_type(type_.bits)} value")
        # A writer is one argument; a function and what it is called with are two, which have to be
        # kept from one byte to the next.
        is_short = layout.size <= _SHORT and names.is_stateless
        name = f"write_{layout_name(layout)}"
        return self.helper(name, "void", arguments, body, is_short=is_short)

    def write_bytes(self) -> str:
        """The function that hands several bytes to a writer."""
        names = self._names
        body = _WRITE_BYTES.format(prefix=names.prefix, writing=names.writing)
        arguments = (names.writer, "const void *from", "size_t size")
        return self.helper("write_bytes", "void", arguments, body)

    def buffered(
        self, name: str, store: str, parameters: tuple[str, ...], passed: str, room: int
    ) -> str:
        """The function that hands to a writer what `store` makes of these, and says the size of."""
        names = self._names
        body = [
            f"uint8_t text[{room}];",
            f"const size_t size = {store}(text, {passed});",
            f"{self.write_bytes()}({names.writing}, text, size);",
        ]
        return self.helper(name, "void", (names.writer, *parameters), body)

    # --- bytes ----------------------------------------------------------------------------------

    def copy(self) -> str:
        """The function that copies bytes; a freestanding compiler has no header for one.

        From the last to the first: with -O3, gcc 12 makes vectors of a loop that goes forwards, and
        warns that they don't fit into arrays as small as ours.
        """
        arguments = ("void *to", "const void *from", "size_t size")
        return self.helper("copy", "void", arguments, _COPY)

    def seven_bit(self) -> str:
        """The function that says whether no byte has its most significant bit set."""
        arguments = ("const void *at", "size_t size")
        return self.helper("is_seven_bit", "bool", arguments, _IS_SEVEN_BIT)

    def text_size(self) -> str:
        """The function that counts the bytes in front of one that ends them, or all."""
        arguments = ("const void *at", "size_t size", "uint8_t end")
        return self.helper("text_size", "size_t", arguments, _TEXT_SIZE)

    def all_bits(self, type_: NumberType) -> str:
        """The function that says which bits are set in some number of an array."""
        kind = unsigned_type(type_.bits)
        arguments = (f"const {kind} *numbers", "size_t count")
        key = f"all_bits_u{storage_bits(type_.bits)}"
        return self.helper(key, kind, arguments, _ALL_BITS.format(kind=kind))

    def missing(self) -> str:
        """The function that says how many bytes a payload needs at least."""
        result = f"enum {self._names.prefix}_result"
        body = _MISSING.format(upper=self._upper)
        return self.helper("missing", result, ("size_t *need", "size_t due"), body)

    def known(self, type_: NumberType) -> str:
        """The function that says whether a closed enum has a value."""
        assert type_.enum is not None
        values = [item.value for item in type_.enum.values]
        labels = (v if abs(v) < 0x8000 else constant(v, type_) for v in values)
        body = [
            "switch (value) {",
            *(f"case {label}:" for label in labels),
            "    return true;",
            "default:",
            "    return false;",
            "}",
        ]
        argument = f"{integer_type(type_)} value"
        return self.helper(f"is_{type_.enum.name}", "bool", (argument,), body)


# --- bodies: printed where a helper is asked for the first time -----------------------------------


def _joined(type_: NumberType) -> Iterator[str]:
    yield from joined(type_, "at")


def _is_pair(type_: NumberType) -> bool:
    """True for a number that fills two bytes of seven bits."""
    return (type_.byte_bits, type_.bits, type_.size) == (7, 14, 2)


def _signed_pair(type_: NumberType) -> tuple[str, ...]:
    """The statements that return it by the sign of its upper byte: shorter than by its own."""
    low, high = (0, 1) if type_.byte_order == "little" else (1, 0)
    return (
        f"const int8_t top = (int8_t)(uint8_t)(at[{high}] << 1);",
        "const int16_t upper = (int16_t)((int16_t)top * 64);",
        f"const uint16_t joined = (uint16_t)((uint16_t)upper | at[{low}]);",
        "return (int16_t)joined;",
    )


def _stored(type_: NumberType) -> Iterator[str]:
    yield from _own_bits(type_)
    stored = [f"at[{place}] = {byte};" for place, byte in enumerate(_own_bytes(type_))]
    # A mask needs no copy of the number where the byte that has its lowest bits comes last.
    is_turned = type_.byte_bits < 8 and type_.byte_order == "little"
    yield from reversed(stored) if is_turned else stored


def _written(type_: NumberType, call: str) -> Iterator[str]:
    yield from _own_bits(type_)
    for byte in _own_bytes(type_):
        yield f"{call}, {byte});"


def _own_bits(type_: NumberType) -> Iterator[str]:
    """A signed number without the bits above its own: one mask instead of one for each byte."""
    if type_.signed:
        kind, mask = unsigned_type(type_.bits), hexadecimal((1 << type_.bits) - 1)
        yield f"const {kind} own = ({kind})(value & {mask});"


def _own_bytes(type_: NumberType) -> tuple[str, ...]:
    """Its bytes in wire order."""
    return parted(type_.unsigned, "own" if type_.signed else "value")
