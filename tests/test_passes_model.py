"""Models that the passes make of a schema: types, places, bounds, names, parts."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from passes_support import HEAD, SCHEMAS, protocol_of

from protogen.compiler import compile_file
from protogen.model.checksums import ChecksumSpec
from protogen.model.expressions import named
from protogen.model.parts import (
    ChecksumPart,
    CounterPart,
    IdentityPart,
    LengthPart,
    LiteralPart,
    Part,
    PayloadPart,
    ValuePart,
)
from protogen.model.protocol import Link, Protocol
from protogen.model.sizes import SizeSet
from protogen.model.transparency import Base16, Cobs, Escape, Substitution
from protogen.model.types import (
    Array,
    Counted,
    Field,
    Fill,
    Fixed,
    Float,
    Integer,
    Octets,
    Struct,
    Switch,
    Text,
)

SLIP = """\
frame: {id: {type: uint8, id: true}, payload: {}, end: {literal: 0xC0}}
transparency: slip
"""
LENGTH = """\
frame:
  id: {type: uint8, id: true}
  length: {type: uint8, counts: payload}
  payload: {}
  check: {type: uint8, algorithm: xor-8, covers: id..payload}
"""


def with_fields(fields: str, more: str = "", frame: str = SLIP) -> Protocol:
    message = f"messages:\n  gyro: {{id: 1, from: robot, fields: {{{fields}}}}}\n"
    return protocol_of(HEAD + frame + more + message)


def fields_of(fields: str, more: str = "", frame: str = SLIP) -> dict[str, Field]:
    return {field.name: field for field in with_fields(fields, more, frame).messages[0].fields}


def one(field: str, more: str = "", frame: str = SLIP) -> Field:
    return fields_of(f"a: {field}", more, frame)["a"]


class TestTypes:
    @pytest.mark.parametrize(
        ("name", "expected"),
        [
            ("uint8", Integer(bits=8)),
            ("sint1", Integer(bits=1, signed=True)),
            ("uint12", Integer(bits=12, byte_order="little")),
            ("sint64", Integer(bits=64, signed=True, byte_order="little")),
            ("byte", Integer(bits=8, role="byte")),
            ("char", Integer(bits=8, role="char")),
            ("bool", Integer(bits=1, role="bool")),
            ("float32", Float(bits=32)),
            ("float64", Float(bits=64)),
            ("{type: ascii, size: 5}", Text(extent=Fixed(count=5))),
            ("{type: bytes, size: 5}", Octets(extent=Fixed(count=5))),
            ("{type: uint8, count: 3}", Array(element=Integer(bits=8), extent=Fixed(count=3))),
        ],
    )
    def test_built_in(self, name: str, expected: Any) -> None:
        assert one(name).type == expected

    @pytest.mark.parametrize(
        ("name", "size"),
        [("uint7", 1), ("uint8", 2), ("uint14", 2), ("char", 1), ("bool", 1), ("float32", 5)],
    )
    def test_seven_bits_a_byte(self, name: str, size: int) -> None:
        frame = "byte_bits: 7\n" + SLIP.replace("uint8", "byte")
        assert one(name, frame=frame).size == size
        assert one("byte", frame=frame).type == Integer(bits=8, role="byte")
        assert one("char", frame=frame).type == Integer(bits=7, byte_bits=7, role="char")

    def test_a_declared_type_with_the_keys_of_its_use_on_top(self) -> None:
        types = "types: {angle: {type: sint16, scale: 1/16, unit: deg, doc: An angle.}}\n"
        plain = one("angle", types)
        assert (plain.type, plain.scale, plain.unit) == (
            Integer(bits=16, signed=True),
            Fraction(1, 16),
            "deg",
        )
        changed = one("{type: angle, unit: rad, count: 2, doc: Two angles.}", types)
        assert (changed.unit, changed.scale, changed.about.doc) == (
            "rad",
            Fraction(1, 16),
            "Two angles.",
        )
        assert changed.size == 4

    def test_a_declared_type_may_be_another_one(self) -> None:
        types = "types: {raw: uint8, code: {type: raw, values: {idle: 0}}, state: code}\n"
        type_ = one("state", types).type
        assert isinstance(type_, Integer)
        assert type_.enum is not None
        assert type_.enum.values[0].name == "idle"

    def test_named_types_come_in_the_order_of_first_use_and_inner_ones_first(self) -> None:
        protocol = with_fields(
            "second: point, first: {fields: {x: {type: uint8, values: {none_seen: 0}}}}, "
            "state: {type: uint8, flags: {ready: 0}}",
            "types: {point: {fields: {at: position}}, position: {fields: {x: uint8}}}\n",
        )
        assert [struct.name for struct in protocol.structs] == ["position", "point", "gyro_first"]
        assert [enum.name for enum in protocol.enums] == ["gyro_first_x"]
        assert [flags.name for flags in protocol.flags] == ["gyro_state"]

    def test_one_declared_type_of_two_fields_is_one_type(self) -> None:
        protocol = with_fields("a: mode, b: mode", "types: {mode: {type: uint8, values: {x: 0}}}\n")
        assert [enum.name for enum in protocol.enums] == ["mode"]

    def test_bit_ranges(self) -> None:
        type_ = one("{type: uint8, bits: {low: 0..5, top: {bits: 6..7, values: {x: 3}}}}").type
        assert isinstance(type_, Integer)
        low, top = type_.bit_fields
        assert (low.mask, top.mask) == (0b0011_1111, 0b1100_0000)
        assert top.enum is not None
        assert top.enum.name == "gyro_a_top"


class TestByteOrder:
    TEXT = """\
