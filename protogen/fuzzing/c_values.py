"""Values as the bytes that drivers of generated C exchange.

The members of a struct one after another, numbers in big-endian order and as wide as their members
are, so that the bytes are the same for every machine. Of arrays, texts and bytes only what is in
use; of a union only the case that the selector chooses. A driver's functions in C do the same.
There and here one walk takes and gives values, so that the two can't differ.
"""

from __future__ import annotations

import math
import struct
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, BinaryIO

from protogen.fuzzing.choices import constant_value
from protogen.fuzzing.samples import Values
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ChooseStep,
    ConstantStep,
    Count,
    FloatStep,
    IntegerStep,
    OptionalStep,
    PayloadPlan,
    RecordStep,
    RegionStep,
    RepeatStep,
    RestStep,
)
from protogen.model.payload_walks import said
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


def pack(plan: PayloadPlan, values: Mapping[str, Any]) -> bytes:
    """The bytes of a struct with these values; raises Unfit where no struct can have them."""
    request = _Request()
    request.record(plan.steps, values)
    return bytes(request.data)


def unpack(plan: PayloadPlan, answers: Answers) -> Values:
    """The values of a struct."""
    return _Answer(answers).record(plan.steps, {})


class _Exchange(ABC):
    """Values of a struct on their way: given ones are put into bytes, or they are read."""

    def __init__(self) -> None:
        self._records: list[Values] = []
        """The records around a step, whose numbers count and select."""

    @abstractmethod
    def octets(self, given: bytes, size: int) -> bytes:
        """So many bytes: those that are given, or what is read instead."""

    def record(self, steps: Sequence[AnyStep], given: Mapping[str, Any]) -> Values:
        """The values of a record."""
        values: Values = {}
        self._records.append(values)
        for step in steps:
            values[step.name] = self._value(step, given.get(step.name))
        self._records.pop()
        return values

    def _value(self, step: AnyStep | RestStep, given: Any) -> Any:
        step = step.step if isinstance(step, RegionStep) else step
        match step:
            case FloatStep():
                return self._float(step.type.bits, float(0 if given is None else given))
            case IntegerStep(type=type_):
                raw = self._number(given or 0, type_.width // 8, signed=type_.signed)
                return bool(raw) if type_.role == "bool" else raw
            case ConstantStep():
                return constant_value(step)
            case BytesStep():
                return self._text(step, given or "")
            case RecordStep(steps=steps):
                return self.record(steps, given or {})
            case RepeatStep():
                return self._elements(step, given)
            case ChooseStep() | OptionalStep():
                chosen = self._chosen(step, given)
                return None if chosen is None else self._value(chosen, given)
            case RestStep():
                data = bytes.fromhex(given or "")
                return self.octets(data, self._filled(step.count, len(data))).hex()

    def _chosen(self, step: ChooseStep | OptionalStep, given: Any) -> AnyStep | RestStep | None:
        """The step that there is; None where there is none, or nothing in it."""
        if isinstance(step, OptionalStep):
            return step.step if self._is_there(step, given) else None
        chosen = step.case(said(step.selector, self._records))
        is_empty = isinstance(chosen, RecordStep) and not chosen.steps
        return None if is_empty else chosen

    def _is_there(self, step: OptionalStep, given: Any) -> bool:
        if step.presence.member:
            return bool(self._number(int(given is not None), 1))
        return bool(said(step.presence.holds, self._records))

    def _number(self, given: int, size: int, *, signed: bool = False) -> int:
        data = self.octets(number(given, size, signed=signed), size)
        return int.from_bytes(data, "big", signed=signed)

    def _float(self, bits: int, given: float) -> float | str:
        form = ">f" if bits == 32 else ">d"
        try:
            data = struct.pack(form, given)
        except OverflowError:
            raise Unfit from None
        value: float = struct.unpack(form, self.octets(data, bits // 8))[0]
        return value if math.isfinite(value) else str(value)

    def _text(self, step: BytesStep, given: str) -> str:
        is_text = isinstance(step.type, Text)
        data = given.encode("latin-1") if is_text else bytes.fromhex(given)
        size = self._size(step.count, len(data))
        if len(data) > size:
            raise Unfit
        data = self.octets(data.ljust(size, b"\0"), size)
        if not is_text:
            return data.hex()
        text = data.decode("latin-1")
        return text.rstrip("\0") if isinstance(step.type.extent, Fixed) else text

    def _elements(self, step: RepeatStep, given: Sequence[Any] | None) -> list[Any]:
        size = self._size(step.count, len(given or ()))
        if given is not None and len(given) != size:
            raise Unfit
        elements = [None] * size if given is None else given
        return [self._value(step.element, item) for item in elements]

    def _size(self, count: Count, given: int) -> int:
        """Number of elements or bytes; where a member holds it, it stands in front."""
        if count.member:
            return self._filled(count, given)
        size = said(count.by, self._records) if count.by is not None else count.known
        if size is None or not 0 <= size <= count.greatest:
            raise Unfit
        return size

    def _filled(self, count: Count, given: int) -> int:
        if given > count.greatest:
            raise Unfit
        return self._number(given, counting_bits(count.greatest) // 8)


class _Request(_Exchange):
    """Puts values into bytes."""

    def __init__(self) -> None:
        super().__init__()
        self.data = bytearray()

    def octets(self, given: bytes, size: int) -> bytes:
        """The bytes that are given, put behind the others."""
        self.data += given
        return given


class _Answer(_Exchange):
    """Reads values."""

    def __init__(self, answers: Answers) -> None:
        super().__init__()
        self._answers = answers

    def octets(self, given: bytes, size: int) -> bytes:
        """The next bytes."""
        return self._answers.take(size)
