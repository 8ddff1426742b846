"""The checksum algorithms that a schema may name, as data for the passes and the targets.

A `ChecksumSpec` says what to compute, not how: each target prints it in its own language.
"""

from collections.abc import Mapping
from functools import cache
from typing import Literal

import msgspec

from protogen.model.crc_catalogue import ALGORITHMS, ALIASES, Row
from protogen.runtime import checksum as sums

ChecksumKind = Literal["xor", "sum", "fletcher", "crc"]


class ChecksumSpec(msgspec.Struct, frozen=True):
    """One checksum algorithm with all its parameters.

    `width` is the checksum's size in bits. `init` is the value before the first byte (`xor`, `sum`
    and `crc`). `negated` belongs to `sum`: the result is what brings the sum to 0 modulo 256.
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

    @property
    def modulus(self) -> int:
        """Modulus of Fletcher's two sums."""
        # No field: it would be in the spec hash of every schema, and the name says it already.
        return 256 if self.name == FLETCHER_256 else 255


FLETCHER_256 = "fletcher-16/256"
"""Fletcher's checksum with sums of one byte that simply overflow, as UBX has it."""

SIMPLE_ALGORITHMS = (
    ChecksumSpec("xor-8", "xor", 8),
    ChecksumSpec("sum-8", "sum", 8),
    ChecksumSpec("sum-8/negated", "sum", 8, negated=True),
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
    return (*_by_name(), *ALIASES)


@cache
def _by_name() -> Mapping[str, ChecksumSpec]:
    """Return each algorithm under its own name, in the order of the catalogue."""
    specs = (*SIMPLE_ALGORITHMS, *map(_spec_of, ALGORITHMS))
    return {spec.name: spec for spec in specs}


@cache
def _by_folded_name() -> Mapping[str, ChecksumSpec]:
    """Return each algorithm under its own name and its aliases, all in lower case."""
    own = _by_name()
    aliases = {alias: own[name] for alias, name in ALIASES.items()}
    return {name.casefold(): spec for name, spec in (*own.items(), *aliases.items())}


def _spec_of(row: Row) -> ChecksumSpec:
    name, width, poly, init, refin, refout, xorout = row
    return ChecksumSpec(
        name,
        "crc",
        width,
        init=init,
        poly=poly,
        refin=refin,
        refout=refout,
        xorout=xorout,
    )


@cache
def checksum_of(spec: ChecksumSpec) -> sums.Checksum:
    """Implementation of a checksum algorithm."""
    match spec.kind:
        case "xor":
            return sums.Xor8(spec.init)
        case "sum":
            return sums.Sum8(spec.init, spec.negated)
        case "fletcher":
            return sums.Fletcher16(spec.modulus)
        case "crc":
            return sums.Crc(spec.width, spec.poly, spec.init, spec.refin, spec.refout, spec.xorout)
