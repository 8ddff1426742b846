"""Transparency: bytes by hand, and what holds for every kind over any data and any region."""

import importlib
import re
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from protogen.runtime.transparency import (
    Base16Upper,
    Cobs,
    Escape,
    Insertion,
    Substitution,
    Transparency,
    TransparencyError,
)
from protogen.runtime.values import replace

# The reference for COBS; it decodes every decodable region and encodes canonically.
cobs_library: Any = importlib.import_module("cobs.cobs")

RFLEX_TABLE = {0x1B: b"\x1b\x00", 0x7C: b"\x7c\x1b\x01"}
MATTY_MEMBERS = frozenset((0x55, 0x56))


def rflex(*, lenient: bool = False) -> Substitution:
    return Substitution(RFLEX_TABLE, lenient)


def matty(*, lenient: bool = False) -> Escape:
    return Escape(0x56, MATTY_MEMBERS, "invert", lenient)


def slip() -> Substitution:
    """SLIP (RFC 1055) without its delimiter."""
    return Substitution({0xC0: b"\xdb\xdc", 0xDB: b"\xdb\xdd"})


def hdlc(*, lenient: bool = False) -> Escape:
    """Asynchronous HDLC (RFC 1662)."""
    return Escape(0x7D, frozenset((0x7D, 0x7E)), 0x20, lenient)


def plain_escape(*, lenient: bool = False) -> Escape:
    """DLE stuffing: 10 is doubled, 02 and 03 get a 10 in front."""
    return Escape(0x10, frozenset((0x02, 0x03, 0x10)), "none", lenient)


def dynamixel() -> Insertion:
    """Dynamixel 2: FD behind FF FF FD."""
    return Insertion(b"\xff\xff\xfd", 0xFD)


def as_lenient(kind: Any) -> Transparency:
    lenient: Transparency = replace(kind, lenient=True)
    return lenient


STRICT: list[Transparency] = [
    rflex(),
    slip(),
    # A swap: codewords of one byte. A long sequence, and one that starts with what another holds.
    Substitution({0x41: b"B", 0x42: b"A"}),
    Substitution({0x01: b"\x01\x02\x01\x03", 0x02: b"\x02\x01"}),
    Substitution({}),
    # Its sequence begins with a byte that is never sent, as 7-bit data allows.
    Substitution({0x01: b"\x80\x01"}),
    matty(),
    plain_escape(),
    hdlc(),
    Base16Upper(),
    Cobs(),
]
ALWAYS_STRICT: list[Transparency] = [dynamixel(), Insertion(b"\x01\x02", 0x00)]
EVERY = [*STRICT, *map(as_lenient, STRICT), *ALWAYS_STRICT]

# The bytes that mean something to one of the kinds, so that examples hit sequences often.
TELLING = bytes.fromhex(
    "00 01 02 03 05 0A 10 1B 41 42 46 55 56 5D 5E 61 7C 7D 7E A9 AA C0 DB DC DD FD FE FF"
)


def telling_bytes(max_size: int = 30) -> st.SearchStrategy[bytes]:
    return st.lists(st.sampled_from(TELLING), max_size=max_size).map(bytes)


def any_bytes() -> st.SearchStrategy[bytes]:
    """Short runs of telling bytes, any bytes, and runs around the size of a full COBS group."""
    run = st.builds(lambda byte, size: bytes((byte,)) * size, st.integers(0, 255), NEAR_FULL)
    return st.one_of(
        telling_bytes(), st.binary(max_size=40), st.lists(run, max_size=3).map(b"".join)
    )


NEAR_FULL = st.sampled_from((0, 1, 2, 252, 253, 254, 255, 256, 507, 508, 509))


def data_for(kind: Transparency) -> st.SearchStrategy[bytes]:
    """Data that may be sent: everything, but without 80 where the table counts on that."""
    if isinstance(kind, Substitution) and kind.table == {0x01: b"\x80\x01"}:
        return any_bytes().map(lambda data: bytes(byte & 0x7F for byte in data))
    return any_bytes()


