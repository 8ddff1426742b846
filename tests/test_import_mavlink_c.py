"""C of imported definitions of MAVLink beside the C that mavgen makes of the same definitions.

One program has both. It gets frames, which Python made. Each side reads each frame, its fields are
handed to the other side, and that has to make the same frame of them.
"""

from __future__ import annotations

import subprocess
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import pytest
from c_library import FLAGS, write_sources
from library_support import peer_module
from mavlink_support import KEY, LINK, TIME, Mavgen, definitions, drawn, engine_of, protocol_of
from tooling import require_tool

from protogen.fuzzing.trips import Case
from protogen.model.messages import Message

HEAD = """
#include <stdio.h>
#include <string.h>
#include "{dialect}/mavlink.h"
#include "ours.h"

static uint8_t frame[300];
static size_t frame_size;
static int wrong;
static int delivered;

static void check(const uint8_t *bytes, size_t size, const char *who) {{
    if (size != frame_size || memcmp(bytes, frame, size) != 0) {{
        wrong++;
        printf("%s makes another frame of message %u\\n", who,
               frame[7] | frame[8] << 8 | frame[9] << 16);
    }}
}}

static uint64_t number(const uint8_t *bytes, int count, int is_big) {{
    uint64_t found = 0;
    for (int i = 0; i < count; i++)
        found = found << 8 | bytes[is_big ? i : count - 1 - i];
    return found;
}}

#define COPY(to, from) do {{ \\
    _Static_assert(sizeof(to) == sizeof(from), "another size"); \\
    memcpy(&(to), &(from), sizeof(to)); \\
}} while (0)
"""
OURS = """
static void ours_{name}(const mavlink_message_t *m) {{
    mavlink_{theirs}_t theirs;
    struct {protocol}_{name} ours;
    uint8_t made[300];
    size_t size;
    memset(&ours, 0, sizeof ours);
    mavlink_msg_{theirs}_decode(m, &theirs);
    {to_ours}
    if (m->incompat_flags == 0)
        size = {protocol}_{name}_frame_from_component_unsigned(
            &ours, m->compat_flags, m->seq, m->sysid, m->compid, made, sizeof made);
    else
        size = {protocol}_{name}_frame_from_component_signed(
            &ours, m->compat_flags, m->seq, m->sysid, m->compid, m->signature[0],
            number(m->signature + 1, 6, 0), number(m->signature + 7, 6, 1), made, sizeof made);
    check(made, size, "protogen");
}}

static void theirs_{name}(const uint8_t *payload, size_t size, const uint8_t sender[3]) {{
    mavlink_{theirs}_t theirs;
    struct {protocol}_{name} ours;
    mavlink_message_t m;
    uint8_t made[300];
    memset(&theirs, 0, sizeof theirs);
    if ({protocol}_{name}_decode(&ours, payload, size) != {upper}_OK)
        wrong++;
    {to_theirs}
    mavlink_get_channel_status(MAVLINK_COMM_0)->current_tx_seq = sender[0];
    mavlink_msg_{theirs}_encode(sender[1], sender[2], &m, &theirs);
    check(made, mavlink_msg_to_send_buffer(made, &m), "mavgen");
}}
"""
HANDLER = """
static void {form}(void *user, const struct {protocol}_component_{form}_event *event) {{
    (void)user;
    if (event->kind != {upper}_MESSAGE)
        return;
    delivered++;
    const uint8_t sender[3] = {{event->parts.seq, event->parts.sysid, event->parts.compid}};
    switch (event->message) {{
{cases}
    default: wrong++;
    }}
}}
"""
MAIN = """
int main(void) {{
    static mavlink_signing_t signing;
    static struct {protocol}_component_unsigned_decoder plain;
    static struct {protocol}_component_signed_decoder other;
    int count = 0;
    signing.link_id = {link};
    for (int i = 0; i < 32; i++)
        signing.secret_key[i] = (uint8_t)i;
    {protocol}_component_unsigned_decoder_init(&plain, unsigned_, NULL);
    {protocol}_component_signed_decoder_init(&other, signed_, NULL);
    for (int low = getchar(); low != EOF; low = getchar()) {{
        mavlink_message_t m;
        mavlink_status_t status;
        int found = 0;
        frame_size = (size_t)(low | getchar() << 8);
        if (fread(frame, 1, frame_size, stdin) != frame_size)
            return 2;
        mavlink_status_t *channel = mavlink_get_channel_status(MAVLINK_COMM_0);
        channel->signing = NULL;
        for (size_t i = 0; i < frame_size; i++)
            found += mavlink_parse_char(MAVLINK_COMM_0, frame[i], &m, &status);
        if (found != 1)
            return 3;
        switch (m.msgid) {{
{cases}
        default: return 4;
        }}
        if (frame[2]) {{
            channel->signing = &signing;
            signing.flags = MAVLINK_SIGNING_FLAG_SIGN_OUTGOING;
            signing.timestamp = {time};
            {protocol}_component_signed_decoder_feed(&other, frame, frame_size);
        }} else {{
            {protocol}_component_unsigned_decoder_feed(&plain, frame, frame_size);
        }}
        if (++count != delivered)
            return 5;
    }}
    printf("%d frames, %d wrong\\n", count, wrong);
    return wrong != 0;
}}
"""


