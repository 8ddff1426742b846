"""The parts of a frame: literals, identities, lengths, counters, values, checksums."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from hypothesis import strategies as st

from protogen.copying import replace
from schema_fuzzing import forms
from schema_fuzzing.names import PARTS, fresh
from schema_fuzzing.numbers import ORDERS
from schema_fuzzing.part_bits import Run, bytes_of, fill
from schema_fuzzing.part_digits import ONE_OF_16, Digits, digits_of

ALGORITHMS = (
    ("xor-8", 8), ("sum-8", 8), ("sum-8/negated", 8), ("fletcher-16", 16), ("fletcher-16/256", 16),
    ("sum-8/inverted", 8), ("sum-16", 16), ("sum-16/negated", 16), ("sum-32/inverted", 32),
    ("xor-16", 16), ("xor-32", 32),
    ("CRC-3/GSM", 3),
    ("CRC-5/USB", 5), ("CRC-7/MMC", 7), ("CRC-8/SMBUS", 8), ("CRC-8/MAXIM-DOW", 8),
    ("CRC-12/UMTS", 12), ("CRC-15/CAN", 15), ("CRC-16/KERMIT", 16), ("CRC-16/MODBUS", 16),
    ("CRC-16/XMODEM", 16), ("CRC-24/OPENPGP", 24), ("crc-32", 32), ("CRC-32/MPEG-2", 32),
    ("CRC-40/GSM", 40), ("CRC-64/XZ", 64),
)  # fmt: skip
_BYTE = frozenset(range(256))


@dataclass(frozen=True, slots=True)
class PartType:
    """An unsigned integer as the type of a part."""

    type: str
    bits: int
    byte_bits: int
    order: str
    digits: Digits | None = None

    @property
    def size(self) -> int:
        if self.digits is not None:
            return self.digits.size
        return -(-self.bits // self.byte_bits)

    @property
    def greatest(self) -> int:
        greatest = (1 << self.bits) - 1
        return greatest if self.digits is None else min(greatest, self.digits.greatest)

    def bytes_between(self, least: int, greatest: int) -> tuple[frozenset[int], ...]:
        """Range of each byte: the bounds tell of the most significant one, of others nothing.

        Of digits they tell of each.
        """
        if self.digits is not None:
            return self.digits.bytes_between(least, greatest)
        shift = self.byte_bits * (self.size - 1)
        top = frozenset(range(least >> shift, (greatest >> shift) + 1))
        rest = (frozenset(range(1 << self.byte_bits)),) * (self.size - 1)
        return (top, *rest) if self.order == "big" else (*rest, top)


@dataclass(frozen=True, slots=True)
class PartPlan:
    """A part that was drawn. `values` is what each of its bytes can be, unstuffed."""

    name: str
    role: str
    data: dict[str, Any] = field(default_factory=dict)
    values: tuple[frozenset[int], ...] = ()
    optional: bool = False
    type: PartType | None = None
    bounds: tuple[int, int] = (0, 0)
    words: tuple[bytes, ...] = ()
    """The literals of a choice."""
    identity: str = ""
    """The name of the bits of it that are an identity, whose type and bounds these are."""
    sum_bits: str = ""
    """The name of the bits of it that are a checksum, or some bits of one."""

    @property
    def size(self) -> int:
        return len(self.values)

    @property
    def can_be_mirrored(self) -> bool:
        """True if another part can have its value, which is that of all its bits."""
        plain = self.type is not None and self.type.digits is None and self.type.type != "ascii"
        return plain and not self.identity and self.role in ("id", "counter", "value")

    @property
    def literal(self) -> bytes:
        """The bytes of a literal."""
        return bytes(next(iter(values)) for values in self.values)

    def adding(self, **more: Any) -> PartPlan:
        """The part with further keys."""
        return replace(self, data={**self.data, **more})

    def adding_to_bits(self, name: str, **more: Any) -> PartPlan:
        """The part, of which these bits have further keys."""
        bits = self.data["bits"]
        return self.adding(bits={**bits, name: {**bits[name], **more}})


class Maker:
    """Draws parts of one frame, each with a name of its own."""

    def __init__(self, draw: st.DrawFn, byte_bits: int, order: str | None) -> None:
        self._draw = draw
        self._byte_bits = byte_bits
        self._order = order
        self._taken = {"payload"}

    def take(self, names: Sequence[str]) -> None:
        """Keep names for parts that are made elsewhere."""
        self._taken.update(names)

    def name(self) -> str:
        found = self._draw(fresh(PARTS, self._taken))
        self._taken.add(found)
        return found

    def literal(self, data: bytes) -> PartPlan:
        written = {"literal": self._draw(forms.octets(data)), **self._draw(forms.about())}
        values = tuple(frozenset({byte}) for byte in data)
        return PartPlan(self.name(), "literal", written, values)

    def choice(self, words: Sequence[bytes]) -> PartPlan:
        """Several literals of one size, of which a frame has one."""
        written = {"any_of": [self._draw(forms.octets(word)) for word in words]}
        if self._draw(st.booleans()):
            written["default"] = self._draw(forms.octets(self._draw(st.sampled_from(words))))
        keys = {"literal": written, **self._draw(forms.about())}
        if all(map(bytes.isascii, words)) and self._draw(forms.one_in(3)):
            keys["type"] = "ascii"
        values = tuple(map(frozenset, zip(*words, strict=True)))
        return PartPlan(self.name(), "choice", keys, values, words=tuple(words))

    def payload(self) -> PartPlan:
        return PartPlan("payload", "payload", self._draw(forms.about()))

    # -- numbers -----------------------------------------------------------------------------

    def type(
        self, bits: int | None = None, *, one_byte: bool = False, least_greatest: int = 0
    ) -> tuple[PartType, dict[str, Any]]:
        """A type, and the keys that say so; one that can say at least `least_greatest`."""
        names: list[tuple[str, int]] = [("byte", 8), ("char", self._byte_bits)]
        names += [(f"uint{width}", width) for width in (self._byte_bits, 8, 8, 12, 16)]
        if bits is not None:
            names = [item for item in names if item[1] == bits] or [(f"uint{bits}", bits)]
        if self._byte_bits == 8 and self._draw(forms.one_in(5)):
            return self._digits(bits, one_byte=one_byte, least_greatest=least_greatest)
        if one_byte:
            names = [item for item in names if item[1] <= self._byte_bits or item[0] == "byte"]
        names = [item for item in names if (1 << item[1]) > least_greatest]
        name, width = self._draw(st.sampled_from(names))
        byte_bits = 8 if name == "byte" else self._byte_bits
        order = self._order
        keys: dict[str, Any] = {"type": name}
        if -(-width // byte_bits) > 1 and (order is None or self._draw(forms.one_in(4))):
            order = keys["byte_order"] = self._draw(ORDERS)
        return PartType(name, width, byte_bits, order or "little"), keys

    def _digits(
        self, bits: int | None, *, one_byte: bool, least_greatest: int
    ) -> tuple[PartType, dict[str, Any]]:
        """The type of a number that is written as digits."""
        if one_byte:
            kind = self._draw(st.sampled_from(["base16-upper", "base16-lower"]))
            type_, keys = PartType("uint4", 4, 8, "little", ONE_OF_16[kind]), {"digits": kind}
            return type_, {"type": "uint4", **keys}
        widths = [width for width in (4, 7, 8, 10, 12, 16, 20) if 1 << width > least_greatest]
        width = bits or self._draw(st.sampled_from(widths))
        is_whole = bits is not None or least_greatest > 0
        digits, keys = self._draw(digits_of(width, whole=is_whole))
        name = f"uint{width}"
        return PartType(name, width, 8, "little", digits), {"type": name, **keys}

    def number(self, role: str, *, start: bool = False) -> PartPlan:
        """A counter or a value; `start`: one byte with a range, which marks the frame's start."""
        if role == "value" and not start and self._draw(forms.one_in(5)):
            return self._text_part(role)
        if role == "value" and not start and self._draw(forms.one_in(5)):
            return self._bits(tells=False)
        type_, keys = self.type(one_byte=start)
        least, greatest = 0, type_.greatest
        if start or self._draw(forms.one_in(3)):
            least, greatest = self._small_bounds(type_)
            keys["range"] = self._written_range(type_, least, greatest)
        if role == "counter":
            keys["counter"] = True
        if self._draw(st.booleans()):
            keys["default"] = self._draw(st.integers(least, greatest))
        keys.update(self._draw(forms.about()))
        values = type_.bytes_between(least, greatest)
        return PartPlan(self.name(), role, keys, values, type=type_, bounds=(least, greatest))

    def mirror(self, of: PartPlan) -> PartPlan:
        """A part that has the value of a number, or that with each bit inverted."""
        type_ = of.type
        assert type_ is not None
        keys = {key: of.data[key] for key in ("type", "byte_order") if key in of.data}
        inverts = self._draw(st.booleans())
        keys["complements" if inverts else "repeats"] = of.name
        keys.update(self._draw(forms.about()))
        values = type_.bytes_between(0, type_.greatest)
        if type_.size == 1:
            least, greatest = of.bounds
            least = 0 if of.role == "length" else least  # It may say less than it counts.
            flips = type_.greatest if inverts else 0
            values = (frozenset(value ^ flips for value in range(least, greatest + 1)),)
        return PartPlan(self.name(), "mirror", keys, values)

    def length_in_bits(self, length: PartPlan) -> PartPlan:
        """The part of which some bits are the length, if these can say enough."""
        type_, (counted, _) = length.type, length.bounds
        assert type_ is not None
        least = (counted + 18).bit_length()
        if least > type_.bits or type_.digits is not None or type_.type == "char":
            return length
        width = self._draw(st.integers(least, type_.bits))
        low = self._draw(st.integers(0, type_.bits - width))
        own = {"counts": length.data["counts"]}
        run = Run(low, width, 0, (1 << width) - 1)
        keys = {key: length.data[key] for key in ("type", "byte_order") if key in length.data}
        keys["bits"], runs = fill(self._draw, type_.bits, self.name, (self.name(), own, run))
        values = bytes_of(runs, type_.size, type_.byte_bits)
        values = values if type_.order == "little" else values[::-1]
        keys.update(self._draw(forms.about()))
        bounds = counted, run.greatest
        return PartPlan(length.name, "length", keys, tuple(values), type=type_, bounds=bounds)

    def _bits(self, *, tells: bool) -> PartPlan:
        """A number whose bits are parts, an identity among them if it `tells` the message."""
        size, byte_bits = self._draw(st.sampled_from([1, 1, 1, 2])), self._byte_bits
        keys: dict[str, Any] = {"type": f"uint{size * byte_bits}"}
        if size == 1 and self._draw(forms.one_in(3)):
            keys["type"], byte_bits = "byte", 8
        order = self._order or "little"
        if size > 1 and (self._order is None or self._draw(forms.one_in(4))):
            order = keys["byte_order"] = self._draw(ORDERS)
        given, type_, bounds = None, None, (0, 0)
        if tells:
            width = self._draw(st.integers(3, size * byte_bits))
            low = self._draw(st.integers(0, size * byte_bits - width))
            type_ = PartType(f"uint{width}", width, byte_bits, order)
            own: dict[str, Any] = {"id": True}
            bounds = 0, type_.greatest
            if width > 4 and self._draw(forms.one_in(4)):
                bounds = self._small_bounds(type_)
                own["range"] = list(bounds)
            given = self.name(), own, Run(low, width, *bounds)
        keys["bits"], runs = fill(self._draw, size * byte_bits, self.name, given)
        keys.update(self._draw(forms.about()))
        values = bytes_of(runs, size, byte_bits)
        values = values if order == "little" else values[::-1]
        role, told = ("id", given[0]) if given is not None else ("value", "")
        return PartPlan(
            self.name(), role, keys, tuple(values), type=type_, bounds=bounds, identity=told
        )

    def _written_range(self, type_: PartType, least: int, greatest: int) -> list[Any]:
        character = type_.type == "char" and greatest < 0x7F
        return [
            self._draw(forms.raw_number(least, character=character)),
            self._draw(forms.raw_number(greatest, character=character)),
        ]

    def identity(self, name: str, keys: dict[str, Any], type_: PartType) -> PartPlan:
        """An identity part of which all but its place is known."""
        bounds = identity_bounds(keys, type_)
        values = type_.bytes_between(0, type_.greatest)
        if type_.type != "ascii":
            values = type_.bytes_between(*bounds)
        elif "range" in keys:
            values = (frozenset(range(bounds[0], bounds[1] + 1)),) * type_.size
        return PartPlan(name, "id", keys, values, type=type_, bounds=bounds)

    def text(self) -> tuple[PartType, dict[str, Any]]:
        """The type of a text, and the keys that say so."""
        size = self._draw(st.sampled_from([1, 2, 3, 3, 8]))
        keys = {"type": "ascii", "size": size}
        return PartType("ascii", self._byte_bits * size, self._byte_bits, "big"), keys

    def _text_part(self, role: str, **more: Any) -> PartPlan:
        type_, keys = self.text()
        keys.update(more)
        each = (1 << self._byte_bits) - 1
        first, last, values = 0, 0x7F, (frozenset(range(each + 1)),) * type_.size
        if self._draw(forms.one_in(3)):
            first = self._draw(st.integers(0, 0x60))
            last = self._draw(st.integers(first + 6, 0x7F))
            keys["range"] = [
                self._draw(forms.raw_number(end, character=True)) for end in (first, last)
            ]
            values = (frozenset(range(first, last + 1)),) * type_.size
        if role == "value" and self._draw(st.booleans()):
            keys["default"] = self._draw(characters(type_.size, first, last))
        keys.update(self._draw(forms.about()))
        return PartPlan(self.name(), role, keys, values, type=type_, bounds=(first, last))

    def new_identity(self, *, start: bool = False) -> PartPlan:
        """An identity part; `start`: its range sets it apart from 7-bit bytes."""
        if not start and self._draw(forms.one_in(6)):
            return self._text_part("id", id=True)
        if not start and self._draw(forms.one_in(4)):
            return self._bits(tells=True)
        type_, keys = self.type(one_byte=start)
        keys["id"] = True
        if start and type_.bits == 8 and self._draw(st.booleans()):
            keys["range"] = [0x80, self._draw(st.integers(0x90, 0xFF))]
        elif start or self._draw(forms.one_in(4)):
            keys["range"] = self._written_range(type_, *self._small_bounds(type_))
        keys.update(self._draw(forms.about()))
        return self.identity(self.name(), keys, type_)

    def _small_bounds(self, type_: PartType) -> tuple[int, int]:
        least = self._draw(st.integers(0, type_.greatest // 2))
        return least, self._draw(
            st.integers(min(least + 6, type_.greatest - 1), type_.greatest - 1)
        )

    # -- checksums ---------------------------------------------------------------------------

    def checksum(self, *, optional: bool) -> PartPlan:
        """A checksum; what it covers is said later."""
        algorithm, width = self._draw(st.sampled_from(ALGORITHMS))
        if self._draw(forms.one_in(3)):
            algorithm, width = self._parameters()
        if not optional and self._draw(forms.one_in(4)):
            return self._checksum_in_bits(algorithm, width)
        type_, keys = self.type(width)
        keys["algorithm"] = algorithm
        needs_order = type_.digits is not None and _adds_words(algorithm)
        if needs_order and (self._order is None or self._draw(forms.one_in(4))):
            keys["byte_order"] = self._draw(ORDERS)
        if optional:
            keys["when"] = "payload"
        values = type_.bytes_between(*_sum_bounds(algorithm, width, type_.greatest))
        return PartPlan(self.name(), "checksum", keys, values, optional=optional, type=type_)

    def _checksum_in_bits(self, algorithm: Any, width: int) -> PartPlan:
        """A part of which some bits are a checksum, or some bits of one."""
        size, byte_bits = self._draw(st.sampled_from([1, 1, 2, 3])), self._byte_bits
        bits, order = size * byte_bits, self._order or "little"
        keys: dict[str, Any] = {"type": f"uint{bits}"}
        needs_order = size > 1 or _adds_words(algorithm)
        if needs_order and (self._order is None or self._draw(forms.one_in(4))):
            order = keys["byte_order"] = self._draw(ORDERS)
        taken = self._draw(st.integers(1, min(width, bits)))
        lowest = self._draw(st.integers(0, width - taken))
        low = self._draw(st.integers(0, bits - taken))
        run = Run(low, taken, 0, (1 << taken) - 1)
        own: dict[str, Any] = {"algorithm": algorithm}
        if taken < width or self._draw(st.booleans()):
            own["takes"] = Run(lowest, taken, 0, 0).written
        name = self.name()
        keys["bits"], runs = fill(self._draw, bits, self.name, (name, own, run), is_sum=True)
        values = bytes_of(runs, size, byte_bits)
        values = values if order == "little" else values[::-1]
        keys.update(self._draw(forms.about()))
        return PartPlan(self.name(), "checksum", keys, tuple(values), sum_bits=name)

    def _folded(self) -> tuple[Any, int]:
        """A sum or an exclusive or with parameters."""
        kind = self._draw(st.sampled_from(["sum", "xor"]))
        widths = st.integers(1, 64) if kind == "sum" else st.integers(1, 8)
        width = self._draw(st.sampled_from([16, 32]) | widths)
        number = st.integers(0, (1 << width) - 1)
        found: dict[str, Any] = {kind: width}
        for key in ("init", "xorout", "mask", "add"):
            if self._draw(st.booleans()):
                found[key] = self._draw(number)
        if kind == "sum" and self._draw(st.booleans()):
            found["negated"] = True
        if kind == "sum" and width in (16, 32) and self._draw(st.booleans()):
            found["words"] = True
        return found, width

    def _parameters(self) -> tuple[Any, int]:
        if self._draw(st.booleans()):
            return self._folded()
        width = self._draw(st.integers(1, 64))
        register = st.integers(0, (1 << width) - 1)
        found: dict[str, Any] = {"width": width, "poly": self._draw(register) | 1}
        for key, values in (
            ("init", register), ("xorout", register), ("refin", st.booleans()),
            ("refout", st.booleans()),
        ):  # fmt: skip
            if self._draw(st.booleans()):
                found[key] = self._draw(values)
        return found, width


def _adds_words(algorithm: Any) -> bool:
    """True if words are added, whose bytes have an order."""
    if isinstance(algorithm, str):
        return algorithm in ("xor-16", "xor-32")
    return bool(algorithm.get("words")) or algorithm.get("xor", 0) > 8


def characters(size: int, first: int, last: int) -> st.SearchStrategy[str]:
    """Texts of exactly so many characters between two."""
    each = st.characters(min_codepoint=first, max_codepoint=last)
    return st.text(each, min_size=size, max_size=size)


def is_text(part: PartPlan) -> bool:
    """True if the part is a text."""
    return part.type is not None and part.type.type == "ascii"


def text_of(value: int, type_: PartType) -> str:
    """All characters of a number, NUL included."""
    places = range(type_.size - 1, -1, -1)
    return "".join(chr(value >> type_.byte_bits * place & 0x7F) for place in places)


def number_of(text: str, type_: PartType) -> int:
    """The number of all characters."""
    value = 0
    for character in text:
        value = value << type_.byte_bits | ord(character)
    return value


def identity_values(part: PartPlan) -> st.SearchStrategy[int]:
    """The values of an identity part that a schema can name."""
    type_ = part.type
    assert type_ is not None
    if type_.type == "ascii":
        return characters(type_.size, *part.bounds).map(lambda text: number_of(text, type_))
    return st.integers(*part.bounds)


def _sum_bounds(algorithm: Any, width: int, greatest: int) -> tuple[int, int]:
    """The least and the greatest checksum: one that is masked and moved is between these."""
    if not isinstance(algorithm, dict) or "mask" not in algorithm:
        return 0, greatest
    low, high = algorithm.get("add", 0), algorithm["mask"] + algorithm.get("add", 0)
    return (low, high) if high < 1 << width else (0, greatest)


def identity_bounds(keys: dict[str, Any], type_: PartType) -> tuple[int, int]:
    """The range of an identity part as numbers."""
    if "range" not in keys:
        return 0, 0x7F if type_.type == "ascii" else type_.greatest
    least, greatest = (ord(end) if isinstance(end, str) else end for end in keys["range"])
    return least, greatest


def every_payload_byte(byte_bits: int, *, whole_bytes: bool) -> frozenset[int]:
    """The bytes that a payload can hold."""
    return _BYTE if byte_bits == 8 or whole_bytes else frozenset(range(128))
