"""Damage that is done to a line on purpose, the same for the same seed."""

from __future__ import annotations

from random import Random

import msgspec


class DamageRates(msgspec.Struct, frozen=True, kw_only=True):
    """How much is damaged; nothing, if nothing is said."""

    drop: float = 0.0
    """Share of bytes that are left out, from 0 to 1."""
    flip: float = 0.0
    """Share of bytes of which one bit is turned over, from 0 to 1."""
    delay: float = 0.0
    """The most seconds that bytes are held back; they stay in order."""

    @property
    def is_none(self) -> bool:
        """True if bytes pass at once and as they are."""
        return not (self.drop or self.flip or self.delay)


class Damage:
    """Damages bytes in one direction."""

    def __init__(self, rates: DamageRates, seed: int | str = 0) -> None:
        self._rates = rates
        self._random = Random(seed)  # noqa: S311 - nothing here is secret
        self.dropped = 0
        """Bytes that were left out."""
        self.flipped = 0
        """Bytes of which a bit was turned over."""

    def of(self, data: bytes) -> bytes:
        """What is left of these bytes."""
        if not self._rates.drop and not self._rates.flip:
            return data
        found = bytearray()
        for byte in data:
            if self._random.random() < self._rates.drop:
                self.dropped += 1
            elif self._random.random() < self._rates.flip:
                self.flipped += 1
                found.append(byte ^ 1 << self._random.randrange(8))
            else:
                found.append(byte)
        return bytes(found)

    def pause(self) -> float:
        """Seconds for which the next bytes are held back."""
        return self._random.uniform(0, self._rates.delay) if self._rates.delay else 0.0
