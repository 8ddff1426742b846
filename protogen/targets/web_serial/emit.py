"""Prints the example of the package of TypeScript: a page that speaks to a device by Web Serial.

The page is as it is; what it has to know of a protocol stands beside it, as JSON. Its form and its
readings are the bench's of the HTML target.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from importlib.resources import files
from pathlib import PurePosixPath

from protogen.model.protocol import Protocol
from protogen.targets.html.plans import plans
from protogen.targets.html.shell import PACKAGE as BENCH
from protogen.targets.output import File
from protogen.targets.typescript.names import names_of

_PACKAGE = "protogen.targets.web_serial"
_FOLDER = PurePosixPath("examples", "web-serial")
_SHARED = (
    *("page.css", "bench.css"),
    *("annotate.js", "cursor.js", "dissect.js", "dom.js", "encode_view.js", "explain.js"),
    *("expressions.js", "form.js", "fractions.js", "gathered.js", "numbers.js", "octets.js"),
    *("plans.js", "readings.js", "tokens.js", "values.js", "wire.js"),
)
"""Of the bench."""


def example(protocols: Sequence[Protocol]) -> Iterator[File]:
    """The page, and what it goes by."""
    names = sorted(names_of(protocol).file for protocol in protocols)
    yield File(_FOLDER / "protocols.json", _json(names), None, shared=True)
    for protocol in protocols:
        path = _FOLDER / "plans" / f"{names_of(protocol).file}.json"
        yield File(path, _json(_plans(protocol)), None)
    own = [item for item in (files(_PACKAGE) / "page").iterdir() if item.is_file()]
    shared = [files(BENCH) / "page" / name for name in _SHARED]
    for item in (*own, *shared):
        yield File(_FOLDER / item.name, item.read_text(encoding="utf-8"), None, shared=True)


def _plans(protocol: Protocol) -> dict[str, object]:
    link = protocol.link
    idle = link.idle_timeout
    return {
        "title": protocol.title,
        "link": {
            "baud": link.baud,
            "dataBits": link.data_bits,
            "parity": link.parity,
            "stopBits": link.stop_bits,
            "idle": None if idle is None else float(idle),
            "endsFrames": any(sender.plan.ends_idle for sender in protocol.senders),
        },
        **plans(protocol),
    }


def _json(value: object) -> str:
    return json.dumps(value, ensure_ascii=True, separators=(",", ":")) + "\n"
