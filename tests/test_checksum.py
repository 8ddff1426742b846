"""Checksums: what they give over known data, and that every named algorithm is the catalogue's."""

import importlib
from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from protogen.model.checksums import (
    ChecksumSpec,
    algorithm_names,
    checksum_of,
    crc_catalogue,
    find_algorithm,
)
from protogen.runtime.checksum import (
    Checksum,
    Crc,
    Fletcher16,
    Sum,
    Xor,
    _mirrored,
    _plain_engine,
    _reflected_engine,
    _zlib_engine,
)

# Two implementations that share nothing with ours, neither of them typed.
anycrc: Any = importlib.import_module("anycrc")
crccheck: Any = importlib.import_module("crccheck.crc")

CHECK_DATA = b"123456789"


def runtime_checksum(spec: ChecksumSpec) -> Checksum:
    """Function that the Python target prints for a spec."""
    match spec.kind:
        case "xor" | "sum":
            return checksum_of(spec)
        case "fletcher":
            return Fletcher16(spec.modulus)
        case "crc":
            return Crc(spec.width, spec.poly, spec.init, spec.refin, spec.refout, spec.xorout)


def named_spec(name: str) -> ChecksumSpec:
    spec = find_algorithm(name)
    assert spec is not None
    return spec


def named(name: str) -> Checksum:
    return runtime_checksum(named_spec(name))


# --- by hand ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "data", "value"),
    [
        # 02 ^ 07 = 05, 05 ^ FF = FA, FA ^ 1B = E1.
        ("xor-8", "02 07 FF 1B", 0xE1),
        ("xor-8", "", 0x00),
        # F0 + 0F + 02 = 101, and 101 modulo 100 = 01.
        ("sum-8", "F0 0F 02", 0x01),
        ("sum-8", "", 0x00),
        # 02 + 00 + 53 = 55, and 100 - 55 = AB.
        ("sum-8/negated", "02 00 53", 0xAB),
        # 80 + 80 = 100, which is 00 modulo 100; what brings that to 0 is 00, not 100.
        ("sum-8/negated", "80 80", 0x00),
        # Running sums 01, 03: low byte 03, high byte 01 + 03 = 04.
        ("fletcher-16", "01 02", 0x0403),
        # FF is 0 modulo FF, in both sums: FF -> 00, then 01 -> 01 and 00 + 01.
        ("fletcher-16", "FF 01", 0x0101),
        # Modulo 100 FF stays: running sums FF, then FF + 01 = 00; high byte FF + 00.
        ("fletcher-16/256", "FF 01", 0xFF00),
        # UBX NAV-POSLLH poll without its sync bytes: running sums 01, 03, 03, 03, so CK_A is 03
        # and CK_B 01 + 03 + 03 + 03 = 0A.
        ("fletcher-16/256", "01 02 00 00", 0x0A03),
    ],
)
def test_a_checksum_worked_out_by_hand(name: str, data: str, value: int) -> None:
    assert named(name).compute(bytes.fromhex(data)) == value


def test_a_crc_divided_by_hand() -> None:
    # CRC-3/GSM divides by x^3 + x + 1. The byte C0 with three zeros behind it:
    #   11000000 000
    #   1011
    #   01110000 000
    #    1011
    #   00101000 000
    #     1011
    #   00000100 000
    #        101 1
    #   00000001 100
    #          1 011
    #   00000000 111    the remainder, which xorout 111 turns into 000
    assert named("CRC-3/GSM").compute(b"\xc0") == 0b000


@pytest.mark.parametrize(
    ("text", "value"), [(b"abcde", 0xC8F0), (b"abcdef", 0x2057), (b"abcdefgh", 0x0627)]
)
def test_fletcher_16_gives_the_widely_published_values(text: bytes, value: int) -> None:
    assert Fletcher16().compute(text) == value


@given(st.binary(max_size=600) | st.integers(0, 600).map(lambda size: b"\xff" * size))
def test_fletcher_modulo_256_is_the_loop_of_the_ubx_manual(data: bytes) -> None:
    ck_a = ck_b = 0
    for byte in data:
        ck_a = ck_a + byte & 0xFF
        ck_b = ck_b + ck_a & 0xFF
    assert named("fletcher-16/256").compute(data).to_bytes(2, "little") == bytes((ck_a, ck_b))


