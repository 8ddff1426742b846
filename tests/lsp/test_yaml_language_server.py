"""The JSON Schema in a real editor's language server.

It is found on the PATH, or where `npm install --prefix .cache/lsp tests/lsp` puts it.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from lsp_client import LspClient, Position

SERVER = "yaml-language-server"
INSTALLED = ".cache/lsp/node_modules/.bin"

GOOD = """\
protocol: tiny
endpoints: {pc: Computer}
frame:
  sync: {literal: 0x55}
  id: {type: uint8, id: true}
  payload: {}
messages:
  gyro:
    id: 1
    from: pc
    fields:
      angle: {type: sint16, scale: 1/16, unit: deg}
"""

DIALECT = """\
protocol: tiny_too
extends: tiny.yaml
messages:
  rename: {gyro: gyroscope}
  gyroscope:
    fields:
      angle: {byte_order: big}
      more: {type: uint8, after: angle}
"""


@pytest.fixture(scope="module")
def server(project_root: Path, require_tool: Callable[[str], str]) -> Iterator[LspClient]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PATH", os.pathsep.join([str(project_root / INSTALLED), os.environ["PATH"]]))
        command = [require_tool(SERVER), "--stdio"]
        schema = (project_root / "schemas" / "protogen.schema.json").as_uri()
        yaml = {"schemas": {schema: "*.yaml"}, "validate": True, "hover": True, "completion": True}
        with LspClient(command, {"yaml": yaml}) as client:
            yield client


def place(text: str, mark: str, offset: int = 0) -> Position:
    """Return the position behind `offset` characters of `mark`."""
    before = text[: text.index(mark) + offset]
    return {"line": before.count("\n"), "character": len(before) - before.rfind("\n") - 1}


def test_good_schema_has_no_diagnostic(server: LspClient) -> None:
    assert server.open("file:///good.yaml", GOOD) == []


def test_dialect_may_use_directives_and_leave_out_the_rest(server: LspClient) -> None:
    assert server.open("file:///dialect.yaml", DIALECT) == []


def test_directive_is_unknown_in_a_schema_that_extends_nothing(server: LspClient) -> None:
    text = GOOD.replace("messages:\n", "messages:\n  remove: [gyro]\n")
    messages = [item["message"] for item in server.open("file:///base.yaml", text)]
    assert messages != []


def test_types_are_completed(server: LspClient) -> None:
    text = GOOD.replace("{type: sint16, scale: 1/16, unit: deg}", "\n        type: ")
    server.open("file:///complete.yaml", text)
    offered = server.completions("file:///complete.yaml", place(text, "        type: ", 14))
    assert {"uint8", "sint16", "char", "float32", "ascii", "bytes"} <= set(offered)


def test_checksum_algorithms_are_completed(server: LspClient) -> None:
    text = GOOD.replace("  payload: {}", "  payload: {}\n  crc:\n    algorithm: ")
    server.open("file:///crc.yaml", text)
    offered = server.completions("file:///crc.yaml", place(text, "algorithm: ", 11))
    assert {"xor-8", "fletcher-16", "CRC-16/KERMIT"} <= set(offered)


def test_keys_are_completed(server: LspClient) -> None:
    text = GOOD.replace("    id: 1\n", "    id: 1\n    s\n")
    server.open("file:///keys.yaml", text)
    offered = server.completions("file:///keys.yaml", place(text, "    s\n", 5))
    assert {"summary", "source"} <= set(offered)


@pytest.mark.parametrize(
    ("key", "explanation"),
    [
        ("endpoints", "The named sides of the link."),
        ("literal", "Fixed bytes that open, close or mark;"),
        ("scale", "physical value = raw value x scale + offset; exact, such as 1/16."),
    ],
)
def test_hover_explains_a_key(server: LspClient, key: str, explanation: str) -> None:
    server.open("file:///hover.yaml", GOOD)
    shown = server.hover("file:///hover.yaml", place(GOOD, key, 1))
    assert explanation in shown.replace("\\+", "+")  # Markdown, where a plus may be escaped.


def test_unknown_key_is_underlined(server: LspClient) -> None:
    text = GOOD.replace("from: pc", "from: pc\n    colour: red")
    (diagnostic,) = server.open("file:///unknown.yaml", text)
    assert diagnostic["message"] == "Property colour is not allowed."
    assert diagnostic["range"]["start"] == place(text, "colour")
    assert diagnostic["range"]["end"] == place(text, "colour", len("colour"))
