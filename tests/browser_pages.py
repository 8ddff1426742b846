"""Pages of the HTML target in Chromium, and what Python says of the same bytes."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

from tooling import PATIENCE, require_module, require_tool, unavailable

from protogen.cli.wire.codec import Codec
from protogen.cli.wire.explain import _rows, _sender, _title, _value
from protogen.model.protocol import Protocol
from protogen.targets.html.emit import emit

AXE = Path(__file__).parents[1] / ".cache" / "axe" / "node_modules" / "axe-core" / "axe.min.js"
SCHEMES = {"light": {}, "dark": {"runOnly": ["color-contrast", "link-in-text-block"]}}
"""Options of axe-core for both schemes, which differ in colours alone. What else it looks for takes
most of its time, and is the same in the dark."""


@contextmanager
def chromium() -> Iterator[Any]:
    """Debian's Chromium; without it, skip the test or fail."""
    program = require_tool("chromium")
    require_module("playwright")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=program, args=["--no-sandbox"], timeout=PATIENCE * 1000
        )
        try:
            yield browser
        finally:
            browser.close()


def context_of(browser: Any, **options: Any) -> Any:
    """A window of its own, whose pages have the time that a busy machine needs."""
    context = browser.new_context(**options)
    context.set_default_timeout(PATIENCE * 1000)
    return context


class _Quiet(SimpleHTTPRequestHandler):
    """Serves files, and says nothing about it."""

    def log_message(self, *_: Any) -> None:
        pass


@contextmanager
def served(folder: Path) -> Iterator[str]:
    """The address of a folder, which any server of files can be at."""
    handler = partial(_Quiet, directory=str(folder))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://localhost:{server.server_port}"
        server.shutdown()


def address_of(page: Any) -> str:
    """The address as the page itself knows it: `page.url` hears of a change only later."""
    return str(page.evaluate("location.href"))


class Opened:
    """A page that was opened as a file, and what it complained of."""

    def __init__(self, browser: Any, path: Path, **context: Any) -> None:
        self.context = context_of(browser, **context)
        self.page = self.context.new_page()
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("dialog", lambda dialog: self.complaints.append(dialog.message))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.url = path.as_uri()
        self.page.goto(self.url)

    def run(self, code: str, value: object = None) -> Any:
        """What a function of JavaScript gives for a value."""
        return self.page.evaluate(code, value)

    def run_on_much(self, code: str, value: object) -> Any:
        """The same of values that JSON has: Playwright takes long to look at each of thousands."""
        text = f"text => JSON.stringify(({code})(JSON.parse(text)))"
        return json.loads(self.page.evaluate(text, json.dumps(value)))

    def barriers(self, scheme: str) -> list[Any]:
        """What axe-core finds, with some of the places; skips the test, or fails, without it."""
        if not AXE.is_file():
            unavailable("axe-core is not installed in .cache/axe")
        if not self.run("'axe' in window"):
            self.run(AXE.read_text(encoding="utf-8"))
        found = self.run("options => axe.run(options)", SCHEMES[scheme])["violations"]
        return [(item["id"], [node["html"][:200] for node in item["nodes"]][:3]) for item in found]

    def __enter__(self) -> Opened:
        return self

    def __exit__(self, *_: object) -> None:
        self.context.close()


def written(protocols: Sequence[Protocol], folder: Path) -> Path:
    """The folder, with the pages of protocols in it."""
    for file in emit(protocols):
        (folder / file.path).write_bytes(file.bytes)
    return folder


def explained(codec: Codec, sender: str, data: bytes) -> list[list[list[str]]]:
    """The rows of each event that `protogen explain` shows."""
    decoder = codec.decoder(sender, None)
    protocol = codec.protocol
    return [
        [
            [
                str(event.offset + row.offset),
                row.bits or row.wire.hex(" ").upper(),
                row.bytes.hex(" ").upper(),
                row.path,
                row.type,
                _value(row.value),
                row.meaning,
                row.fault,
            ]
            for row in _rows(protocol, _sender(protocol, event), event, decoder.told)
        ]
        for event in (*decoder.feed(data), *decoder.flush())
    ]


def titles(codec: Codec, sender: str, data: bytes) -> list[str]:
    """The titles of the same events."""
    decoder = codec.decoder(sender, None)
    return [" ".join(_title(event)) for event in (*decoder.feed(data), *decoder.flush())]
