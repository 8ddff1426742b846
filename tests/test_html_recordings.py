"""Recordings on the bench of a page: what they count is what Python counts, whatever they are."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import zip_longest
from pathlib import Path
from random import Random
from typing import Any

import pytest
from browser_pages import Opened, chromium, written

from protogen.cli.wire.codec import Codec, open_codec
from protogen.fuzzing.python_engine import PythonEngine

ROOT = Path(__file__).parents[1]
PORTION = 1 << 17
"""Bytes of a file that the page reads at once."""


@pytest.fixture(scope="module")
def codecs() -> dict[str, Codec]:
    return {name: open_codec(ROOT / "schemas" / f"{name}.yaml") for name in ("matty", "rn1")}


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as found:
        yield found


@pytest.fixture(scope="module")
def folder(codecs, tmp_path_factory) -> Path:
    protocols = [codec.protocol for codec in codecs.values()]
    return written(protocols, tmp_path_factory.mktemp("pages"))


@pytest.fixture
def opened(request, browser, folder) -> Iterator[Opened]:
    name = getattr(request, "param", "matty")
    with Opened(browser, folder / f"{name}.html") as found:
        found.page.click("#tab-file")
        yield found
        assert found.complaints == []


def recording(codec: Codec, sender: str, size: int) -> bytes:
    """Frames of examples in any order, some with a bit turned over, and noise."""
    random = Random(size)
    frames = [
        item.bytes
        for message in codec.protocol.messages
        for item in message.examples
        if item.sender == sender and item.covers is None
    ]
    found = bytearray()
    while len(found) < size:
        frame = bytearray(random.choice(frames))
        if random.random() < 0.03:
            frame[random.randrange(len(frame))] ^= 1 << random.randrange(8)
        found += frame
        if random.random() < 0.01:
            found += random.randbytes(3)
    return bytes(found)


Counts = tuple[dict[str, tuple[int, int]], int, int]
"""Of each message how many and their bytes; the spans that are no frame, and their bytes."""


def counted(codec: Codec, streams: dict[str, bytes]) -> Counts:
    """What Python counts in what each endpoint sent."""
    counts: dict[str, tuple[int, int]] = {}
    invalid = lost = 0
    for sender, data in streams.items():
        decoder = codec.decoder(sender, None)
        for event in (*decoder.feed(data), *decoder.flush()):
            if event.kind == "invalid":
                invalid, lost = invalid + 1, lost + len(event.raw)
                continue
            name = event.message.NAME if event.kind == "message" else "unknown"
            count, size = counts.get(name, (0, 0))
            counts[name] = (count + 1, size + len(event.raw))
    return counts, invalid, lost


def read(opened: Opened, text: bytes | str, sender: str = "esp") -> str:
    """Let the page read a file to its end; what it says then."""
    data = text.encode() if isinstance(text, str) else text
    opened.page.select_option("#file-sender", sender)
    opened.page.set_input_files(
        "#chosen", {"name": "a", "mimeType": "application/octet-stream", "buffer": data}
    )
    opened.page.wait_for_selector("#summary table")
    return str(opened.page.inner_text("#progress"))


def shown(opened: Opened) -> Counts:
    """What the page counts."""
    rows = opened.run(
        "[...document.querySelector('#summary table').tBodies[0].rows]"
        ".map((row) => [...row.cells].map((cell) => cell.textContent))"
    )
    head = opened.run("document.querySelector('#summary h3 ~ h3').textContent")
    _, spans, _, lost, _ = head.split()
    return {name: (int(count), int(size)) for name, count, size, *_ in rows}, int(spans), int(lost)


def split(data: bytes, width: int) -> list[bytes]:
    return [data[at : at + width] for at in range(0, len(data), width)]


def lines(data: bytes, width: int, shape: Callable[[int, bytes], str]) -> str:
    return "\n".join(shape(index, part) for index, part in enumerate(split(data, width)))


def printable(part: bytes) -> str:
    return "".join(chr(byte) if 0x20 <= byte < 0x7F else "." for byte in part)


def escapes(data: bytes) -> str:
    return "".join(f"\\x{byte:02x}" for byte in data)


DRESSES: dict[str, Callable[[bytes], bytes | str]] = {
    "a raw recording": lambda data: data,
    "hex": lambda data: lines(data, 23, lambda _, part: part.hex(" ")),
    "hex in one line": lambda data: data.hex(),
    "hex with prefixes": escapes,
    "hex with remarks": lambda data: lines(data, 9, lambda at, part: f"0x{part.hex()} # {at}, 55"),
    "a text of a program": lambda data: f'b"{escapes(data)}";\n',
    "an array": lambda data: (
        "/* {1, 2} */ unsigned char a[] = {\n"
        + ",\n".join(", ".join(f"0x{byte:02x}" for byte in part) for part in split(data, 12))
        + f"\n}};\nunsigned int a_len = {len(data)};\n"
    ),
    "an array in decimals": lambda data: f"[{', '.join(map(str, data))}]",
    "a dump": lambda data: lines(
        data, 16, lambda at, part: f"{16 * at:08x}: {part.hex(' ', -2):39}  {printable(part)}"
    ),
    "a dump with bars": lambda data: (
        lines(
            data,
            16,
            lambda at, part: f"{16 * at:08x}  {part.hex(' '):47}  |{printable(part)}|",
        )
        + f"\n{len(data):08x}\n"
    ),
    "a log": lambda data: lines(
        data, 8, lambda at, part: f"({1700000000 + at / 1000:.6f}) can0 123#{part.hex().upper()}"
    ),
    "a log of candump": lambda data: lines(
        data, 8, lambda _, part: f"  can0  123   [{len(part)}]  {part.hex(' ').upper()}"
    ),
    "a log with names": lambda data: lines(
        data, 20, lambda at, part: f"12:00:{at // 1000 % 60:02}.{at % 1000:03} esp: {part.hex(' ')}"
    ),
    "an export of a logic analyser": lambda data: (
        "Time [s],Value,Parity Error,Framing Error\n"
        + lines(data, 1, lambda at, part: f"{at / 1e5:.5f},0x{part.hex()},,")
    ),
    "an export of sigrok": lambda data: lines(data, 1, lambda _, part: f"uart-1: {part.hex()}"),
}


@pytest.mark.parametrize("dress", DRESSES)
def test_counts_are_those_of_python(opened, codecs, dress):
    """All texts are longer than a portion, which ends anywhere in a line."""
    data = recording(codecs["matty"], "esp", 90_000)
    said = read(opened, DRESSES[dress](data))
    assert said.startswith(f"{len(data)} bytes of {dress.split(' in ')[0].split(' with ')[0]}"), (
        said
    )
    assert "left out" not in said
    assert shown(opened) == counted(codecs["matty"], {"esp": data})


@pytest.mark.parametrize("word", ["TX", "pc"])
def test_two_directions_are_two_streams(opened, codecs, word):
    """The other direction comes behind the first bytes, by which the form is known."""
    sent, got = (recording(codecs["matty"], sender, 30_000) for sender in ("pc", "esp"))
    other = {"TX": "RX", "pc": "esp"}[word]
    early, late = got[:26_000], got[26_000:]
    log = [
        f"12:00:00.{index % 1000:03} {other}: {it.hex(' ')}"
        for index, it in enumerate(split(early, 9))
    ]
    assert len("\n".join(log)) > 1 << 16
    for one, two in zip_longest(split(late, 2), split(sent, 12), fillvalue=b""):
        both = ((other, one), (word, two))
        log += [f"12:00:01.1 {name}: {part.hex(' ')}" for name, part in both if part]
    read(opened, "\n".join(log), "pc")
    assert shown(opened) == counted(codecs["matty"], {"pc": sent, "esp": got})


def test_a_log_of_one_direction_is_what_the_side_chosen_sent(opened, codecs):
    data = recording(codecs["matty"], "esp", 2000)
    read(opened, lines(data, 9, lambda _, part: f"12:00:00.1 TX: {part.hex(' ')}"))
    assert shown(opened) == counted(codecs["matty"], {"esp": data})


def test_what_is_no_hex_after_all_is_read_as_it_is(opened, codecs):
    text = b"55 02 01 41 BC\n" * 10_000 + b"55 02 0G\n"
    said = read(opened, text)
    problem = "line 10001, column 8: `G` is no hex digit and no separator"
    assert said == f"{len(text)} bytes of a raw recording (as text, {problem}), decoded"
    assert shown(opened) == counted(codecs["matty"], {"esp": text})


def test_lines_that_are_left_out_are_told(opened):
    good = ["12:00:00.1 esp 55 02 01 41 BC"] * 5
    said = read(opened, "\n".join([*good, "what is this", *good, "and this?"]))
    assert said == (
        "50 bytes of a log, decoded. 2 lines are left out. line 6 is left out: what is this. "
        "line 12 is left out: and this?"
    )


def test_reading_can_be_cancelled(opened, codecs):
    """The counts are those of what was read; another file is read as if nothing had been."""
    data = recording(codecs["matty"], "esp", 5 * PORTION)
    opened.run(
        """() => new MutationObserver((_, observer) => {
            if (!/^[1-9]\\d %/.test(document.querySelector("#progress").textContent)) return;
            observer.disconnect();
            document.querySelector("#cancel").click();
        }).observe(document.querySelector("#progress"), { childList: true })"""
    )
    said = read(opened, data)
    assert said == f"{2 * PORTION} bytes of a raw recording, decoded, then cancelled"
    assert opened.page.is_hidden("#cancel")
    decoder = codecs["matty"].decoder("esp", None)
    events = decoder.feed(data[: 2 * PORTION])
    frames = sum(event.kind == "message" for event in events)
    assert sum(count for count, _ in shown(opened)[0].values()) == frames
    opened.run("document.querySelector('#summary').replaceChildren()")
    assert read(opened, data) == f"{len(data)} bytes of a raw recording, decoded"
    assert shown(opened) == counted(codecs["matty"], {"esp": data})


def test_the_page_goes_on_in_between(opened, codecs):
    """What is due by a timer runs at least once in each two portions."""
    data = recording(codecs["matty"], "esp", PORTION) * 6
    opened.run(
        """() => {
            const { port1, port2 } = new MessageChannel();
            globalThis.turns = 0;
            port1.onmessage = () => {
                turns += /%/.test(document.querySelector("#progress").textContent);
                setTimeout(() => port2.postMessage(0));
            };
            port2.postMessage(0);
        }"""
    )
    read(opened, data)
    assert opened.run("turns") >= 3


@pytest.mark.parametrize("opened", ["rn1"], indirect=True)
def test_of_many_values_the_least_and_the_greatest_are_plotted(opened, codecs):
    """40,000 values are more than are kept one by one; `int_x` is 14 bits with a sign."""
    engine = PythonEngine(codecs["rn1"].runtime)
    frames = {
        value: engine.frame(
            "brain", "gyro", {"status": 1, "int_x": value, "int_y": 0, "int_z": 0}, {}
        )
        for value in (0, 1, 8_000, -8_191)
    }
    values = [index % 2 for index in range(40_000)]
    values[12_345], values[33_333] = 8_000, -8_191
    read(opened, b"".join(frames[value] for value in values), "brain")
    opened.page.select_option("#summary select", label="gyro.int_x")
    opened.page.wait_for_function(
        "() => document.querySelector('canvas').ariaLabel.includes('values')"
    )
    said = opened.page.get_attribute("canvas", "aria-label")
    assert said.startswith("gyro.int_x: 40000 values from -8191 to 8000")


def test_times_are_those_of_the_last_bytes(opened):
    """Three frames in four seconds; the second is cut by a line."""
    rows = [(0, "55 02 01 41 BC 55 02"), (3, "01 41 BC"), (4, "55 02 01 41 BC")]
    read(opened, "\n".join(f"({1700000000 + time}.0) {text}" for time, text in rows))
    cells = opened.page.locator("#summary td").all_inner_texts()
    assert cells[:4] == ["ack", "3", "15", "0.7500"]