protocol: demo
endpoints: {host: Host, robot: Robot}
byte_order: {host: little, robot: big}
frame:
  id: {type: uint8, id: true}
  payload: {}
  check: {type: uint16, algorithm: CRC-16/KERMIT, covers: id..payload, byte_order: little}
  end: {literal: 0xC0}
transparency: slip
types:
  pair: {byte_order: little, fields: {x: uint16, y: {type: uint16, byte_order: big}}}
messages:
  ask: {id: 1, from: host, fields: {a: uint16}}
  tell:
    id: 2
    from: robot
    fields: {a: uint16, b: {type: uint16, byte_order: little}, c: pair, d: float32}
  turned: {id: 3, from: robot, byte_order: little, fields: {a: uint16}}
"""

    def test_the_innermost_statement_holds(self) -> None:
        protocol = protocol_of(self.TEXT)
        order = {
            f"{message.name}.{field.name}": getattr(field.type, "byte_order", None)
            for message in protocol.messages
            for field in message.fields
        }
        assert order == {
            "ask.a": "little",
            "tell.a": "big",
            "tell.b": "little",
            "tell.c": None,
            "tell.d": "big",
            "turned.a": "little",
        }
        (pair,) = protocol.structs
        assert [getattr(field.type, "byte_order", "") for field in pair.fields] == ["little", "big"]

    def test_a_part_has_its_own(self) -> None:
        check = protocol_of(self.TEXT).sender("robot").frame.checksums[0]
        assert check.type.byte_order == "little"


class TestPlaces:
    def test_positions_are_counted_until_a_size_varies(self) -> None:
        fields = fields_of(
            "a: uint8, b: uint32, n: uint8, c: {type: uint16, count: n}, d: uint8",
        )
        positions = {name: field.position for name, field in fields.items()}
        assert positions == {"a": 0, "b": 1, "n": 5, "c": 6, "d": None}

    def test_positions_in_a_struct_count_from_its_start(self) -> None:
        field = fields_of("a: uint16, s: {fields: {x: uint8, y: uint8}}")["s"]
        assert field.position == 2
        assert isinstance(field.type, Struct)
        assert [inner.position for inner in field.type.fields] == [0, 1]


class TestExtents:
    def test_a_counting_field_bounds_by_its_range(self) -> None:
        type_ = fields_of("n: {type: uint8, range: [2, 9]}, a: {type: uint16, count: n}")["a"].type
        assert type_ == Array(
            element=Integer(bits=16), extent=Counted(by=named("n"), least=2, greatest=9)
        )
        assert type_.sizes == SizeSet.between(4, 18, 2)

    def test_a_count_is_bounded_by_what_the_frame_can_hold(self) -> None:
        # 255 bytes of payload, one of them the count: 254, or 127 elements of two bytes.
        fields = fields_of("n: uint8, a: {type: uint16, count: n}", frame=LENGTH)
        assert fields["a"].type.extent == Counted(by=named("n"), least=0, greatest=127)  # type: ignore[union-attr]

    @pytest.mark.parametrize(
        ("fields", "greatest"),
        [
            ("a: {type: bytes, size: fill}", 255),
            ("n: uint16, a: {type: uint16, count: fill}", 126),
            ("n: uint16, a: {type: uint16, count: {fill: true, max: 5}}", 5),
            ("s: {fields: {n: uint8, a: {type: ascii, size: fill}}}", 254),
        ],
    )
    def test_a_fill_takes_what_is_left(self, fields: str, greatest: int) -> None:
        message = with_fields(fields, frame=LENGTH).messages[0]
        field = message.fields[-1]
        if isinstance(field.type, Struct):
            field = field.type.fields[-1]
        assert field.type.extent == Fill(greatest=greatest)  # type: ignore[union-attr]

    def test_a_field_of_a_struct_around_may_count(self) -> None:
        fields = fields_of(
            "n: {type: uint8, range: [0, 3]}, s: {fields: {a: {type: uint8, count: n}}}"
        )
        assert fields["s"].type.sizes == SizeSet.between(0, 3)


class TestSwitches:
    SWITCH = (
        "kind: {type: uint8, values: {reset: 1, speed: 2}}, "
        "value: {switch: kind, cases: {reset: {fields: {}}, 2: uint16, 7: {fields: {x: uint8}}}}"
    )

    def switch(self, more: str = "", frame: str = SLIP) -> Switch:
        type_ = fields_of(self.SWITCH + more, frame=frame)["value"].type
        assert isinstance(type_, Switch)
        return type_

    def test_cases_are_called_by_the_enum_or_their_number(self) -> None:
        cases = self.switch().cases
        assert [(case.value, case.name) for case in cases] == [
            (1, "reset"),
            (2, "speed"),
            (7, "case_7"),
        ]
        assert [case.type.sizes.fixed for case in cases] == [0, 2, 1]

    def test_a_case_of_one_type_is_a_struct_of_one_value(self) -> None:
        speed = self.switch().cases[1].type
        assert isinstance(speed, Struct)
        assert speed.name == "gyro_value_speed"
        assert [field.name for field in speed.fields] == ["value"]

    def test_the_rest_is_kept_where_the_frame_ends_it(self) -> None:
        # A length part bounds it by the frame: 255 bytes without the kind.
        assert self.switch(frame=LENGTH).rest == 254
        # With an end only, it is as long as the longest case.
        assert self.switch().rest == 2
        # It can't be told where something follows.
        assert self.switch(", more: uint8").rest is None

    def test_a_character_chooses(self) -> None:
        type_ = fields_of("k: char, v: {switch: k, cases: {A: uint8, 0x42: uint8}}")["v"].type
        assert isinstance(type_, Switch)
        assert [case.value for case in type_.cases] == [0x41, 0x42]


class TestMeaning:
    @pytest.mark.parametrize(
        ("field", "expected"),
        [
            ("{type: uint8, const: 5}", 5),
            ("{type: char, const: A}", 0x41),
            ("{type: bool, const: true}", 1),
            ("{type: uint8, values: {idle: 3}, const: idle}", 3),
            ("{type: float32, const: 1.5}", 1.5),
            ("{type: float32, const: 2}", 2.0),
            ("{type: ascii, size: 4, const: abc}", "abc"),
            ("{type: bytes, size: 2, const: {hex: 01 FF}}", b"\x01\xff"),
            ("{type: bytes, size: 2, const: [1, 255]}", b"\x01\xff"),
            ("{type: uint16, count: 2, const: [1, 300]}", (1, 300)),
            ("{type: uint8, count: 2, const: {hex: 01 02}}", (1, 2)),
        ],
    )
    def test_constants_are_raw_values(self, field: str, expected: object) -> None:
        assert one(field).const == expected
        assert one(field.replace("const", "default")).default == expected

    def test_bounds_are_the_range_or_what_the_bits_hold(self) -> None:
        def bounds(field: str) -> tuple[object, object, bool]:
            made = one(field)
            return made.least, made.greatest, made.ranged

        assert bounds("sint8") == (-128, 127, False)
        assert bounds("{type: sint8, range: [-5, 5]}") == (-5, 5, True)
        assert bounds("{type: uint8, count: 2, range: [1, 2]}") == (1, 2, True)
        assert bounds("float32") == (None, None, False)
        assert bounds("{type: float32, range: [-1/2, 1/2]}") == (
            Fraction(-1, 2),
            Fraction(1, 2),
            True,
        )

    def test_scale_and_offset_are_exact(self) -> None:
        field = one("{type: uint8, scale: 0.1, offset: -273.15, unit: K}")
        assert (field.scale, field.offset, field.unit) == (
            Fraction(1, 10),
            Fraction(-27315, 100),
            "K",
        )
        assert field.scaled
        assert not one("uint8").scaled

    def test_special_values(self) -> None:
        field = one("{type: sint16, special: {no_echo: 0x7FFE}}")
        assert [(item.name, item.value) for item in field.special] == [("no_echo", 0x7FFE)]


class TestFrames:
    TEXT = """\
