"""Schemas whose names and shapes meet something in the generated Python."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import pytest

import protogen

HEAD = """\
protocol: corner
endpoints: {a: A, b: B}
byte_order: little
frame:
  sync: {literal: 0x55, unprotected: accepted}
  ident: {type: uint8, id: true}
  payload: {}
  end: {literal: 0xAA, unprotected: accepted}
decisions:
  accepted: {question: May it occur in the data?, document: Silent., choice: Yes., because: It can.}
"""


@pytest.fixture
def compiled(tmp_path: Path, request: pytest.FixtureRequest) -> ModuleType:
    schema = tmp_path / "corner.yaml"
    schema.write_text(HEAD + request.param)
    return protogen.module_of(protogen.load(schema))


EMPTY = """\
types: {nothing: {fields: {}}}
messages:
  ping:
    id: 1
    from: a
    fields: {one: nothing, two: {fields: {}}, three: {fields: {}, count: 2}, x: uint8}
"""


@pytest.mark.parametrize("compiled", [EMPTY], indirect=True)
def test_a_struct_without_fields_takes_no_bytes(compiled: ModuleType) -> None:
    values = {"one": {}, "two": {}, "three": [{}, {}], "x": 7}
    ping = compiled.Ping.from_dict(values)
    assert ping.to_payload() == b"\x07"
    assert compiled.Ping.from_payload(b"\x07") == ping
    assert ping.to_dict() == values


SHADOWED = """\
messages:
  ping:
    id: 1
    from: a
    fields:
      bytes: {type: uint8, default: 1}
      value: {type: bytes, size: 2, const: {hex: BA 0D}}
"""


@pytest.mark.parametrize("compiled", [SHADOWED], indirect=True)
def test_a_field_may_be_called_like_a_built_in_type(compiled: ModuleType) -> None:
    assert compiled.Ping().to_payload() == bytes.fromhex("01 BA 0D")


OUTER = """\
messages:
  ping:
    id: 1
    from: a
    fields:
      kind: uint8
      choice:
        switch: kind
        cases:
          1: {fields: {kind: {switch: kind, cases: {1: uint16}}}}
          2: {fields: {data: {type: uint8, count: kind}, kind: uint8}}
"""


@pytest.mark.parametrize("compiled", [OUTER], indirect=True)
def test_a_field_is_chosen_by_what_stands_in_front_of_it(compiled: ModuleType) -> None:
    """Neither the field's own name nor that of one behind it hides the outer field."""
    named_alike = compiled.Ping.from_dict({"kind": 1, "choice": {"kind": {"value": 5}}})
    # kind 1, then the uint16 5, least significant byte first.
    assert named_alike.to_payload() == bytes.fromhex("01 05 00")
    counted = compiled.Ping.from_dict({"kind": 2, "choice": {"data": [8, 9], "kind": 3}})
    # kind 2, so two numbers, then the inner kind.
    assert counted.to_payload() == bytes.fromhex("02 08 09 03")
    assert compiled.Ping.from_payload(bytes.fromhex("02 08 09 03")) == counted


FLAGS = """\
messages:
  ping: {id: 1, from: a, fields: {state: {type: uint7, flags: {on: 0, hot: 1}}}}
"""


@pytest.mark.parametrize("compiled", [FLAGS], indirect=True)
def test_flags_are_never_negative(compiled: ModuleType) -> None:
    """Python takes -1 for all flags; on the wire that would be another value."""
    with pytest.raises(ValueError, match=r"state: -1 is not in 0\.\.127"):
        compiled.Ping.from_dict({"state": -1})
    with pytest.raises(ValueError, match="state"):
        compiled.Ping(state=-1).to_payload()


COUNTED = """\
messages:
  ping:
    id: 1
    from: a
    fields:
      number: {type: uint8, range: [0, 2]}
      data: {type: uint8, count: number}
      rest: {type: uint8, count: {fill: true, max: 4}}
"""


