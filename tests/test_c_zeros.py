"""A decoder in memory of zeros is one that was initialised, in every framing.

Mostly `init` leaves zeros as they are. It depends on nothing but that memory and its arguments, so
one run shows it. Where it sets more, the two are in one state behind the first byte, whichever it
is and whether or not the input ended in front of it. What follows is then the same for both.
"""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from c_proof.generated import generate
from compiled import SCHEMAS, protocol_of
from tooling import require_tool

from protogen.targets.c.options import EVENTS, COptions, Events

_INIT = re.compile(r"void (\w+)_decoder_init\(\s*struct \w+ \*decoder(, \w+ handler)?")
_HEAD = """#include <stdio.h>
#include <string.h>

static unsigned long told; /* What was reported, as one number. */
"""
_HANDLER = """
static void handle_{prefix}(void *user, const struct {prefix}_event *event) {{
    (void)user;
    told = told * 31UL + (unsigned long)event->kind * 7UL + event->offset + event->size + 1UL;
}}
"""
_TRIED = """
static struct {prefix}_decoder {prefix};

static void begin_{prefix}(int way) {{
    memset(&{prefix}, 0, sizeof {prefix});
    told = 0;
    if (way == 1) {{
        {prefix}_decoder_init(&{prefix}{handler});
    }}
{given}}}

static void try_{prefix}(void) {{
    static struct {prefix}_decoder ways[2];
    static struct {prefix}_decoder ended[2];
    unsigned long reported[2];
    begin_{prefix}(0);
    ways[0] = {prefix};
    begin_{prefix}(1);
    ways[1] = {prefix};
    if (memcmp(&ways[0], &ways[1], sizeof ways[0]) == 0) {{
        return;
    }}
    (void)puts("{prefix} differs behind init");
    for (int way = 0; way < 2; way++) {{
        begin_{prefix}(way);
        (void){prefix}_decoder_flush(&{prefix});
        ended[way] = {prefix};
    }}
    if (memcmp(ways, ended, sizeof ways) != 0) {{
        (void)puts("{prefix} differs behind an end"); /* So that others change nothing, either. */
    }}
    for (int byte = 0; byte < 256; byte++) {{
        for (int way = 0; way < 2; way++) {{
            begin_{prefix}(way);
            {push}
            ways[way] = {prefix};
            reported[way] = told;
        }}
        if (memcmp(&ways[0], &ways[1], sizeof ways[0]) != 0 || reported[0] != reported[1]) {{
            (void)printf("{prefix} differs behind byte %d\\n", byte);
        }}
    }}
}}
"""
_PUSH = "{prefix}_decoder_push(&{prefix}, (uint8_t)byte);"


@pytest.mark.parametrize("events", EVENTS)
def test_a_decoder_of_zeros_is_one_that_was_initialised(events: Events, tmp_path: Path) -> None:
    """With its counters."""
    tried: dict[str, str] = {}
    for path in SCHEMAS:
        made = generate(protocol_of(path), tmp_path, COptions(events=events))
        for prefix, handler in _INIT.findall(made.header.read_text(encoding="utf-8")):
            tried[prefix] = _tried(prefix, has_handler=bool(handler))
    assert len(tried) > len(SCHEMAS)
    assert _printed(tried, tmp_path) == ""


def _tried(prefix: str, *, has_handler: bool) -> str:
    push = _PUSH.format(prefix=prefix)
    if not has_handler:
        return _TRIED.format(
            prefix=prefix, handler="", given="", push=f"told = (unsigned long){push}"
        )
    given = f"    {prefix}.handler = handle_{prefix};\n"
    handler = f", handle_{prefix}, NULL"
    text = f"{_HANDLER}{_TRIED}"
    return text.format(prefix=prefix, handler=handler, given=given, push=push)


def _printed(tried: dict[str, str], folder: Path) -> str:
    """What a program says that tries the decoders."""
    defines = [f"-D{protocol_of(path).name.upper()}_COUNTERS" for path in SCHEMAS]
    headers = "".join(f'#include "{path.name}"\n' for path in sorted(folder.glob("*.h")))
    calls = "".join(f"    try_{prefix}();\n" for prefix in tried)
    text = f"{headers}{_HEAD}{''.join(tried.values())}\nint main(void) {{\n{calls}}}\n"
    (folder / "main.c").write_text(text, encoding="utf-8")
    sources = [path.name for path in sorted(folder.glob("*.c"))]
    command = [require_tool("gcc"), "-std=c99", "-O0", *defines, *sources, "-o", "main"]
    subprocess.run(command, check=True, cwd=folder)
    return subprocess.run([folder / "main"], capture_output=True, text=True, check=True).stdout
