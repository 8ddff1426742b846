"""The machines that a cost can be asked for, and their compilers."""

from __future__ import annotations

import msgspec


class Machine(msgspec.Struct, frozen=True):
    """A compiler and what it is told."""

    name: str
    title: str
    compiler: str
    flags: tuple[str, ...]
    package: str
    """The package of Debian and Ubuntu that has the compiler."""
    constants_in_ram: bool = False
    """True if constants are copied to RAM before the program starts."""


MACHINES: dict[str, Machine] = {
    machine.name: machine
    for machine in (
        Machine(
            "atmega328p",
            "ATmega328P",
            "avr-gcc",
            ("-mmcu=atmega328p",),
            "gcc-avr avr-libc",
            constants_in_ram=True,
        ),
        Machine(
            "cortex-m0",
            "Cortex-M0",
            "arm-none-eabi-gcc",
            ("-mcpu=cortex-m0", "-mthumb"),
            "gcc-arm-none-eabi",
        ),
        Machine("host", "this machine", "cc", (), "gcc"),
    )
}
