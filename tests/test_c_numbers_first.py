"""Messages whose numbers of elements are given when a frame is begun, with sanitizers: the same
structs field by field into the buffer of a frame, and as a whole."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from c_in_place_frames import FRAMES
from c_library import write_sources
from c_numbers_first import FILLED, NUMBERS_FIRST, first_schema
from compiled import protocol_of
from test_c_in_place import HEAD, written
from test_c_in_place_varied import SANITIZED, STRICT, run
from tooling import require_compiler

from protogen.targets.c.emit import unit_of
from protogen.targets.c.frame.message_frames import MessageFrame
from protogen.targets.c.options import COptions

ANYTHING = """
#include <stdio.h>
#include <stdlib.h>
#define EXPECT(condition) \\
    do { \\
        if (!(condition)) { printf("line %d: %s\\n", __LINE__, #condition); return 1; } \\
    } while (0)
static uint32_t state = 1;
static uint32_t any(uint32_t below) {
    state = state * 1664525U + 1013904223U;
    return (state >> 8) % below;
}
static int sent;
static int refused;
"""
TRY = """
/* What is written in place is what `frame` makes of the same struct, with the same room. */
static int try_{name}(void) {{
    {struct} message;
    const size_t capacity = {capacity};
    uint8_t *const buffer = malloc(capacity + !capacity);
    uint8_t *const whole = malloc(capacity + !capacity);
    size_t size = 0;
    size_t expected;
    int result;
    for (size_t i = 0; i < sizeof message; i++) {{
        ((uint8_t *)&message)[i] = (uint8_t)any(12);
    }}
    {{
        {struct} *const m = &message;
{shape}
    }}
    result = write_{name}(&message, -1, buffer, capacity, &size{parts});
    expected = {frame}(&message, {parts_first}whole, capacity);
    EXPECT(result == -1 || result == 0 || result == 100 || result == 200);
    EXPECT((result == 0) == (expected != 0) && size == expected);
    EXPECT(size == 0 || memcmp(buffer, whole, size) == 0);
    sent += size != 0;
    refused += size == 0;
    free(buffer);
    free(whole);
    return 0;
}}
"""
_POINT = "{at}.x = (int16_t)any(60000);"
_STEP = "{at}.kind = (uint8_t)(1 + any(2)); {at}.level = (uint16_t)(2 + any(299));"
SHAPES = {
    "doubled": "m->n = (uint8_t)any(24);",
    "grid": "m->rows = (uint8_t)any(8); m->columns = (uint16_t)any(7); "
    "m->number = (uint16_t)(1 + any(9)); "
    "for (int i = 0; i < 2; i++) { " + _STEP.format(at="m->steps[i]") + " }",
    "shifted": "m->n = (int8_t)((int)any(48) - 6);",
    "keyed": "m->key = (uint8_t)any(256); for (int i = 0; i < 15; i++) { m->x[i] = any(90001); }",
    "headed": "m->head.n = (uint8_t)any(15); m->head.kind = (uint8_t)(1 + any(2)); "
    "m->level = -1 - (int32_t)any(5);",
    "plainly": "m->head.n = (uint8_t)any(50);",
    "deep": "m->a = (uint8_t)any(7); memset(&m->at, 0, sizeof m->at); "
    "m->at.inner.n = (uint16_t)any(24); "
    "for (int i = 0; i < 7; i++) { for (int j = 0; j < 3; j++) { "
    "m->again[i].cells[j] = (int16_t)((int)any(201) - 100); } }",
    "pair": "m->n = (uint8_t)any(230); m->m = (uint8_t)any(any(2) ? 20 : 256); "
    "memset(m->y, 0, sizeof m->y); for (size_t i = 0; i < sizeof m->y / sizeof m->y[0]; i++) { "
    + _STEP.format(at="m->y[i]")
    + " }",
    "named": "m->n = (uint8_t)any(256); m->points_count = (uint8_t)any(37); "
    + _POINT.format(at="m->points[0]"),
    "noted": "m->n = (uint8_t)any(any(2) ? 256 : 30); m->m = (uint8_t)any(256); "
    "m->text_size = (__typeof__(m->text_size))any(sizeof m->text + 1U);",
}
"""Values that a frame often has, and often not. There is 0 between members of structs."""


def tries(item: MessageFrame) -> Iterator[str]:
    name = item.message.name
    needed = f"{item.room}U" if name in FILLED else f"any(3) ? {item.room}U : any({item.room}U)"
    yield written(item)
    yield TRY.format(
        name=name,
        struct=item.view.struct,
        capacity=needed,
        shape=f"        {SHAPES[name]}",
        frame=item.called.function,
        parts=", 7" * len(item.arguments),
        parts_first="7, " * len(item.arguments),
    )


@pytest.mark.parametrize("frame", [frame for frame in FRAMES if frame != "trimmed"])
def test_frames_are_those_that_are_made_of_structs(frame: str, tmp_path: Path) -> None:
    path = tmp_path / "first.yaml"
    path.write_text(first_schema("place", frame), encoding="utf-8")
    protocol = protocol_of(path)
    source = write_sources(protocol, tmp_path)
    parts = [HEAD.format(name=source), ANYTHING]
    items = [it for it in unit_of(protocol, COptions()).framing.messages if it.in_place]
    assert {it.message.name for it in items} == set(SHAPES) == set(NUMBERS_FIRST)
    for item in items:
        parts += tries(item)
    calls = "".join(f"        EXPECT(try_{name}() == 0);\n" for name in SHAPES)
    loop = f"    for (int turn = 0; turn < 500; turn++) {{\n{calls}    }}\n"
    enough = f"    EXPECT(sent > {200 * len(SHAPES)} && refused > {50 * len(SHAPES)});\n"
    parts.append(f"int main(void) {{\n{loop}{enough}    return 0;\n}}\n")
    (tmp_path / "main.c").write_text("".join(parts), encoding="utf-8")
    compiler = require_compiler("cc", *SANITIZED)
    flags = [*STRICT, "-Wno-unused-function", *SANITIZED, "-O1"]
    run([compiler, *flags, "main.c", "-o", "main"], tmp_path)
    run([tmp_path / "main"], tmp_path)
