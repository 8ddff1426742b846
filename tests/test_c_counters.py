"""Counters of what came of a line, held against the events of Python's decoder."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from random import Random
from tempfile import mkdtemp

import pytest
from c_library import FLAGS, write_sources
from compiled import DOCUMENTS, ROOT, covering, module_at, name_of, protocol_of
from corpus import known_frames, material_of, stream_of
from tooling import require_tool

from protogen.targets.c.emit import emit, texts, unit_of
from protogen.targets.c.options import COptions

DECODERS = [
    (ROOT / "schemas" / "matty.yaml", "esp"),
    (ROOT / "schemas" / "rflex.yaml", "flex"),
    *(
        (ROOT / "tests" / "framings" / f"{name}.yaml", "station")
        for name in ("cobs", "hdlc", "trimmed_forms")
    ),
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


# --- decoders that are polled ---------------------------------------------------------------------

MESSAGES = COptions(events="messages")
POLLED = """
static void run_{prefix}(const uint8_t *data, size_t size, size_t piece) {{
    static struct {prefix}_decoder decoder;
    const struct {name}_counters *const counters = {prefix}_decoder_counters(&decoder);
    {prefix}_decoder_init(&decoder);
    for (size_t at = 0; at < size && piece == 0U; at++) {{
        enum {name}_message message = {prefix}_decoder_push(&decoder, data[at]);
        while (message != {upper}_NO_MESSAGE) {{
            message = {prefix}_decoder_next(&decoder);
        }}
    }}
    for (size_t at = 0; at < size && piece != 0U; at += piece) {{
        const size_t end = size - at < piece ? size : at + piece;
        struct {prefix}_event event;
        size_t from = at;
        do {{
            from += {prefix}_decoder_feed(&decoder, &data[from], end - from, &event);
        }} while (event.message != {upper}_NO_MESSAGE);
    }}
    if ({prefix}_decoder_flush(&decoder) != {upper}_NO_MESSAGE) {{
        while ({prefix}_decoder_next(&decoder) != {upper}_NO_MESSAGE) {{
        }}
    }}
    printf("%lu %lu %lu %lu", (unsigned long)counters->messages,
           (unsigned long)counters->checksums, (unsigned long)counters->lost,
           (unsigned long)counters->pending);
}}
"""
MAIN = """
int main(int count, char **arguments) {{
    static uint8_t data[1 << 20];
    const size_t size = fread(data, 1, sizeof data, stdin);
    const size_t piece = (size_t)atoi(arguments[2]);
    (void)count;
    switch (atoi(arguments[1])) {{
{cases}
    default:
        return 1;
    }}
    return 0;
}}
"""


@dataclass(frozen=True)
class Counts:
    """What a decoder that is polled counted, or should have."""

    messages: int
    checksums: int
    lost: int
    pending: int = 0


def source_of(path: Path, folder: Path, options: COptions = MESSAGES) -> str:
    """Writes header and source; returns their name."""
    header, source = texts(protocol_of(path), options)
    name = unit_of(protocol_of(path), options).module.file
    (folder / f"{name}.h").write_text(header, encoding="utf-8")
    (folder / f"{name}.c").write_text(source, encoding="utf-8")
    return name


def prefixes_of(path: Path) -> dict[str, str]:
    """Prefixes of the decoders, by their sender, or the endpoint of several forms."""
    framing = unit_of(protocol_of(path), MESSAGES).framing
    return {item.name: item.prefix for item in (*framing.decoders, *framing.together)}


@cache
def program_of(path: Path) -> Path:
    """A program that counts what comes in, for each decoder of a schema."""
    folder = Path(mkdtemp(prefix="counters"))
    file = source_of(path, folder)
    name, prefixes = unit_of(protocol_of(path), MESSAGES).names.prefix, prefixes_of(path).values()
    cases = "\n".join(
        f"    case {number}:\n        run_{prefix}(data, size, piece);\n        break;"
        for number, prefix in enumerate(prefixes)
    )
    functions = (POLLED.format(prefix=it, name=name, upper=name.upper()) for it in prefixes)
    text = f'#include "{file}.h"\n#include <stdio.h>\n#include <stdlib.h>\n{"".join(functions)}'
    (folder / "main.c").write_text(text + MAIN.format(cases=cases), encoding="utf-8")
    sources = ["main.c", f"{file}.c", "-o", "main"]
    define = f"-D{name.upper()}_COUNTERS"
    run([require_tool("cc"), *FLAGS, "-O1", define, *sources], folder)
    return folder / "main"


def run(command: list[str], folder: Path) -> None:
    """Run a compiler that must find nothing to say."""
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def counted(path: Path, decoder: str, data: bytes, piece: int) -> Counts:
    """What the decoder of C counts, in pieces for `feed`; by `push` where these have no size."""
    number = list(prefixes_of(path)).index(decoder)
    command = [program_of(path), str(number), str(piece)]
    ran = subprocess.run(command, input=data, capture_output=True, check=False)
    assert ran.returncode == 0, ran.stderr.decode()
    return Counts(*map(int, ran.stdout.split()))


def expected(path: Path, decoder: str, data: bytes) -> Counts:
    """What the events of Python come to: frames of no message are lost bytes."""
    cutter = module_at(path).Decoder(decoder)
    events = [*cutter.feed(data), *cutter.flush()]
    messages = [event for event in events if event.kind == "message"]
    wrong = [event for event in events if event.kind == "invalid" and event.reason == "checksum"]
    lost = len(data) - sum(event.size for event in messages)
    return Counts(len(messages), len(wrong), lost)


SAMPLERS = [ROOT / "tests" / "c_schemas" / f"{it}.yaml" for it in ("mirrors", "part_bits")]
CASES = [
    (path, decoder) for path in [*sorted(covering()), *SAMPLERS] for decoder in prefixes_of(path)
]
PIECES = (0, 7, 1 << 20)
"""By `push`, and by `feed` in pieces and as a whole."""


def senders_of(path: Path, decoder: str) -> Iterator[str]:
    """The senders whose frames a decoder takes, one for each form."""
    for sender in protocol_of(path).senders:
        if decoder in (sender.name, sender.endpoint):
            yield sender.name


@pytest.mark.parametrize(("path", "decoder"), CASES, ids=name_of)
def test_polled_decoders_count_what_python_finds(path: Path, decoder: str) -> None:
    for sender in senders_of(path, decoder):
        data = stream_of(material_of(path, sender), Random(f"{path.stem} {sender}"), 200).data
        due = expected(path, decoder, data)
        for piece in PIECES:
            found = counted(path, decoder, data, piece)
            assert (found.messages, found.lost, found.pending) == (due.messages, due.lost, 0)
            if path in DOCUMENTS:
                assert found.checksums == due.checksums
            else:
                # What is longer than any message is given up before its checksum.
                assert found.checksums <= due.checksums


ALIKE = """
protocol: alike
endpoints: {host: Host}
byte_order: little
frame:
  start: {literal: 0x7E}
  length: {type: uint8, counts: payload}
  id: {type: uint8, id: true}
  payload: {}
  sum: {type: uint8, algorithm: sum-8, covers: length..payload}
