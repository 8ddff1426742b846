"""Pages without a mouse: the whole bench by keys, and what axe-core says of each tab."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from browser_pages import SCHEMES, Opened, chromium, written
from cli_support import run

from protogen.compiler import compile_file

ROOT = Path(__file__).parents[1]
MATTY = ROOT / "schemas" / "matty.yaml"
ACK = "55 02 01 41 BC"
_FOCUSED = "document.activeElement.dataset.key || document.activeElement.id"


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as found:
        yield found


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """Pages of Matty, the index, and a comparison with a version of another speed."""
    protocol = compile_file(MATTY).protocol
    assert protocol is not None
    place = written([protocol], tmp_path_factory.mktemp("pages"))
    text = MATTY.read_text(encoding="utf-8")
    changed = place / "matty.yaml"
    changed.write_text(text.replace("speed: {type: sint16", "speed: {type: uint16"))
    done = run("diff", str(MATTY), str(changed), "--format", "html")
    (place / "comparison.html").write_text(done.output, encoding="utf-8")
    return place


@pytest.fixture
def matty(browser, folder) -> Iterator[Opened]:
    with Opened(browser, folder / "matty.html") as opened:
        yield opened
        assert opened.complaints == []


def go_to(opened: Opened, due: str) -> None:
    """Press Tab until an element has the focus, as its id or key."""
    for _ in range(200):
        if opened.run(_FOCUSED) == due:
            return
        opened.page.keyboard.press("Tab")
    raise AssertionError(f"no Tab leads to {due}")


def to_bench(opened: Opened) -> None:
    """Follow the second link of the page, which leads to the bench."""
    opened.run("document.querySelector('.skip').focus()")
    opened.page.keyboard.press("Tab")
    opened.page.keyboard.press("Enter")
    opened.page.wait_for_function("() => document.activeElement.id === 'bench'")


def test_search_by_keys(matty):
    keys = matty.page.keyboard
    keys.press("Tab")
    assert matty.run("document.activeElement.textContent") == "To the reference"
    keys.press("/")
    keys.type("speed")
    keys.press("ArrowDown")
    keys.press("Enter")
    matty.page.wait_for_function("() => location.hash.startsWith('#message-')")
    keys.press("/")
    keys.press("Escape")
    assert matty.page.input_value("#query") == ""


def test_decode_by_keys(matty):
    """Bytes are put in, said to be the ESP's, and walked over."""
    page, keys = matty.page, matty.page.keyboard
    to_bench(matty)
    go_to(matty, "bytes")
    keys.type(ACK)
    # Behind that, nothing is shown anew: where keys come slowly, there are events before.
    page.wait_for_function(
        "() => document.querySelector('#note').textContent.startsWith('5 bytes')"
    )
    page.wait_for_selector("#events article")
    go_to(matty, "sender")
    keys.type("esp")
    keys.press("Tab")
    page.wait_for_selector("#events .message")
    assert "message ack" in page.inner_text("#events h3")
    keys.press("Tab")
    assert matty.run("document.activeElement.className").startswith("run ")
    keys.press("ArrowRight")
    assert "length" in page.inner_text("#events tr.lit")


def test_encode_by_keys(matty):
    """A speed of 500 mm/s, F4 01, behind one that no message can have; 06+01+47+F4+01+BD = 200."""
    page, keys = matty.page, matty.page.keyboard
    to_bench(matty)
    go_to(matty, "tab-decode")
    keys.press("ArrowRight")
    go_to(matty, "message")
    keys.type("go")
    go_to(matty, "speed")
    keys.press("Control+A")
    keys.type("40000")
    assert page.get_attribute('[data-key="speed"]', "aria-invalid") == "true"
    keys.press("Control+A")
    keys.type("500")
    go_to(matty, "@counter")
    keys.press("Control+A")
    keys.type("1")
    assert page.inner_text("#made code >> nth=0") == "55 06 01 47 F4 01 00 00 BD"
    to_bench(matty)
    go_to(matty, "tab-encode")
    keys.press("ArrowRight")
    go_to(matty, "chosen")


@pytest.mark.parametrize("scheme", SCHEMES)
def test_axe_finds_nothing_in_any_state(browser, folder, scheme):
    for name in ("index", "comparison"):
        with Opened(browser, folder / f"{name}.html", color_scheme=scheme) as opened:
            assert opened.barriers(scheme) == [], name
    with Opened(browser, folder / "matty.html", color_scheme=scheme) as opened:
        page = opened.page
        page.fill("#query", "speed")
        page.select_option("#sender", "esp")
        page.fill("#bytes", f"{ACK} 55 02 01 41 BD 01 02")
        page.wait_for_selector("#events .invalid")
        page.hover("#events .run >> nth=3")
        assert opened.barriers(scheme) == [], "decode"
        page.click("#tab-encode")
        page.select_option("#message", "go")
        assert opened.barriers(scheme) == [], "encode"
        page.fill('[data-key="speed"]', "40000")
        assert page.inner_text(".wrong .fault")
        assert opened.barriers(scheme) == [], "a value that no message can have"
        page.click("#tab-file")
        data = bytes.fromhex(ACK) * 20 + b"\x01\x02" + bytes.fromhex(ACK)
        page.set_input_files("#chosen", {"name": "a.bin", "mimeType": "x", "buffer": data})
        page.wait_for_selector("#summary table")
        assert opened.barriers(scheme) == [], "file"


@pytest.mark.parametrize("name", ["matty", "index"])
def test_nothing_is_wider_than_a_narrow_screen(browser, folder, name):
    """Tables and drawings scroll by themselves; hashes and names break."""
    with Opened(browser, folder / f"{name}.html", viewport={"width": 420, "height": 900}) as opened:
        assert opened.run("document.documentElement.scrollWidth") == 420