def pushed(kind: Transparency, region: bytes) -> bytes:
    decoder = kind.decoder()
    return b"".join([*map(decoder.push, region), decoder.finish()])


def outcome(decode: Any, region: bytes) -> bytes | tuple[str, str]:
    """Reading of a region by a decoder: the data, or what it says is wrong."""
    try:
        data: bytes = decode(region)
    except TransparencyError as error:
        return error.reason, str(error)
    return data


def accepts(kind: Transparency, region: bytes) -> bool:
    return isinstance(outcome(kind.decode, region), bytes)


def failing_byte(kind: Transparency, region: str) -> int | None:
    """The index of the byte that push refuses; None when only finish does."""
    decoder = kind.decoder()
    for index, byte in enumerate(bytes.fromhex(region)):
        try:
            decoder.push(byte)
        except TransparencyError:
            return index
    with pytest.raises(TransparencyError):
        decoder.finish()
    return None


# --- by hand ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("kind", "data", "region"),
    [
        # rFLEX: ESC is 1B 00, the bar is 7C 1B 01, everything else itself.
        (rflex(), "02 1B 7C 03", "02 1B00 7C1B01 03"),
        (rflex(), "1B 02", "1B00 02"),
        # Matty: 55 and 56 become 56 and the inverted byte: 55 ^ FF = AA, 56 ^ FF = A9.
        (matty(), "55 56 57 AA", "56AA 56A9 57 AA"),
        # RFC 1055: END C0 -> DB DC, ESC DB -> DB DD.
        (slip(), "C0 DB DC DD", "DBDC DBDD DC DD"),
        # RFC 1662, 4.2: 7E -> 7D 5E, 7D -> 7D 5D.
        (hdlc(), "7E 7D 03 5E", "7D5E 7D5D 03 5E"),
        (plain_escape(), "10 02 41", "1010 1002 41"),
        # UHERobot: length 06, type 03, in ASCII.
        (Base16Upper(), "06 03 AF", "30 36  30 33  41 46"),
        (Substitution({0x41: b"B", 0x42: b"A"}), "41 42 43", "42 41 43"),
    ],
)
def test_bytes_stuffed_by_hand(kind: Transparency, data: str, region: str) -> None:
    assert kind.encode(bytes.fromhex(data)) == bytes.fromhex(region)
    assert kind.decode(bytes.fromhex(region)) == bytes.fromhex(data)
    assert pushed(kind, bytes.fromhex(region)) == bytes.fromhex(data)


FROM_01_TO_FE = bytes(range(0x01, 0xFF))


@pytest.mark.parametrize(
    ("data", "region"),
    [
        # Each group: a code that counts itself, then bytes; the zero behind it is implied.
        (b"", "01"),
        (b"\x00", "01 01"),
        (b"\x00\x00", "01 01 01"),
        (b"\x00\x11\x00", "01 02 11 01"),
        (b"\x11\x22\x00\x33", "03 11 22 02 33"),
        (b"\x11\x22\x33\x44", "05 11 22 33 44"),
        (b"\x11\x00\x00\x00", "02 11 01 01 01"),
        # 254 bytes fill a group of code FF, and nothing follows it at the end of the data.
        (FROM_01_TO_FE, "FF" + FROM_01_TO_FE.hex()),
        (b"\x00" + FROM_01_TO_FE, "01 FF" + FROM_01_TO_FE.hex()),
        # A zero behind a full group needs a group of its own, and then ends that one.
        (FROM_01_TO_FE + b"\x00", "FF" + FROM_01_TO_FE.hex() + "01 01"),
        (FROM_01_TO_FE + b"\xff", "FF" + FROM_01_TO_FE.hex() + "02 FF"),
        # 253 bytes are a group of code FE.
        (FROM_01_TO_FE[:-1], "FE" + FROM_01_TO_FE[:-1].hex()),
        (FROM_01_TO_FE[:-1] + b"\x00", "FE" + FROM_01_TO_FE[:-1].hex() + "01"),
    ],
)
def test_cobs_by_hand(data: bytes, region: str) -> None:
    assert Cobs().encode(data) == bytes.fromhex(region)
    assert Cobs().decode(bytes.fromhex(region)) == data
    assert pushed(Cobs(), bytes.fromhex(region)) == data