transparency: {covers: length..sum, escape: {byte: 0x7D, of: [0x7D, 0x7E], transform: {xor: 0x20}}}
messages:
  go: {id: 0x7D, from: host, fields: {x: uint8, y: uint16}}
  turn: {id: 0x41, from: host, fields: {x: uint8, y: uint16}}
"""
TELLING = b"\x7e\x7d\x5d\x5e\x41\x03\x80\xff"


def alike_stream(dice: Random) -> tuple[bytes, int]:
    """Frames as the schema says, worked out here, between cut ones and noise, and their number."""
    data, whole = bytearray(), 0
    for _ in range(60):
        body = bytes([3, dice.choice((0x7D, 0x41)), *dice.choices(TELLING, k=3)])
        frame = bytearray(b"\x7e")
        for byte in (*body, sum(body) & 0xFF):
            frame += bytes([0x7D, byte ^ 0x20]) if byte in b"\x7d\x7e" else bytes([byte])
        match dice.randrange(4):
            case 0:
                data += frame[: dice.randrange(1, len(frame))]
            case 1:
                data += bytes(dice.choices(TELLING, k=dice.randrange(1, 9)))
                data += b"\x7e\x7d\x00"  # Closes what the noise began, and is none itself.
            case _:
                data += frame
                whole += 1
    return bytes(data), whole


@pytest.mark.parametrize("seed", range(12))
def test_frames_of_one_size_are_counted_behind_escapes(seed: int, tmp_path: Path) -> None:
    """In streams of the bytes that mean something to a receiver."""
    path = tmp_path / "alike.yaml"
    path.write_text(ALIKE, encoding="utf-8")
    data, whole = alike_stream(Random(f"alike {seed}"))
    due = expected(path, "host", data)
    assert due.messages >= whole > 10
    for piece in (0, 1, 5, len(data)):
        found = counted(path, "host", data, piece)
        assert (found.messages, found.lost, found.pending) == (due.messages, due.lost, 0)
        assert found.checksums == due.checksums


COMMANDS = """
protocol: commands
endpoints: {host: Host}
byte_order: little
frame:
  id: {type: uint8, id: true}
  payload: {}
  sum: {type: uint8, algorithm: xor-8, covers: id..payload}
  end: {literal: 0x0A, unprotected: end}
