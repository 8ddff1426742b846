"""A decoder in memory of zeros is one that was initialised, in every framing.

Mostly `init` leaves zeros as they are. It depends on nothing but that memory and its arguments, so
one run shows it. Where it sets more, all that can come of the two is looked through: any byte, the
end of the input, or asking for what is left, from each pair of states that they reach, until they
are in one state. They report the same, payloads included, and what follows is then the same for
both.
"""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from c_proof.generated import Generated, generate
from compiled import ROOT, SCHEMAS, protocol_of
from tooling import require_tool

from protogen.targets.c.options import EVENTS, COptions, Events

_INIT = re.compile(r"void (\w+)_decoder_init\(\s*struct \w+ \*decoder(,\s*\w+ handler)?")
_HEAD = """#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint64_t told; /* What was reported, as one number. */

static void tell(uint64_t value) {
    told = (told ^ (value + 1U)) * UINT64_C(1099511628211);
}

static void tell_payload(const uint8_t *payload, size_t size) {
    tell(size);
    for (size_t index = 0; index < size; index++) {
        tell(payload[index]);
    }
}
"""
_HANDLER = """
static void handle_{prefix}(void *user, const struct {prefix}_event *event) {{
    (void)user;
    tell((uint64_t)event->kind);
    tell((uint64_t)event->reason);
    tell(event->offset);
    tell(event->size);
    tell((uint64_t)event->message);
    tell_payload(event->payload, event->payload_size);
}}
"""
_SHOWN = """
static void show_{prefix}(enum {name}_message message) {{
    struct {prefix}_event event;
    tell((uint64_t)message);
    if (message != {upper}_NO_MESSAGE) {{
        {prefix}_decoder_event(&{prefix}, message, &event);
        tell_payload(event.payload, event.payload_size);
    }}
}}
"""
_TRIED = """
/* At one place, as a state has addresses in it. */
static struct {prefix}_decoder {prefix};
{shown}
static struct {prefix}_decoder after_{prefix}(struct {prefix}_decoder state, int byte) {{
    {prefix} = state;
    if (byte < 256) {{
        {push}
    }} else if (byte == 256) {{
        {flush}
    }} else {{
        {next}
    }}
    memset(&{prefix}.buffer[{prefix}.count], 0, sizeof {prefix}.buffer - {prefix}.count);
{translate}    return {prefix};
}}

static int try_{prefix}(void) {{
    struct {prefix}_decoder (*pairs)[2] = malloc({most} * sizeof *pairs);
    size_t count = 0;
    size_t done = 0;
    memset(&{prefix}, 0, sizeof {prefix});
{given}    pairs[0][0] = {prefix};
    memset(&{prefix}, 0, sizeof {prefix});
    {prefix}_decoder_init(&{prefix}{handler});
    pairs[0][1] = {prefix};
    count += memcmp(&pairs[0][0], &pairs[0][1], sizeof pairs[0][0]) != 0;
    for (; done < count; done++) {{
        for (int byte = 0; byte <= 257; byte++) {{
            struct {prefix}_decoder one, other;
            size_t known = 0;
            unsigned long before;
            told = 0;
            one = after_{prefix}(pairs[done][0], byte);
            before = told;
            told = 0;
            other = after_{prefix}(pairs[done][1], byte);
            if (told != before) {{
                (void)puts("{prefix}: another event");
                return 1;
            }}
            if (memcmp(&one, &other, sizeof one) == 0) {{
                continue;
            }}
            while (known < count && (memcmp(&pairs[known][0], &one, sizeof one) != 0 ||
                                     memcmp(&pairs[known][1], &other, sizeof other) != 0)) {{
                known++;
            }}
            if (known == count) {{
                if (count == {most}) {{
                    (void)puts("{prefix}: too many states");
                    return 1;
                }}
                pairs[count][0] = one;
                pairs[count][1] = other;
                count++;
            }}
        }}
    }}
    free(pairs);
    return 0;
}}
"""
_COUNT = re.compile(r"^struct (\w+)_decoder \{(?:(?!\};).*\n)*? +uint\d+_t count;", re.MULTILINE)
_FORGET = re.compile(r"^    memset\(&\w+\.buffer\[.*\n", re.MULTILINE)
"""Behind what a decoder has in its buffer it reads nothing, as EVA shows."""
_END = re.compile(r"_decoder_init\([^{;]*\{\n(?:    .*\n)*?    \w+_reset\(decoder\);\n")
_MOST = 5000
"""More pairs of states than are looked at."""