protocol: demo
endpoints: {host: Host, robot: Robot, mute: Says nothing}
byte_order: big
frame:
  sync: {literal: {hex: AA 55}, unprotected: accepted, doc: Two bytes.}
  length: {type: uint16, counts: [length, counter, kind, payload], range: [4, 300]}
  counter: {type: uint8, counter: true, default: 1}
  kind: {type: uint8, id: true, range: [1, 9]}
  flavour: {type: uint8, range: [0, 3]}
  payload: {}
  check:
    type: uint16
    algorithm: {width: 16, poly: 0x8005, init: 1, refin: true, refout: true, xorout: 2}
    covers: length..payload
    over: wire
    when: payload
messages:
  gyro: {id: 1, from: [robot, host], fields: {angle: uint16}}
decisions: {accepted: {question: Q, document: D, choice: C, because: B}}
"""

    def test_parts_have_roles(self) -> None:
        parts: dict[str, Part] = {
            part.name: part for part in protocol_of(self.TEXT).sender("robot").frame.parts
        }
        sync, length, counter = parts["sync"], parts["length"], parts["counter"]
        assert isinstance(sync, LiteralPart)
        assert (sync.bytes, sync.unprotected, sync.about.doc) == (
            b"\xaa\x55",
            "accepted",
            "Two bytes.",
        )
        assert isinstance(length, LengthPart)
        assert length.counts == ("length", "counter", "kind", "payload")
        assert (length.least, length.greatest, length.type.byte_order) == (4, 300, "big")
        assert isinstance(counter, CounterPart)
        assert counter.default == 1
        assert isinstance(parts["kind"], IdentityPart)
        assert isinstance(parts["flavour"], ValuePart)
        assert isinstance(parts["payload"], PayloadPart)

    def test_a_checksum_by_parameters(self) -> None:
        (check,) = protocol_of(self.TEXT).sender("host").frame.checksums
        assert isinstance(check, ChecksumPart)
        assert check.covers == ("length", "counter", "kind", "flavour", "payload")
        assert (check.over_wire, check.when_payload) == (True, True)
        assert check.algorithm == ChecksumSpec(
            "CRC", "crc", 16, poly=0x8005, init=1, refin=True, refout=True, xorout=2
        )

    def test_who_sends_nothing_is_no_sender(self) -> None:
        protocol = protocol_of(self.TEXT)
        assert [sender.name for sender in protocol.senders] == ["host", "robot"]
        assert [endpoint.name for endpoint in protocol.endpoints] == ["host", "robot", "mute"]
        assert protocol.message("gyro").senders == ("robot", "host")

    @pytest.mark.parametrize(
        ("transparency", "encoding"),
        [
            ("slip", Substitution(table=((0xC0, b"\xdb\xdc"), (0xDB, b"\xdb\xdd")))),
            ("hdlc", Escape(byte=0x7D, of=(0x7D, 0x7E), xor=0x20)),
            ("{encoding: base16-upper}", Base16()),
            ("{encoding: cobs}", Cobs()),
            (
                "{escape: {byte: 0x56, of: [0x56, 0x55], transform: invert}}",
                Escape(byte=0x56, of=(0x55, 0x56), xor=0xFF),
            ),
            (
                "{escape: {byte: 0x56, of: [0x56], transform: none}}",
                Escape(byte=0x56, of=(0x56,), xor=0),
            ),
            (
                "{escape: {byte: 0x56, of: [0x56], transform: {xor: 0x20}}}",
                Escape(byte=0x56, of=(0x56,), xor=0x20),
            ),
        ],
    )
    def test_transparencies(self, transparency: str, encoding: object) -> None:
        message = "messages: {gyro: {id: 1, from: robot, fields: {a: uint8}}}\n"
        text = HEAD + LENGTH + f"transparency: {transparency}\n" + message
        found = protocol_of(text).sender("robot").frame.transparency
        assert found is not None
        assert found.encoding == encoding
        assert (found.first, found.last) == ("id", "check")

    def test_a_transparency_covers_all_between_the_outer_literals(self) -> None:
        found = with_fields("a: uint8").sender("robot").frame.transparency
        assert found is not None
        assert (found.first, found.last, found.preset) == ("id", "payload", "slip")

    def test_literals_that_stand_together_are_one_delimiter(self) -> None:
        frame = """\