@pytest.mark.parametrize(
    ("data", "value"),
    [
        (bytes(32), 0x8A9136AA),
        (b"\xff" * 32, 0x62A8AB43),
        (bytes(range(32)), 0x46DD794E),
        (bytes(range(31, -1, -1)), 0x113FDB5C),
    ],
)
def test_crc_32c_gives_the_values_of_rfc_3720_appendix_b_4(data: bytes, value: int) -> None:
    assert named("CRC-32C").compute(data) == value


def test_the_initial_value_is_part_of_a_sum() -> None:
    assert Xor(init=0x55).compute(b"\x0f") == 0x5A
    assert Sum(init=0xFF).compute(b"\x02") == 0x01
    assert Sum(init=0xFF, negated=True).compute(b"\x02") == 0xFF


# --- sums that real protocols send ----------------------------------------------------------------


@pytest.mark.parametrize(
    ("spec", "data", "value"),
    [
        # XBee API: 08 + 01 + 4E + 49 = A0, and A0 + 5F = FF.
        (named_spec("sum-8/inverted"), "08 01 4E 49", 0x5F),
        # Dynamixel 1: 01 + 04 + 02 + 2B + 01 = 33, inverted.
        (named_spec("sum-8/inverted"), "01 04 02 2B 01", 0xCC),
        # SCIP: the characters "00" sum up to 60; six bits of it are 20, and 30 makes it a "P".
        (ChecksumSpec("sum", "sum", 8, mask=0x3F, add=0x30), "30 30", ord("P")),
        # Roland's system exclusive: 40 + 11 + 00 + 41 = 92, modulo 128 12, and 80 - 12 = 6E.
        (ChecksumSpec("sum", "sum", 7, negated=True), "40 11 00 41", 0x6E),
        (named_spec("sum-16"), "FF FF 02", 0x0200),
        (named_spec("sum-16/negated"), "FF FF 02", 0xFE00),
        (named_spec("sum-16/inverted"), "20 40", 0xFF9F),  # FFFF - 60, as in iBus.
        (named_spec("sum-32/inverted"), "20 40", 0xFFFFFF9F),
        (named_spec("xor-16"), "01 02 03 04", 0x0602),
        (named_spec("xor-16"), "01 02 03", 0x0202),
        (ChecksumSpec("xor", "xor", 16, words="big"), "01 02 03", 0x0202),
        (ChecksumSpec("xor", "xor", 16, words="big", init=0x1111), "12 34", 0x0325),
        (ChecksumSpec("sum", "sum", 16, words="big"), "FF FF 00 02", 0x0001),
        (ChecksumSpec("sum", "sum", 32, words="big"), "00 00 00 01 02", 0x02000001),
        (ChecksumSpec("xor", "xor", 8, xorout=0xF0, mask=0x7F, add=0x01), "0F 81", 0x7F),
    ],
)  # fmt: skip
def test_a_sum_is_what_was_added_up_by_hand(spec: ChecksumSpec, data: str, value: int) -> None:
    assert runtime_checksum(spec).compute(bytes.fromhex(data)) == value


# --- names --------------------------------------------------------------------------------------


def test_a_name_is_found_in_upper_or_lower_case_and_by_its_aliases() -> None:
    kermit = named_spec("CRC-16/KERMIT")
    assert kermit == ChecksumSpec(
        "CRC-16/KERMIT", "crc", 16, poly=0x1021, init=0, refin=True, refout=True, xorout=0
    )
    for name in ("crc-16/kermit", "CRC-16/CCITT", "Kermit", "CRC-CCITT", "crc-16/bluetooth"):
        assert find_algorithm(name) == kermit


@pytest.mark.parametrize(
    ("alias", "name"),
    [
        ("X-25", "CRC-16/IBM-SDLC"),
        ("CRC-16/X-25", "CRC-16/IBM-SDLC"),
        ("CRC-16/CCITT-FALSE", "CRC-16/IBM-3740"),
        ("XMODEM", "CRC-16/XMODEM"),
        ("MODBUS", "CRC-16/MODBUS"),
        ("CRC-16", "CRC-16/ARC"),
        ("CRC-8", "CRC-8/SMBUS"),
        ("CRC-32", "CRC-32/ISO-HDLC"),
        ("CRC-32/CASTAGNOLI", "CRC-32/ISCSI"),
        ("CRC-64", "CRC-64/ECMA-182"),
    ],
)
def test_an_alias_leads_to_the_algorithm_s_own_name(alias: str, name: str) -> None:
    assert named_spec(alias).name == name


