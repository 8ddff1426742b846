"""The frame plan, worked out by hand from the five documents and from small frames."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import pytest
from compiled import ROOT, protocol_of

from protogen.model.frame_places import Place, Run, Side
from protogen.model.frame_plan import EndRule, FramePlan, StartRule, Store
from protogen.model.frame_room import room
from protogen.model.parts import LiteralPart, PayloadPart
from protogen.model.transparency import Base16, Escape, Substitution


def plan_of(schema: str, sender: str) -> FramePlan:
    return protocol_of(ROOT / "schemas" / f"{schema}.yaml").sender(sender).plan


def head(offset: int) -> Place:
    return Place(Side.HEAD, offset)


def tail(offset: int, absent: int = 0) -> Place:
    return Place(Side.TAIL, offset, absent)


def test_rn1_brain_is_one_byte_of_a_set_and_a_payload_whose_size_it_tells():
    plan = plan_of("rn1", "brain")
    assert (plan.start, plan.start_is_unique) == (StartRule.SET, True)
    assert plan.start_set == tuple(range(0x80, 0xFF))
    assert (plan.end_rule, plan.end_bytes) == (EndRule.IDENTITY, b"")
    assert [(item.name, item.offset, item.size) for item in plan.head] == [("start", 0, 1)]
    assert (plan.tail, plan.checksums, plan.length, plan.region) == ((), (), None, None)
    assert plan.size_known_at == 1
    assert plan.seven_bit
    assert plan.takes_whole
    assert plan.streams
    # An unknown identity tells no size; the next start ends its frame.
    assert (plan.opens, plan.ends_at_start, plan.measures) == (True, True, False)
    assert (plan.rescans, plan.store) == (False, Store.CONTENT)


def test_rn1_host_has_an_end_of_its_own():
    plan = plan_of("rn1", "host")
    assert (plan.end_rule, plan.end_bytes) == (EndRule.DELIMITER, b"\xff")
    assert plan.end_is_unique
    assert [part.name for part in plan.end_literals] == ["stop"]
    assert plan.tail_size == 0


def test_matty_counts_behind_its_length_and_may_be_as_large_again_when_escaped():
    plan = plan_of("matty", "pc")
    assert (plan.start, plan.start_bytes, plan.start_is_unique) == (
        StartRule.LITERAL,
        b"\x55",
        True,
    )
    assert plan.end_rule is EndRule.NEXT_START  # Only the start shows before bytes are unescaped.
    places = [(item.name, item.place, item.is_stuffed) for item in plan.placed]
    assert places == [
        ("sync", head(0), False),
        ("length", head(1), True),
        ("counter", head(2), True),
        ("command", head(3), True),
        ("crc", tail(0), True),
    ]
    assert plan.length is not None
    assert (plan.length.base, plan.length.optional) == (2, 0)  # The counter and the command.
    assert plan.length.counted(3) == 5
    assert [plan.length.payload(value) for value in (1, 2, 5)] == [None, 0, 3]
    (checksum,) = plan.checksums
    assert checksum.covers == (Run(head(1), tail(0)),)  # Neighbours are one run.
    region = plan.region
    assert region is not None
    assert isinstance(region.encoding, Escape)
    # 0x55 and 0x56 are sent as 0x56 and themselves inverted.
    assert region.codes == ((0x55, b"\x56\xaa"), (0x56, b"\x56\xa9"))
    assert (region.before, region.behind, region.longest) == (1, 0, 2)
    assert (region.literals_in_front, region.reaches_end) == (True, True)
    assert plan.size_known_at == 2
    # Start, length (2 to 6) and command are none of these; counter, payload and sum can be.
    assert room(plan, 3) == 3 + 2 * (1 + 3 + 1)
    assert [item.name for item in plan.shown] == ["counter", "command"]


def test_rflex_looks_for_an_end_and_has_two_parts_of_identity():
    plan = plan_of("rflex", "flex")
    assert (plan.start_bytes, plan.end_bytes) == (b"\x1b\x02", b"\x1b\x03")
    assert plan.end_rule is EndRule.DELIMITER
    assert plan.identity_is_early
    assert plan.identity_bits == 16
    assert [(item.name, item.offset) for item in plan.head] == [
        ("start", 0),
        ("class", 2),
        ("number", 3),
        ("subclass", 4),
        ("length", 5),
    ]
    (checksum,) = plan.checksums
    assert checksum.covers == (Run(head(6), tail(0)),)
    assert plan.region is not None
    assert isinstance(plan.region.encoding, Substitution)
    assert plan.region.longest == 3
    keys = [(group.identity, group.key) for group in plan.groups]
    assert all(key == high << 8 | low for (high, low), key in keys)


def test_uherobot_counts_itself_and_travels_as_hex():
    plan = plan_of("uherobot", "daemon")
    assert plan.length is not None
    assert plan.length.base == 2  # The length and the type.
    assert plan.region is not None
    assert isinstance(plan.region.encoding, Base16)
    assert plan.region.parts == ("length", "type", "payload")
    assert room(plan, 1) == 1 + 2 * (2 + 1) + 1  # The literals in front and behind are one byte.
    assert plan.checksums == ()


def test_dagny_has_a_checksum_where_there_are_data():
    plan = plan_of("dagny", "robot")
    assert (plan.start, plan.end_bytes, plan.end_is_unique) == (StartRule.AFTER_END, b"\n", False)
    assert plan.end_rule is EndRule.IDENTITY  # A size known by identity beats looking for the end.
    (checksum,) = plan.checksums
    assert checksum.placed.is_optional
    assert checksum.placed.end_place == tail(1, absent=1)
    assert checksum.covers == (Run(head(0), tail(0)),)
    assert plan.optional_size == 1
    assert (plan.rescans, plan.store) == (True, Store.WIRE)
    assert plan.cut_ambiguous
    assert not plan.has_one_spelling


@pytest.mark.parametrize(
    ("place", "payload", "index"),
    [
        (head(2), 9, 2),
        (tail(0), 9, 12),
        (tail(4), 9, 16),
        (tail(4, absent=1), 9, 16),
        (tail(4, absent=1), 0, 6),
    ],
)
def test_a_place_behind_the_payload_moves_with_it(place: Place, payload: int, index: int):
    assert place.at(3, payload) == index


def everything() -> Iterator[tuple[str, FramePlan]]:
    folders = ("schemas", "tests/framings", "tests/stuffed_schemas", "tests/c_schemas")
    for folder in folders:
        for path in sorted((ROOT / folder).rglob("*.yaml")):
            if path.parent.name == "shared":
                continue
            for sender in protocol_of(path).senders:
                yield f"{path.stem}-{sender.name}", sender.plan


PLANS = dict(everything())


@pytest.mark.parametrize("name", PLANS)
def test_parts_fill_the_content_without_a_gap(name: str):
    plan = PLANS[name]
    for payload in {plan.payload.least, plan.payload.greatest}:
        place = 0
        for part in plan.frame.parts:
            if isinstance(part, PayloadPart):
                place += payload
            elif part in plan.end_literals or (part.is_optional and not payload):
                continue
            else:
                placed = plan.part(part.name)
                assert placed.place.at(plan.head_size, payload) == place
                place += placed.size
        absent = 0 if payload else plan.optional_size
        assert place == plan.head_size + payload + plan.tail_size - absent


@pytest.mark.parametrize("name", PLANS)
def test_a_checksum_runs_over_just_the_parts_that_it_names(name: str):
    plan = PLANS[name]
    payload = plan.payload.greatest
    sizes = {
        part.name: payload if isinstance(part, PayloadPart) else part.size
        for part in plan.frame.declared
    }
    for checksum in plan.checksums:
        runs = [run for run in checksum.covers if isinstance(run, Run)]
        spans = [
            (run.first.at(plan.head_size, payload), run.end.at(plan.head_size, payload))
            for run in runs
        ]
        literals = sum(len(run) for run in checksum.covers if isinstance(run, bytes))
        literals += sum(part.size for part in checksum.virtual)
        total = sum(sizes[covered] for covered in checksum.part.covers)
        assert sum(last - first for first, last in spans) + literals == total


@pytest.mark.parametrize(("name", "payload"), list(product(PLANS, (0, 1, 5))), ids=str)
def test_a_length_and_a_payload_tell_each_other(name: str, payload: int):
    length = PLANS[name].length
    if length is not None and payload in PLANS[name].payload:
        assert length.payload(length.counted(payload)) == payload


def test_literals_of_the_end_are_no_content():
    for plan in PLANS.values():
        ends = b"".join(part.bytes for part in plan.end_literals if isinstance(part, LiteralPart))
        assert ends.endswith(plan.end_bytes)
        assert not {part.name for part in plan.end_literals} & {item.name for item in plan.placed}
