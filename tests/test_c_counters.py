"""Counters of what came of a line, held against the events of Python's decoder."""

from __future__ import annotations

import subprocess
from pathlib import Path
from random import Random

import pytest
from c_library import FLAGS, write_sources
from compiled import ROOT, module_at, protocol_of
from corpus import material_of, stream_of
from tooling import require_tool

FRAMINGS = ROOT / "tests" / "framings"
DECODERS = [
    (ROOT / "schemas" / "matty.yaml", "esp"),
    (ROOT / "schemas" / "rflex.yaml", "flex"),
    (FRAMINGS / "cobs.yaml", "station"),
    (FRAMINGS / "hdlc.yaml", "station"),
    (FRAMINGS / "trimmed_forms.yaml", "station"),
]
"""Escapes with a sum, substitution, COBS, HDLC, and a decoder of two forms."""
PROGRAM = """
#include "{file}.h"
#include <stdio.h>

static void take(void *user, const struct {prefix}_event *event) {{
    {prefix}_count((struct {name}_counters *)user, event);
}}

int main(void) {{
    static struct {prefix}_decoder decoder;
    struct {name}_counters counters = {{0, 0, 0, 0}};
    int byte;
    {prefix}_decoder_init(&decoder, take, &counters);
    while ((byte = getchar()) != EOF) {{
        {prefix}_decoder_push(&decoder, (uint8_t)byte);
    }}
    {prefix}_decoder_flush(&decoder);
    printf("%lu %lu %lu %lu", (unsigned long)counters.messages, (unsigned long)counters.unknown,
           (unsigned long)counters.checksums, (unsigned long)counters.lost);
    return 0;
}}
"""


@pytest.mark.parametrize(("path", "sender"), DECODERS, ids=lambda it: getattr(it, "stem", it))
def test_counters_are_those_of_the_events(path: Path, sender: str, tmp_path: Path) -> None:
    protocol = protocol_of(path)
    name = write_sources(protocol, tmp_path)
    given = {"file": name, "name": protocol.name, "prefix": f"{protocol.name}_{sender}"}
    (tmp_path / "main.c").write_text(PROGRAM.format(**given), encoding="utf-8")
    sources = ["main.c", f"{name}.c", "-o", "main"]
    command = [require_tool("cc"), *FLAGS, "-O1", *sources]
    built = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (built.returncode, built.stderr) == (0, "")

    dice = Random(path.stem)
    form = next(it.name for it in protocol.senders if it.endpoint == sender)
    data = stream_of(material_of(path, form), dice, 300).data
    ran = subprocess.run([tmp_path / "main"], input=data, capture_output=True, check=True)

    decoder = module_at(path).Decoder(sender)
    events = [*decoder.feed(data), *decoder.flush()]
    invalid = [event for event in events if event.kind == "invalid"]
    frames = [sum(event.kind == kind for event in events) for kind in ("message", "unknown")]
    lost = len(data) - sum(event.size for event in events if event.kind != "invalid")
    checksums = sum(event.reason == "checksum" for event in invalid)
    assert list(map(int, ran.stdout.split())) == [*frames, checksums, lost]
    assert frames[0] > 50
    assert checksums > 5
