"""Fields that only count: left out, they are what follows from what they count."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice
from pathlib import Path
from random import Random
from types import ModuleType
from typing import Any

import pytest
from cli_support import run
from compiled import ROOT, module_at, protocol_of

from protogen.fuzzing.samples import samples
from protogen.model.computed import computed
from protogen.model.types import Array, Field, Struct, Type
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
  region:
    id: 11
    from: host
    fields: {n: uint8, s: {size: n, fields: {t: {type: ascii, size: fill}}}}
  tags:
    id: 12
    from: host
    fields:
      items:
        count: fill
        fields:
          tag: {type: uint8, values: {a: 1, b: 2, c: 3}}
          n: uint8
          value:
            switch: tag
            size: n - 1
            cases: {a: uint16, b: {type: ascii, size: fill}, c: {fields: {}}}
  lines:
    id: 13
    from: host
    fields:
      n: uint8
      k: uint8
      s:
        size: n
        when: k > 0
        fields: {k: uint8, t: {type: bytes, size: k}, x: {type: uint8, count: fill}}
  held:
    id: 14
    from: host
    fields:
      n: uint8
      k: uint8
      all: {type: uint8, count: k}
      s: {size: n, fields: {t: {type: ascii, size: k}}}
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
    ("region", {"s": {"t": "abc"}}, "03 61 62 63"),
    ("region", {"s": {"t": ""}}, "00"),
    # A number, a text, nothing, and what has no case: each with its size and one more.
    ("tags", {"items": [{"tag": 1, "value": {"value": 5}}]}, "01 03 0500"),
    ("tags", {"items": [{"tag": 2, "value": {"value": "a"}}]}, "02 02 61"),
    ("tags", {"items": [{"tag": 3, "value": None}, {"tag": 9, "value": "0a"}]}, "03 01 09 02 0A"),
    ("lines", {"k": 7, "s": {"t": "0a0b", "x": [1]}}, "04 07 02 0A 0B 01"),
    ("held", {"all": [1, 2], "s": {"t": "ab"}}, "02 02 01 02 61 62"),
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
    holder = {"inside": lambda: message.s, "each": lambda: message.all[0]}
    holder["tags"] = lambda: message.items[0]
    counted = holder.get(name, lambda: message)()
    counted.n += 1
    with pytest.raises(EncodeError, match=r"needs exactly|is no number of them"):
        message.to_payload()


def test_the_size_of_what_is_not_there_is_free(demo: ModuleType) -> None:
    assert demo.Lines(k=0, s=None).to_payload() == b"\0\0"
    assert demo.Lines(k=0, s=None, n=7).to_payload() == b"\7\0"


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
        "{n: uint8, s: {size: n, fields: {x: {type: bytes, size: n // 2}, y: uint8}}}",
        "{n: uint8, s: {size: n, when: n > 3, fields: {all: {type: uint8, count: fill}}}}",
    ],
    ids=[
        "when",
        "switch",
        "when inside",
        "rounded",
        "two fields",
        "counts in another struct",
        "counts in its region",
        "when of its region",
    ],
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


def test_what_is_wrong_in_a_region_is_said_by_the_encoder(demo: ModuleType) -> None:
    message = demo.Region(s=demo.RegionS(t="\u20ac"))
    assert message.n == 0
    with pytest.raises(EncodeError, match=r"^s\.t: "):
        message.to_payload()
    assert demo.Region(s=5).n == 0


@pytest.mark.parametrize("name", ["expressions", "regions", "sampler", "sized_arrays"])
def test_samples_are_the_same_without_what_is_worked_out(name: str) -> None:
    path = ROOT / "tests" / "c_schemas" / f"{name}.yaml"
    protocol, module = protocol_of(path), module_at(path)
    left_out = 0
    for message in protocol.messages:
        (sender, *_) = protocol.senders_of(message)
        for values, _ in islice(samples(message, sender.frame, Random(name)), 15):
            kept = without_computed(message.fields, values)
            kind = module.PROTOCOL.sender(sender.name).named(message.name)
            assert kind.from_dict(kept).to_dict() == kind.from_dict(values).to_dict()
            left_out += kept != values
    assert left_out > 10


def without_computed(fields: Sequence[Field], values: dict[str, Any]) -> dict[str, Any]:
    """The values without the numbers that are worked out of something that is there."""
    counts = computed(fields)
    gone = {name for name, found in counts.items() if values[found.field] is not None}
    return {
        field.name: bare(field.type, values[field.name])
        for field in fields
        if field.name in values and field.name not in gone
    }


def bare(type_: Type, value: Any) -> Any:
    """A value without what is worked out inside of it, up to the cases of switches."""
    if isinstance(type_, Struct) and value is not None:
        return without_computed(type_.fields, value)
    if isinstance(type_, Array) and value is not None:
        return [bare(type_.element, element) for element in value]
    return value
