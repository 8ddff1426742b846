"""Several forms of frame on one line, and what several endpoints send on one."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from random import Random
from typing import Any

import pytest
from compiled import ROOT, module_at
from crccheck.crc import Crc16Xmodem
from hypothesis import given
from hypothesis import strategies as st

from protogen.runtime.errors import DecodeError, EncodeError

TRIO = ROOT / "tests" / "framings" / "forms.yaml"
MATTY = ROOT / "schemas" / "matty.yaml"

BEGUN = """
protocol: demo
endpoints: {one: One}
forms:
  short:
    frame: {start: {literal: 2, unprotected: any},
            length: {type: uint8, counts: payload, range: [0, 9]}, payload: {},
            sum: {type: uint8, algorithm: sum-8, covers: payload}}
  long:
    frame: {start: {literal: {hex: 02 7E 7E}, unprotected: any},
            length: {type: uint8, counts: payload}, payload: {}}
messages:
  note: {from: one, fields: {text: {type: ascii, size: {fill: true, max: 9}}}}
decisions:
  any: {question: What of data?, document: No., choice: Look on., because: Rare.}
"""

# --- an oracle: the frames of `trio`, read by hand ------------------------------------------------

KNOWN = {"brief": {0x00, 0x7E, 0xC0, 0x7D, 0xB5}, "wide": {0x7E, 0xC0, 0x7D, 0xDB, 0xB5}}
KNOWN["counted"] = KNOWN["wide"] | {0x00}
ENGINES = ("fast", "construct")


def brief_at(data: bytes, at: int) -> int:
    """Size of the brief frame there; 0 if there is none."""
    size = 4 + data[at + 1] if len(data) > at + 1 else 0
    frame = data[at : at + size]
    is_whole = frame[:1] == b"\x02" and len(frame) == size <= 130
    return size if is_whole and sum(frame[1:]) % 256 == 0 else 0


def wide_at(data: bytes, at: int) -> int:
    payload = int.from_bytes(data[at + 1 : at + 3], "big")
    frame = data[at : at + payload + 7]
    is_whole = frame[:1] == b"\x04" and len(frame) == payload + 7 and payload <= 60
    crc = Crc16Xmodem.calc(frame[1:-3]) if is_whole else 0
    return len(frame) if is_whole and frame[-3:] == crc.to_bytes(2, "big") + b"\x03" else 0


def counted_at(data: bytes, at: int) -> int:
    payload = data[at + 3] if len(data) > at + 3 else 61
    frame = data[at : at + payload + 7]
    is_whole = frame[:2] == b"\x02\x7e" and len(frame) == payload + 7 and payload <= 60
    return len(frame) if is_whole and sum(frame[2:-2]) == int.from_bytes(frame[-2:], "big") else 0


IDENTITY_AT = {"brief": 2, "wide": 3, "counted": 4}
SIZES = {0x00: {0}, 0x7E: {4}, 0xC0: {1 + 2 * n for n in range(13)}, 0x7D: {*range(33)}}
SIZES |= {0xDB: {*range(2, 43)}, 0xB5: {*range(1, 200)}}
AROUND = {"brief": 4, "wide": 7, "counted": 7}


def frames_by_hand(data: bytes) -> Iterator[tuple[int, int, str]]:
    """Offset, size and form of each frame whose payload has a size that its message has."""
    at = 0
    while at < len(data):
        found = {
            form: size
            for form, read in (("brief", brief_at), ("wide", wide_at), ("counted", counted_at))
            if (size := read(data, at)) and fits(form, data[at : at + size])
        }
        known = [form for form in found if data[at + IDENTITY_AT[form]] in KNOWN[form]]
        form = next(iter((*known, *found)), "")
        if form:
            yield at, found[form], form
        at += found.get(form, 1)


def fits(form: str, frame: bytes) -> bool:
    identity = frame[IDENTITY_AT[form]]
    return identity not in KNOWN[form] or len(frame) - AROUND[form] in SIZES[identity]


# --- streams --------------------------------------------------------------------------------------


def events_of(decoder: Any, portions: list[bytes]) -> list[Any]:
    events = [event for portion in portions for event in decoder.feed(portion)]
    return [*events, *decoder.flush()]


def lines(events: list[Any]) -> list[dict[str, Any]]:
    return [event.as_json() for event in events]


def sent(dice: Random) -> bytes:
    """A frame of any form."""
    trio = module_at(TRIO)
    message = dice.choice(
        [
            trio.Ping(),
            trio.Wind(direction=dice.randrange(360), speed=dice.choice([2, 0x0402, 0x027E, -3])),
            trio.Note(text="x" * dice.randrange(33)),
            trio.Dump(address=0x0402, memory=bytes(dice.choices([2, 4, 3, 0x7E], k=9))),
        ]
    )
    forms = [form for form, known in KNOWN.items() if message.IDENTITY[0] in known]
    given = {"form": dice.choice(forms)}
    number = {"number": dice.randrange(256)} if given["form"] == "counted" else {}
    frame: bytes = trio.encode(message, **given, **number)
    return frame


def stream(dice: Random) -> bytes:
    """Frames with noise between them, and some damage."""
    pieces: list[bytes] = []
    for _ in range(30):
        frame = sent(dice)
        match dice.randrange(5):
            case 0:
                frame = frame[: dice.randrange(len(frame))]
            case 1:
                frame = bytes(dice.choices([2, 4, 3, 0x7E, 0x55], k=5)) + frame
            case 2:
                place = dice.randrange(len(frame))
                frame = (
                    frame[:place]
                    + bytes([frame[place] ^ 1 << dice.randrange(8)])
                    + frame[place + 1 :]
                )
        pieces.append(frame)
    return b"".join(pieces)


@pytest.mark.parametrize("seed", range(40))
def test_the_frames_of_all_forms_are_those_that_are_found_by_hand(seed: int) -> None:
    trio, data = module_at(TRIO), stream(Random(seed))
    for engine in ENGINES:
        events = events_of(trio.Decoder("station", engine), [data])
        found = [
            (event.offset, event.size, event.form) for event in events if event.kind != "invalid"
        ]
        # The oracle looks at no values; the messages here have none that a decoder refuses.
        assert found == list(frames_by_hand(data))
        assert b"".join(event.raw for event in events) == data


@given(data=st.lists(st.sampled_from([0x00, 0x02, 0x04, 0x03, 0x7E, 0x01, 0xDB])), cuts=st.data())
def test_portions_do_not_change_the_events_of_any_form(
    data: list[int], cuts: st.DataObject
) -> None:
    trio, stream = module_at(TRIO), bytes(data)
    whole = lines(events_of(trio.Decoder("station", "construct"), [stream]))
    size = cuts.draw(st.integers(1, 9))
    portions = [stream[at : at + size] for at in range(0, len(stream), size)]
    for engine in ENGINES:
        assert lines(events_of(trio.Decoder("station", engine), portions)) == whole


@pytest.mark.parametrize("seed", range(10))
def test_portions_do_not_change_the_events_of_streams(seed: int) -> None:
    trio, dice = module_at(TRIO), Random(seed)
    data = stream(dice)
    whole = lines(events_of(trio.Decoder("station"), [data]))
    for size in (1, 2, 7, 64):
        portions = [data[at : at + size] for at in range(0, len(data), size)]
        assert lines(events_of(trio.Decoder("station"), portions)) == whole


def test_lines_of_all_forms_give_the_stream_back() -> None:
    trio, data = module_at(TRIO), stream(Random(7))
    events = events_of(trio.Decoder("station"), [data])
    texts = [json.dumps(line) for line in lines(events)]
    assert b"".join(trio.PROTOCOL.encode_line(json.loads(text)) for text in texts) == data


# --- encoding -------------------------------------------------------------------------------------


def test_an_encoder_takes_the_first_form_that_fits() -> None:
    trio = module_at(TRIO)
    assert trio.encode(trio.Ping())[:1] == b"\x02"
    assert trio.encode(trio.Dump(address=1, memory=b""))[:1] == b"\x04"
    assert trio.encode(trio.Ping(), number=3).hex() == "027e0300000003", "only one form has it"
    for engine in ENGINES:
        assert (
            trio.encode(trio.Ping(), form="counted", number=3, engine=engine).hex()
            == "027e0300000003"
        )
    with pytest.raises(EncodeError, match="'wide' is no form of frame for Ping; there is brief"):
        trio.encode(trio.Ping(), form="wide")


def test_a_counter_advances_with_the_frames_that_have_it() -> None:
    trio = module_at(TRIO)
    encoder = trio.Encoder("station")
    assert encoder.encode(trio.Ping()).hex() == "02000000"
    assert [encoder.encode(trio.Ping(), number=5).hex() for _ in range(2)] == ["027e0500000005"] * 2
    counted = trio.Encoder("station_counted")
    assert [counted.encode(trio.Ping()).hex() for _ in range(2)] == [
        "027e0000000000",
        "027e0100000001",
    ]


def test_exactly_one_frame_is_read_in_any_form() -> None:
    trio = module_at(TRIO)
    assert trio.decode(bytes.fromhex("027e0700000007")) == trio.Ping()
    with pytest.raises(DecodeError) as caught:
        trio.decode(bytes.fromhex("040004DB1234020414F004"))
    assert (caught.value.reason, caught.value.offset) == ("length", 10)


# --- several endpoints ----------------------------------------------------------------------------


def talk(dice: Random) -> tuple[bytes, list[tuple[str, str]]]:
    """What both ends of matty's line send, and the sender and message of each frame."""
    matty = module_at(MATTY)
    pieces, told = [], []
    for number in range(40):
        sender, message = dice.choice(
            [
                ("pc", matty.Go(speed=dice.randrange(100), steer=-5)),
                ("pc", matty.Stop()),
                ("esp", matty.Ack()),
                ("esp", matty.Nack()),
            ]
        )
        pieces.append(matty.encode(message, counter=number))
        told.append((sender, message.NAME))
    return b"".join(pieces), told