decisions:
  end: {question: One inside?, document: No., choice: The size tells., because: Nothing else.}
messages:
  go: {id: 1, from: host, fields: {x: uint8}}
  turn: {id: 2, from: host, fields: {x: uint8}}
"""


def test_no_checksum_is_wrong_of_a_small_frame_with_an_unknown_identity(tmp_path: Path) -> None:
    path = tmp_path / "commands.yaml"
    path.write_text(COMMANDS, encoding="utf-8")
    dice = Random(7)
    streams = [bytes.fromhex("00 0A 01 0A"), bytes.fromhex("01 05 05 0A 02 05 07 0A")]
    streams += [bytes(dice.choice(b"\x00\x01\x02\x03\x0a") for _ in range(9)) for _ in range(200)]
    for data in streams:
        due, found = expected(path, "host", data), counted(path, "host", data, 0)
        assert (found.messages, found.lost) == (due.messages, due.lost), data.hex(" ")
        assert found.checksums <= due.checksums, data.hex(" ")


def cut(path: Path, sender: str, data: bytes) -> list[tuple[str, int, str | None]]:
    """Kind, size and reason of each event of Python."""
    cutter = module_at(path).Decoder(sender)
    events = [*cutter.feed(data), *cutter.flush()]
    return [(it.kind, it.size, getattr(it, "reason", None)) for it in events]


def wrong_sums(path: Path, sender: str) -> Iterator[bytes]:
    """Frames of messages with a bit of a checksum changed, which nothing else is wrong with."""
    plan = protocol_of(path).sender(sender).plan
    dice, end = Random(f"{path.stem} {sender}"), len(plan.end_bytes)
    for frame in known_frames(path, protocol_of(path).sender(sender)):
        damaged = bytearray(frame)
        damaged[len(frame) - end - dice.randint(1, plan.tail_size)] ^= 1 << dice.randrange(8)
        events = cut(path, sender, frame + damaged + frame)
        kinds = [kind for kind, *_ in events]
        if kinds == ["message", "invalid", "message"] and events[1][2] == "checksum":
            yield bytes(damaged)


SUMMED = [
    (path, sender.name)
    for path in sorted(covering())
    for sender in protocol_of(path).senders
    if sender.plan.checksums and sender.plan.tail_size
]


@pytest.mark.parametrize(("path", "sender"), SUMMED, ids=name_of)
def test_each_frame_of_a_message_with_a_wrong_checksum_counts(path: Path, sender: str) -> None:
    wrong = list(wrong_sums(path, sender))
    right = next(known_frames(path, protocol_of(path).sender(sender)))
    data = right + b"".join(frame + right for frame in wrong)
    assert wrong or path not in DOCUMENTS
    for piece in PIECES:
        assert counted(path, sender, data, piece) == expected(path, sender, data)


# --- by hand --------------------------------------------------------------------------------------

MATTY = ROOT / "schemas" / "matty.yaml"
STEPS = [
    ("55 02 01 53 AA", Counts(1, 0, 0)),
    ("00 11", Counts(1, 0, 2)),  # No frame begins there.
    ("55 02", Counts(1, 0, 2, 2)),
    ("01 53 AB", Counts(1, 1, 7)),  # The sum would be AA.
    ("55 02 01 58 A5", Counts(1, 1, 12)),  # A valid frame of an unknown message.
    ("55 06 01 47 00 00 00 00 B2", Counts(1, 1, 21)),  # That of one which was left out.
    ("55 02 01 53 AA", Counts(2, 1, 21)),
]
"""Bytes for a decoder of matty's `stop` alone, and what it has counted behind them."""
BY_HAND = """
#include "matty.{suffix}"
#include <stdio.h>

static {decoder} decoder;

static void show(void) {{
    const struct matty_counters *const counters = {counters};
    printf("%lu %lu %lu %lu\\n", (unsigned long)counters->messages,
           (unsigned long)counters->checksums, (unsigned long)counters->lost,
           (unsigned long)counters->pending);
}}

int main() {{
    int byte;
    while ((byte = getchar()) != EOF) {{
        {push};
        show();
    }}
    return 0;
}}
"""
IN_C = {
    "suffix": "h",
    "decoder": "struct matty_pc_decoder",
    "counters": "matty_pc_decoder_counters(&decoder)",
    "push": "(void)matty_pc_decoder_push(&decoder, (uint8_t)byte)",
}
IN_CPP = {
    "suffix": "hpp",
    "decoder": "matty::pc_decoder",
    "counters": "&decoder.counters()",
    "push": "decoder.push(static_cast<uint8_t>(byte))",
}


