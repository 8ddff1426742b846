"""Cases of a switch for all values that no other case has: `else`."""

from __future__ import annotations

from itertools import islice
from pathlib import Path
from random import Random
from types import ModuleType
from typing import Any

import pytest
from cli_support import run
from compiled import protocol_of

from protogen.evolution.findings import findings
from protogen.evolution.lock import lock_text, read_lock
from protogen.fuzzing.samples import samples
from protogen.live.codec import module_of
from protogen.model.protocol import Protocol
from protogen.model.types import Switch

HEAD = """\
protocol: demo
endpoints: {host: Host}
byte_order: little
frame:
  length: {type: uint8, counts: payload}
  id: {type: uint8, id: true}
  payload: {}
  crc: {type: uint16, algorithm: CRC-16/KERMIT, covers: length..payload}
messages:
  m:
    id: 1
    from: host
    fields:
"""
FIELDS = """\
      kind: {type: uint8, values: {speed: 1, name: 2}}
      value:
        switch: kind
        cases:
          else: {fields: {a: uint8, b: uint8}}
          speed: uint16
          name: {type: ascii, size: {fill: true, max: 4}}
"""


def with_fields(folder: Path, fields: str = FIELDS, name: str = "demo") -> Protocol:
    path = folder / f"{name}.yaml"
    path.write_text(HEAD + fields)
    return protocol_of(path)


@pytest.fixture
def demo(tmp_path: Path) -> ModuleType:
    return module_of(with_fields(tmp_path))


def switch_of(protocol: Protocol) -> Switch:
    (message,) = protocol.messages
    found = message.fields[-1].type
    assert isinstance(found, Switch)
    return found


class TestModel:
    def test_it_is_the_last_case_wherever_it_is_written(self, tmp_path: Path) -> None:
        protocol = with_fields(tmp_path)
        switch = switch_of(protocol)
        assert [(case.value, case.name) for case in switch.cases] == [
            (1, "speed"),
            (2, "name"),
            (None, "else"),
        ]
        other = "          else: {fields: {a: uint8, b: uint8}}\n"
        moved = with_fields(tmp_path, FIELDS.replace(other, "") + other, "moved")
        assert moved.spec_hash == protocol.spec_hash

    def test_no_bytes_are_left_without_a_case(self, tmp_path: Path) -> None:
        switch = switch_of(with_fields(tmp_path))
        assert switch.rest is None
        assert switch.case(9) is switch.cases[-1]
        assert (switch.sizes.least, switch.sizes.greatest) == (0, 4)

    def test_a_lock_gives_it_back(self, tmp_path: Path) -> None:
        protocol = with_fields(tmp_path)
        path = tmp_path / "protogen.lock"
        path.write_text(lock_text({"a.yaml": protocol}))
        (back,) = read_lock(path).values()
        assert switch_of(back).cases[-1].value is None
        assert findings(protocol, back)[1] == []


class TestPython:
    def test_the_number_stays_where_it_was_given(self, demo: ModuleType) -> None:
        message = demo.M(kind=200, value=demo.MValueElse(a=3, b=4))
        frame = bytes.fromhex("03 01 C8 03 04")
        assert demo.encode(message)[:5] == frame
        assert demo.decode(demo.encode(message), "host") == message
        assert message.to_dict() == {"kind": 200, "value": {"a": 3, "b": 4}}
        assert demo.M.from_dict(message.to_dict()) == message

    @pytest.mark.parametrize(
        ("kind", "case", "fields", "problem"),
        [
            (1, "MValueElse", {"a": 3, "b": 4}, "value: must be a MValueSpeed, not MValueElse"),
            (7, "MValueSpeed", {"value": 3}, "value: must be a MValueElse, not MValueSpeed"),
        ],
    )
    @pytest.mark.parametrize("strict", [True, False])
    def test_a_number_has_no_case_but_its_own(
        self,
        kind: int,
        case: str,
        fields: dict[str, int],
        problem: str,
        strict: bool,
        demo: ModuleType,
    ) -> None:
        message = demo.M(kind=kind, value=getattr(demo, case)(**fields))
        with pytest.raises(demo.EncodeError, match=problem):
            demo.encode(message, strict=strict)

    def test_bytes_are_no_value_of_it(self, demo: ModuleType) -> None:
        with pytest.raises(demo.EncodeError, match="must be a MValueElse, not b'ab'"):
            demo.encode(demo.M(kind=7, value=b"ab"))

    def test_too_few_bytes_are_no_case(self, demo: ModuleType) -> None:
        with pytest.raises(demo.DecodeError):
            demo.M.from_payload(bytes.fromhex("07 01"))


