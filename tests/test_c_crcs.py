"""Checksums of generated C, in each way that a user can choose, beside those of a library."""

from __future__ import annotations

import importlib
import subprocess
from functools import cache
from pathlib import Path
from random import Random
from types import SimpleNamespace
from typing import Any

import pytest
from tooling import require_tool

from protogen.model.checksums import ChecksumSpec, checksum_of, crc_catalogue, find_algorithm
from protogen.targets.c.emit import c_environment
from protogen.targets.c.frame.algorithms import Algorithm, Checksums, algorithm_of
from protogen.targets.c.frame.crc_plan import crc_plan

# An implementation that shares nothing with ours. It is not typed.
anycrc: Any = importlib.import_module("anycrc")

CHECK_DATA = b"123456789"
WAYS = {
    "bit by bit": ("-DT_FAST_FEED=1", "-DT_SMALL_CRC=1"),
    "small machines": ("-DT_FAST_FEED=0",),
    "machines of bytes": ("-DT_FAST_FEED=0", "-DOF_BYTES"),
    "hosts": ("-DT_FAST_FEED=1",),
}
SIZES = (*range(20), 257, 4099, 9001)
"""Bytes that are summed: some of each remainder by 4, and more than Fletcher's block."""


def drawn_crc(index: int) -> ChecksumSpec:
    """A CRC of any parameters."""
    dice = Random(f"crc {index}")
    width = dice.choice((4, 5, 7, 8, 9, 12, 15, 16, 17, 24, 31, 32, 33, 40, 48, 63, 64))
    poly, init, xorout = (dice.getrandbits(width) for _ in range(3))
    refin, refout = dice.random() < 0.5, dice.random() < 0.5
    name = f"drawn-{index}"
    return ChecksumSpec(
        name, "crc", width, init=init, poly=poly | 1, refin=refin, refout=refout, xorout=xorout
    )


def named(name: str) -> ChecksumSpec:
    spec = find_algorithm(name)
    assert spec is not None
    return spec


def with_few_terms(width: int, poly: int, *, reflected: bool) -> ChecksumSpec:
    """A CRC of a polynomial that leaves some byte of the register without a term."""
    name = f"few-{width}-{poly:X}-{reflected:d}"
    return ChecksumSpec(name, "crc", width, init=1, poly=poly, refin=reflected, refout=reflected)


FEW_TERMS = tuple(
    with_few_terms(width, poly, reflected=reflected)
    for width, poly in ((8, 0x01), (8, 0x80), (16, 0x0001), (16, 0x0100), (16, 0x8000))
    for reflected in (False, True)
)
FLETCHERS = (named("fletcher-16"), named("fletcher-16/256"))
SPECS = (*crc_catalogue(), *(drawn_crc(index) for index in range(24)), *FEW_TERMS, *FLETCHERS)


@cache
def data() -> bytes:
    return CHECK_DATA + Random("data").randbytes(max(SIZES))


def value_by_others(spec: ChecksumSpec, text: bytes) -> int:
    if spec.kind != "crc":
        return int(checksum_of(spec).compute(text))
    row = (spec.width, spec.poly, spec.init, spec.refin, spec.refout, spec.xorout)
    return int(anycrc.CRC(*row).calc(text))


def program(algorithms: tuple[Algorithm, ...]) -> str:
    """A program that prints what each algorithm makes of the data: at once, in pieces, in bytes."""
    given = {"module": SimpleNamespace(name="t", upper="T")}
    template: Any = c_environment().get_template("frame/checksums.c.j2").make_module(given)
    checksums = Checksums(algorithms)
    octets = ", ".join(map(str, data()))
    calls = "".join(
        f"    for (i = 0; i < sizeof sizes / sizeof *sizes; i++) {{\n"
        f"        const size_t size = sizes[i], part = size / 3;\n"
        f"        {item.type} pieces = {item.function}_run({item.init}, data, part);\n"
        f"        {item.type} bytes = {item.init};\n"
        f"        pieces = {item.function}_run(pieces, data + part, size - part);\n"
        f"        for (j = 0; j < size; j++) bytes = {item.function}_step(bytes, data[j]);\n"
        f"        say({item.function}_final({item.function}_run({item.init}, data, size)));\n"
        f"        say({item.function}_final(pieces));\n"
        f"        say({item.function}_final(bytes));\n"
        f"    }}\n"
        for item in algorithms
    )
    return (
        "#include <stdint.h>\n#include <stddef.h>\n#include <stdio.h>\n"
        "#define T_INLINE static inline\n"
        "#ifdef OF_BYTES\n#undef UINTPTR_MAX\n#define UINTPTR_MAX 0xFFFF\n#endif\n"
        f"{template.choice(checksums)}\n{template.functions(checksums, False)}\n"
        f"static const uint8_t data[] = {{{octets}}};\n"
        f"static const size_t sizes[] = {{{', '.join(map(str, SIZES))}}};\n"
        'static void say(uint64_t value) { printf("%llu\\n", (unsigned long long)value); }\n'
        f"int main(void) {{\n    size_t i, j;\n{calls}    return 0;\n}}\n"
    )