@pytest.mark.parametrize(("compiler", "spelled"), [("cc", IN_C), ("g++", IN_CPP)])
def test_a_decoder_counts_byte_by_byte(
    compiler: str, spelled: dict[str, str], tmp_path: Path
) -> None:
    options = COptions(events="messages", only=("stop",), hpp=True)
    for file in emit([protocol_of(MATTY)], options):
        if file.path.suffix in (".h", ".c", ".hpp"):
            (tmp_path / file.path.name).write_text(file.text, encoding="utf-8")
    suffix = ".c" if compiler == "cc" else ".cc"
    (tmp_path / f"main{suffix}").write_text(BY_HAND.format(**spelled), encoding="utf-8")
    define = "-DMATTY_COUNTERS"
    run([require_tool("cc"), *FLAGS, define, "-c", "matty.c"], tmp_path)
    sources = [f"main{suffix}", "matty.o", "-o", "main"]
    run([require_tool(compiler), *FLAGS[1:], define, *sources], tmp_path)
    data = bytes.fromhex(" ".join(text for text, _ in STEPS))
    ran = subprocess.run([tmp_path / "main"], input=data, capture_output=True, check=True)
    lines, at = ran.stdout.splitlines(), 0
    for text, due in STEPS:
        at += len(bytes.fromhex(text))
        assert Counts(*map(int, lines[at - 1].split())) == due, text


# --- at no cost -----------------------------------------------------------------------------------

_COUNTING = re.compile(r"_counters\b|_(tally|lose|took)\(|WRONG_SUM|OTHER_FRAME|SUM_FAILED")


@pytest.mark.parametrize("path", sorted(covering()), ids=name_of)
def test_nothing_is_there_where_nobody_counts(path: Path, tmp_path: Path) -> None:
    file = source_of(path, tmp_path)
    command = [require_tool("cc"), "-std=c99", "-E", "-P", f"{file}.c"]
    text = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert not _COUNTING.search(text)


@pytest.mark.parametrize("path", sorted(covering()), ids=name_of)
def test_a_small_board_counts_without_a_warning(path: Path, tmp_path: Path) -> None:
    file = source_of(path, tmp_path)
    macro = f"-D{unit_of(protocol_of(path), MESSAGES).names.prefix.upper()}_COUNTERS"
    flags = ["-Os", "-mmcu=atmega328p", macro, "-c", f"{file}.c"]
    run([require_tool("avr-gcc"), *FLAGS, *flags], tmp_path)


SWITCH = """
#include "matty.h"
bool is_message(enum matty_message message);
bool is_message(enum matty_message message) {{
    switch (message) {{
{cases}
        return true;
    case MATTY_NO_MESSAGE:
        return false;
    }}
    return false;
}}
"""


@pytest.mark.parametrize("compiler", ["gcc", "clang", "g++"])
@pytest.mark.parametrize("define", [[], ["-DMATTY_COUNTERS"]], ids=["off", "on"])
def test_a_switch_over_all_messages_is_complete(
    compiler: str, define: list[str], tmp_path: Path
) -> None:
    """Counters add nothing to the messages that a user's `switch` has to name."""
    source_of(MATTY, tmp_path)
    messages = [it.constant for it in unit_of(protocol_of(MATTY), MESSAGES).module.messages]
    cases = "\n".join(f"    case {constant}:" for constant in messages)
    source = "main.cc" if compiler == "g++" else "main.c"
    (tmp_path / source).write_text(SWITCH.format(cases=cases), encoding="utf-8")
    run([require_tool(compiler), "-Wall", "-Wextra", *define, "-fsyntax-only", source], tmp_path)
