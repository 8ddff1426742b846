"""What the bench makes of pasted texts, of pointing at bits, and of links."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

import pytest
from browser_pages import Opened, address_of, chromium, written

from protogen.compiler import compile_file

SCHEMAS = Path(__file__).parents[1] / "schemas"
ACK = "55 02 01 41 BC"
"""ack of command 1, from esp."""
STOP = "55 02 01 53 AA"
"""stop with counter 1, from pc: 02 + 01 + 53 + AA are 100 hex."""


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as found:
        yield found


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    protocol = compile_file(SCHEMAS / "matty.yaml").protocol
    assert protocol is not None
    return written([protocol], tmp_path_factory.mktemp("pages"))


@pytest.fixture(scope="module")
def page(browser, folder) -> Iterator[Any]:
    with Opened(browser, folder / "matty.html") as opened:
        yield opened.page
        assert opened.complaints == []


def titles(page: Any, text: str, sender: str, count: int) -> list[str]:
    """The titles of the events of a text that is pasted."""
    page.fill("#bytes", "")
    page.wait_for_selector("#events article", state="detached")
    page.select_option("#sender", sender)
    page.fill("#bytes", text)
    page.wait_for_function(
        "count => document.querySelectorAll('#events article').length === count", arg=count
    )
    found: list[str] = page.locator("#events h3").all_inner_texts()
    return [title.split(" bytes from ")[-1] for title in found]


@pytest.mark.parametrize(
    "text",
    [
        "00000000: 5502 0141 bc55 0201 41bc                 U..A.U..A.",
        "00000000: 5502 0141 bc55  ab cd\n00000006: 0201 41bc  AB",
        "00000000  55 02 01 41 bc 55 02 01  41 bc           |U..A.U..A.|\n0000000a\n",
        f"{ACK}\n{ACK}",
        f"const uint8_t a[] = {{{', '.join(f'0x{item}' for item in (ACK + ' ' + ACK).split())}}};",
    ],
)
def test_dumps_of_bytes(page, text):
    assert titles(page, text, "esp", 2) == ["esp: message ack"] * 2


def test_what_was_sent_and_received_are_two_streams(page):
    """TX is the side that was chosen. Each frame is cut by a line of the other direction."""
    sent, got = STOP.split(), ACK.split()
    lines = [
        f"12:00:00.1 TX: {' '.join(sent[:2])}",
        f"12:00:00.2 RX: {' '.join(got[:3])}",
        f"12:00:00.3 TX: {' '.join(sent[2:])}",
        f"12:00:00.4 RX: {' '.join(got[3:])}",
    ]
    assert titles(page, "\n".join(lines), "pc", 2) == ["pc: message stop", "esp: message ack"]


def test_directions_of_sigrok(page):
    sent, got = STOP.split(), ACK.split()
    lines = [
        f"uart-1: {word} data: {byte}"
        for pair in zip(sent, got, strict=True)
        for word, byte in zip(("TX", "RX"), pair, strict=True)
    ]
    assert titles(page, "\n".join(lines), "pc", 2) == ["pc: message stop", "esp: message ack"]


def test_a_byte_lights_up_its_row_with_all_of_its_bits(page):
    """The flags of status are rows inside of its byte."""
    text = "55 14 10 49 01 02 5C 1C 78 00 00 00 00 00 65 00 17 00 DD 05 EA 00 56 AA"
    titles(page, text, "esp", 1)
    page.hover("#events .run >> nth=6")
    assert page.locator("#events tr.lit").count() == 1
    inside = page.locator("#events tbody tr[data-inside]")
    page.hover("#events .run >> nth=4")
    assert page.locator("#events tr.lit").count() == 1 + inside.count()


def test_a_link_keeps_the_lines_of_a_log(browser, folder):
    log = f"12:00:00.1 esp {ACK}\n12:00:00.2 pc {STOP}"
    with Opened(browser, folder / "matty.html") as opened:
        opened.page.fill("#bytes", log)
        opened.page.wait_for_selector("#events article >> nth=1")
        url = address_of(opened.page)
    assert url.endswith("#" + urlencode({"d": "any", "hex": log}))
    with Opened(browser, folder / "matty.html") as opened:
        opened.page.goto(url)
        opened.page.reload()
        assert opened.page.input_value("#bytes") == log
        assert opened.page.locator("#events article").count() == 2
