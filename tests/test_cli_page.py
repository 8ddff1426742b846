"""Commands that make pages: `open`, `explain --html` and `diff --format html`."""

from __future__ import annotations

import webbrowser
from pathlib import Path
from urllib.parse import unquote, urlparse

import pytest
from cli_support import run
from test_html_page import Elements

ROOT = Path(__file__).parents[1]
MATTY = ROOT / "schemas" / "matty.yaml"


@pytest.fixture
def opened(monkeypatch, tmp_path) -> list[str]:
    """The addresses that a browser was asked to open."""
    found: list[str] = []
    monkeypatch.setattr(webbrowser, "open", lambda url: found.append(url) or True)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    return found


def file_of(url: str) -> Path:
    return Path(unquote(urlparse(url).path))


def test_open_makes_a_page_and_opens_it(opened):
    done = run("open", str(MATTY))
    assert done.exit_code == 0
    (url,) = opened
    assert done.output.strip() == url
    assert "<title>Matty serial protocol" in file_of(url).read_text(encoding="utf-8")


def test_open_shows_bytes_on_the_bench(opened):
    assert run("open", str(MATTY), "--sender", "esp", "--hex", "55020141BC").exit_code == 0
    assert opened[0].endswith("#d=esp&hex=55+02+01+41+bc")


def test_explain_shows_bytes_on_the_bench(opened):
    done = run("explain", str(MATTY), "--html", "--sender", "esp", "--hex", "55 02 01 41 BC")
    assert done.exit_code == 0
    assert opened[0].endswith("#d=esp&hex=55+02+01+41+bc")


def test_a_machine_without_a_browser_is_told_where_the_page_is(opened, monkeypatch):
    monkeypatch.setattr(webbrowser, "open", lambda _: False)
    done = run("open", str(MATTY))
    assert done.exit_code == 0
    assert "no browser was found; the page is file://" in done.output.replace("\n", " ")


def test_an_endpoint_that_is_none_is_a_mistake_of_the_user(opened):
    assert run("open", str(MATTY), "--sender", "nobody", "--hex", "55").exit_code == 2
    assert opened == []


def test_diff_shows_the_witness_as_both_versions_read_it(tmp_path):
    """`speed` of `go` becomes unsigned: what the old one sends as -1 is 65535 to the new one."""
    text = MATTY.read_text(encoding="utf-8")
    old = "speed: {type: sint16, unit: mm/s, doc: Driving speed"
    assert old in text
    changed = tmp_path / "matty.yaml"
    changed.write_text(text.replace(old, old.replace("sint16", "uint16")), encoding="utf-8")
    done = run("diff", str(MATTY), str(changed), "--format", "html")
    assert done.exit_code == 1
    page = Elements(done.output)
    assert page.names.count("table") >= 2
    assert "Old sends" in page.words
    assert "New reads" in page.words
    assert "uint16 little" in page.words
    assert "sint16 little" in page.words
    assert "differs" in page.words


def test_diff_of_what_did_not_change_is_a_page_too():
    done = run("diff", str(MATTY), str(MATTY), "--format", "html")
    assert done.exit_code == 0
    assert "no change" in Elements(done.output).words
