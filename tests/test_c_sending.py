"""What firmware that sends is given beside encoders, run on machines of both byte orders."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from c_library import write_sources
from compiled import DOCUMENTS, ROOT, protocol_of
from tooling import require_tool

from protogen.targets.c.emit import unit_of
from protogen.targets.c.options import COptions

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
    struct rn1_move_relative_arc arc = {{-8192, 8191}};
    uint8_t frame[64];
    size_t whole;
    size_t step;
    out.offer = mine.offer = offer;
    out.user = mine.user = NULL;
    out.sent = out.seen = mine.sent = mine.seen = 0;
    for (step = 1; step < 14; step++) {{ /* Rooms in each turn; one frame behind the other. */
        size_t turns = 0;
        whole = rn1_move_relative_arc_frame(&arc, frame, sizeof frame);
        size = 0;
        do {{
            room = step;
            EXPECT(rn1_move_relative_arc_send(&arc, rn1_transmit, &out) == RN1_OK);
            turns++;
        }} while (!rn1_transmitted(&out));
        EXPECT(turns == (whole + step - 1) / step);
        EXPECT(size == whole && memcmp(line, frame, size) == 0);

        /* A checksum, and escapes that are cut in two. */
        whole = matty_go_frame(&go, 0x56, frame, sizeof frame);
        EXPECT(whole == 13);
        size = 0;
        do {{
            room = step;
            EXPECT(matty_go_send(&go, 0x56, matty_transmit, &mine) == MATTY_OK);
        }} while (!matty_transmitted(&mine));
        EXPECT(size == whole && memcmp(line, frame, size) == 0);
    }}
    size = room = 0;
    EXPECT(matty_nack_send(1, matty_transmit, &mine) == MATTY_OK);
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


DEFAULTS = """\
protocol: defaults
endpoints: {host: Host}
byte_order: little
types:
  point: {fields: {x: sint8, y: {type: sint8, default: -3}}}
frame: {id: {type: uint8, id: true}, payload: {}, end: {literal: 0xC0}}
transparency: slip
messages:
  all:
    id: 1
    from: host
    fields:
      on: {type: bool, default: true}
      small: {type: sint16, default: -32768}
      wide: {type: uint64, default: 0xFFFFFFFFFFFFFFFF}
      real: {type: float32, default: 1.5}
      at: point
      far: {type: point, count: 2}
      padded: {type: ascii, size: 4, default: "a'"}
      key: {type: bytes, size: 2, default: {hex: 00 FF}}
      three: {type: uint8, count: 3, default: [1, 2, 3]}
      none: {type: uint8, count: 3}
      name: {type: ascii, size: {fill: true, max: 9}, default: gain}
  empty: {id: 2, from: host, fields: {}}
  large: {id: 3, from: host, fields: {x: {type: float64}}}
  unwritable: {id: 4, from: host, fields: {x: {type: float64, default: 0.5}}}
"""

BEGINS = f"""{EXPECT}
#include "defaults.h"

int main(void) {{
    static const struct defaults_all all = DEFAULTS_ALL_INIT;
    const struct defaults_large large = DEFAULTS_LARGE_INIT;
    EXPECT(all.on && all.small == -32767 - 1 && all.wide == 0xFFFFFFFFFFFFFFFFULL);
    EXPECT(all.real > 1.4f && all.real < 1.6f && all.at.x == 0 && all.at.y == -3);
    EXPECT(all.far[0].x == 0 && all.far[0].y == -3 && all.far[1].y == -3);
    EXPECT(memcmp(all.padded, "a'\\0\\0", 4) == 0 && all.key[0] == 0 && all.key[1] == 0xFF);
    EXPECT(all.three[0] == 1 && all.three[2] == 3 && all.none[0] == 0 && all.none[2] == 0);
    EXPECT(all.name_size == 4 && memcmp(all.name, "gain", 4) == 0);
#ifdef DEFAULTS_EMPTY_INIT
    EXPECT(0);
#endif
    EXPECT(!(large.x > 0) && !(large.x < 0));
#ifdef DEFAULTS_UNWRITABLE_INIT
    EXPECT(0);
#endif
    return 0;
}}
"""


COMMANDS = f"""{EXPECT}
#include "dagny.h"

int main(void) {{
    static const uint8_t identities[4] = {{
        DAGNY_MOTOR_ID, DAGNY_STEERING_ID, DAGNY_REFLEX_ID, DAGNY_POWER_ID}};
    static const struct dagny_steering steering = {{0x40}};
    static const struct dagny_power power = {{0x40}};
    size_t index;
    uint8_t made[4];
    for (index = 0; index < 4; index++) {{
        const uint8_t id = identities[index];
        const uint8_t due[4] = {{id, 0x40, (uint8_t)(id ^ 0x40), 0x0A}};
        uint8_t frame[4] = {{1, 2, 3, 4}};
        EXPECT(dagny_host_frame_byte(0x40, frame, 3, id) == 0);
        EXPECT(frame[0] == 1 && frame[1] == 2 && frame[2] == 3);
        EXPECT(dagny_host_frame_byte(0x40, frame, 4, id) == 4);
        EXPECT(memcmp(frame, due, 4) == 0);
    }}
    EXPECT(dagny_power_frame(&power, made, 4) == 4 && memcmp(made, "P\\x40\\x10\\n", 4) == 0);
    EXPECT(dagny_steering_frame(&steering, made, 4) == 4);
    EXPECT(memcmp(made, "S\\x40\\x13\\n", 4) == 0);
    EXPECT(dagny_steering_frame(&steering, made, 3) == 0);
    return 0;
}}
"""


@EACH_COMPILER
def test_the_frame_of_a_byte_has_the_identity_that_is_given(compiler: str, tmp_path: Path) -> None:
    run(compiler, COMMANDS, ["dagny"], tmp_path)


@EACH_COMPILER
def test_a_message_begins_with_its_defaults(compiler: str, tmp_path: Path) -> None:
    schema = tmp_path / "defaults.yaml"
    schema.write_text(DEFAULTS, encoding="utf-8")
    write_sources(protocol_of(schema), tmp_path)
    run(compiler, BEGINS, [], tmp_path)


def test_every_message_has_an_initialiser_that_no_compiler_warns_of(tmp_path: Path) -> None:
    text = ""
    paths = (*DOCUMENTS, *(ROOT / "tests" / "c_schemas").glob("*.yaml"))
    for path in paths:
        unit = unit_of(protocol_of(path), COptions())
        write_sources(unit.protocol, tmp_path)
        text += f'#include "{unit.names.file}.h"\n'
        for view in (view for view in unit.module.messages if view.initialiser):
            macro = "\n".join(view.initialiser).partition("#define ")[2].split()[0]
            text += f"extern const {view.struct} {macro.lower()};\n"
            text += f"const {view.struct} {macro.lower()} = {macro};\n"
    (tmp_path / "all.c").write_text(text, encoding="utf-8")
    assert text.count("_INIT") > 100
    avr = ["avr-gcc", "-std=c99", "-mmcu=atmega328p", *STRICT]
    for command in (*(command for command, _ in COMPILERS.values()), avr):
        call = [require_tool(command[0]), *command[1:], "-c", "all.c", "-o", "all.o"]
        done = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")