@pytest.mark.parametrize("engine", ENGINES)
def test_a_decoder_without_a_sender_hears_both_ends(engine: Any) -> None:
    """Their frames begin alike: a known message tells who sent it."""
    matty = module_at(MATTY)
    data, told = talk(Random(1))
    for size in (1, 5, len(data)):
        portions = [data[at : at + size] for at in range(0, len(data), size)]
        events = events_of(matty.Decoder(engine=engine), portions)
        assert [(event.sender, event.message.NAME) for event in events] == told


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("sizes", [(3,), (1, 1, 1), (1, 2), (2, 1)])
def test_a_start_that_came_in_pieces_begins_a_frame_that_the_end_cuts_off(
    sizes: tuple[int, ...], engine: str, tmp_path: Path
) -> None:
    schema = tmp_path / "demo.yaml"
    schema.write_text(BEGUN, encoding="utf-8")
    decoder, rest, found = module_at(schema).Decoder("one", engine=engine), b"\x02\x7e\x7e", []
    for size in sizes:
        found += decoder.feed(rest[:size])
        rest = rest[size:]
    found += decoder.flush()
    # 7E is no length of a short frame, which has two bytes then; a long one has its start.
    assert [(event.size, event.reason) for event in found] == [(3, "truncated")]


def test_bytes_of_nobody_have_no_sender() -> None:
    matty = module_at(MATTY)
    noise, damaged = events_of(matty.Decoder(), [bytes.fromhex("00 01 55 02 01 53 AB")])
    assert (noise.sender, noise.reason, damaged.reason) == ("", "noise", "checksum")
    assert "sender" not in noise.as_json()
    assert matty.PROTOCOL.encode_line(noise.as_json()) == b"\0\1"


