"""The checksum algorithms that a schema may name, as data for the passes and the targets.

A `ChecksumSpec` says what to compute, not how: each target prints it in its own language.
"""

import re
from collections.abc import Mapping
from functools import cache
from typing import Literal

import msgspec

from protogen.model.crc_catalogue import catalogue_rows
from protogen.runtime import checksum as sums

ChecksumKind = Literal["xor", "sum", "fletcher", "crc"]


_WORD = re.compile(r"[a-z]+|[0-9]+")
_GREATEST_LETTERS = 3
"""Letters, numbers and companies, such as `A`, `16` and `IBM`, are in names of all kinds."""


class ChecksumSpec(msgspec.Struct, frozen=True):
    """One checksum algorithm with all its parameters.

    `width` is the checksum's size in bits. `init` is the value before the first byte (`xor`, `sum`
    and `crc`). A `sum` that is `negated` is what brings the sum to 0 modulo 2**width. `words` of a
    `sum` or an `xor`: not bytes but words of `width` bits in this order are taken, the last one
    filled with zeros. Behind it, `sum` and `xor` are changed by `xorout`, `mask` and `add`, in
    this order; None masks nothing.
    `modulus` belongs to `fletcher` and follows from the name.
    `poly`, `refin`, `refout` and `xorout` belong to `crc` and are the Rocksoft parameters as the
    catalogue prints them: `poly` without its top bit, `init` and `poly` most significant bit
    first whatever `refin` says.
    """

    name: str
    kind: ChecksumKind
    width: int
    negated: bool = False
    init: int = 0
    poly: int = 0
    refin: bool = False
    refout: bool = False
    xorout: int = 0
    mask: int | None = None
    add: int = 0
    words: Literal["little", "big"] | None = None

    @property
    def is_folded_byte(self) -> bool:
        """True for sums and exclusive ors of bytes in a register of 8 bits."""
        return self.kind in ("sum", "xor") and self.width == 8 and self.words is None

    @property
    def is_bare(self) -> bool:
        """True if a sum or an exclusive or is sent as it is, or negated."""
        return self.mask is None and not self.xorout and not self.add

    @property
    def parameters(self) -> dict[str, object]:
        """Those of its parameters that are not as usual, by their names."""
        optional = [item for item in msgspec.structs.fields(self) if not item.required]
        found = {item.name: (getattr(self, item.name), item.default) for item in optional}
        return {name: value for name, (value, usual) in found.items() if value != usual}

    def result(self, register: int) -> int:
        """The checksum of a sum or an exclusive or that has come to `register`."""
        result = (-register if self.negated else register) ^ self.xorout
        return ((result if self.mask is None else result & self.mask) + self.add) & self.greatest

    @property
    def greatest(self) -> int:
        """The greatest number of so many bits."""
        return (1 << self.width) - 1

    @property
    def bounds(self) -> tuple[int, int]:
        """The least and the greatest checksum, as far as mask and addition say."""
        if self.mask is None or self.mask + self.add > self.greatest:
            return 0, self.greatest
        return self.add, self.mask + self.add

    @property
    def modulus(self) -> int:
        """Modulus of Fletcher's two sums."""
        # No field: it would be in the spec hash of every schema, and the name says it already.
        return 256 if self.name == FLETCHER_256 else 255


FLETCHER_256 = "fletcher-16/256"
"""Fletcher's checksum with sums of one byte that simply overflow, as UBX has it."""

SIMPLE_ALGORITHMS = (
    ChecksumSpec("xor-8", "xor", 8),
    ChecksumSpec("xor-16", "xor", 16, words="little"),
    ChecksumSpec("xor-32", "xor", 32, words="little"),
    *(
        spec
        for width in (8, 16, 32)
        for spec in (
            ChecksumSpec(f"sum-{width}", "sum", width),
            ChecksumSpec(f"sum-{width}/negated", "sum", width, negated=True),
            ChecksumSpec(f"sum-{width}/inverted", "sum", width, xorout=(1 << width) - 1),
        )
    ),
    ChecksumSpec("fletcher-16", "fletcher", 16),
    ChecksumSpec(FLETCHER_256, "fletcher", 16),
)


def find_algorithm(name: str) -> ChecksumSpec | None:
    """Return the algorithm of that name or alias, in upper or lower case, or None.

    The result's `name` is the algorithm's own, also when it was found by an alias.
    """
    return _by_folded_name().get(name.casefold())


def algorithm_names() -> tuple[str, ...]:
    """Return every name that `find_algorithm` knows: first the algorithms' own, then aliases."""
    own = (spec.name for spec in (*SIMPLE_ALGORITHMS, *crc_catalogue()))
    aliases = (alias for found in crc_catalogue().values() for alias in found)
    return (*own, *aliases)


def variants(name: str) -> tuple[str, ...]:
    """Return the algorithms that a shortened name may stand for; none if it is one's own name."""
    found, start = find_algorithm(name), name.casefold()
    if found is None or found.name.casefold() == start:
        return ()
    meant = (
        spec.name
        for key, spec in _by_folded_name().items()
        if key.startswith(start) or (spec.width == found.width and _has_words(key, start))
    )
    names = tuple(dict.fromkeys((found.name, *meant)))
    return names if len(names) > 1 else ()


def _has_words(name: str, short: str) -> bool:
    """True for `CRC-16/CCITT-FALSE` and `CRC-CCITT`, but not for what has letters in common."""
    words = set(_WORD.findall(short)) - {"crc"}
    told_apart = any(len(word) > _GREATEST_LETTERS for word in words)
    return told_apart and words <= set(_WORD.findall(name))


@cache
def crc_catalogue() -> Mapping[ChecksumSpec, tuple[str, ...]]:
    """The algorithms of the CRC catalogue up to 64 bits, in its order, each with its aliases."""
    return {_spec_of(row): tuple(row["aliases"].split()) for row in catalogue_rows()}


def _spec_of(row: Mapping[str, str]) -> ChecksumSpec:
    return ChecksumSpec(
        row["name"],
        "crc",
        int(row["width"]),
        init=int(row["init"], 16),
        poly=int(row["poly"], 16),
        refin=row["refin"] == "true",
        refout=row["refout"] == "true",
        xorout=int(row["xorout"], 16),
    )


@cache
def _by_folded_name() -> Mapping[str, ChecksumSpec]:
    """Return each algorithm under its own name and its aliases, all in lower case."""
    simple = {spec.name: spec for spec in SIMPLE_ALGORITHMS}
    catalogue = {
        name.casefold(): spec
        for spec, aliases in crc_catalogue().items()
        for name in (spec.name, *aliases)
    }
    return simple | catalogue


@cache
def checksum_of(spec: ChecksumSpec) -> sums.Checksum:
    """Implementation of a checksum algorithm."""
    match spec.kind:
        case "xor":
            rest = spec.xorout, spec.mask, spec.add
            return sums.Xor(spec.width, spec.init, *rest, words=spec.words)
        case "sum":
            rest = spec.xorout, spec.mask, spec.add
            return sums.Sum(spec.width, spec.init, *rest, negated=spec.negated, words=spec.words)
        case "fletcher":
            return sums.Fletcher16(spec.modulus)
        case "crc":
            return sums.Crc(spec.width, spec.poly, spec.init, spec.refin, spec.refout, spec.xorout)
