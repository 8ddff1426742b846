"""Cycles of a Cortex-M0 are those of Arm's table, added up by hand."""

import subprocess
import sys
from pathlib import Path

from tooling import require_module, require_tool

ROOT = Path(__file__).parent.parent
sys.path.append(str(ROOT / "benchmarks"))

PROGRAM = """\
    .syntax unified
    .thumb
    .section .vectors, "ax"
    .global main
    .thumb_func
main:
    .short 0x46C9           @ mark 1
    movs r0, #2             @ 1
again:
    subs r0, #1             @ 1, twice
    bne again               @ 3, then 1
    ldr r1, =0x20000100     @ 2
    stmia r1!, {r0, r2}     @ 1 + 2
    subs r1, #8             @ 1
    ldmia r1!, {r3, r4, r5} @ 1 + 3
    ldrsb r3, [r1, r0]      @ 2
    ldrh r3, [r1, #2]       @ 2
    muls r3, r3             @ 1
    sub sp, #8              @ 1
    str r3, [sp]            @ 2
    add sp, #8              @ 1
    .short 0x46D2           @ mark 2
    .short 0x46DB           @ mark 3
    bl apart                @ 4
    b behind                @ 3
    nop
behind:
    uxtb r3, r3             @ 1
    mov r8, r3              @ 1
    .short 0x46E4           @ mark 4
    ldr r1, =0x40002000
    movs r0, #0x5A
    strb r0, [r1]           @ said
    .short 0x46F6           @ the end
    .thumb_func
apart:
    push {r4, r5, lr}       @ 1 + 3
    adr r4, there           @ 1
    adds r4, #1             @ 1
    bx r4                   @ 3
    .balign 4
there:
    mov r12, r4             @ 1
    cmp r12, r4             @ 1
    beq back                @ 3
    nop
back:
    pop {r4, r5, pc}        @ 4 + 3
"""
FIRST = 1 + 2 * 1 + 3 + 1 + 2 + 3 + 1 + 4 + 2 + 2 + 2 + 1 + 1 + 1
SECOND = 4 + (4 + 1 + 1 + 3) + (1 + 1 + 3 + 7) + 3 + 1 + 1


def test_cycles_are_added_up(tmp_path: Path) -> None:
    """Each kind of instruction that compilers print."""
    require_module("unicorn")
    require_module("elftools")
    compiler = require_tool("arm-none-eabi-gcc")
    from c_costs import cortex_m0, events
    from c_costs.toolchains import ARM, ORDINARY

    source, program = tmp_path / "program.s", tmp_path / "program"
    source.write_text(PROGRAM, encoding="utf-8")
    command = [compiler, *ARM[ORDINARY].flags, "-nostdlib", "-o", str(program), str(source)]
    subprocess.run(command, check=True)
    told = cortex_m0.events(program)
    assert events.spans(told, 1) == [FIRST]
    assert events.spans(told, 3) == [SECOND]
    assert events.said(told) == [0x5A]