def test_endpoints_whose_frames_are_found_otherwise_need_a_sender(tmp_path: Path) -> None:
    schema = tmp_path / "mixed.yaml"
    schema.write_text(
        "protocol: mixed\n"
        "endpoints: {pump: Pump, panel: Panel}\n"
        "frame:\n"
        "  pump: {at: {literal: 1}, id: {type: char, id: true}, payload: {}, end: {literal: 2}}\n"
        "  panel: {id: {type: char, id: true}, payload: {}, end: {literal: 2}}\n"
        "transparency: {encoding: base16-upper}\n"
        "messages: {run: {id: 1, from: pump}, press: {id: 1, from: panel}}\n"
    )
    mixed = module_at(schema)
    with pytest.raises(ValueError, match="frames of pump and panel are found in different ways"):
        mixed.Decoder()
    assert mixed.Decoder("panel").feed(b"01\x02")[0].message == mixed.Press()


def test_a_form_that_no_message_uses_changes_no_call(tmp_path: Path) -> None:
    schema = tmp_path / "demo.yaml"
    schema.write_text(BEGUN.replace("note: {from: one,", "note: {from: one, forms: [short],"))
    demo = module_at(schema)
    message = demo.Note(text="a")
    assert demo.encode(message) == b"\x02\x01a\x61"
    assert demo.encode(message, form="short") == demo.PROTOCOL.encode(message, form="short")
    with pytest.raises(EncodeError, match="'long' is no form of frame for Note; there is short"):
        demo.encode(message, form="long")


