"""Texts of a hostile schema on pages: wherever they stand, they stay text, and nothing runs."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from browser_pages import Opened, chromium, written
from cli_support import run
from test_html_page import Elements

from protogen.compiler import compile_file
from protogen.copying import replace
from protogen.model.protocol import Protocol

ROOT = Path(__file__).parents[1]
_QUESTION = ("question", "document", "choice", "because")
_SOURCE = ("document", "revision", "lines", "section", "license", "note")
_TEXTS = {*_QUESTION, *_SOURCE, "title", "doc", "summary", "unit", "why"}
"""Keys of a schema whose values are texts for people."""
HOSTILE = " ".join(
    [
        "hacked=1//",
        "</script><script>hacked=1</script>",
        "</style></title></textarea></option></select></svg><script>hacked=1</script>",
        "<!--<script>",
        "<img src=x onerror=hacked=1>",
        "<svg onload=hacked=1><a href=javascript:hacked=1>x</a>",
        "\"onload='hacked=1' '><script>hacked=1</script>",
        "[x](javascript:hacked=1) ![x](x.png) <javascript:hacked=1>",
        "<iframe srcdoc='<script>parent.hacked=1</script>'></iframe>",
        "<form action=x><button autofocus onfocus=hacked=1>",
        "<base href=https://example.com/><meta http-equiv=refresh content='0;url=x'>",
        "${hacked=1} `${hacked=1}` {{ hacked }} \\u003cscript>hacked=1\\u003c/script>",
    ]
)
_WALK = """() => {
    document.querySelector("#bench")?.removeAttribute("hidden");
    for (const link of document.querySelectorAll("a")) {
        if (link.protocol === "javascript:") link.click();
    }
    for (const element of document.querySelectorAll("*")) {
        for (const { name } of element.attributes) if (name.startsWith("on")) return name;
    }
    return globalThis.hacked ?? null;
}"""

_CHOOSE_EACH = """(selector) => {
    const menu = document.querySelector(selector);
    for (const { value } of [...menu.options]) {
        menu.value = value;
        menu.dispatchEvent(new Event("change"));
    }
}"""


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as found:
        yield found


def hostile_schema(text: str, url: str) -> dict[str, Any]:
    """The schema of Matty with the text for each text of its own, and two sources with an address.

    It has documents, decisions, exchanges, enums, units, examples and revisions of sources.
    """
    schema = yaml.safe_load((ROOT / "schemas" / "matty.yaml").read_text(encoding="utf-8"))
    schema["version"] = text
    schema["link"]["doc"] = text
    schema["decisions"]["of_a_stranger"] = dict.fromkeys(_QUESTION, text) | {
        "source": dict.fromkeys(_SOURCE, text) | {"url": url}
    }
    found: dict[str, Any] = _replaced(schema, text)
    return found


def _replaced(value: Any, text: str, key: str = "") -> Any:
    if isinstance(value, dict):
        return {name: _replaced(item, text, name) for name, item in value.items()}
    if isinstance(value, list):
        return [_replaced(item, text, key) for item in value]
    return text if isinstance(value, str) and key in _TEXTS else value


def compiled(schema: dict[str, Any], text: str, path: Path) -> Protocol:
    """The protocol of a schema, whose file has the text as its name."""
    path.write_text(json.dumps(schema), encoding="utf-8")
    compilation = compile_file(path)
    assert compilation.protocol is not None, [item.message for item in compilation.problems]
    return replace(compilation.protocol, files=(f"{text}.yaml",))


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    place = tmp_path_factory.mktemp("pages")
    schema = hostile_schema(HOSTILE, "javascript:hacked=1")
    return written([compiled(schema, HOSTILE, place / "matty.yaml")], place)


@pytest.fixture(scope="module")
def plain(tmp_path_factory) -> Path:
    place = tmp_path_factory.mktemp("plain")
    schema = hostile_schema("plain", "https://example.com/")
    return written([compiled(schema, "plain", place / "matty.yaml")], place)


@pytest.fixture(scope="module")
def comparison(tmp_path_factory) -> Path:
    """The page of two versions, each of which is hostile, and which differ in many places."""
    place = tmp_path_factory.mktemp("versions")
    old = hostile_schema(HOSTILE, "javascript:hacked=1")
    new = hostile_schema(f"{HOSTILE} new", "javascript:hacked=2")
    fields = new["messages"]["go"]["fields"]
    fields["speed"] |= {"type": "uint16"}
    fields["steer"] |= {"scale": 0.02}
    del new["messages"]["stop"], new["exchanges"]
    paths = [place / name / "hostile.yaml" for name in ("old", "new")]
    for path, schema in zip(paths, (old, new), strict=True):
        path.parent.mkdir()
        path.write_text(json.dumps(schema), encoding="utf-8")
    done = run("diff", *map(str, paths), "--format", "html")
    assert done.exit_code == 1, done.output
    (place / "comparison.html").write_text(done.output, encoding="utf-8")
    return place / "comparison.html"


def work(opened: Opened) -> None:
    """Have the page show all that it shows: what is found, every example, message and name."""
    page = opened.page
    for word in ("hacked", "script", "m", "x"):
        page.fill("#query", word)
    page.fill("#bytes", "55 02 01 41 BC 55 02 01 41 BD")
    page.dispatch_event("#bytes", "input")
    for menu, tab in (("#example", "decode"), ("#message", "encode")):
        page.click(f"#tab-{tab}")
        opened.run(_CHOOSE_EACH, menu)
    page.click("#tab-file")
    data = bytes.fromhex("55 02 01 41 BC 55 02 01 41 BD")
    page.set_input_files("#chosen", {"name": HOSTILE, "mimeType": "x", "buffer": data})
    page.wait_for_selector("#summary table")


def pages_of(folder: Path, comparison: Path) -> tuple[Path, ...]:
    return (folder / "matty.html", folder / "index.html", comparison)


def test_the_text_is_on_the_pages(folder, comparison):
    """A text that no page had would be tried in vain."""
    reference, index, changes = (
        Elements(path.read_text(encoding="utf-8")).words for path in pages_of(folder, comparison)
    )
    assert reference.count("hacked=1") > 300
    assert index.count("hacked=1") >= 10
    assert changes.count("hacked=1") >= 10


def test_no_text_becomes_markup(folder, plain, comparison):
    for name in ("matty.html", "index.html"):
        found = Elements((folder / name).read_text(encoding="utf-8"))
        due = Elements((plain / name).read_text(encoding="utf-8"))
        links = [value for _, value in due.attributes if value == "https://example.com/"]
        assert Counter(due.names) - Counter(found.names) == Counter(a=len(links))
        assert Counter(found.names) - Counter(due.names) == Counter()
    changes = Elements(comparison.read_text(encoding="utf-8"))
    assert not {"img", "iframe", "base", "form", "a"} & set(changes.names)
    for path in pages_of(folder, comparison):
        elements = Elements(path.read_text(encoding="utf-8"))
        assert not [name for name, _ in elements.attributes if name.startswith("on")]


def test_policies_allow_what_is_ours_alone(folder, comparison):
    """Scripts and styles are named by their hashes, and all else is forbidden."""
    for path in pages_of(folder, comparison):
        text = path.read_text(encoding="utf-8")
        found = re.search(r'<meta http-equiv="Content-Security-Policy" content="([^"]*)">', text)
        assert found is not None
        policy = found[1].replace("&#39;", "'")
        assert "unsafe" not in policy
        assert policy.startswith("default-src 'none'; ")
        assert re.fullmatch(
            r"default-src 'none';( script-src 'sha256-[\w+/=]+';)? style-src 'sha256-[\w+/=]+';"
            r" base-uri 'none'; form-action 'none'",
            policy,
        )


@pytest.mark.parametrize("bypass_csp", [False, True], ids=["policy", "no policy"])
def test_nothing_runs(browser, folder, comparison, bypass_csp):
    """Neither the texts nor the policy lets it: without the policy, the texts alone do not."""
    for path in pages_of(folder, comparison):
        with Opened(browser, path, bypass_csp=bypass_csp) as opened:
            scripts = opened.run("document.scripts.length")
            if path.name == "matty.html":
                work(opened)
            assert opened.run(_WALK) is None, path.name
            assert opened.run("document.scripts.length") == scripts
            assert opened.requests == [opened.url]
            assert opened.complaints == []


def test_the_policy_stops_what_is_slipped_in(browser, plain, tmp_path):
    """A page with markup of a stranger: his scripts do not run, and nothing is loaded."""
    text = (plain / "matty.html").read_text(encoding="utf-8")
    slipped = (
        "<script>hacked=1</script><img src=https://example.com/x.png onerror=hacked=1>"
        "<iframe src=https://example.com/></iframe></body>"
    )
    path = tmp_path / "slipped.html"
    path.write_text(text.replace("</body>", slipped), encoding="utf-8")
    with Opened(browser, path) as opened:
        assert opened.run("globalThis.hacked ?? null") is None
        assert opened.run("typeof protogen") == "object"
        found = [item for item in opened.complaints if "Content Security Policy" in item]
        for kind in ("script", "image", "fram"):
            assert any(kind in item for item in found), kind
