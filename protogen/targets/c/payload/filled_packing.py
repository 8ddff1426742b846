"""Packed numbers, as many as fill what is left: functions that walk over their bytes.

A number has 8 bits or more, so that each byte ends one number at most. Shifts are of numbers of the
size that the elements have.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import msgspec

from protogen.c_language.numbers import hexadecimal, integer_type, unsigned_type
from protogen.model.packing import FilledPacking
from protogen.model.payload_plan import IntegerStep, RepeatStep
from protogen.model.types import Integer
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.number_bytes import is_whole

_SIZE = "return count / 8U * bits + (count % 8U * bits + 7U) / 8U; /* Eight take whole bytes. */"


class FilledRun(msgspec.Struct, frozen=True):
    """Numbers of one type in one order of bits."""

    type: Integer
    packing: FilledPacking

    @classmethod
    def of(cls, step: RepeatStep) -> FilledRun:
        """The numbers of a step."""
        assert isinstance(step.packing, FilledPacking)
        assert isinstance(step.element, IntegerStep)
        return cls(step.element.type, step.packing)

    @property
    def _is_least_first(self) -> bool:
        return self.packing.order == "lsb_first"

    @property
    def _name(self) -> str:
        sign = "s" if self.type.signed else "u"
        return f"{sign}{self.packing.width}_{self.packing.order}"

    @property
    def _kind(self) -> str:
        return unsigned_type(self.type.bits)

    # --- sizes ------------------------------------------------------------------------------------

    def size(self, helpers: Helpers, count: str) -> str:
        """The bytes of so many numbers."""
        function = helpers.helper("packed_size", "size_t", ("size_t count", "size_t bits"), [_SIZE])
        return f"{function}({count}, {self.packing.width}U)"

    def spare(self, size: str) -> str:
        """The bits of as many bytes that belong to no number."""
        operand = f"({size})" if " " in size else size
        return f"(uint8_t)({operand} % {self.packing.width}U * 8U % {self.packing.width}U)"

    def misfit(self, size: str) -> str:
        """The condition that no number of numbers takes as many bytes; empty where any can."""
        return f"{self.spare(size)} > 7U" if self.packing.width > 8 else ""

    def padding(self, byte: str, spare: str) -> str:
        """The condition that such bits of the last byte are set."""
        if self._is_least_first:
            return f"{byte} >> (8U - {spare}) != 0U"
        return f"({byte} & ((1U << {spare}) - 1U)) != 0U"

    # --- reading ----------------------------------------------------------------------------------

    def unpack(self, helpers: Helpers) -> str:
        """The function that takes the numbers out of bytes, and says how many there are."""
        kind = integer_type(self.type)
        body = [
            "size_t count = 0U;",
            *self._scan([f"numbers[count] = {self._number(helpers)};", "count++;"]),
            "return count;",
        ]
        arguments = (f"{kind} *numbers", "const uint8_t *at", "size_t size")
        return helpers.helper(f"unpack_{self._name}", "size_t", arguments, body)

    def are_known(self, helpers: Helpers) -> str:
        """The function that says whether a closed enum has all numbers that lie in bytes."""
        assert self.type.enum is not None
        known = helpers.known(self.type)
        unknown = [f"if (!{known}({self._number(helpers)})) {{", "    return false;", "}"]
        body = [*self._scan(unknown), "return true;"]
        arguments = ("const uint8_t *at", "size_t size")
        key = f"are_{self.type.enum.name}_{self._name}"
        return helpers.helper(key, "bool", arguments, body)

    def _scan(self, each: Iterable[str]) -> Iterator[str]:
        """A loop over bytes, with statements for each number, whose bits are in `value`."""
        kind, width, wide = self._kind, f"{self.packing.width}U", _wide(self._kind)
        yield f"{kind} value = 0U;"
        yield "uint8_t bits = 0U; /* Of the value. */"
        yield "for (size_t i = 0; i < size; i++) {"
        if self._is_least_first:
            yield f"    value |= ({kind})(({wide})at[i] << bits);"
            yield "    bits = (uint8_t)(bits + 8U);"
            yield f"    if (bits >= {width}) {{"
            yield f"        bits = (uint8_t)(bits - {width});"
            yield from (f"        {line}" for line in each)
            yield f"        value = ({kind})(({wide})at[i] >> (8U - bits));"
        else:
            yield "    bits = (uint8_t)(bits + 8U);"
            yield f"    if (bits < {width}) {{"
            yield f"        value = ({kind})((({wide})value << 8U) | at[i]);"
            yield "    } else {"
            yield f"        bits = (uint8_t)(bits - {width});"
            upper, lower = f"({wide})value << (8U - bits)", f"({wide})(at[i] >> bits)"
            yield f"        value = ({kind})(({upper}) | {lower});"
            yield from (f"        {line}" for line in each)
            yield f"        value = ({kind})(at[i] & ((1U << bits) - 1U));"
        yield "    }"
        yield "}"

    def _number(self, helpers: Helpers) -> str:
        """The number whose bits are the lowest ones of `value`."""
        raw = "value"
        if self._is_least_first and not is_whole(self.type):
            raw = f"({self._kind})(value & {hexadecimal((1 << self.type.bits) - 1)})"
        if not self.type.signed:
            return raw
        is_cast = is_whole(self.type)
        return f"({integer_type(self.type)}){raw}" if is_cast else helpers.extended(self.type, raw)

    # --- writing ----------------------------------------------------------------------------------

    def store(self, helpers: Helpers) -> str:
        """The function that puts numbers into bytes."""
        body = self._join("at[0] = {};", "at++;")
        arguments = ("uint8_t *at", self._numbers, "size_t count")
        return helpers.helper(f"pack_{self._name}", "void", arguments, body)

    def write(self, helpers: Helpers, prefix: str, writing: str) -> str:
        """The function that hands their bytes to a writer."""
        body = self._join(f"{prefix}_write({writing}, {{}});")
        arguments = (helpers.writer, self._numbers, "size_t count")
        return helpers.helper(f"write_{self._name}", "void", arguments, body)

    @property
    def _numbers(self) -> str:
        return f"const {integer_type(self.type)} *numbers"

    def _join(self, *put: str) -> Iterator[str]:
        """A loop over numbers, which puts each byte as soon as it is full."""
        yield "uint8_t byte = 0U;"
        yield "uint8_t bits = 0U; /* Of the byte. */"
        yield "for (size_t i = 0; i < count; i++) {"
        body = self._join_least_first(put) if self._is_least_first else self._join_most_first(put)
        yield from (f"    {line}" for line in body)
        yield "}"
        yield "if (bits > 0U) {"
        yield from _put(put, "byte", 1)
        yield "}"

    def _join_least_first(self, put: Iterable[str]) -> Iterator[str]:
        kind, wide = self._kind, _wide(self._kind)
        yield f"{kind} value = {self._raw};"
        yield from _put(put, f"(uint8_t)(byte | (uint8_t)(({wide})value << bits))")
        yield f"value = ({kind})(value >> (8U - bits));"
        yield f"bits = (uint8_t)(bits + {self.packing.width - 8}U); /* Of the value. */"
        yield "for (; bits >= 8U; bits = (uint8_t)(bits - 8U)) {"
        yield from _put(put, "(uint8_t)value", 1)
        yield f"    value = ({kind})(value >> 8U);"
        yield "}"
        yield "byte = (uint8_t)value;"

    def _join_most_first(self, put: Iterable[str]) -> Iterator[str]:
        yield f"const {self._kind} value = {self._raw};"
        yield f"bits = (uint8_t)(bits + {self.packing.width - 8}U); /* Of the value. */"
        yield from _put(put, "(uint8_t)(byte | (uint8_t)(value >> bits))")
        yield "while (bits >= 8U) {"
        yield "    bits = (uint8_t)(bits - 8U);"
        yield from _put(put, "(uint8_t)(value >> bits)", 1)
        yield "}"
        yield f"byte = (uint8_t)(({_wide(self._kind)})value << (8U - bits));"

    @property
    def _raw(self) -> str:
        """The bits of a number, and no others."""
        if not self.type.signed:
            return "numbers[i]"
        raw = f"({self._kind})numbers[i]"
        if is_whole(self.type):
            return raw
        return f"({self._kind})({raw} & {hexadecimal((1 << self.type.bits) - 1)})"


def _put(put: Iterable[str], byte: str, depth: int = 0) -> Iterator[str]:
    """Statements that put a byte."""
    yield from ("    " * depth + line.format(byte) for line in put)


def _wide(kind: str) -> str:
    """The type in which a number is shifted by up to 8 bits: no int, which may have 16."""
    return "uint16_t" if kind == "uint8_t" else kind