# --- errors -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("kind", "region", "reason", "place"),
    [
        # 1B must be followed by 00; 7C by 1B 01.
        (rflex(), "05 1B 02", "stuffing", 2),
        (rflex(), "7C 1B 00", "stuffing", 2),
        (rflex(), "7C 7C", "stuffing", 1),
        (rflex(), "05 7C 1B", "stuffing", None),
        # 57 inverted is A8: an encoder never escapes 57. A bare 55 is never sent.
        (matty(), "41 56 A8", "stuffing", 2),
        (matty(), "41 55", "stuffing", 1),
        (matty(), "41 56", "stuffing", None),
        (slip(), "C0", "stuffing", 0),
        (slip(), "DB 00", "stuffing", 1),
        (hdlc(), "7D 7D", "stuffing", 1),
        # A byte that only begins sequences is no byte of its own.
        (Substitution({0x01: b"\x80\x01"}), "80 80", "stuffing", 1),
        (Substitution({0x41: b"BB"}), "42 43", "stuffing", 1),
        # Lower case, a space, a character behind F, half a byte.
        (Base16Upper(), "30 61", "encoding", 1),
        (Base16Upper(), "30 36 20 33", "encoding", 2),
        (Base16Upper(), "47", "encoding", 0),
        (Base16Upper(), "30 36 30", "encoding", None),
        (Base16Upper(lenient=True), "67", "encoding", 0),
        (Base16Upper(lenient=True), "61", "encoding", None),
        # A zero as code and in a group, a group cut short, no group.
        (Cobs(), "00", "encoding", 0),
        (Cobs(), "03 11 00", "encoding", 2),
        (Cobs(), "03 11", "encoding", None),
        (Cobs(), "", "encoding", None),
        # The end of a full group needs no 01.
        (Cobs(), "FF" + FROM_01_TO_FE.hex() + "01", "encoding", None),
        (Cobs(lenient=True), "02 00", "encoding", 1),
        (Cobs(lenient=True), "03 11", "encoding", None),
        (matty(lenient=True), "41 56", "stuffing", None),
    ],
)
def test_a_region_that_stands_for_nothing(
    kind: Transparency, region: str, reason: str, place: int | None
) -> None:
    with pytest.raises(TransparencyError) as caught:
        kind.decode(bytes.fromhex(region))
    assert caught.value.reason == reason
    assert failing_byte(kind, region) == place


def test_an_error_shows_the_bytes_that_are_wrong() -> None:
    with pytest.raises(TransparencyError, match="7C 1B 00 is no sequence"):
        rflex().decode(bytes.fromhex("7C 1B 00"))
    with pytest.raises(TransparencyError, match="ends inside a sequence, behind 7C 1B"):
        rflex().decode(bytes.fromhex("7C 1B"))
    with pytest.raises(TransparencyError, match="0A is no hexadecimal digit"):
        Base16Upper().decode(b"3\n")
    with pytest.raises(TransparencyError, match="missing in the last group: 3"):
        Cobs().decode(bytes.fromhex("05 11"))


# --- lenient ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("kind", "region", "data"),
    [
        # What is no sequence passes byte by byte: 7C, then 1B 00 is read again as a sequence.
        (rflex(lenient=True), "7C 1B 00", "7C 1B"),
        (rflex(lenient=True), "1B 02 1B", "1B 02 1B"),
        (rflex(lenient=True), "7C 7C 1B 01", "7C 7C"),
        (rflex(lenient=True), "7C 1B", "7C 1B"),
        (rflex(lenient=True), "1B 1B 00", "1B 1B"),
        # Any byte behind the escape byte is transformed back, bare members pass.
        (matty(lenient=True), "56 A8 55 56 56", "57 55 A9"),
        (hdlc(lenient=True), "7D 23 7E 7D 0A", "03 7E 2A"),
        (plain_escape(lenient=True), "10 41 03", "41 03"),
        (Base16Upper(lenient=True), "61 46 30 66", "AF 0F"),
        (Cobs(lenient=True), "", ""),
        (Cobs(lenient=True), "FF" + FROM_01_TO_FE.hex() + "01", FROM_01_TO_FE.hex()),
    ],
)
def test_a_lenient_decoder_accepts_more(kind: Transparency, region: str, data: str) -> None:
    assert kind.decode(bytes.fromhex(region)) == bytes.fromhex(data)
    assert pushed(kind, bytes.fromhex(region)) == bytes.fromhex(data)
    assert kind.encode(bytes.fromhex(data)) != bytes.fromhex(region)


