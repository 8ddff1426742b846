"""Small functions that codecs share, each printed only where it is used."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from fractions import Fraction
from math import inf, nextafter

from protogen.model.types import Float, Integer, storage_bits
from protogen.targets.c.lines import Lines, function
from protogen.targets.c.spelling import (
    Names,
    hexadecimal,
    integer_type,
    layout_name,
    unsigned_type,
)

_AT = "const uint8_t *at"
_MOST_TERMS = 4
"""Bytes that are joined in one expression; more of them are joined in two halves or a loop."""


class Helpers:
    """The helpers that were asked for, in the order in which they have to be printed."""

    def __init__(self, names: Names) -> None:
        self._names = names
        self._known: dict[str, str] = {}
        self._functions: list[tuple[str, tuple[str, ...], Lines]] = []
        self._public: set[str] = set()
        self._is_public = False
        self.floats: set[int] = set()
        """Bits of the floats that were asked for."""
        self.has_vectors = False
        """True if some function has a way for SSE2."""

    @property
    def texts(self) -> tuple[str, ...]:
        """The definitions of the functions that only the source calls."""
        return self._texts("static", public=False)

    @property
    def public_texts(self) -> tuple[str, ...]:
        """The definitions of those that inline functions of the header call as well."""
        return self._texts("static inline", public=True)

    def _texts(self, words: str, *, public: bool) -> tuple[str, ...]:
        return tuple(
            function(f"{words} {head}", arguments, body)
            for head, arguments, body in self._functions
            if (head.split()[-1] in self._public) == public
        )

    @contextmanager
    def public(self) -> Iterator[None]:
        """Helpers asked for meanwhile are called by inline functions of the header."""
        self._is_public = True
        yield
        self._is_public = False

    def _name(self, key: str) -> str | None:
        """A new name, or None where the helper is there already."""
        is_new = key not in self._known
        if is_new:
            self._known[key] = self._names.claim(key)
        if self._is_public:
            self._public.add(self._known[key])
        return self._known[key] if is_new else None

    def _define(self, head: str, arguments: tuple[str, ...], body: Lines) -> None:
        """`head` ends with the name."""
        self._functions.append((head, arguments, body))

    # --- reading --------------------------------------------------------------------------------

    def load(self, type_: Integer | Float) -> str:
        """The function that reads a number of more than one byte, or of a part of one."""
        if isinstance(type_, Float):
            return self._load_float(type_)
        type_ = type_ if type_.signed else widened(type_)
        key = f"load_{layout_name(type_)}"
        raw = self._raw_load(type_)
        name = self._name(key)
        if name is None:
            return self._known[key]
        body = Lines()
        if type_.signed:
            body.add(f"return {sign_extended(type_, raw)};")
        else:
            for line in joined(type_, "at"):
                body.add(line)
        self._define(f"{integer_type(type_)} {name}", (_AT,), body)
        return name

    def loads_runs(self, type_: Integer) -> bool:
        """True if an array of such numbers is read by a function of its own."""
        if type_.signed or self._is_public:
            return False
        is_pair = (type_.byte_bits, type_.bits, type_.size) == (7, 14, 2)
        return is_pair and type_.byte_order == "little"

    def load_run(self, type_: Integer) -> str:
        """The function that reads an array of numbers of two seven-bit bytes."""
        key = f"load_{layout_name(type_)}_run"
        load = self.load(type_)
        name = self._name(key)
        if name is None:
            return self._known[key]
        self.has_vectors = True
        body = Lines()
        body.add("size_t i = 0;")
        body.directive(f"#if {self._names.prefix.upper()}_SSE2")
        with body.block("for (; count - i >= 8U; i += 8U)"):
            body.add(
                "const void *const from = &at[2U * i];",
                "const __m128i pairs = _mm_loadu_si128((const __m128i *)from);",
                "const __m128i low = _mm_and_si128(pairs, _mm_set1_epi16(0x7F));",
                "const __m128i next = _mm_srli_epi16(pairs, 1);",
                "const __m128i high = _mm_and_si128(next, _mm_set1_epi16(0x3F80));",
                "_mm_storeu_si128((__m128i *)(void *)&numbers[i], _mm_or_si128(low, high));",
            )
        body.directive("#endif")
        with body.block("for (; i < count; i++)"):
            body.add(f"numbers[i] = {load}(&at[2U * i]);")
        arguments = (f"{integer_type(type_)} *numbers", _AT, "size_t count")
        self._define(f"void {name}", arguments, body)
        return name

    def _raw_load(self, type_: Integer) -> str:
        """The unsigned value of a signed number at `at`."""
        if not type_.signed:
            return ""
        return f"{self.load(type_.unsigned)}(at)" if type_.size > 1 else "at[0]"

    def _load_float(self, type_: Float) -> str:
        key = f"load_{layout_name(type_)}"
        raw = self.load(type_.pattern)
        reading = self._reinterpret(type_.bits, from_bits=True)
        name = self._name(key)
        if name is None:
            return self._known[key]
        body = Lines()
        body.add(f"return {reading}({raw}(at));")
        self._define(f"{self.float_type(type_)} {name}", (_AT,), body)
        return name

    def float_type(self, type_: Float) -> str:
        """The type of a member that holds such floats."""
        self.floats.add(type_.bits)
        return "float" if type_.bits == 32 else f"{self._names.prefix}_float64"

    def _reinterpret(self, bits: int, *, from_bits: bool) -> str:
        key = f"float{bits}_of" if from_bits else f"bits{bits}_of"
        name = self._name(key)
        if name is None:
            return self._known[key]
        floating = self.float_type(Float(bits=32 if bits == 32 else 64))
        source, target = f"uint{bits}_t", floating
        if not from_bits:
            source, target = target, source
        body = Lines()
        body.add(f"{target} value;")
        body.add("unsigned char *to = (unsigned char *)&value;")
        body.add("const unsigned char *from = (const unsigned char *)&given;")
        with body.block("for (size_t i = 0; i < sizeof value; i++)"):
            body.add("to[i] = from[i];")
        body.add("return value;")
        self._define(f"{target} {name}", (f"{source} given",), body)
        return name

    def bits_of_float(self, type_: Float) -> str:
        """The function that gives the bits of a float."""
        return self._reinterpret(type_.bits, from_bits=False)

    def float_bounds(
        self, type_: Float, least: Fraction | None, greatest: Fraction | None
    ) -> Callable[[str], list[str]]:
        """Conditions that hold for floats in a range."""
        if type_.bits == 64:
            return self._float64_bounds(least, greatest)
        low = "" if least is None else f" >= {_float_literal(least, up=True)}"
        high = "" if greatest is None else f" <= {_float_literal(greatest, up=False)}"
        return lambda expression: [f"{expression}{test}" for test in (low, high) if test]

    def _float64_bounds(
        self, least: Fraction | None, greatest: Fraction | None
    ) -> Callable[[str], list[str]]:
        """By the bits, which are in the order of the numbers: not every target has a double."""
        ordered = self._float64_order()
        low = -inf if least is None else _nearest(least, 64, up=True)
        high = inf if greatest is None else _nearest(greatest, 64, up=False)
        bounds = _order_of(-0.0 if low == 0 else low), _order_of(abs(high) if high == 0 else high)
        tests = f" >= {hexadecimal(bounds[0], 16)}", f" <= {hexadecimal(bounds[1], 16)}"
        return lambda expression: [f"{ordered}({expression}){test}" for test in tests]

    def _float64_order(self) -> str:
        bits = self._reinterpret(64, from_bits=False)
        name = self._name("float64_order")
        if name is None:
            return self._known["float64_order"]
        body = Lines()
        body.add(f"const uint64_t bits = {bits}(value);")
        top = hexadecimal(1 << 63)
        body.add(f"return (bits & {top}) != 0U ? ~bits : bits | {top};")
        self._define(f"uint64_t {name}", (f"{self._names.prefix}_float64 value",), body)
        return name

    # --- writing --------------------------------------------------------------------------------

    def store(self, type_: Integer) -> str:
        """The function that writes an unsigned number."""
        layout = _cut(type_)
        key = f"store_{layout_name(layout)}"
        name = self._name(key)
        if name is None:
            return self._known[key]
        body = Lines()
        for index, byte in enumerate(parted(layout, "value")):
            body.add(f"at[{index}] = {byte};")
        arguments = ("uint8_t *at", f"{unsigned_type(type_.bits)} value")
        self._define(f"void {name}", arguments, body)
        return name

    def write(self, type_: Integer) -> str:
        """The function that hands an unsigned number to a writer, byte by byte."""
        layout = _cut(type_)
        key = f"write_{layout_name(layout)}"
        name = self._name(key)
        if name is None:
            return self._known[key]
        body = Lines()
        for byte in parted(layout, "value"):
            body.add(f"{self._names.prefix}_write({self._names.writing}, {byte});")
        arguments = (self._names.writer,)
        self._define(f"void {name}", (*arguments, f"{unsigned_type(type_.bits)} value"), body)
        return name

    def write_bytes(self) -> str:
        """The function that hands several bytes to a writer."""
        name = self._name("write_bytes")
        if name is None:
            return self._known["write_bytes"]
        body = Lines()
        body.add("const uint8_t *bytes = (const uint8_t *)from;")
        with body.block("for (size_t i = 0; i < size; i++)"):
            body.add(f"{self._names.prefix}_write({self._names.writing}, bytes[i]);")
        arguments = (self._names.writer, "const void *from")
        self._define(f"void {name}", (*arguments, "size_t size"), body)
        return name

    # --- bytes ----------------------------------------------------------------------------------

    def copy(self) -> str:
        """The function that copies bytes; a freestanding compiler has no header for one.

        From the last to the first: with -O3, gcc 12 makes vectors of a loop that goes forwards, and
        warns that they don't fit into arrays as small as ours.
        """
        name = self._name("copy")
        if name is None:
            return self._known["copy"]
        body = Lines()
        body.add("uint8_t *target = (uint8_t *)to;")
        body.add("const uint8_t *source = (const uint8_t *)from;")
        with body.block("while (size > 0)"):
            body.add("size--;", "target[size] = source[size];")
        self._define(f"void {name}", ("void *to", "const void *from", "size_t size"), body)
        return name

    def seven_bit(self) -> str:
        """The function that says whether no byte has its most significant bit set."""
        name = self._name("is_seven_bit")
        if name is None:
            return self._known["is_seven_bit"]
        body = Lines()
        body.add("const uint8_t *bytes = (const uint8_t *)at;", "uint8_t all = 0U;")
        with body.block("for (size_t i = 0; i < size; i++)"):
            body.add("all |= bytes[i];")
        body.add("return all <= 0x7FU;")
        self._define(f"bool {name}", ("const void *at", "size_t size"), body)
        return name

    def all_bits(self, type_: Integer) -> str:
        """The function that says which bits are set in some number of an array."""
        kind = unsigned_type(type_.bits)
        key = f"all_bits_u{type_.width}"
        name = self._name(key)
        if name is None:
            return self._known[key]
        body = Lines()
        body.add(f"{kind} all = 0U;")
        with body.block("for (size_t i = 0; i < count; i++)"):
            body.add("all |= numbers[i];")
        body.add("return all;")
        self._define(f"{kind} {name}", (f"const {kind} *numbers", "size_t count"), body)
        return name

    def missing(self) -> str:
        """The function that says how many bytes a payload needs at least."""
        name = self._name("missing")
        if name is None:
            return self._known["missing"]
        body = Lines()
        with body.block("if (need != NULL)"):
            body.add("*need = due;")
        body.add(f"return {self._names.prefix.upper()}_ERROR_SIZE;")
        head = f"enum {self._names.prefix}_result {name}"
        self._define(head, ("size_t *need", "size_t due"), body)
        return name

    def known(self, type_: Integer) -> str:
        """The function that says whether a closed enum has a value."""
        assert type_.enum is not None
        values = [item.value for item in type_.enum.values]
        key = f"is_{type_.enum.name}"
        name = self._name(key)
        if name is None:
            return self._known[key]
        body = Lines()
        with body.switch("value"):
            for value in values:
                body.add(f"case {value if -0x8000 < value < 0x8000 else _label(value, type_)}:")
            body.add("    return true;", "default:", "    return false;")
        self._define(f"bool {name}", (f"{integer_type(type_)} value",), body)
        return name


def _nearest(bound: Fraction, bits: int, *, up: bool) -> float:
    """The float that is nearest to a bound, but not beyond it."""
    value = _rounded(float(bound), bits)
    towards = inf if up else -inf
    while value not in (inf, -inf) and ((value < bound) if up else (value > bound)):
        value = _next(value, bits, towards)
    return value


def _rounded(value: float, bits: int) -> float:
    form = "<f" if bits == 32 else "<d"
    try:
        rounded: float = struct.unpack(form, struct.pack(form, value))[0]
    except OverflowError:
        rounded = inf if value > 0 else -inf
    return rounded


def _next(value: float, bits: int, towards: float) -> float:
    if bits == 64:
        return nextafter(value, towards)
    pattern = struct.unpack("<i", struct.pack("<f", value))[0]
    if value == 0:
        return 2.0**-149 if towards > 0 else -(2.0**-149)
    pattern += 1 if (value > 0) == (towards > 0) else -1
    found: float = struct.unpack("<f", struct.pack("<i", pattern))[0]
    return found


def _float_literal(bound: Fraction, *, up: bool) -> str:
    """The number that a float is compared with.

    The cast makes it a float also where constants have more digits than their type.
    """
    value = _nearest(bound, 32, up=up)
    if value in (inf, -inf):
        value = math.copysign((2 - 2**-23) * 2.0**127, value)
    text = f"{value:.9g}"
    return f"(float){text}f" if "." in text or "e" in text else f"(float){text}.0f"


def _order_of(value: float) -> int:
    """The place of a float among all of them."""
    bits: int = struct.unpack("<Q", struct.pack("<d", value))[0]
    return bits ^ ((1 << 64) - 1) if bits >> 63 else bits | 1 << 63


def _label(value: int, type_: Integer) -> str:
    from protogen.targets.c.spelling import constant

    return constant(value, type_)


# --- expressions --------------------------------------------------------------------------------


def is_plain(type_: Integer) -> bool:
    """True if the number is a byte as it is."""
    return type_.size == 1 and (type_.bits == 8 or not type_.signed)


def widened(type_: Integer) -> Integer:
    """The unsigned layout that has the same bytes and the same type in C, but no padding."""
    bits = min(64, type_.byte_bits * type_.size)
    bits = bits if storage_bits(bits) == type_.width else type_.bits
    return Integer(bits=bits, byte_bits=type_.byte_bits, byte_order=type_.byte_order)


def _cut(type_: Integer) -> Integer:
    """The layout that a writer needs: of a signed number the bits above its own are cut off."""
    if not type_.signed or is_whole(type_) or type_.bits == type_.byte_bits * type_.size:
        return widened(type_)
    return Integer(
        bits=type_.bits, signed=True, byte_bits=type_.byte_bits, byte_order=type_.byte_order
    )


def is_whole(type_: Integer) -> bool:
    """True if the number has just as many bits as its C type, so that a cast changes its sign."""
    return type_.bits in (8, 16, 32, 64)


def sign_extended(type_: Integer, raw: str) -> str:
    """The signed value of a raw one."""
    if is_whole(type_):
        return f"({integer_type(type_)}){raw}"
    top = hexadecimal(1 << (type_.bits - 1))
    return f"({integer_type(type_)})(({raw} ^ {top}) - {top})"


def joined(type_: Integer, at: str) -> tuple[str, ...]:
    """The statements that return the unsigned number at `at`."""
    size, group, target = type_.size, type_.byte_bits, unsigned_type(type_.bits)
    if size > _MOST_TERMS:
        return _joined_in_a_loop(type_, at)
    order = range(size) if type_.byte_order == "little" else range(size - 1, -1, -1)
    terms = []
    for place, index in enumerate(order):
        term = f"{at}[{index}]"
        cast = "uint16_t" if target == "uint8_t" else target
        terms.append(f"(({cast}){term} << {group * place})" if place else term)
    if size == 1:
        return (f"return {terms[0]};",)
    return (f"return ({target})({' | '.join(terms)});",)


def _joined_in_a_loop(type_: Integer, at: str) -> tuple[str, ...]:
    target, size = unsigned_type(type_.bits), type_.size
    index = "i" if type_.byte_order == "big" else f"{size - 1} - i"
    return (
        f"{target} value = 0U;",
        f"for (size_t i = 0; i < {size}; i++) {{",
        f"    value = ({target})(value << {type_.byte_bits}) | {at}[{index}];",
        "}",
        "return value;",
    )


def parted(type_: Integer, value: str) -> tuple[str, ...]:
    """The bytes of an unsigned number in wire order; of a signed one, its own bits only."""
    group, size = type_.byte_bits, type_.size
    items = []
    for place in range(size):
        shift = group * place
        shifted = _shifted(type_, value, shift)
        mask = _mask(type_, place)
        if mask is not None:
            shifted = f"({shifted}) & {mask}" if shift else f"{shifted} & {mask}"
        items.append(f"(uint8_t)({shifted})" if shift or mask else f"(uint8_t){shifted}")
    return tuple(items if type_.byte_order == "little" else reversed(items))


def _shifted(type_: Integer, value: str, shift: int) -> str:
    """The number without its lowest bits."""
    if (
        shift == 7 and type_.bits <= 16
    ):  # Seven steps on an 8-bit controller; this is one, and a byte.
        return f"(uint16_t)({value} << 1) >> 8"
    return f"{value} >> {shift}" if shift else value


def _mask(type_: Integer, place: int) -> str | None:
    """Mask of the bits that belong to a byte; None where a cast cuts off the others."""
    left = type_.bits - type_.byte_bits * place
    bits = min(type_.byte_bits, left)
    if bits == 8 or (bits < type_.byte_bits and not type_.signed):
        return None
    return hexadecimal((1 << bits) - 1)