def printed_by(algorithms: tuple[Algorithm, ...], flags: tuple[str, ...], folder: Path) -> str:
    source, made = folder / "sums.c", folder / "sums"
    source.write_text(program(algorithms), encoding="utf-8")
    warnings = ("-Wall", "-Wextra", "-Wconversion", "-Wsign-conversion", "-Werror")
    checks = ("-fsanitize=undefined", "-fno-sanitize-recover=all")
    compiler = require_tool("gcc")
    command = [compiler, "-std=c99", "-O0", *warnings, *checks, *flags, "-o", made, source]
    subprocess.run(command, check=True)
    return subprocess.run([made], check=True, capture_output=True, text=True).stdout


@pytest.mark.parametrize("way", WAYS)
def test_a_checksum_is_the_same_in_each_way(way: str, tmp_path: Path) -> None:
    algorithms = tuple(algorithm_of(spec, f"sum_{i}") for i, spec in enumerate(SPECS))
    found = map(int, printed_by(algorithms, WAYS[way], tmp_path).split())
    for spec in SPECS:
        for size in SIZES:
            due = value_by_others(spec, data()[:size])
            values = [next(found) for _ in range(3)]
            assert values == [due] * 3, f"{spec.name} of {size} bytes"
    assert next(found, None) is None


class TestPlan:
    @pytest.mark.parametrize(
        ("name", "quotient", "product"),
        [
            # 1021 is x^12 + x^5 + 1: the twelfth power brings the upper half down by 4.
            ("CRC-16/XMODEM", (0, -4), (0, 5, 12)),
            # The same in a mirror of 16 bits, where 0, 5 and 12 are 8, 3 and -4.
            ("CRC-16/KERMIT", (0, 4), (8, 3, -4)),
            # 07 is x^2 + x + 1: from bit 7, they bring down by 6 and 7.
            ("CRC-8/SMBUS", (0, -6, -7), (0, 1, 2)),
        ],
    )
    def test_few_terms_that_lie_low_are_shifts(
        self, name: str, quotient: tuple[int, ...], product: tuple[int, ...]
    ) -> None:
        shifts = crc_plan(named(name)).shifts
        assert shifts is not None
        assert (shifts.quotient, shifts.product) == (quotient, product)

    @pytest.mark.parametrize("name", ["CRC-16/MODBUS", "CRC-8/MAXIM-DOW", "CRC-32/ISO-HDLC"])
    def test_others_have_tables(self, name: str) -> None:
        assert crc_plan(named(name)).shifts is None

    def test_a_table_holds_what_halves_of_a_byte_leave(self) -> None:
        low, high = crc_plan(named("CRC-8/SMBUS")).table[0]
        # 01 leaves the polynomial 07, and 02 twice that. 10 leaves 70, and 20 E0, where all still
        # fits; 40 leaves 1C0, from which 107 is taken: C7.
        assert (low[0], low[1], low[2], low[3]) == (0x00, 0x07, 0x0E, 0x09)
        assert (high[1], high[2], high[4]) == (0x70, 0xE0, 0xC7)

    def test_each_row_takes_one_byte_more(self) -> None:
        spec = named("CRC-32/ISO-HDLC")
        bare = spec.poly, 0, True, True, 0
        table = crc_plan(spec).table
        for more, (low, high) in enumerate(table):
            zeros = bytes(more)
            crc = anycrc.CRC(spec.width, *bare)
            assert [crc.calc(bytes([half]) + zeros) for half in range(16)] == list(low)
            assert [crc.calc(bytes([half << 4]) + zeros) for half in range(16)] == list(high)