def reread(table: dict[int, bytes], region: bytes) -> bytes:
    """The documented reading of a lenient substitution, one position after the other."""
    data = bytearray()
    while region:
        for byte, sequence in table.items():
            if region.startswith(sequence):
                data.append(byte)
                region = region[len(sequence) :]
                break
        else:
            data.append(region[0])
            region = region[1:]
    return bytes(data)


@given(st.lists(st.sampled_from(b"\x00\x01\x02\x03\x1b\x7c"), max_size=20).map(bytes))
@pytest.mark.parametrize(
    "table", [RFLEX_TABLE, {0x01: b"\x01\x02\x01\x03", 0x02: b"\x02\x01"}], ids=["rflex", "long"]
)
def test_a_lenient_substitution_reads_on_behind_a_byte_that_passed(
    table: dict[int, bytes], region: bytes
) -> None:
    assert Substitution(table, lenient=True).decode(region) == reread(table, region)
    assert pushed(Substitution(table, lenient=True), region) == reread(table, region)


@pytest.mark.parametrize("kind", STRICT, ids=repr)
@given(data=st.data())
def test_a_lenient_decoder_accepts_what_the_strict_one_does(
    kind: Transparency, data: st.DataObject
) -> None:
    lenient = as_lenient(kind)
    assert lenient.lenient
    sent = data.draw(data_for(kind))
    assert lenient.decode(kind.encode(sent)) == sent
    assert lenient.encode(sent) == kind.encode(sent)


# --- what holds for every kind ------------------------------------------------------------------


@pytest.mark.parametrize("kind", EVERY, ids=repr)
@given(data=st.data())
def test_what_was_encoded_decodes_to_itself(kind: Transparency, data: st.DataObject) -> None:
    sent = data.draw(data_for(kind))
    region = kind.encode(sent)
    assert kind.decode(region) == sent
    assert pushed(kind, region) == sent


@pytest.mark.parametrize("kind", STRICT, ids=repr)
@given(region=any_bytes())
@example(region=b"0a")
@example(region=b"0 0A")
@example(region=b"")
def test_a_strict_decoder_accepts_only_what_the_encoder_makes(
    kind: Transparency, region: bytes
) -> None:
    if accepts(kind, region):
        assert kind.encode(kind.decode(region)) == region


@pytest.mark.parametrize("kind", EVERY, ids=repr)
@given(region=any_bytes())
@example(region=b"a")
@example(region=b"AZ0")
@example(region=b"\xff" + FROM_01_TO_FE + b"\x01")
@example(region=b"\xff" + FROM_01_TO_FE + b"\x01\x01")
def test_a_whole_region_decodes_as_it_does_byte_by_byte(kind: Transparency, region: bytes) -> None:
    whole = outcome(kind.decode, region)
    assert whole == outcome(lambda region: pushed(kind, region), region)


@pytest.mark.parametrize("kind", EVERY, ids=repr)
@given(data=st.data())
def test_a_damaged_region_decodes_as_it_does_byte_by_byte(
    kind: Transparency, data: st.DataObject
) -> None:
    region = bytearray(kind.encode(data.draw(data_for(kind))))
    if region:
        place = data.draw(st.integers(0, len(region) - 1))
        region[place : place + data.draw(st.integers(0, 2))] = data.draw(telling_bytes(2))
    whole = outcome(kind.decode, bytes(region))
    assert whole == outcome(lambda region: pushed(kind, region), bytes(region))