frame:
  first: {literal: 0x1B}
  second: {literal: 0x02}
  id: {type: uint8, id: true}
  payload: {}
  third: {literal: 0x1B}
  fourth: {literal: 0x03}
transparency: {substitute: {0x1B: [0x1B, 0x00]}}
"""
        framing = with_fields("a: uint8", frame=frame).sender("robot").framing
        assert framing.start.bytes == b"\x1b\x02"  # type: ignore[union-attr]
        assert framing.end is not None
        assert (framing.end.bytes, framing.end.protected) == (b"\x1b\x03", True)


class TestMessages:
    def test_an_unspecified_payload_is_one_field_of_bytes(self) -> None:
        text = (
            HEAD + SLIP + "messages:\n"
            "  bounded: {id: 1, from: robot, fields: unspecified, min_size: 2, max_size: 9}\n"
        )
        message = protocol_of(text).message("bounded")
        assert message.unspecified
        assert message.sizes == SizeSet.between(2, 9)
        (field,) = message.fields
        assert (field.name, field.unknown, field.type) == (
            "data",
            True,
            Octets(extent=Fill(greatest=9)),
        )

    def test_a_length_part_bounds_it(self) -> None:
        text = HEAD + LENGTH + "messages: {raw: {id: 1, from: robot, fields: unspecified}}\n"
        assert protocol_of(text).message("raw").sizes == SizeSet.between(0, 255)

    def test_identities_by_part_in_wire_order(self) -> None:
        frame = SLIP.replace(
            "id: {type: uint8, id: true}",
            "class_id: {type: uint8, id: true}, letter: {type: char, id: true}",
        )
        message = "messages: {gyro: {id: {letter: A, class_id: 2}, from: robot}}\n"
        assert protocol_of(HEAD + frame + message).message("gyro").identity == (2, 0x41)

    def test_overloads_exchanges_and_decisions(self) -> None:
        text = (
            HEAD
            + SLIP
            + (
                "messages:\n"
                "  brief: {id: 1, from: robot, fields: {a: uint8}}\n"
                "  wordy: {id: 1, from: robot, fields: {a: uint16}}\n"
                "  halt: {id: 1, from: host}\n"
                "  pause: {id: 1, from: host}\n"
                "overloads:\n"
                "  sizes: {messages: [brief, wordy], by: size}\n"
                "  stops: {messages: [halt, pause], by: undecidable, yields: halt, decision: why}\n"
                "exchanges:\n"
                "  start: {title: Start, steps: [halt, {message: brief, doc: At last.}]}\n"
                "decisions:\n"
                "  why: {question: Q , document: D, choice: C, because: B, source: 3-4}\n"
            )
        )
        protocol = protocol_of(text)
        (sizes,) = protocol.sender("robot").overloads
        (stops,) = protocol.sender("host").overloads
        assert (sizes.messages, sizes.yields) == (("brief", "wordy"), None)
        assert (stops.messages, stops.yields, stops.decision) == (("halt", "pause"), "halt", "why")
        (exchange,) = protocol.exchanges
        assert exchange.title == "Start"
        assert [(step.message, step.about.doc) for step in exchange.steps] == [
            ("halt", ""),
            ("brief", "At last."),
        ]
        (decision,) = protocol.decisions
        assert decision.source is not None
        assert (decision.name, decision.question, decision.source.lines) == ("why", "Q", "3-4")

    def test_examples(self) -> None:
        text = (
            HEAD
            + SLIP
            + (
                "content_covers: id..payload\n"
                "messages:\n"
                "  gyro:\n"
                "    id: 1\n"
                "    from: robot\n"
                "    fields: {a: uint8}\n"
                "    examples:\n"
                "      whole: {frame: {hex: 01 05 C0}, values: {a: 5}, doc: Whole.}\n"
                "      inner: {content: [1, 5], values: {a: 5}}\n"
                "      payload: {content: 5, covers: payload, values: {a: 5}}\n"
            )
        )
        whole, inner, payload = protocol_of(text).message("gyro").examples
        assert (whole.bytes, whole.covers, whole.sender) == (b"\x01\x05\xc0", None, "robot")
        assert (inner.bytes, inner.covers) == (b"\x01\x05", ("id", "payload"))
        assert (payload.bytes, payload.covers) == (b"\x05", ("payload",))
        assert (whole.about.doc, whole.values) == ("Whole.", {"a": 5})


class TestProtocol:
    def test_titles_fall_back_to_names(self) -> None:
        protocol = with_fields("a: uint8")
        assert (protocol.title, protocol.messages[0].title) == ("demo", "gyro")
        assert protocol.version is None
        assert protocol.files == ("schema.yaml",)

    def test_link(self) -> None:
        link = "link: {baud: 9600, parity: even, stop_bits: 2, data_bits: 7, idle_timeout: 20 ms}\n"
        found = with_fields("a: uint8", link).link
        assert found == Link(
            baud=9600, data_bits=7, parity="even", stop_bits=2, idle_timeout=Fraction(1, 50)
        )
        assert found.bits_per_byte == 11

    def test_files_are_the_schema_and_its_bases(self) -> None:
        protocol = compile_file(SCHEMAS / "dialects" / "matty_v4.yaml").protocol
        assert protocol is not None
        assert protocol.files == ("matty_v4.yaml", "matty.yaml")

    def test_unknown_names_are_not_found(self) -> None:
        protocol = with_fields("a: uint8")
        with pytest.raises(KeyError, match="nobody"):
            protocol.sender("nobody")
        with pytest.raises(KeyError, match="nothing"):
            protocol.message("nothing")
        with pytest.raises(KeyError, match="none"):
            protocol.sender("robot").frame.part("none")


def test_a_switch_in_a_type_that_nobody_uses_may_yet_end_anything() -> None:
    """`pair` has it at its end and elsewhere, which matters only where a payload ends with it."""
    protocol_of(
        """\
protocol: demo
endpoints: {host: Host, robot: Robot}
frame: {id: {type: uint8, id: true}, payload: {}, end: {literal: 0xC0}}
transparency: slip
types:
  tagged: {fields: {kind: uint8, value: {switch: kind, cases: {1: uint8}}}}
  pair: {fields: {first: tagged, second: tagged}}
messages:
  alone: {id: 1, from: robot, fields: {a: uint8}}
"""
    )