@pytest.mark.parametrize("name", ["", "crc", "CRC-16/KERMITT", "CRC-82/DARC", "xor"])
def test_an_unknown_name_finds_nothing(name: str) -> None:
    assert find_algorithm(name) is None


def test_every_listed_name_is_found_and_listed_once() -> None:
    names = algorithm_names()
    sums = [f"sum-{bits}{what}" for bits in (8, 16, 32) for what in ("", "/negated", "/inverted")]
    simple = ("xor-8", "xor-16", "xor-32", *sums, "fletcher-16", "fletcher-16/256")
    assert names[:15] == (*simple, "CRC-3/GSM")
    assert len({name.casefold() for name in names}) == len(names)
    assert all(find_algorithm(name) for name in names)
    own = [name for name in names if named_spec(name).name == name]
    assert names[: len(own)] == tuple(own)


# --- the catalogue ------------------------------------------------------------------------------


def anycrc_name(name: str) -> str:
    """anycrc writes CRC16-KERMIT for CRC-16/KERMIT, and keeps names without a width."""
    head, slash, tail = name.partition("/")
    if slash or head.removeprefix("CRC-")[:1].isdigit():
        head = head.replace("CRC-", "CRC") if head.startswith("CRC-") else head
    return f"{head}-{tail}" if slash else head


def crccheck_classes() -> Iterator[tuple[str, Any]]:
    for found in crccheck.ALLCRCCLASSES:
        if found.width() <= 64:
            yield found._names[0], found


CRCCHECK = dict(crccheck_classes())
CATALOGUE_NAMES = [spec.name for spec in crc_catalogue()]
ALIASES = {alias: spec.name for spec, found in crc_catalogue().items() for alias in found}


def test_the_catalogue_holds_the_names_that_two_libraries_hold() -> None:
    assert len(CATALOGUE_NAMES) == 112
    assert set(CATALOGUE_NAMES) == set(CRCCHECK)
    assert {anycrc_name(name) for name in CATALOGUE_NAMES} == set(anycrc.models)


def test_the_catalogue_holds_the_aliases_that_two_libraries_hold() -> None:
    ours = {anycrc_name(alias): anycrc_name(name) for alias, name in ALIASES.items()}
    assert ours == anycrc.aliases
    crccheck_aliases = {
        alias: name for name, found in CRCCHECK.items() for alias in found._names[1:]
    }
    # The catalogue spells this one X-CRC-12.
    assert crccheck_aliases.pop("CRC-12-X") == ALIASES["X-CRC-12"]
    assert crccheck_aliases.items() <= ALIASES.items()


@pytest.mark.parametrize("name", CATALOGUE_NAMES)
def test_an_algorithm_gives_the_catalogue_s_check_value(name: str) -> None:
    checksum = named(name)
    value = checksum.compute(CHECK_DATA)
    assert value == CRCCHECK[name].check_result()
    assert value == anycrc.models[anycrc_name(name)].check
    assert value.bit_length() <= CRCCHECK[name].width()


@pytest.mark.parametrize("name", CATALOGUE_NAMES)
def test_an_algorithm_has_the_catalogue_s_parameters(name: str) -> None:
    spec = named_spec(name)
    ours = (spec.width, spec.poly, spec.init, spec.refin, spec.refout, spec.xorout)
    theirs = CRCCHECK[name]
    assert ours == (
        theirs.width(),
        theirs.poly(),
        theirs.initvalue(),
        theirs.reflect_input(),
        theirs.reflect_output(),
        theirs.xor_output(),
    )
    assert ours == anycrc.models[anycrc_name(name)][:6]


@given(st.sampled_from(CATALOGUE_NAMES), st.binary(max_size=300))
def test_an_algorithm_agrees_with_two_libraries_over_any_data(name: str, data: bytes) -> None:
    value = named(name).compute(data)
    assert value == CRCCHECK[name].calc(data)
    assert value == anycrc.Model(anycrc_name(name)).calc(data)


