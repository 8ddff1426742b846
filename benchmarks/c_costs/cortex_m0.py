"""Cycles of a program on a Cortex-M0, in Unicorn.

Unicorn runs the instructions; what each takes is in the table of Arm's Technical Reference Manual
of the Cortex-M0 (DDI 0432C, 3.3), for memory without wait states and the fast multiplier.
"""

from __future__ import annotations

from pathlib import Path

from elftools.elf.elffile import ELFFile
from unicorn import UC_ARCH_ARM, UC_HOOK_CODE, UC_HOOK_MEM_WRITE, UC_MODE_MCLASS, UC_MODE_THUMB, Uc
from unicorn.arm_const import UC_ARM_REG_SP, UC_CPU_ARM_CORTEX_M0

from c_costs.events import END, Event

FLASH, FLASH_SIZE = 0, 0x10000
RAM, RAM_SIZE = 0x20000000, 0x4000
PORTS, PORTS_SIZE = 0x40000000, 0x4000
SAY = 0x40002000
"""What is written there is an event, as harness/cycles.c says."""
MARKS = {0x46C9: 1, 0x46D2: 2, 0x46DB: 3, 0x46E4: 4, 0x46F6: END}
"""Moves of a register to itself, which are marks: no compiler prints them."""
MOST = 50_000_000
"""Instructions after which a program is given up."""
BRANCHES = 2
"""Cycles that a conditional branch takes more where it branches."""


def events(program: Path) -> list[Event]:
    """Run a program until its last mark."""
    return _Run(program).events


class _Run:
    """A program that runs, and what it has told."""

    def __init__(self, program: Path) -> None:
        self.events: list[Event] = []
        self._cycle = 0
        self._straight: int | None = None
        """Where a conditional branch goes on that does not branch."""
        self._costs: dict[int, tuple[int, int | None, int | None]] = {}
        self._machine = machine = Uc(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS)
        machine.ctl_set_cpu_model(UC_CPU_ARM_CORTEX_M0)
        for place, size in ((FLASH, FLASH_SIZE), (RAM, RAM_SIZE), (PORTS, PORTS_SIZE)):
            machine.mem_map(place, size)
        with program.open("rb") as file:
            image = ELFFile(file)
            for segment in image.iter_segments("PT_LOAD"):
                machine.mem_write(segment["p_vaddr"], segment.data())
            entry = image["e_entry"]
        machine.reg_write(UC_ARM_REG_SP, RAM + RAM_SIZE)
        machine.hook_add(UC_HOOK_CODE, self._step)
        machine.hook_add(UC_HOOK_MEM_WRITE, self._say, begin=SAY, end=SAY)
        machine.emu_start(entry | 1, FLASH_SIZE, count=MOST)
        if not self.events or self.events[-1].mark != END:
            raise SystemExit(f"{program} did not end")

    def _step(self, machine: Uc, address: int, size: int, user: object) -> None:
        del user
        if self._straight is not None and address != self._straight:
            self._cycle += BRANCHES
        found = self._costs.get(address)
        if found is None:
            found = self._costs[address] = self._cost(address, size)
        cycles, self._straight, mark = found
        self._cycle += cycles
        if mark is not None:
            self.events.append(Event(self._cycle, mark=mark))
            if mark == END:
                machine.emu_stop()

    def _cost(self, address: int, size: int) -> tuple[int, int | None, int | None]:
        """Cycles of an instruction, where it goes on without a branch, and which mark it is."""
        code = int.from_bytes(self._machine.mem_read(address, 2), "little")
        mark = MARKS.get(code)
        straight = address + size if is_conditional(code) else None
        return (0 if mark is not None else cycles_of(code)), straight, mark

    def _say(
        self, machine: Uc, access: int, address: int, size: int, value: int, user: object
    ) -> None:
        del machine, access, address, size, user
        self.events.append(Event(self._cycle, said=value & 0xFF))


def is_conditional(code: int) -> bool:
    """Whether an instruction is a branch with a condition."""
    return code >> 12 == 0b1101 and code >> 8 & 0xF < 0b1110


def cycles_of(code: int) -> int:
    """Cycles of an instruction by its first 16 bits; of a conditional branch that does not branch.

    A Cortex-M0 has but one instruction of 32 bits that these programs use: BL.
    """
    for first, last, cycles in _SPANS:
        if first <= code <= last:
            return cycles(code) if callable(cycles) else cycles
    return 1


def _high(code: int) -> int:
    """ADD, CMP and MOV with any registers: where they write the program counter they branch."""
    writes = code >> 8 & 0b11 in (0b00, 0b10)
    return 3 if writes and (code >> 7 & 1, code & 7) == (1, 7) else 1


def _several(code: int) -> int:
    """LDM, STM, PUSH and POP: one, and one for each register."""
    return 1 + (code & 0xFF).bit_count()


def _push(code: int) -> int:
    return 1 + (code & 0x1FF).bit_count()


def _pop(code: int) -> int:
    """It also returns where it takes the program counter."""
    return (4 if code & 0x100 else 1) + (code & 0x1FF).bit_count()


_SPANS = (
    (0x4400, 0x46FF, _high),
    (0x4700, 0x47FF, 3),  # BX, BLX
    (0x4800, 0x9FFF, 2),  # LDR, STR and their kinds
    (0xB400, 0xB5FF, _push),
    (0xBC00, 0xBDFF, _pop),
    (0xC000, 0xCFFF, _several),  # STM, LDM
    (0xE000, 0xE7FF, 3),  # B
    (0xF000, 0xFFFF, 4),  # BL
)