@given(any_bytes())
def test_protected_bytes_stay_out_of_the_region(data: bytes) -> None:
    assert 0x00 not in Cobs().encode(data)
    assert 0xC0 not in slip().encode(data)
    assert 0x7E not in hdlc().encode(data)
    assert 0x55 not in matty().encode(data)
    assert re.fullmatch(rb"[0-9A-F]*", Base16Upper().encode(data))
    # rFLEX: neither the start 1B 02 nor the end 1B 03.
    assert not re.search(rb"\x1b[\x02\x03]", rflex().encode(data))


# --- against the cobs package -------------------------------------------------------------------


@given(any_bytes())
def test_cobs_encodes_as_the_cobs_package_does(data: bytes) -> None:
    assert Cobs().encode(data) == cobs_library.encode(data)


@given(st.one_of(any_bytes(), any_bytes().map(Cobs().encode), telling_bytes(6)))
def test_lenient_cobs_accepts_what_the_cobs_package_accepts(region: bytes) -> None:
    try:
        expected = cobs_library.decode(region)
    except cobs_library.DecodeError:
        assert not accepts(Cobs(lenient=True), region)
    else:
        assert Cobs(lenient=True).decode(region) == expected


@given(st.one_of(any_bytes(), any_bytes().map(Cobs().encode), telling_bytes(6)))
def test_strict_cobs_accepts_what_the_cobs_package_encodes(region: bytes) -> None:
    try:
        canonical = cobs_library.encode(cobs_library.decode(region)) == region
    except cobs_library.DecodeError:
        canonical = False
    assert accepts(Cobs(), region) == canonical


# --- insertion ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("data", "wire"),
    [
        ("FF FF FD", "FF FF FD FD"),
        ("FF FF FD 00", "FF FF FD FD 00"),
        # Of three FF the last two count.
        ("FF FF FF FD", "FF FF FF FD FD"),
        ("FF FF FD FD", "FF FF FD FD FD"),
        ("FF FF FD FF FF FD", "FF FF FD FD FF FF FD FD"),
        # What was put in belongs to no other sequence.
        ("FF FF FD FF FD", "FF FF FD FD FF FD"),
        ("FF FF", "FF FF"),
        ("FF FD FD", "FF FD FD"),
    ],
)
def test_a_byte_is_put_in_behind_each_sequence(data: str, wire: str) -> None:
    assert dynamixel().encode(bytes.fromhex(data)) == bytes.fromhex(wire)
    assert dynamixel().decode(bytes.fromhex(wire)) == bytes.fromhex(data)


@pytest.mark.parametrize(
    ("region", "refused"),
    [("FF FF FD 00", 3), ("FF FF FD FF", 3), ("FF FF FF FD FE", 4), ("41 FF FF FD", None)],
)
def test_no_other_byte_stands_behind_a_sequence(region: str, refused: int | None) -> None:
    assert failing_byte(dynamixel(), region) == refused
    with pytest.raises(TransparencyError):
        dynamixel().decode(bytes.fromhex(region))


@given(st.lists(st.sampled_from(b"\xff\xfd\x00"), max_size=12).map(bytes))
def test_the_beginning_of_a_header_stands_in_no_region(data: bytes) -> None:
    assert b"\xff\xff\xfd\x00" not in dynamixel().encode(data)


# --- values -------------------------------------------------------------------------------------


def test_kinds_compare_and_hash_by_their_parameters() -> None:
    assert slip() == slip() != as_lenient(slip())
    assert hdlc() == hdlc() != hdlc(lenient=True)
    assert len({*map(hash, EVERY)}) > 1
    assert (
        repr(matty())
        == "Escape(byte=86, of=frozenset({85, 86}), transform='invert', lenient=False)"
    )


def test_decoders_of_one_kind_do_not_share_their_state() -> None:
    kind = rflex()
    first, second = kind.decoder(), kind.decoder()
    assert first.push(0x1B) == b""
    assert second.push(0x41) == b"A"
    assert first.push(0x00) == b"\x1b"
