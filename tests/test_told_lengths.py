"""Lengths that are not sent: a decoder is told them, by its program or by other frames."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from cli_support import run
from compiled import ROOT, module_at, protocol_of
from test_told import names

from protogen.capture import CaptureError, columns
from protogen.model.reading.annotate import annotate

LENGTHS = ROOT / "tests" / "told_schemas" / "lengths.yaml"
ENGINE = pytest.mark.parametrize("engine", ["fast", "construct"])

SEND_3 = bytes.fromhex("A5 01 02 03 00 06")  # Command 1, two bytes, 3; 1 + 2 + 3 = 6.
BATCH_4_4_1 = bytes.fromhex("A5 02 07 03 04 00 04 00 01 00 15")  # 2 + 7 + 3 + 4 + 4 + 1 = 21.
NEAR = bytes.fromhex("5A 01 01 07 08 9C 9B")  # Sync, kind 1, two points, checksum.
"""CRC-16/KERMIT of 01 07 08, which is worked out below, is 9B9C."""
NO_POINTS = bytes.fromhex("5A 01 01")  # Sync, kind 1; no checksum without points.
NAME = bytes.fromhex("02 41 03 42 03")  # Start, A, the byte of the end, B, end.
FAULT = bytes.fromhex("07 03 03")  # Start, code 3, end.


def kermit(data: bytes) -> int:
    """CRC-16/KERMIT, bit by bit: 0x8408 reflected, from 0."""
    found = 0
    for byte in data:
        found ^= byte
        for _ in range(8):
            found = found >> 1 ^ (0x8408 if found & 1 else 0)
    return found


def test_the_checksum_of_the_bytes_by_hand() -> None:
    assert kermit(NEAR[2:5]).to_bytes(2, "little") == NEAR[5:]


@ENGINE
def test_bare_bytes_are_as_many_as_was_told(engine: str) -> None:
    decoder = module_at(LENGTHS).Decoder("store", engine)
    decoder.tell(announced=3)
    assert decoder.feed(b"\x01\x02") == []
    (event,) = decoder.feed(b"\x03")
    assert (event.message.data, event.as_json()["parts"]) == (b"\1\2\3", {})
    assert names([*decoder.feed(b"\x04"), *decoder.flush()]) == ["invalid"]  # It was told for one.


@ENGINE
def test_blocks_of_a_file_are_told_one_after_another(engine: str) -> None:
    decoder = module_at(LENGTHS).Decoder("store", engine)
    decoder.tell(announced=[4, 4, 1])
    found = decoder.feed(bytes(range(9)))
    assert [item.raw for item in found] == [bytes(range(4)), bytes(range(4, 8)), b"\x08"]


@ENGINE
def test_commands_announce_data(engine: str) -> None:
    module = module_at(LENGTHS)
    host, store = module.Decoder("host", engine), module.Decoder("store", engine)
    for event in host.feed(SEND_3):
        store.hear(event)
    assert [item.raw for item in store.feed(b"abc")] == [b"abc"]
    for event in host.feed(BATCH_4_4_1):
        store.hear(event)
    assert [item.raw for item in store.feed(b"abcdefghi")] == [b"abcd", b"efgh", b"i"]


@ENGINE
def test_nothing_is_a_frame_before_anything_is_told(engine: str) -> None:
    decoder = module_at(LENGTHS).Decoder("store", engine)
    events = [*decoder.feed(b"abc"), *decoder.flush()]
    assert [(item.kind, item.raw) for item in events] == [("invalid", b"abc")]


@ENGINE
def test_a_length_counts_other_parts_as_well(engine: str) -> None:
    decoder = module_at(LENGTHS).Decoder("radar", engine)
    (event,) = decoder.feed(NEAR)  # The default is 5: a kind, two points, the checksum.
    assert event.message.points == [7, 8]
    decoder.tell(width=1)
    (event,) = decoder.feed(NO_POINTS)
    assert event.message.points == []
    with pytest.raises(ValueError, match=r"width can't be 3: it is from 1 to 22"):
        decoder.tell(width=3)  # A checksum, and no point.
    with pytest.raises(ValueError, match=r"width can't be 23: it is from 1 to 22"):
        decoder.tell(width=23)  # 24 bytes are the most, 2 of which are the sync.


@ENGINE
def test_an_end_stands_where_the_length_says(engine: str) -> None:
    module = module_at(LENGTHS)
    decoder = module.Decoder("meter", engine)
    decoder.tell(asked=1, size=3)
    (event,) = decoder.feed(NAME)
    assert (event.message.name, event.as_json()["parts"]) == ("A\x03B", {"asked": 1})
    decoder.tell(size=1)
    assert names(decoder.feed(FAULT)) == ["fault"]
    decoder.tell(size=2)
    events = [*decoder.feed(FAULT), *decoder.flush()]
    assert (names(events), events[0].reason) == (["invalid"], "truncated")


@pytest.mark.parametrize("told", [0, 9, 300])
def test_a_length_that_other_frames_tell_may_be_none(told: int) -> None:
    """Nothing that follows is a frame then, up to the next length."""
    module = module_at(LENGTHS)
    host, store = module.Decoder("host"), module.Decoder("store")
    (event,) = host.feed(module.encode(module.Send(count=told)))
    store.hear(event)
    events = [*store.feed(bytes(9)), *store.flush()]
    assert names(events) == (["data"] if told == 9 else ["invalid"])


def test_what_can_not_be_told_is_said() -> None:
    decoder = module_at(LENGTHS).Decoder("store")
    with pytest.raises(ValueError, match=r"announced can't be 21: it is from 1 to 20"):
        decoder.tell(announced=21)
    with pytest.raises(ValueError, match=r"announced can't be 70000: it has 16 bits"):
        decoder.tell(announced=[1, 70000])
    decoder.tell(announced=0)  # As before anything was told.
    assert decoder.told == {"announced": 0}


def test_one_frame_alone_has_the_length_that_it_has() -> None:
    module = module_at(LENGTHS)
    assert module.decode(b"abc", "store").data == b"abc"
    assert module.decode(NAME, "meter", told={"asked": 1}).name == "A\x03B"
    assert module.decode(NO_POINTS, "radar").points == []
    with pytest.raises(module.DecodeError, match="the frame has only 2 of these 3 bytes"):
        module.decode(b"abc", "store", told={"announced": 2})
    with pytest.raises(module.DecodeError, match="length"):
        module.decode(bytes(21), "store")


def test_an_encoder_keeps_to_the_length() -> None:
    module = module_at(LENGTHS)
    assert module.encode(module.Data(data=b"abc")) == b"abc"
    assert module.encode(module.Near(points=[7, 8])) == NEAR
    assert module.encode(module.Near(points=[])) == NO_POINTS
    for strict in (True, False):
        with pytest.raises(module.EncodeError, match=r"21|makes announced 0"):
            module.encode(module.Data(data=bytes(21)), strict=strict)
        with pytest.raises(module.EncodeError):
            module.encode(module.Data(data=b""), strict=strict)


@ENGINE
def test_lines_of_events_give_the_bytes_again(engine: str) -> None:
    module = module_at(LENGTHS)
    decoder = module.Decoder("meter", engine)
    decoder.tell(asked=7, size=3)  # An identity that no message has.
    (event,) = decoder.feed(NAME)
    assert (event.kind, event.payload) == ("unknown", b"A\x03B")
    assert module.PROTOCOL.encode_line(event.as_json()) == NAME


# --- commands -------------------------------------------------------------------------------------


def told(*arguments: str, given: str = "") -> tuple[int, str]:
    """The exit code of a command and what it prints."""
    result = run(*arguments, input=given)
    return result.exit_code, result.output


def test_decode_is_told_on_the_command_line() -> None:
    line = ("--sender", "store", "--hex", "616263")
    code, text = told("decode", str(LENGTHS), *line, "--told", "announced=3")
    assert (code, text.split()[:2]) == (0, ["0", "data"])
    code, text = told("decode", str(LENGTHS), *line, "--told", "announced=2,1")
    assert [row.split()[:2] for row in text.splitlines()] == [["0", "data"], ["2", "data"]]
    code, text = told("decode", str(LENGTHS), *line, "--told", "announced=21")
    assert (code, "announced can't be 21: it is from 1 to 20" in text) == (2, True)


def test_a_log_of_both_ways_tells_by_itself() -> None:
    log = f"host: {SEND_3.hex()}\nstore: 616263\n"
    code, text = told("decode", str(LENGTHS), "--tagged", "-", given=log)
    assert (code, [row.split()[2] for row in text.splitlines()]) == (0, ["send", "data"])


def test_what_is_told_nothing_says_so() -> None:
    code, text = told("decode", str(LENGTHS), "--sender", "store", "--hex", "616263")
    hint = "hint: some frames do not say how long they are: give --told announced=NUMBER"
    assert (code, hint in text) == (0, True)


def test_explain_shows_what_was_told() -> None:
    given = ("--sender", "store", "--hex", "616263", "--told", "announced=3")
    code, text = told("explain", str(LENGTHS), *given)
    assert (code, "bytes of payload; told, not sent" in text) == (0, True)


def test_each_part_has_its_bytes() -> None:
    rows = annotate(protocol_of(LENGTHS), "radar", NEAR)
    assert [(row.path, row.bytes.hex(), row.value) for row in rows][:4] == [
        ("sync", "5a01", None),
        ("kind", "01", 1),
        ("width", "", 5),
        ("points[0]", "07", 7),
    ]
    assert not [row.fault for row in rows if row.fault]


def test_tables_say_that_they_are_told_nothing(tmp_path: Path) -> None:
    with pytest.raises(CaptureError, match=r"frames of store do not say .* announced"):
        columns(b"abc", protocol=LENGTHS, sender="store")


def test_every_engine_takes_samples_there_and_back() -> None:
    code, text = told("fuzz", str(LENGTHS), "--examples", "8")
    assert code == 0, text


def test_the_reference_says_how_long_frames_are(tmp_path: Path) -> None:
    code, text = told("generate", str(LENGTHS), "-o", str(tmp_path), "--target", "markdown")
    assert code == 0, text
    page = (tmp_path / "markdown" / "lengths.md").read_text("utf-8")
    about = "Number of bytes of `payload`, which is not sent: a receiver is told it."
    assert f"{about} By `send.count` and `batch.counts`." in page
    assert "No bytes are a frame before." in page


def test_models_are_equal_where_lengths_are(tmp_path: Path) -> None:
    """Another length, or another teller, is another protocol."""

    def spec_hash(old: str = "", new: str = "") -> str:
        path = tmp_path / f"lengths_{len(list(tmp_path.iterdir()))}.yaml"
        path.write_text(LENGTHS.read_text("utf-8").replace(old, new, 1), "utf-8")
        module: Any = module_at(path)
        return str(module.SPEC_HASH)

    every = [spec_hash(), spec_hash("range: [1, 20]", "range: [1, 21]"), spec_hash(", once: true")]
    every.append(spec_hash("default: 5", "default: 6"))
    assert len(set(every)) == len(every)