TOLD = sorted((ROOT / "tests" / "told_schemas").glob("*.yaml"))
"""Of which something is told to a decoder."""


@pytest.mark.slow
@pytest.mark.parametrize("events", EVENTS)
def test_a_decoder_of_zeros_is_one_that_was_initialised(events: Events, tmp_path: Path) -> None:
    tried: dict[str, str] = {}
    for path in (*SCHEMAS, *TOLD):
        tried |= _tried_of(generate(protocol_of(path), tmp_path, COptions(events=events)))
    assert len(tried) > len(SCHEMAS) + len(TOLD)
    assert _printed(tried, tmp_path) == ""


@pytest.mark.parametrize("other", ["noise = 2", "offset = 1", "state = 1"])
@pytest.mark.parametrize("name", ["dagny", "forms"])
def test_an_init_that_leaves_other_things_to_come_is_found(
    name: str, other: str, tmp_path: Path
) -> None:
    [path] = [path for path in SCHEMAS if path.stem == name]
    made = generate(protocol_of(path), tmp_path)
    assert made.source is not None
    before = made.source.read_text(encoding="utf-8")
    after = _END.sub(rf"\g<0>    decoder->{other};\n", before)
    assert after != before
    made.source.write_text(after, encoding="utf-8")
    assert "another event" in _printed(_tried_of(made), tmp_path)


def _tried_of(made: Generated) -> dict[str, str]:
    """What tries each decoder of a protocol."""
    header = made.header.read_text(encoding="utf-8")
    counting = _COUNT.findall(header)
    tried = {}
    for prefix, handler in _INIT.findall(header):
        text = _tried(made.protocol.name, prefix, has_handler=bool(handler))
        tried[prefix] = text if prefix in counting else _FORGET.sub("", text)
    return tried


def _tried(name: str, prefix: str, *, has_handler: bool) -> str:
    push = f"{prefix}_decoder_push(&{prefix}, (uint8_t)byte)"
    flush = f"{prefix}_decoder_flush(&{prefix})"
    given = {"prefix": prefix, "most": _MOST}
    if has_handler:
        return f"{_HANDLER}{_TRIED}".format(
            push=f"{push};",
            flush=f"{flush};",
            next="/* Nothing is left to come. */",
            shown="",
            given=f"    {prefix}.handler = handle_{prefix};\n",
            handler=f", handle_{prefix}, NULL",
            # Where the input is says nothing of what comes next, but how far it went is told.
            translate=f"    tell({prefix}.offset);\n    {prefix}.offset = 0;\n",
            **given,
        )
    return _TRIED.format(
        push=f"show_{prefix}({push});",
        flush=f"show_{prefix}({flush});",
        next=f"show_{prefix}({prefix}_decoder_next(&{prefix}));",
        shown=_SHOWN.format(prefix=prefix, name=name, upper=name.upper()),
        given="",
        handler="",
        translate="",
        **given,
    )


def _printed(tried: dict[str, str], folder: Path) -> str:
    """What a program says that tries the decoders."""
    headers = "".join(f'#include "{path.name}"\n' for path in sorted(folder.glob("*.h")))
    calls = "".join(f"    (void)try_{prefix}();\n" for prefix in tried)
    text = f"{headers}{_HEAD}{''.join(tried.values())}\nint main(void) {{\n{calls}}}\n"
    (folder / "main.c").write_text(text, encoding="utf-8")
    sources = [path.name for path in sorted(folder.glob("*.c"))]
    command = [require_tool("gcc"), "-std=c99", "-O1", *sources, "-o", "main"]
    subprocess.run(command, check=True, cwd=folder)
    return subprocess.run([folder / "main"], capture_output=True, text=True, check=True).stdout