@pytest.mark.parametrize("compiled", [COUNTED], indirect=True)
def test_a_number_counts_no_more_than_its_range(compiled: ModuleType) -> None:
    """A receiver in C has room for no more, so no receiver takes it."""
    assert compiled.Ping.from_payload(bytes.fromhex("02 07 08")).data == [7, 8]
    with pytest.raises(ValueError, match="number counts 0 to 2, not 3"):
        compiled.Ping.from_payload(bytes.fromhex("03 07 08 09"))


STUFFED = """\
protocol: corner
endpoints: {a: A, b: B}
byte_order: little
frame:
  sync: {literal: 0x55}
  length: {type: uint8, counts: [ident, payload]}
  ident: {type: uint8, id: true}
  payload: {}
transparency: {covers: length..payload, escape: {byte: 0x56, of: [0x55, 0x56], transform: invert}}
messages:
  index_error: {id: 1, from: a, fields: {x: uint8}}
  type_error: {id: 2, from: a, fields: {x: uint8}}
  exception: {id: 3, from: a, fields: {x: uint8}}
"""


def test_a_message_may_be_called_like_an_exception(tmp_path: Path) -> None:
    """Generated code still catches the exception then."""
    schema = tmp_path / "corner.yaml"
    schema.write_text(STUFFED)
    module = protogen.module_of(protogen.load(schema))
    decoder = module.Decoder("a")
    frame = module.encode(module.IndexError(x=7))
    assert decoder.feed(b"") == []
    (event,) = decoder.feed(frame + frame[:1])
    assert event.message == module.IndexError(x=7)
    assert [event.reason for event in (*decoder.feed(b""), *decoder.flush())] == ["truncated"]


OVERLOADED = """\
overloads: {sized: {messages: [brief, full], by: size}}
messages:
  brief: {id: 1, from: a, fields: {x: uint8}}
  full: {id: 1, from: a, fields: {x: uint16}}
  a_1: {id: 2, from: a, fields: {y: uint8}}
"""


@pytest.mark.parametrize("compiled", [OVERLOADED], indirect=True)
def test_a_message_may_be_called_like_an_identity(compiled: ModuleType) -> None:
    """The messages of identity 1 of `a`, told by size, hide none that is called `a_1`."""
    for message in (compiled.Brief(x=3), compiled.Full(x=3), compiled.A1(y=3)):
        frame = compiled.encode(message)
        assert compiled.decode(frame, "a") == message
        assert compiled.decode(frame, "a", engine="construct") == message
        (event,) = compiled.Decoder("a").feed(frame)
        assert event.message == message


def test_a_sender_of_thousands_of_messages_can_be_imported(tmp_path: Path) -> None:
    """Python compiles only so many nested operators, and `A | B | C` nests."""
    messages = (f"  m{i}: {{id: {i}, from: a, fields: {{x: uint8}}}}\n" for i in range(3001))
    head = HEAD.replace("{type: uint8, id", "{type: uint16, id")
    schema = tmp_path / "corner.yaml"
    schema.write_text(head + "messages:\n" + "".join(messages))
    module = protogen.module_of(protogen.load(schema))
    frame = bytes.fromhex("55 B8 0B 05 AA")  # 0x0BB8 is 3000.
    assert module.encode(module.M3000(x=5)) == frame
    assert module.decode(frame, "a") == module.M3000(x=5)


def test_a_switch_of_thousands_of_cases_can_be_imported(tmp_path: Path) -> None:
    """Python compiles only so many levels of `elif`, and of `A | B | C`."""
    cases = ", ".join(f"{i}: {{fields: {{x: uint8}}}}" for i in range(3000))
    schema = tmp_path / "corner.yaml"
    schema.write_text(
        f"{HEAD}messages: {{m: {{id: 1, from: a, fields: {{kind: uint16, body: "
        f"{{switch: kind, cases: {{{cases}}}}}}}}}}}\n"
    )
    module = protogen.module_of(protogen.load(schema))
    frame = bytes.fromhex("55 01 B7 0B 05 AA")  # 0x0BB7 is 2999.
    message = module.M(kind=2999, body=module.MBodyCase2999(x=5))
    assert module.encode(message) == frame
    assert module.decode(frame, "a") == message
