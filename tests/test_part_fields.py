"""Fields that are parts of the frame: what no schema of the tests says of them."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

from protogen.compiler import Compilation, compile_file
from protogen.live.codec import module_of

NAMES = ("data", "stream", "payload", "cls", "self", "class")
"""Names that what reads payloads, or Python, has for something else."""
TAKEN = """
protocol: taken
endpoints: {robot: Robot}
frame:
  sync: {literal: 0xC0}
  bits: {type: uint8, bits: {p0: 0, p1: 1, p2: 2, p3: 3, p4: 4, p5: 5..7}}
  payload: {}
  end: {literal: 0xC1}
transparency: {escape: {byte: 0xC2, of: [0xC0, 0xC1, 0xC2], transform: {xor: 0x20}}}
messages:
  state:
    from: robot
    fields:
"""
WHOLE_BYTE = """
protocol: whole
byte_bits: 7
endpoints: {robot: Robot}
frame:
  flags: {type: byte, range: [0, 0x7F]}
  payload: {}
  end: {literal: 0xFF}
messages:
  state: {from: robot, fields: {flags: {part: flags, type: byte}, level: uint7}}
"""


def compiled(text: str, folder: Path) -> Compilation:
    path = folder / "schema.yaml"
    path.write_text(text, encoding="utf-8")
    return compile_file(path)


def module_with_taken_names(folder: Path) -> ModuleType:
    fields = [
        f"      {name}: {{part: p{index}, type: uint{3 if index == 5 else 1}}}"
        for index, name in enumerate(NAMES)
    ]
    last = "      amount: {type: uint8, when: data and self}"
    protocol = compiled(TAKEN + "\n".join([*fields, last, ""]), folder).protocol
    assert protocol is not None
    return module_of(protocol)


def test_names_that_are_taken_are_escaped(tmp_path: Path) -> None:
    module = module_with_taken_names(tmp_path)
    message = module.State(data=1, stream=0, payload=1, cls=0, self_=1, class_=6, amount=7)
    frame = module.encode(message)
    # C0 starts, C1 ends. Bits 0, 2 and 4 are 1, and those from 5 on 6: D5. The amount follows.
    assert frame == bytes.fromhex("C0 D5 07 C1")
    held = {"data_": 1, "stream_": 0, "payload_": 1, "cls_": 0, "self_": 1, "class_": 6}
    assert module.State.from_payload(b"\x07", **held) == message
    assert module.State.FORMAT.parse(b"\x07", **held).amount == 7
    assert module.decode(frame) == message


def test_a_byte_of_the_frame_is_none_of_the_payload(tmp_path: Path) -> None:
    """An `FF` can stand in no payload, so it ends frames."""
    made = compiled(WHOLE_BYTE, tmp_path)
    assert [str(item.message) for item in made.problems] == []


TEXT = """
protocol: text
endpoints: {robot: Robot}
frame:
  sync: {literal: 0xEF}
  length: {type: uint8, counts: payload, range: [0, 20]}
  payload: {CUT}
messages:
  state: {from: robot, fields: {text: {type: ascii, size: SIZE, code: {bits: 7}, CONST}}}
"""


def test_newer_senders_may_have_any_byte_behind_a_text(tmp_path: Path) -> None:
    text = TEXT.replace("SIZE", "4").replace(", CONST", "")
    plain = compiled(text.replace("CUT", ""), tmp_path)
    assert [item.code for item in plain.problems] == []
    cut = compiled(text.replace("CUT", "longer: cut"), tmp_path)
    assert [item.code for item in cut.problems] == ["PG142"]


def test_newer_senders_may_have_something_behind_no_text(tmp_path: Path) -> None:
    text = TEXT.replace("SIZE", "0").replace("CONST", "const: ''").replace("CUT", "longer: cut")
    text += "transparency: {substitute: {0xEF: {hex: EE01}, 0xEE: {hex: EE02}}, covers: payload}\n"
    assert compiled(text, tmp_path).protocol is not None
