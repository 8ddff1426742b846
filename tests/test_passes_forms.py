"""What the compiler works out about several forms of frame."""

from __future__ import annotations

import pytest
from passes_support import HEAD, compile_text, protocol_of

FORMS = """\
forms:
  first:
    frame:
      start:   {literal: 0x3A}
      kind:    {type: uint8, id: true}
      payload: {}
      end:     {literal: 0x0A}
    transparency: {encoding: base16-upper}
  second:
    frame:
      start:   {literal: SECOND}
      length:  {type: uint8, counts: payload}
      kind:    {type: uint8, id: true}
      payload: {}
    transparency: {escape: {byte: 0x7D, of: [0x7D, SECOND], transform: {xor: 0x20}}}
messages:
  go: {id: 1, from: robot, fields: {speed: uint8}}
"""


class TestSynchronisation:
    def test_a_start_that_another_form_can_hold_may_be_a_false_one(self) -> None:
        first, second = protocol_of(HEAD + FORMS.replace("SECOND", "0x7E")).senders
        assert not first.framing.self_synchronising, "3A may stand in a payload of the second form"
        assert "frames of the form `second`" in first.framing.why_synchronising
        assert second.framing.self_synchronising, "7E is no digit"

    def test_the_start_of_the_second_may_be_one_that_the_first_can_hold(self) -> None:
        _, second = protocol_of(HEAD + FORMS.replace("SECOND", "0x46")).senders
        assert not second.framing.self_synchronising, "46 is the digit F"

    @pytest.mark.parametrize("start", ["0x7E", "{hex: 7E 7E}", "{hex: 55 7E}"])
    def test_what_all_forms_begin_with_is_no_false_start(self, start: str) -> None:
        senders = protocol_of(HEAD + ALIKE.replace("START", start)).senders
        assert [sender.framing.self_synchronising for sender in senders] == [True] * 3

    @pytest.mark.parametrize("start", ["0x7E", "{hex: 7E 7E}", "{hex: 55 7E}"])
    def test_a_start_behind_another_literal_is_one(self, start: str) -> None:
        text = ALIKE.replace("{start: {literal: START}, mark", "{first: {literal: START}, mark")
        text = text.replace(
            "{first: {literal: START}, mark: {literal: 0xF0}",
            "{first: {literal: 0x0A}, mark: {literal: START}",
        )
        first, second, third = protocol_of(HEAD + text.replace("START", start)).senders
        assert not first.framing.self_synchronising
        assert not second.framing.self_synchronising
        assert "frames of the form `third`" in first.framing.why_synchronising
        assert third.framing.self_synchronising


ALIKE = """\
forms:
  first:
    frame: {start: {literal: START}, length: {type: uint8, counts: payload, range: [0, 9]},
            id: {type: uint8, id: true}, payload: {}}
    transparency: {covers: id..payload, escape: ESCAPE}
  second:
    frame: {start: {literal: START}, length: {type: uint8, counts: payload, range: [10, 50]},
            id: {type: uint8, id: true}, payload: {}}
    transparency: {covers: id..payload, escape: ESCAPE}
  third:
    frame: {start: {literal: START}, mark: {literal: 0xF0}, length: {type: uint8, counts: payload},
            id: {type: uint8, id: true}, payload: {}}
    transparency: {covers: length..payload, escape: ESCAPE}
messages:
  go: {id: 1, from: robot, fields: {data: {type: bytes, size: fill}}}
""".replace("ESCAPE", "{byte: 0x7D, of: [0x0A, 0x55, 0x7D, 0x7E], transform: {xor: 0x20}}")
"""Three forms with one literal at their beginning, which occurs nowhere else."""


class TestMessages:
    def test_a_form_whose_length_can_not_say_a_size_does_not_carry_the_message(self) -> None:
        text = FORMS.replace("SECOND", "0x7E").replace(
            "counts: payload}", "counts: payload, range: [2, 9]}"
        )
        first, second, *others = protocol_of(
            HEAD + text + "  note: {id: 2, from: robot, fields: {a: uint32}}\n"
        ).senders
        assert [message.name for message in first.messages] == ["go", "note"]
        assert [message.name for message in second.messages] == ["note"]
        assert others == []

    def test_forms_of_different_endpoints_are_frames_of_their_own(self) -> None:
        text = FORMS.replace("SECOND", "0x7E")
        text = text.replace("  first:", "  first:\n    from: host").replace(
            "  second:", "  second:\n    from: robot"
        )
        protocol = protocol_of(HEAD + text + "  stop: {id: 2, from: host}\n")
        assert [sender.name for sender in protocol.senders] == ["host", "robot"]
        assert all(sender.is_only_form for sender in protocol.senders)


RANGES = """\
forms:
  bare:
    frame:
      start:   {literal: 0x7E, unprotected: any}
      FIRST
      kind:    {type: uint8, id: true}
      payload: {}
      crc:     {type: uint16, algorithm: CRC-16/IBM-SDLC, covers: kind..payload}
  full:
    frame:
      start:   {literal: 0x7E, unprotected: any}
      SECOND
      kind:    {type: uint8, id: true}
      check:   {type: uint8, algorithm: xor-8, covers: kind}
      payload: {}
      crc:     {type: uint16, algorithm: CRC-16/IBM-SDLC, covers: kind..payload}
messages:
  data: {id: 1, from: robot, fields: {data: {type: bytes, size: {fill: true, max: 9}}}}
decisions:
  any: {question: What of data?, document: No., choice: Look on., because: Rare.}
"""
BITS = (
    "size: {type: uint16, byte_order: big, "
    "bits: {mark: {bits: 12..15, const: 10}, n: {bits: BITS, counts: size..crc, range: RANGE}}}"
)
WHOLE = "n: {type: uint16, counts: kind..crc, range: RANGE}"


class TestRangesOfLengths:
    """`bare` has a length of 3, as its payload is empty, and `full` of 5 and more."""

    @staticmethod
    def codes(first: str, second: str) -> list[str]:
        text = HEAD + RANGES.replace("FIRST", first).replace("SECOND", second)
        return [problem.code for problem in compile_text(text).problems]

    @staticmethod
    def bits(bounds: str, place: str = "0..10") -> str:
        return BITS.replace("RANGE", bounds).replace("BITS", place)

    def test_bits_tell_as_whole_parts_do(self) -> None:
        assert self.codes(self.bits("[5, 5]"), self.bits("[7, 2047]")) == []
        for order in ("big", "little"):
            first, second = (
                WHOLE.replace("RANGE", bounds).replace("uint16", f"uint16, byte_order: {order}")
                for bounds in ("[3, 3]", "[5, 500]")
            )
            assert self.codes(first, second) == []

    def test_ranges_that_overlap_do_not_tell(self) -> None:
        assert self.codes(self.bits("[5, 7]"), self.bits("[7, 2047]")) == ["PG173"]

    def test_lengths_in_other_places_do_not_tell(self) -> None:
        assert self.codes(self.bits("[5, 5]", "0..9"), self.bits("[7, 2047]")) == ["PG173"]
        low = WHOLE.replace("RANGE", "[5, 500]").replace("uint16", "uint16, byte_order: little")
        high = WHOLE.replace("RANGE", "[3, 3]").replace("uint16", "uint16, byte_order: big")
        assert self.codes(high, low) == ["PG173"]
