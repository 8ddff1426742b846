"""Values as the bytes that drivers of generated C exchange.

The members of a struct one after another, numbers in big-endian order and as wide as their members
are, so that the bytes are the same for every machine. Of arrays, texts and bytes only what is in
use; of a union only the case that the selector chooses. A driver's functions in C do the same.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping, Sequence
from typing import Any, BinaryIO

from protogen.fuzzing.samples import Values
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ChooseStep,
    ConstantStep,
    Count,
    FloatStep,
    IntegerStep,
    PayloadPlan,
    RecordStep,
    RepeatStep,
    RestStep,
)
from protogen.model.types import Fixed, Text, counting_bits


class Unfit(Exception):  # noqa: N818 - a verdict, not a failure
    """No struct can hold the value."""


class Answers:
    """A driver's answers, read from the front."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream

    def take(self, size: int) -> bytes:
        """The next bytes."""
        data = self._stream.read(size)
        if len(data) < size:
            raise EOFError(f"the driver stopped: {size - len(data)} bytes are missing")
        return data

    def number(self, size: int, *, signed: bool = False) -> int:
        """The number of the next bytes."""
        return int.from_bytes(self.take(size), "big", signed=signed)

    def data(self) -> bytes:
        """The next bytes, in front of which their number stands."""
        return self.take(self.number(4))


def number(value: int, size: int, *, signed: bool = False) -> bytes:
    """A number; raises Unfit."""
    try:
        return int(value).to_bytes(size, "big", signed=signed)
    except OverflowError:
        raise Unfit from None


class _Walk:
    """The numbers of the records around a step, which count and select."""

    def __init__(self) -> None:
        self._records: list[Mapping[str, Any]] = []

    def _count(self, count: Count, filled: int) -> int:
        """Number of elements or bytes; `filled` if they fill the payload."""
        if count.by is not None:
            return int(self._records[count.by.level][count.by.name])
        return filled if count.known is None else count.known

    def _chosen(self, step: ChooseStep) -> AnyStep | RestStep | None:
        by = step.selector
        return step.case(by if isinstance(by, int) else int(self._records[by.level][by.name]))


# --- values into bytes ----------------------------------------------------------------------------


def pack(plan: PayloadPlan, values: Mapping[str, Any]) -> bytes:
    """The bytes of a struct with these values; raises Unfit where no struct can have them."""
    return _Pack().record(plan.steps, values)


class _Pack(_Walk):
    def record(self, steps: Sequence[AnyStep], values: Mapping[str, Any]) -> bytes:
        self._records.append(values)
        data = b"".join(
            self._bytes(step, values[step.name]) for step in steps if step.field.const is None
        )
        self._records.pop()
        return data

    def _bytes(self, step: AnyStep | RestStep | None, value: Any) -> bytes:
        match step:
            case FloatStep():
                return _float_bytes(step.type.bits, float(value))
            case IntegerStep(type=type_):
                return number(value, type_.width // 8, signed=type_.signed)
            case BytesStep():
                data = _of_text(step, value)
                return self._prefix(step.count, len(data)) + self._padded(data, step.count)
            case RecordStep(steps=steps):
                return self.record(steps, value)
            case RepeatStep():
                return self._elements(step, value)
            case ChooseStep():
                chosen = self._chosen(step)
                return b"" if value is None else self._bytes(chosen, value)
            case RestStep():
                data = bytes.fromhex(value)
                if len(data) > step.count.greatest:
                    raise Unfit
                return _counted(len(data), step.count.greatest) + data
            case _:
                return b""

    def _elements(self, step: RepeatStep, values: Sequence[Any]) -> bytes:
        prefix, size = self._prefix(step.count, len(values)), len(values)
        if size != self._count(step.count, size) or size > step.count.greatest:
            raise Unfit
        return prefix + b"".join(self._bytes(step.element, item) for item in values)

    def _padded(self, data: bytes, count: Count) -> bytes:
        size = self._count(count, len(data))
        if len(data) > size or size > count.greatest:
            raise Unfit
        return data.ljust(size, b"\0")

    def _prefix(self, count: Count, size: int) -> bytes:
        return _counted(size, count.greatest) if count.fills else b""


def _of_text(step: BytesStep, value: str) -> bytes:
    return value.encode("latin-1") if isinstance(step.type, Text) else bytes.fromhex(value)


def _counted(size: int, greatest: int) -> bytes:
    return number(size, counting_bits(greatest) // 8)


def _float_bytes(bits: int, value: float) -> bytes:
    try:
        return struct.pack(">f" if bits == 32 else ">d", value)
    except OverflowError:
        raise Unfit from None


# --- bytes into values ----------------------------------------------------------------------------


def unpack(plan: PayloadPlan, answers: Answers) -> Values:
    """The values of a struct."""
    return _Unpack(answers).record(plan.steps)


class _Unpack(_Walk):
    def __init__(self, answers: Answers) -> None:
        super().__init__()
        self._answers = answers

    def record(self, steps: Sequence[AnyStep]) -> Values:
        found: Values = {}
        self._records.append(found)
        for step in steps:
            found[step.name] = self._value(step)
        self._records.pop()
        return found

    def _value(self, step: AnyStep | RestStep | None) -> Any:
        match step:
            case FloatStep():
                return self._float(step.type.bits)
            case IntegerStep(type=type_):
                raw = self._answers.number(type_.width // 8, signed=type_.signed)
                return bool(raw) if type_.role == "bool" else raw
            case ConstantStep():
                return _shown(step)
            case BytesStep():
                return self._text(step, self._answers.take(self._size(step.count)))
            case RecordStep(steps=steps):
                return self.record(steps)
            case RepeatStep():
                return [self._value(step.element) for _ in range(self._size(step.count))]
            case ChooseStep():
                chosen = self._chosen(step)
                is_empty = isinstance(chosen, RecordStep) and not chosen.steps
                return None if is_empty else self._value(chosen)
            case RestStep():
                return self._answers.take(self._filled(step.count.greatest)).hex()
            case _:
                raise AssertionError("a decoder takes no value without a case")

    def _float(self, bits: int) -> float | str:
        data = self._answers.take(bits // 8)
        value: float = struct.unpack(">f" if bits == 32 else ">d", data)[0]
        return value if math.isfinite(value) else str(value)

    def _size(self, count: Count) -> int:
        return self._count(count, self._filled(count.greatest) if count.fills else 0)

    def _filled(self, greatest: int) -> int:
        return self._answers.number(counting_bits(greatest) // 8)

    @staticmethod
    def _text(step: BytesStep, data: bytes) -> str:
        if not isinstance(step.type, Text):
            return data.hex()
        text = data.decode("latin-1")
        return text.rstrip("\0") if isinstance(step.type.extent, Fixed) else text


def _shown(step: ConstantStep) -> Any:
    """A constant as JSON lines have it."""
    constant, value = step.field.const, step.value
    if isinstance(value, FloatStep):
        assert isinstance(constant, int | float)
        return float(constant)
    if isinstance(value, IntegerStep) and value.type.role == "bool":
        return bool(constant)
    if isinstance(constant, bytes):
        return constant.hex()
    return list(constant) if isinstance(constant, tuple) else constant
