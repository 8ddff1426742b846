"""What firmware that sends is given beside encoders, run on machines of both byte orders."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from compiled import ROOT
from tooling import require_tool

GENERATED = ROOT / "generated" / "c"
STRICT = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror")
COMPILERS = {
    "gcc": (["gcc", "-std=c99", "-O2", *STRICT], []),
    "clang": (["clang", "-std=c99", *STRICT, "-fsanitize=undefined"], []),
    "g++": (["g++", "-std=c++11", "-x", "c++", *STRICT], []),
    "tcc": (["tcc", "-std=c99", "-Wall", "-Werror"], []),
    "s390x": (["s390x-linux-gnu-gcc", "-std=c99", "-static", *STRICT], ["qemu-s390x"]),
}
"""Each with what runs its programs."""
EACH_COMPILER = pytest.mark.parametrize("compiler", COMPILERS)


def run(compiler: str, program: str, names: list[str], folder: Path) -> None:
    """Compile a program with what is generated, and run it; it has to return 0."""
    (folder / "main.c").write_text(program, encoding="utf-8")
    command, runner = COMPILERS[compiler]
    sources = [str(GENERATED / f"{name}.c") for name in names]
    without = [f"-D{name.upper()}_NO_HANDLERS" for name in names]
    call = [*command, *without, f"-I{GENERATED}", "main.c", *sources, "-o", "main"]
    require_tool(call[0])
    done = subprocess.run(call, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    executed = [*map(require_tool, runner), str(folder / "main")]
    ran = subprocess.run(executed, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, f"line {ran.stdout}{ran.stderr}"


EXPECT = """
#include <stdio.h>
#include <string.h>
#define EXPECT(condition) \\
    do { if (!(condition)) { printf("%d\\n", __LINE__); return 1; } } while (0)
"""

PIECES = f"""{EXPECT}
#include "matty.h"
#include "rn1.h"

static uint8_t line[64];
static size_t size, room;

static bool offer(void *user, uint8_t byte) {{
    (void)user;
    if (room == 0) {{
        return false;
    }}
    room--;
    line[size++] = byte;
    return true;
}}

int main(void) {{
    struct rn1_transmission out;
    struct matty_transmission mine;
    struct matty_go go = {{0x5556, 85}};
    struct matty_nack nack = {{0}};
    struct rn1_move_relative_arc arc = {{-8192, 8191}};
    uint8_t frame[64];
    size_t whole = 0;
    size_t step;
    out.offer = mine.offer = offer;
    out.user = mine.user = NULL;
    out.sent = out.seen = mine.sent = mine.seen = 0;
    for (step = 1; step < 14; step++) {{ /* Rooms in each turn; one frame behind the other. */
        size_t turns = 0;
        EXPECT(rn1_move_relative_arc_frame(&arc, frame, sizeof frame, &whole) == RN1_OK);
        size = 0;
        do {{
            room = step;
            EXPECT(rn1_move_relative_arc_send(&arc, rn1_transmit, &out) == RN1_OK);
            turns++;
        }} while (!rn1_transmitted(&out));
        EXPECT(turns == (whole + step - 1) / step);
        EXPECT(size == whole && memcmp(line, frame, size) == 0);

        /* A checksum, and escapes that are cut in two. */
        EXPECT(matty_go_frame(&go, 0x56, frame, sizeof frame, &whole) == MATTY_OK);
        EXPECT(whole == 13);
        size = 0;
        do {{
            room = step;
            EXPECT(matty_go_send(&go, 0x56, matty_transmit, &mine) == MATTY_OK);
        }} while (!matty_transmitted(&mine));
        EXPECT(size == whole && memcmp(line, frame, size) == 0);
    }}
    size = room = 0;
    EXPECT(matty_nack_send(&nack, 1, matty_transmit, &mine) == MATTY_OK);
    EXPECT(!matty_transmitted(&mine) && size == 0);
    arc.angle = 8192; /* Nothing of what is out of range goes out, and nothing of it is left. */
    EXPECT(rn1_move_relative_arc_send(&arc, rn1_transmit, &out) == RN1_ERROR_RANGE);
    EXPECT(rn1_transmitted(&out) && size == 0);
    return 0;
}}
"""


@EACH_COMPILER
def test_a_frame_goes_on_with_the_byte_that_was_refused(compiler: str, tmp_path: Path) -> None:
    run(compiler, PIECES, ["rn1", "matty"], tmp_path)