def generate_theirs(dialect: str, folder: Path) -> None:
    """Let mavgen make C of its definitions."""
    mavgen: Any = peer_module("pymavlink.generator.mavgen")
    options = mavgen.Opts(str(folder), wire_protocol="2.0", language="C", validate=False)
    with redirect_stdout(StringIO()):
        assert mavgen.mavgen(options, [str(definitions("2") / f"{dialect}.xml")])


def program(dialect: str, mavgen: Mavgen) -> str:
    """The source of the program."""
    protocol = protocol_of(dialect, "2")
    upper = protocol.name.upper()
    given = {"protocol": protocol.name, "upper": upper}
    parts = [HEAD.format(dialect=dialect)]
    parts += [OURS.format(**given, **names(message, mavgen)) for message in protocol.messages]
    received = "\n".join(
        f"    case {upper}_MESSAGE_{message.name.upper()}:"
        f" theirs_{message.name}(event->payload, event->payload_size, sender); break;"
        for message in protocol.messages
    )
    for form in ("unsigned", "signed"):
        handler = HANDLER.replace("void {form}(", "void {form}_(")
        parts.append(handler.format(**given, form=form, cases=received))
    parsed = "\n".join(
        f"        case {message.identity[0]}: ours_{message.name}(&m); break;"
        for message in protocol.messages
    )
    parts.append(MAIN.format(**given, link=LINK, time=TIME, cases=parsed))
    return "\n".join(parts)


def names(message: Message, mavgen: Mavgen) -> dict[str, str]:
    """The names of a message on both sides, and what copies its fields, which are in one order."""
    theirs = mavgen.kinds[message.title].ordered_fieldnames
    ours = [field.name for field in message.fields]
    pairs = list(zip(ours, theirs, strict=True))
    return {
        "name": message.name,
        "theirs": message.title.lower(),
        "to_ours": "\n    ".join(f"COPY(ours.{one}, theirs.{other});" for one, other in pairs),
        "to_theirs": "\n    ".join(f"COPY(theirs.{other}, ours.{one});" for one, other in pairs),
    }


def frames(dialect: str, mavgen: Mavgen) -> list[bytes]:
    """Frames of boundary and random values, signed and unsigned."""
    engine = engine_of(dialect, "2")
    made: list[bytes] = []
    for title, case in drawn(dialect, "2", 3):
        # Its C does not let a caller choose the version.
        values = {**case.values, **({"mavlink_version": 3} if title == "HEARTBEAT" else {})}
        parts = dict(case.parts)
        if "signature" in parts:
            signed = mavgen.frame(title, Case(case.sender, case.message, values, parts))
            parts["signature"] = int.from_bytes(signed[-6:], "big")
        made.append(engine.frame(case.sender, case.message, values, parts))
    return made


@pytest.mark.parametrize("dialect", ["minimal", "common"])
def test_each_reads_and_makes_the_frames_of_the_other(dialect: str, tmp_path: Path) -> None:
    assert bytes(range(32)) == KEY
    compiler = require_tool("cc")
    mavgen = Mavgen(dialect, "2")
    generate_theirs(dialect, tmp_path / "mavgen")
    (tmp_path / "protogen").mkdir()
    name = write_sources(protocol_of(dialect, "2"), tmp_path / "protogen")
    # Both sides have a header of the dialect's name.
    (tmp_path / "ours.h").write_text(f'#include "protogen/{name}.h"\n')
    (tmp_path / "main.c").write_text(program(dialect, mavgen))
    command = [compiler, "-std=gnu11", "-O1", "-w", "-I", ".", "-I", "mavgen", "-o", "main"]
    sources = ["main.c", f"protogen/{name}.c"]
    flags = [*FLAGS, "-c", sources[1], "-o", "ours.o"]
    subprocess.run([compiler, *flags], cwd=tmp_path, check=True, capture_output=True)
    subprocess.run([*command, *sources], cwd=tmp_path, check=True, capture_output=True)
    made = frames(dialect, mavgen)
    data = b"".join(len(frame).to_bytes(2, "little") + frame for frame in made)
    done = subprocess.run([str(tmp_path / "main")], input=data, capture_output=True, check=False)
    assert done.returncode == 0, (done.returncode, done.stdout[-500:])
    assert done.stdout.decode() == f"{len(made)} frames, 0 wrong\n"