@pytest.mark.parametrize("engine", ENGINES)
def test_a_range_of_a_length_in_bits_tells_forms_apart(engine: Any) -> None:
    module: Any = module_at(ROOT / "tests" / "form_schemas" / "ranges.yaml")
    frames = [module.encode(module.Data(data=data)) for data in (b"", b"hello")]
    assert [frame[:4].hex(" ") for frame in frames] == ["7e a0 05 01", "7e a0 0c 01"]
    events = module.Decoder("board", engine).feed(b"".join(frames))
    assert [(event.form, event.message.data) for event in events] == [
        ("bare", b""),
        ("full", b"hello"),
    ]


BOTH_ENDS = """
protocol: both_ends
endpoints: {host: Host, camera: Camera}
max_frame: 16
frame:
  host:
    head: {type: uint8, bits: {mark: {bits: 4..7, const: 8}, number: 0..3}}
    code: &code {type: uint7, code: {bits: 7}, id: true}
    payload: {}
    end: {literal: 0xFF}
  camera:
    head: {type: uint8, bits: {mark: {bits: 4..7, const: 9}, number: 0..3}}
    code: *code
    payload: {}
    end: {literal: 0xFF}
messages:
  ask: {id: 1, from: host, fields: {x: {type: uint7, code: {bits: 7}}}}
  answer: {id: 1, from: camera, fields: {x: {type: uint7, code: {bits: 7}}}}
"""


@pytest.mark.parametrize("engine", ENGINES)
def test_an_unknown_identity_of_one_end_takes_in_a_frame_of_the_other(
    engine: Any, tmp_path: Path
) -> None:
    path = tmp_path / "both_ends.yaml"
    path.write_text(BOTH_ENDS)
    module: Any = module_at(path)
    damaged = bytes.fromhex("8D 14 67 6A") + bytes.fromhex("90 01 05 FF")
    (event,) = module.Decoder(engine=engine).feed(damaged)
    assert (event.kind, event.sender, event.raw) == ("unknown", "host", damaged)
    noise, answer = module.Decoder("camera", engine).feed(damaged)
    assert (noise.kind, answer.message) == ("invalid", module.Answer(x=5))