class TestCommands:
    def test_values_are_given_by_name(self, tmp_path: Path) -> None:
        with_fields(tmp_path)
        schema = str(tmp_path / "demo.yaml")
        done = run("encode", schema, "m", "kind=9", "value.a=1", "value.b=2")
        assert (done.exit_code, done.stdout[:14]) == (0, "03 01 09 01 02")
        shown = run("decode", schema, "--hex", done.stdout, "--format", "jsonl")
        assert '"fields": {"kind": 9, "value": {"a": 1, "b": 2}}' in shown.stdout
        explained = run("explain", schema, "--hex", done.stdout)
        assert "value.b" in explained.stdout

    def test_hints_say_what_it_has(self, tmp_path: Path) -> None:
        with_fields(tmp_path)
        done = run("encode", str(tmp_path / "demo.yaml"), "m", "kind=9", "value=3")
        assert done.exit_code == 2
        assert "give value.a=... value.b=..." in done.stderr

    def test_a_reference_has_it_last(self, tmp_path: Path) -> None:
        with_fields(tmp_path)
        out = tmp_path / "out"
        done = run("generate", str(tmp_path / "demo.yaml"), "-o", str(out), "--target", "markdown")
        assert done.exit_code == 0, done.output
        text = (out / "markdown" / "demo.md").read_text()
        assert "| `value` if `kind` is `2` name |" in text
        assert "| struct | `value` otherwise |" in text
        assert "invalid" not in text.partition("`value` otherwise")[2].partition("\n\n")[0]


class TestSamples:
    @pytest.mark.parametrize(
        ("fields", "kinds"),
        [
            (
                "      kind: {type: uint8, range: [0, 3]}\n"
                "      value: {switch: kind, cases: {0: uint8, 1: uint8, 3: uint8, else: bool}}\n",
                {0, 1, 2, 3},
            ),
            (
                "      kind: {type: uint8, values: {a: 1, b: 2, c: 9}, closed: true}\n"
                "      value: {switch: kind, cases: {a: uint8, b: uint16, else: uint64}}\n",
                {1, 2, 9},
            ),
        ],
    )
    def test_each_case_is_drawn(self, fields: str, kinds: set[int], tmp_path: Path) -> None:
        protocol = with_fields(tmp_path, fields)
        (message,) = protocol.messages
        drawn = islice(samples(message, protocol.senders[0].frame, Random(1)), 100)
        assert {values["kind"] for values, _ in drawn} == kinds


class TestDialects:
    @pytest.mark.parametrize(
        ("change", "expected"),
        [
            ("{remove: [else]}", [1, 2]),
            ("{3: uint8}", [1, 2, 3, None]),
            ("{else: {replace: true, type: uint32}}", [1, 2, None]),
        ],
    )
    def test_take_it_away_or_add_to_it(
        self, change: str, expected: list[Any], tmp_path: Path
    ) -> None:
        with_fields(tmp_path)
        path = tmp_path / "dialect.yaml"
        path.write_text(
            "protocol: dialect\nextends: demo.yaml\n"
            f"messages: {{m: {{fields: {{value: {{cases: {change}}}}}}}}}\n"
        )
        switch = switch_of(protocol_of(path))
        assert [case.value for case in switch.cases] == expected
