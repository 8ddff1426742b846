"""Pages on paper: what is left out, what stays together, and colours of the dark scheme."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from browser_pages import Opened, chromium, written

from protogen.compiler import compile_file

MATTY = Path(__file__).parents[1] / "schemas" / "matty.yaml"
A4 = {"width": 680, "height": 1009}
"""Pixels of a page within margins of 15 mm."""


@pytest.fixture(scope="module")
def printed(tmp_path_factory) -> Iterator[Opened]:
    protocol = compile_file(MATTY).protocol
    assert protocol is not None
    path = written([protocol], tmp_path_factory.mktemp("pages")) / "matty.html"
    with (
        chromium() as browser,
        Opened(browser, path, color_scheme="dark", viewport=A4) as opened,
    ):
        opened.page.emulate_media(media="print")
        yield opened


def style(printed: Opened, selector: str, name: str) -> list[Any]:
    code = (
        "([selector, name]) => [...document.querySelectorAll(selector)]"
        ".map(item => getComputedStyle(item)[name])"
    )
    found: list[Any] = printed.run(code, [selector, name])
    assert found
    return found


@pytest.mark.parametrize("part", ["nav", "#bench", "#query", ".skip >> nth=0"])
def test_what_one_works_with_is_left_out(printed, part):
    assert not printed.page.is_visible(part)


def test_the_reference_is_black_on_white_in_the_dark_scheme_too(printed):
    assert style(printed, "body", "color") == ["rgb(0, 0, 0)"]
    assert style(printed, "body", "backgroundColor") == ["rgb(255, 255, 255)"]
    assert set(style(printed, "svg text", "fill")) <= {"rgb(0, 0, 0)", "rgb(51, 51, 51)"}


def test_tables_and_drawings_that_fit_on_a_page_are_not_cut(printed):
    for selector in (".wide", "figure", "tr"):
        assert set(style(printed, selector, "breakInside")) == {"avoid"}


def test_headings_stay_with_what_is_below_them(printed):
    for selector in ("h2", "h3", "h4", "h3 + p"):
        assert set(style(printed, selector, "breakAfter")) == {"avoid"}


def test_nothing_is_wider_than_a_page(printed):
    widest = (
        "() => Math.max(...[...document.querySelectorAll('table, svg, pre')]"
        ".map(item => item.getBoundingClientRect().right))"
    )
    assert printed.run(widest) <= A4["width"]


def test_it_can_be_printed(printed):
    assert printed.page.pdf(format="A4").startswith(b"%PDF")
