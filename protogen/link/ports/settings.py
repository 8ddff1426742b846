"""How the line is set: rate, format of a character, control lines."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import msgspec

if TYPE_CHECKING:
    from protogen.model.protocol import Link
    from protogen.runtime.line import Line

DEFAULT_BAUD = 115200
"""Rate of a device where neither the schema nor the user says one."""


class LineSettings(msgspec.Struct, frozen=True, kw_only=True):
    """Settings of a serial port; sockets and recordings have none."""

    baud: int = DEFAULT_BAUD
    """Bits per second."""
    data_bits: Literal[5, 6, 7, 8] = 8
    parity: Literal["none", "even", "odd", "mark", "space"] = "none"
    stop_bits: Literal[1, 2] = 1
    dtr: bool | None = None
    """State of DTR; None leaves it as it is, as many boards are reset by it."""
    rts: bool | None = None
    """State of RTS; None leaves it as it is."""


def settings_of(
    link: Link | Line, baud: int | None = None, *, dtr: bool | None = None, rts: bool | None = None
) -> LineSettings:
    """The settings of a schema's `link`, or of a module's line; what is given goes before."""
    return msgspec.convert(
        {
            "baud": baud or link.baud or DEFAULT_BAUD,
            "data_bits": link.data_bits,
            "parity": link.parity,
            "stop_bits": link.stop_bits,
            "dtr": dtr,
            "rts": rts,
        },
        LineSettings,
    )
