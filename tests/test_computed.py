"""Fields that only count: left out, they are what follows from what they count."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from cli_support import run
from compiled import module_at

from protogen.runtime.errors import EncodeError

HEAD = """\
protocol: demo
endpoints: {host: Host}
byte_order: little
frame:
  length: {type: uint8, counts: payload}
  id: {type: uint8, id: true}
  payload: {}
  sum: {type: uint8, algorithm: sum-8, covers: length..payload}
messages:
"""
COUNTING = """\
  elements: {id: 1, from: host, fields: {n: uint8, all: {count: n, fields: {a: uint8}}}}
  numbers: {id: 2, from: host, fields: {n: uint8, all: {type: uint16, count: n}}}
  words: {id: 3, from: host, fields: {n: uint8, t: {type: ascii, size: n}}}
  octets: {id: 4, from: host, fields: {n: uint16, t: {type: bytes, size: n}}}
  inside: {id: 5, from: host, fields: {s: {fields: {n: uint8, t: {type: ascii, size: n}}}}}
  each:
    id: 6
    from: host
    fields: {all: {count: fill, fields: {n: uint8, t: {type: ascii, size: n}}}}
  twice:
    id: 7
    from: host
    fields: {n: uint8, a: {type: uint8, count: n}, b: {type: uint8, count: n}}
  sized: {id: 8, from: host, fields: {n: uint8, all: {type: uint16, size: n}}}
  some:
    id: 9
    from: host
    fields: {n: uint8, has: bool, a: {type: uint8, count: n, when: has}, b: {type: uint8, count: n}}
  line: {id: 10, from: host, fields: {n: uint8, all: {type: uint8, count: 2 * n - 1}}}
"""


@pytest.fixture(scope="module")
def schema(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("computed") / "demo.yaml"
    path.write_text(HEAD + COUNTING)
    return path


@pytest.fixture(scope="module")
def demo(schema: Path) -> ModuleType:
    return module_at(schema)


PAYLOADS = [
    ("elements", {"all": [{"a": 5}, {"a": 6}]}, "02 05 06"),
    ("elements", {"all": []}, "00"),
    ("numbers", {"all": [5, 6]}, "02 0500 0600"),
    ("words", {"t": "abc"}, "03 61 62 63"),
    ("octets", {"t": "0a0b"}, "0200 0A 0B"),
    ("inside", {"s": {"t": "a"}}, "01 61"),
    ("each", {"all": [{"t": "ab"}, {"t": ""}]}, "02 61 62 00"),
    ("twice", {"a": [1, 2], "b": [3, 4]}, "02 01 02 03 04"),
    ("sized", {"all": [1, 2]}, "04 0100 0200"),
    ("some", {"has": False, "a": None, "b": [7]}, "01 00 07"),
    ("line", {"all": [7, 8, 9]}, "02 07 08 09"),
]
every_payload = pytest.mark.parametrize(("name", "fields", "payload"), PAYLOADS)


def message_of(module: ModuleType, name: str, fields: dict[str, Any]) -> Any:
    return getattr(module, name.capitalize()).from_dict(fields)


@every_payload
def test_the_number_follows_from_what_is_counted(
    demo: ModuleType, name: str, fields: dict[str, Any], payload: str
) -> None:
    message = message_of(demo, name, fields)
    data = bytes.fromhex(payload)
    assert message.to_payload() == data
    line = {"event": "message", "message": name, "sender": "host", "fields": fields}
    assert demo.PROTOCOL.encode_line(line)[2:-1] == data
    again = demo.decode(demo.encode(message), sender="host")
    assert again == message == message_of(demo, name, message.to_dict())


@every_payload
def test_a_number_that_is_given_has_to_be_right(
    demo: ModuleType, name: str, fields: dict[str, Any], payload: str
) -> None:
    message = message_of(demo, name, fields)
    holder = next(iter(getattr(message, "all", [])), None) if name == "each" else message
    holder = message.s if name == "inside" else holder
    holder.n += 1
    with pytest.raises(EncodeError, match=r"needs exactly|is no number of them"):
        message.to_payload()


def test_constructors_take_what_is_counted_alone(demo: ModuleType) -> None:
    message = demo.Elements(all=[demo.ElementsAll(a=5)])
    assert message == demo.Elements(n=1, all=[demo.ElementsAll(a=5)])
    assert demo.Words(t="abc").n == 3


def test_it_may_be_left_out_on_the_command_line(schema: Path) -> None:
    # 05 + 03 + 03 + 61 + 62 + 63 = 0x131.
    assert run("encode", str(schema), "words", "t=abc").stdout == "04 03 03 61 62 63 30\n"
    assert run("encode", str(schema), "words", "t=abc", "n=3").stdout.endswith(" 63 30\n")
    wrong = run("encode", str(schema), "words", "t=abc", "n=2")
    assert wrong.exit_code == 2
    assert "t: needs exactly 2 characters, as n says, not 3" in wrong.output


@pytest.mark.parametrize(
    "fields",
    [
        "{n: uint8, all: {type: uint8, count: n}, more: {type: uint8, when: n == 2}}",
        "{n: uint8, all: {type: uint8, count: n}, x: {switch: n, cases: {1: uint8, else: uint16}}}",
        "{n: uint8, all: {type: uint8, count: n}, s: {fields: {x: {type: uint8, when: n > 1}}}}",
        "{n: uint8, all: {type: uint8, count: n // 2}}",
        "{n: uint8, m: {type: uint8, range: [0, 3]}, all: {type: uint8, count: n + m}}",
        "{n: uint8, s: {fields: {all: {type: uint8, count: n}}}}",
    ],
    ids=["when", "switch", "when inside", "rounded", "two fields", "counts in another struct"],
)
def test_a_number_that_says_more_or_less_has_to_be_given(fields: str, tmp_path: Path) -> None:
    path = tmp_path / "demo.yaml"
    path.write_text(f"{HEAD}  m: {{id: 1, from: host, fields: {fields}}}\n")
    module = module_at(path)
    with pytest.raises(TypeError, match="'n'"):
        module.M()
    with pytest.raises(EncodeError, match="n: the value is missing"):
        module.M.from_dict({"all": [1]} if "s:" not in fields else {})


def test_a_default_stands_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "demo.yaml"
    fields = "{n: {type: uint8, default: 1}, all: {type: uint8, count: n}}"
    path.write_text(f"{HEAD}  m: {{id: 1, from: host, fields: {fields}}}\n")
    assert module_at(path).M(all=[7, 8]).n == 1