# --- any parameters -----------------------------------------------------------------------------


@st.composite
def crcs(draw: st.DrawFn) -> Crc:
    width = draw(st.integers(1, 64))
    bits = st.integers(0, (1 << width) - 1)
    return Crc(width, draw(bits), draw(bits), draw(st.booleans()), draw(st.booleans()), draw(bits))


def bit_by_bit(crc: Crc, data: bytes) -> int:
    """The definition: shift one bit after the other into a register of exactly `width` bits."""
    register = crc.init
    for byte in data:
        for place in range(8) if crc.refin else range(7, -1, -1):
            carry = (register >> (crc.width - 1)) ^ (byte >> place & 1)
            register = (register << 1) % (1 << crc.width) ^ (crc.poly if carry else 0)
    if crc.refout:
        register = int(format(register, f"0{crc.width}b")[::-1], 2)
    return register ^ crc.xorout


@given(crcs(), st.binary(max_size=40))
def test_a_crc_of_any_parameters_agrees_with_the_definition(crc: Crc, data: bytes) -> None:
    value = crc.compute(data)
    assert value == bit_by_bit(crc, data)
    assert 0 <= value < 1 << crc.width


@given(crcs(), st.binary(max_size=40))
def test_a_crc_of_any_parameters_agrees_with_crccheck(crc: Crc, data: bytes) -> None:
    theirs = crccheck.Crc(crc.width, crc.poly, crc.init, crc.refin, crc.refout, crc.xorout)
    assert crc.compute(data) == theirs.calc(data)


@given(crcs(), st.binary(max_size=40))
def test_a_crc_of_any_parameters_agrees_with_anycrc(crc: Crc, data: bytes) -> None:
    theirs = anycrc.CRC(crc.width, crc.poly, crc.init, crc.refin, crc.refout, crc.xorout)
    assert crc.compute(data) == theirs.calc(data)


@given(st.binary(max_size=300), st.integers(0, 0xFFFF))
def test_the_standard_library_s_crc_16_is_the_table_s(data: bytes, register: int) -> None:
    plain, reflected = _plain_engine(16, 0x1021), _reflected_engine(16, 0x1021)
    assert _mirrored(plain, 16)(data, register) == reflected(data, register)
    for refin, engine in ((False, plain), (True, reflected)):
        crc = Crc(16, 0x1021, init=register, refin=refin, refout=refin)
        start = int(f"{register:016b}"[::-1], 2) if refin else register
        assert crc.compute(data) == engine(data, start)


@given(st.binary(max_size=300), st.integers(0, 0xFFFFFFFF))
def test_the_standard_library_s_crc_32_is_the_table_s(data: bytes, register: int) -> None:
    plain, reflected = _plain_engine(32, 0x04C11DB7), _reflected_engine(32, 0x04C11DB7)
    assert _zlib_engine(data, register) == reflected(data, register)
    assert _mirrored(_zlib_engine, 32)(data, register) == plain(data, register)


@pytest.mark.parametrize(
    ("width", "poly", "init", "xorout", "complaint"),
    [
        (0, 0, 0, 0, "1..64 bits, not 0"),
        (65, 1, 0, 0, "1..64 bits, not 65"),
        (8, 0x107, 0, 0, "poly does not fit 8 bits"),
        (8, 0x07, -1, 0, "init does not fit 8 bits"),
        (8, 0x07, 0, 0x100, "xorout does not fit 8 bits"),
    ],
)
def test_parameters_that_make_no_crc_are_refused(
    width: int, poly: int, init: int, xorout: int, complaint: str
) -> None:
    with pytest.raises(ValueError, match=complaint):
        Crc(width, poly, init, xorout=xorout)


@given(st.binary(max_size=300))
def test_simple_checksums_keep_to_their_width(data: bytes) -> None:
    for name in ("xor-8", "sum-8", "sum-8/negated", "fletcher-16", "fletcher-16/256"):
        checksum = named(name)
        assert 0 <= checksum.compute(data) < 1 << named_spec(name).width


@given(st.binary(max_size=300))
def test_a_negated_sum_brings_the_sum_of_everything_to_zero(data: bytes) -> None:
    whole = data + bytes((named("sum-8/negated").compute(data),))
    assert named("sum-8").compute(whole) == 0
