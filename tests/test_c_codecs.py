"""The payload codecs of generated C, compiled and held against the Python runtime."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from itertools import islice
from pathlib import Path
from random import Random
from types import ModuleType
from typing import Any, NamedTuple

import c_reference
import pytest
from c_library import (
    FLAGS,
    OK,
    RANGE,
    RESULTS,
    SIZE,
    SPACE,
    CLibrary,
    Encoded,
    held_of,
    write_sources,
)
from c_structs import FloatConstant, Unfit, Values
from compiled import ROOT, SCHEMAS, module_at, name_of, protocol_of
from expression_oracle import worked_out
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from schema_fuzzing import Schema, schemas
from schema_fuzzing.text import to_yaml
from schema_fuzzing.values import values_of
from tooling import require_tool

from protogen.compiler import compile_file
from protogen.fuzzing.samples import boundary_rounds, samples
from protogen.live.codec import module_of
from protogen.model.messages import Message
from protogen.model.protocol import Protocol
from protogen.model.types import Array, Field, Float, Integer, Octets, Struct, Switch, Text, Type
from protogen.runtime.attributes import held_arguments
from protogen.runtime.constructs import PayloadError, Whole
from protogen.runtime.errors import EncodeError
from protogen.targets.c import options
from protogen.targets.c.emit import emit, unit_of
from protogen.targets.c.options import COptions
from protogen.version import VERSION

SAMPLERS = sorted((ROOT / "tests" / "c_schemas").glob("*.yaml"))


class Content(NamedTuple):
    """A payload, and the numbers of its frame that the message has as fields."""

    payload: bytes
    numbers: tuple[tuple[str, int], ...] = ()

    @property
    def held(self) -> Mapping[str, int]:
        """The numbers by the names of the fields."""
        return dict(self.numbers)

    def __str__(self) -> str:
        return f"{self.payload.hex(' ')} {self.numbers or ''}"


class Subject:
    """One message, and the engines that are compared."""

    def __init__(self, protocol: Protocol, message: Message) -> None:
        self.protocol = protocol
        self.message = message

    def __repr__(self) -> str:
        return f"{self.protocol.name}-{self.message.name}"

    @property
    def codec(self) -> Any:
        """The message in C."""
        raise NotImplementedError

    @property
    def record(self) -> Any:
        """The generated Python class."""
        raise NotImplementedError

    @property
    def dice(self) -> Random:
        return Random(repr(self))

    def samples(self, random: int = 20) -> Iterator[Values]:
        """Values with each boundary, and some random ones."""
        frame = self.protocol.senders_of(self.message)[0].frame
        rounds = boundary_rounds(self.message, frame)
        for values, _ in islice(samples(self.message, frame, self.dice), rounds + random):
            yield values

    def payload(self, values: Values) -> bytes | None:
        """Payload that Python makes of the values; None where it refuses them."""
        try:
            payload: bytes = self.record.from_dict(values).to_payload()
        except EncodeError:
            return None
        return payload

    def contents(self) -> list[Content]:
        """Payloads, each with the numbers of its frame."""
        found = ((values, self.payload(values)) for values in self.samples())
        return list(
            dict.fromkeys(
                Content(payload, (*held_of(self.message, values).items(),))
                for values, payload in found
                if payload is not None
            )
        )

    def damages(self, content: Content, others: list[Content], dice: Random) -> Iterator[Content]:
        """The payload damaged, in frames of the same numbers, or of others."""
        for payload in damages(content.payload, [other.payload for other in others], dice):
            numbers = content.numbers
            if numbers and dice.randrange(2):
                numbers = self._other_numbers(dice.choice(others), dice)
            yield Content(payload, numbers)
        for _ in numbers:
            yield Content(content.payload, self._other_numbers(dice.choice(others), dice))

    def _other_numbers(self, content: Content, dice: Random) -> tuple[tuple[str, int], ...]:
        """The numbers of a content, or with another one among them."""
        name = dice.choice([field.name for field in self.message.held])
        bits = next(field.type.bits for field in self.message.held if field.name == name)
        other = {} if dice.randrange(2) else {name: dice.randrange(1 << bits)}
        return (*{**content.held, **other}.items(),)

    def values(self, content: Content) -> tuple[int, Values | None]:
        """Message that Python reads; the reference has to agree unless a count is out of bounds."""
        counts = False
        expected = OK
        try:
            c_reference.check(self.message, content.payload, content.held)
        except c_reference.Wrong as wrong:
            expected, counts = RESULTS[wrong.reason], wrong.count
        if counts:
            return SIZE, None
        found, values = self._python(content)
        assert found == expected, content
        return found, values

    def _python(self, content: Content) -> tuple[int, Values | None]:
        """A message of one size is looked at only where it has that size; others by field."""
        sizes, payload = self.message.sizes, content.payload
        if sizes.fixed is not None and len(payload) != sizes.fixed:
            return SIZE, None
        try:
            Whole(self.record.FORMAT).parse(payload, **held_arguments(content.held))
            if len(payload) not in sizes:
                return SIZE, None
            values = self.record.from_payload(payload, **held_arguments(content.held)).to_dict()
        except PayloadError as error:
            return RESULTS[error.reason], None
        return OK, values


class Case(Subject):
    """One message of one of the schemas."""

    def __init__(self, path: Path, message: Message) -> None:
        super().__init__(protocol_of(path), message)
        self.path = path

    @property
    def codec(self) -> Any:
        return library_of(self.path)[self.message.name]

    @property
    def record(self) -> Any:
        return module_at(self.path).MESSAGES[self.message.name]


class Drawn(Subject):
    """One message of a random schema."""

    def __init__(
        self, message: Message, library: CLibrary, module: ModuleType, drawn: list[Values]
    ) -> None:
        super().__init__(library.protocol, message)
        self._library = library
        self._module = module
        self._drawn = [as_json(values) for values in drawn]

    def samples(self, random: int = 20) -> Iterator[Values]:
        yield from self._drawn

    @property
    def codec(self) -> Any:
        return self._library[self.message.name]

    @property
    def record(self) -> Any:
        return self._module.MESSAGES[self.message.name]


CASES = [
    Case(path, message) for path in (*SCHEMAS, *SAMPLERS) for message in protocol_of(path).messages
]
EVERY_MESSAGE = pytest.mark.parametrize("case", CASES, ids=repr)


@cache
def library_of(path: Path) -> CLibrary:
    """The compiled codec of a schema."""
    return CLibrary(protocol_of(path))


# --- values and payloads --------------------------------------------------------------------------


@EVERY_MESSAGE
def test_values_make_the_bytes_that_python_makes(case: Subject) -> None:
    for values in case.samples():
        payload = case.payload(values)
        check_encoding(case, values, payload)
        assert payload is None or case.codec.put(values) == payload


def check_encoding(case: Subject, values: Values, payload: bytes | None) -> None:
    """C makes the same bytes, or refuses the values as well, unless it can't hold them at all."""
    try:
        record = case.codec.record(values)
    except Unfit:
        assert payload is None
        return
    done = case.codec.encode_record(record)
    assert done == Encoded(RANGE if payload is None else OK, payload or b"", intact=True)


@EVERY_MESSAGE
def test_bytes_have_the_values_that_python_reads(case: Subject) -> None:
    for payload, numbers in case.contents():
        done = case.codec.decode(payload, dict(numbers))
        assert done.result == OK
        held = held_arguments(dict(numbers))
        assert same(done.values, case.record.from_payload(payload, **held).to_dict())


@EVERY_MESSAGE
def test_a_short_buffer_is_refused_and_left_alone(case: Subject) -> None:
    for values in case.samples(5):
        payload = case.payload(values)
        if not payload:
            continue
        for capacity in {0, len(payload) // 2, len(payload) - 1}:
            done = case.codec.encode(values, capacity)
            assert (done.result, done.intact) == (SPACE, True)
        assert case.codec.encode(values, len(payload)).payload == payload


@EVERY_MESSAGE
def test_damaged_payloads_are_what_python_says(case: Subject) -> None:
    dice = case.dice
    contents = case.contents()
    tried = {damaged for item in contents for damaged in case.damages(item, contents, dice)}
    for content in sorted(tried):
        result, values = case.values(content)
        done = case.codec.decode(content.payload, content.held)
        assert done.result == result, content
        assert done.result == OK or done.intact
        assert same(done.values, values), content


def damages(payload: bytes, others: list[bytes], dice: Random) -> Iterator[bytes]:
    """The payload cut, made longer, and with wrong bytes."""
    for size in {*range(min(len(payload), 24)), len(payload) - 1, len(payload) // 2}:
        yield payload[: max(0, size)]
    yield payload + b"\0"
    yield payload + dice.randbytes(dice.randint(1, 9))
    yield dice.randbytes(len(payload))
    for _ in range(12):
        damaged = bytearray(payload)
        for _ in range(dice.choice([1, 1, 1, 2, 4])):
            if damaged:
                place = dice.randrange(min(len(damaged), dice.choice([4, 16, 1 << 20])))
                damaged[place] = dice.choice([damaged[place] ^ 1 << dice.randrange(8), 0, 1, 0xFF])
        yield bytes(damaged)
    other = dice.choice(others)
    yield payload[: len(payload) // 2] + other[len(other) // 2 :]


def as_json(values: Any) -> Any:
    """The values with the numbers that JSON does not have as texts."""
    if isinstance(values, dict):
        return {name: as_json(value) for name, value in values.items()}
    if isinstance(values, list):
        return [as_json(value) for value in values]
    return str(values) if isinstance(values, float) and not math.isfinite(values) else values


def same(found: Any, expected: Any) -> bool:
    """True if values are equal, where one NaN is like another and 0 is unlike -0."""
    if isinstance(found, FloatConstant):
        return bool(found == expected)
    if isinstance(expected, float) and isinstance(found, float):
        return found == expected and math.copysign(1, found) == math.copysign(1, expected)
    if isinstance(expected, dict):
        return found.keys() == expected.keys() and all(
            same(found[name], value) for name, value in expected.items()
        )
    if isinstance(expected, list):
        return len(found) == len(expected) and all(map(same, found, expected))
    return bool(found == expected) and isinstance(found, bool) == isinstance(expected, bool)


# --- what is refused ------------------------------------------------------------------------------


@EVERY_MESSAGE
def test_values_that_python_refuses_are_refused(case: Subject) -> None:
    """One number or text of good values is replaced by one that may be out of range."""
    for values in islice(case.samples(), 12):
        for spoilt in spoilings(case.message.fields, values, frozenset(), {}):
            check_encoding(case, spoilt, case.payload(spoilt))


def spoilings(
    fields: Sequence[Field], values: Values, used: frozenset[str], outer: Values
) -> Iterator[Values]:
    """The values with another one in one place; what counts or selects is left alone."""
    used |= counting_names(fields)
    scope = outer | values
    for field in fields:
        is_there = field.when is None or worked_out(field.when, scope)
        is_there = is_there and not (field.optional and values[field.name] is None)
        if field.const is None and field.name not in used and is_there:
            for value in others(field.type, values[field.name], used, scope):
                yield {**values, field.name: value}
        if field.behind and values[field.name] is not None:
            yield {**values, field.behind: None}


def counting_names(fields: Sequence[Field]) -> frozenset[str]:
    needed = frozenset[str]().union(*(field.needs for field in fields))
    return frozenset(name.partition(".")[0] for name in needed)


def others(type_: Type, value: Any, used: frozenset[str], scope: Values) -> Iterator[Any]:
    match type_:
        case Integer(role="number", flags=None):
            yield from _other_integers(type_)
        case Float():
            yield from ("nan", "inf", 0.1, 0.0999, 0.7, 0.75, -0.0, 0.0, -1.5, -1.6, 1000.3, 1e30)
        case Text() if value:
            yield from (value[:-1] + "\x80", "\xff" + value[1:], value[:-1] + "a")
        case Octets() if value:
            yield from ("ff" + value[2:], value[:-2] + "80")
        case Struct(fields=fields):
            yield from spoilings(fields, value, used, scope)
        case Array(element=element) if value:
            for other in others(element, value[-1], used, scope):
                yield [*value[:-1], other]
        case Switch(selector=selector, cases=cases) if isinstance(value, dict):
            chosen = worked_out(selector, scope), None  # That of all others is last.
            case = next(case for case in cases if case.value in chosen)
            assert isinstance(case.type, Struct)
            yield from spoilings(case.type.fields, value, used, scope)


def _other_integers(type_: Integer) -> Iterator[int]:
    bits = type_.bits
    yield from (-1, 0, 1, 1 << (bits - 1), (1 << bits) - 1, 1 << bits, -(1 << bits))
    yield from (type_.least, type_.least - 1, type_.greatest + 1, 100, 101, -1801, 1801)


SAMPLER = ROOT / "tests" / "c_schemas" / "sampler.yaml"
UNDELIMITED = (
    ROOT / "tests" / "c_schemas" / "undelimited.yaml",
    ROOT / "tests" / "framings" / "part_fields_alone.yaml",
)


@pytest.mark.parametrize(
    ("message", "member", "value"),
    [
        ("counted", "count", 10),
        ("counted", "count", 0),
        ("counted", "length", 2001),
        ("counted", "other_length", 21),
        ("filled", "points_count", 10),
        ("filled_text", "text_size", 21),
        ("filled_bytes", "data_size", 301),
        ("inner_choice", "kind", 5),
        ("unknown", "data_size", 1),
        ("unknown", "data_size", 31),
    ],
)
def test_numbers_that_count_too_many_are_refused(message: str, member: str, value: int) -> None:
    codec = library_of(SAMPLER)[message]
    case = next(item for item in CASES if item.path == SAMPLER and item.message.name == message)
    record = codec.record(next(case.samples()))
    assert codec.encode_record(record).result == OK
    setattr(record, member, value)
    assert codec.encode_record(record) == Encoded(RANGE, b"", intact=True)


def test_a_message_is_refused_that_no_frame_can_carry() -> None:
    codec = library_of(SAMPLER)["counted"]
    case = next(it for it in CASES if it.path == SAMPLER and it.message.name == "counted")
    values = next(case.samples())
    room = codec.view.greatest - len(case.payload(values) or b"") + len(values["data"]) // 2
    assert codec.encode(values | {"length": room, "data": "00" * room}).result == OK
    too_long = codec.record(values | {"length": room, "data": "00" * room})
    too_long.length = room + 1
    assert codec.encode_record(too_long) == Encoded(RANGE, b"", intact=True)


# --- payloads that tell their own size ------------------------------------------------------------


def cases_with_needs() -> list[Case]:
    """Cases whose payload tells by its start how long it is."""
    modules = {path: unit_of(protocol_of(path), COptions()).module for path in UNDELIMITED}
    cases = (case for case in CASES if case.path in modules)
    return [case for case in cases if modules[case.path].message(case.message.name).needs]


@pytest.mark.parametrize("case", cases_with_needs(), ids=repr)
def test_the_start_of_a_payload_says_how_much_is_missing(case: Case) -> None:
    for payload, numbers in case.contents():
        held = dict(numbers)
        tried = [*islice(damages(payload, [payload], case.dice), 40), payload]
        for start in {data[:size] for data in tried for size in range(len(data) + 1)}:
            result, need = case.codec.check(start, held)
            try:
                c_reference.check(case.message, start, held)
            except c_reference.Wrong as wrong:
                assert result == RESULTS[wrong.reason]
                assert (need > len(start)) == (wrong.missing > 0), start.hex(" ")
                assert need == 0 or need >= wrong.missing
            else:
                assert (result, need) == (OK, 0)
        assert _asked(case, payload, held) == len(payload)


def _asked(case: Case, payload: bytes, held: Mapping[str, int]) -> int:
    """Give what is asked for until it is enough."""
    size = 0
    while True:
        result, need = case.codec.check(payload[:size], held)
        if result == OK:
            return size
        assert (result, need > size) == (SIZE, True)
        size = need


# --- random schemas -------------------------------------------------------------------------------

TESTS_OF_VALUES = (
    test_values_make_the_bytes_that_python_makes,
    test_bytes_have_the_values_that_python_reads,
    test_a_short_buffer_is_refused_and_left_alone,
    test_damaged_payloads_are_what_python_says,
    test_values_that_python_refuses_are_refused,
)
DRAWN = int(os.environ.get("PROTOGEN_C_SCHEMAS", "5"))
"""Random schemas whose codecs are compiled."""


@settings(
    max_examples=DRAWN,
    suppress_health_check=list(HealthCheck),
    phases=[Phase.explicit, Phase.reuse, Phase.generate],
)
@given(schema=schemas(), data=st.data())
def test_random_schemas(
    schema: Schema, data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.mktemp("drawn") / "drawn.yaml"
    path.write_text(to_yaml(schema.data), encoding="utf-8", newline="")
    protocol = compile_file(path).protocol
    assert protocol is not None
    module = module_of(protocol)
    # A `when` may ask for a count that its array has no room for: gcc sees that it is never loaded.
    library = CLibrary(protocol, ("-O1", "-Wno-aggressive-loop-optimizations"))
    try:
        for message in protocol.messages:
            frames = [sender.frame for sender in protocol.senders_of(message)]
            drawn = data.draw(st.lists(values_of(message, frames), min_size=1, max_size=5))
            for test in TESTS_OF_VALUES:
                test(Drawn(message, library, module, drawn))
    finally:
        sys.modules.pop(module.__name__, None)


def test_arrays_are_nested_deeper_than_there_are_letters(tmp_path: Path) -> None:
    types = "".join(
        f"  t{depth}: {{fields: {{a: {{type: t{depth + 1}, count: 1}}}}}}\n" for depth in range(16)
    )
    path = tmp_path / "deep.yaml"
    path.write_text(
        "protocol: deep\nendpoints: {board: Board}\nbyte_order: little\n"
        "frame: {sync: {literal: 0xFD}, length: {type: uint8, counts: payload}, payload: {}}\n"
        "transparency: {covers: length..payload, encoding: base16-upper}\n"
        f"types:\n{types}  t16: {{fields: {{x: {{type: uint16, range: [0, 999]}}}}}}\n"
        "messages: {deep: {from: board, fields: {a: {type: t0, count: 1}}}}\n",
        encoding="utf-8",
    )
    protocol = compile_file(path).protocol
    assert protocol is not None
    (source,) = emit([protocol], COptions(style="single"))
    (tmp_path / "deep.h").write_text(source.text, encoding="utf-8")
    member = ".".join(["message", *["a[0]"] * 17, "x"])
    lines = [
        "#define DEEP_IMPLEMENTATION",
        '#include "deep.h"',
        "int main(void) {",
        "    static struct deep_deep message;",
        "    const uint8_t payload[2] = {0x02, 0x01};  /* 0x0102, little-endian */",
        "    if (deep_deep_decode(&message, payload, 2) != DEEP_OK) { return 1; }",
        f"    return {member} == 0x0102 ? 0 : 2;",
        "}",
    ]
    (tmp_path / "main.c").write_text("\n".join(lines) + "\n", encoding="utf-8")
    run([require_tool("cc"), *FLAGS, "main.c", "-o", "main"], tmp_path)
    run([tmp_path / "main"], tmp_path)


# --- the sources ----------------------------------------------------------------------------------

COMPILERS = {
    "gcc": ["-O2", "-S", "-o", "x.s"],
    "clang": ["-fsyntax-only"],
    "avr-gcc": ["-mmcu=atmega328p", "-fsyntax-only"],
}
"""Those that know other warnings, or other widths; test_c_lint.py has what is in no sampler. The
first says more where it optimises, the others say all of it before."""


@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("path", SAMPLERS, ids=name_of)
def test_the_source_compiles_without_warnings(path: Path, compiler: str, tmp_path: Path) -> None:
    source = written(path, tmp_path) / f"{protocol_of(path).name}.c"
    flags = [*FLAGS, *COMPILERS[compiler]]
    run([require_tool(compiler), *flags, source], tmp_path)


@pytest.mark.parametrize("path", SAMPLERS, ids=name_of)
def test_the_header_can_be_included_by_cpp(path: Path, tmp_path: Path) -> None:
    header = f"{protocol_of(path).name}.h"
    written(path, tmp_path)
    (tmp_path / "x.cpp").write_text(f'#include "{header}"\n#include "{header}"\n')
    flags = ["-std=c++11", *FLAGS[1:]]
    run([require_tool("g++"), *flags, "-c", "x.cpp", "-o", "x.o"], tmp_path)


@pytest.mark.parametrize("path", SAMPLERS, ids=name_of)
def test_the_layout_is_that_of_clang_format(path: Path, tmp_path: Path) -> None:
    written(path, tmp_path)
    style = Path(options.__file__).with_name(".clang-format")
    files = sorted(file.name for file in tmp_path.iterdir())
    (tmp_path / ".clang-format").write_bytes(style.read_bytes())
    run([require_tool("clang-format"), "--dry-run", "-Werror", *files], tmp_path)


def test_a_single_header_holds_all(tmp_path: Path) -> None:
    for file in emit([protocol_of(SAMPLER)], COptions(style="single")):
        (tmp_path / file.path).write_bytes(file.bytes)
    assert [file.name for file in tmp_path.iterdir()] == ["sampler.h"]
    (tmp_path / "x.c").write_text('#define SAMPLER_IMPLEMENTATION\n#include "sampler.h"\n')
    (tmp_path / "y.c").write_text('#include "sampler.h"\nint main(void) { return 0; }\n')
    run([require_tool("cc"), *FLAGS, "x.c", "y.c", "-o", "x"], tmp_path)


def test_only_what_is_chosen_is_printed() -> None:
    header, source = printed(COptions(only=("choice",)))
    assert "sampler_choice_encode" in header
    assert "sampler_point" in header
    for word in ("sampler_integers", "SAMPLER_COLOUR", "sampler_nested", "sampler_load_u64"):
        assert word not in header + source
    header, _ = printed(COptions(senders=("other",)))
    assert "sampler_clashes_encode" in header
    assert "sampler_empty_encode" in header
    assert "sampler_choice_encode" not in header


def printed(options: COptions) -> tuple[str, str]:
    """The header and the source of the sampler."""
    files = {file.path.name: file.text for file in emit([protocol_of(SAMPLER)], options)}
    return files["sampler.h"], files["sampler.c"]


PROGRAM = r"""
#include "rn1.h"
#include "sampler.h"
#include <string.h>

int main(void) {
    uint8_t payload[RN1_LIDAR_PAYLOAD_SIZE];
    static struct rn1_lidar lidar, again;
    size_t size = 0;
    for (size_t i = 0; i < 360u; i++) {
        lidar.distances[i] = (uint16_t)(i * 45u);
    }
    if (rn1_lidar_encode(&lidar, payload, sizeof payload, &size) != RN1_OK) {
        return 1;
    }
    for (size_t i = 0; i < 360u; i++) {
        if (rn1_lidar_distances_at(payload, i) != lidar.distances[i]) {
            return 2;
        }
    }
    if (rn1_lidar_decode(&again, payload, size) != RN1_OK || memcmp(&lidar, &again, sizeof lidar)) {
        return 3;
    }
    uint16_t settings = sampler_ranges_settings_mode_set(0x8000u, SAMPLER_SETTINGS_MODE_BUSY);
    settings = sampler_ranges_settings_gain_set(settings, 0xFFFFu);
    settings = sampler_ranges_settings_on_line_set(settings, 0u);
    if (settings != 0x03FDu || sampler_ranges_settings_gain_get(settings) != 0x7Fu) {
        return 4;
    }
    if (SAMPLER_RANGES_SETTINGS_GAIN_MASK != 0x03F8u || SAMPLER_RANGES_SETTINGS_GAIN_SHIFT != 3u) {
        return 5;
    }
    if (SAMPLER_RANGES_ANGLE_SCALE_NUM * 10 != SAMPLER_RANGES_ANGLE_SCALE_DEN ||
        SAMPLER_RANGES_OFFSET_OFFSET_NUM != -40 || SAMPLER_RANGES_OFFSET_OFFSET_DEN != 1 ||
        SAMPLER_RANGES_OFFSET_DEFAULT != 7u || SAMPLER_RANGES_ANGLE_OFF != 32767 ||
        SAMPLER_RANGES_PERCENT_MIN != 0 || SAMPLER_RANGES_PERCENT_MAX != 100u ||
        0 -SAMPLER_RANGES_ANGLE_MIN != 1800 || SAMPLER_RANGES_ANGLE_MAX != 1800 ||
        0 -SAMPLER_RANGES_OFFSET_OFFSET_NUM != 40 ||
        RN1_BAUD != 115200 || strcmp(RN1_PROTOGEN_VERSION, PROTOGEN) != 0 ||
        RN1_PROTOGEN_VERSION_NUMBER != PROTOGEN_NUMBER ||
        SAMPLER_FAR_FAR != 0x80000000u || RN1_LIDAR_DISTANCES_NO_DATAPOINT != 0u) {
        return 6;
    }
    if (strcmp(SAMPLER_RANGES_ANGLE_UNIT, "\xc2\xb0") != 0 || strlen(RN1_SPEC_HASH) != 64u) {
        return 7;
    }
    const uint8_t shorts[] = {0, 0xFF, 0x80, 0x34, 0x12};
    return sampler_filled_numbers_values_at(shorts, 0) == 0x3480FFul ? 0 : 8;
}
"""


MACHINES = {"little": ("cc", []), "big": ("s390x-linux-gnu-gcc", ["qemu-s390x"])}
"""By byte order: a compiler, and what runs its programs."""


@pytest.mark.parametrize("machine", MACHINES)
def test_macros_and_inline_functions(machine: str, tmp_path: Path) -> None:
    for path in (SAMPLER, ROOT / "schemas" / "rn1.yaml"):
        written(path, tmp_path)
    major, minor, patch = map(int, VERSION.split("."))
    known = f'#define PROTOGEN "{VERSION}"\n'
    known += f"#define PROTOGEN_NUMBER {major * 10000 + minor * 100 + patch}\n"
    (tmp_path / "main.c").write_text(f"{known}{PROGRAM}")
    execute(machine, ["main.c", "rn1.c", "sampler.c"], tmp_path)


NAMES = """
#include <string.h>
#include "rn1.h"
#include "sampler.h"

static int differs(const char *name, const char *expected) {
    return strcmp(name, expected) != 0;
}

static int refuses_by_member(void) {
    struct rn1_move_manual fits = {-64, 63}, fast = {64, 63}, sharp = {-64, -65};
    struct rn1_maintenance motor, other;
    struct rn1_sonar sonar = {0x7F, {0, 1, 2, 3, 16383, 16384, 16384}};
    motor.operation = RN1_MAINTENANCE_OPERATION_RUN_MOTOR_CONTROLLER_FLASHER;
    motor.argument.run_motor_controller_flasher.motor_controller = 5;
    other.operation = 1;
    other.argument.other.size = 4;
    return rn1_move_manual_refused(&fits) != NULL ||
           differs(rn1_move_manual_refused(&fast), "speed") ||
           differs(rn1_move_manual_refused(&sharp), "arc") ||
           differs(rn1_maintenance_refused(&motor),
                   "argument.run_motor_controller_flasher.motor_controller") ||
           differs(rn1_maintenance_refused(&other), "argument.other") ||
           differs(rn1_sonar_refused(&sonar), "distances");
}

int main(void) {
    return refuses_by_member() ||
           differs(rn1_message_name(RN1_MESSAGE_GYRO), "gyro") ||
           differs(rn1_message_name(RN1_NO_MESSAGE), "?") ||
           differs(rn1_result_name(RN1_OK), "ok") ||
           differs(rn1_result_name(RN1_ERROR_RANGE), "range") ||
           differs(rn1_reason_name(RN1_TRUNCATED), "truncated") ||
           differs(rn1_reason_name(RN1_NO_REASON), "?") ||
           differs(sampler_settings_mode_name(SAMPLER_SETTINGS_MODE_BUSY), "busy") ||
           differs(sampler_settings_mode_name(255), "?");
}
"""


@pytest.mark.parametrize("machine", MACHINES)
def test_names_for_logs(machine: str, tmp_path: Path) -> None:
    for path in (SAMPLER, ROOT / "schemas" / "rn1.yaml"):
        written(path, tmp_path)
    (tmp_path / "main.c").write_text(NAMES)
    defined = ["-DRN1_NAMES", "-DSAMPLER_NAMES"]
    execute(machine, [*defined, "main.c", "rn1.c", "sampler.c"], tmp_path)


ROUND_TRIP = """
static int trip_{name}(const uint8_t *payload, size_t size) {{
    {message}uint8_t again[{room} + 1];
    size_t made = 0;
    return {decode}({given}payload, size) == {ok} &&
           {encode}({given}again, sizeof again, &made) == {ok} && made == size &&
           memcmp(again, payload, size) == 0;
}}
"""


@pytest.mark.parametrize("path", SAMPLERS, ids=name_of)
@pytest.mark.parametrize("machine", MACHINES)
def test_payloads_come_back_on_any_machine(machine: str, path: Path, tmp_path: Path) -> None:
    name = protocol_of(path).name
    write_sources(protocol_of(path), tmp_path, payloads_only=True)
    functions, calls = [], []
    for case in (case for case in CASES if case.path == path):
        view = case.codec.view
        functions.append(
            ROUND_TRIP.format(
                name=view.name,
                message=f"{view.struct} message;\n    " if view.struct else "",
                given="&message, " if view.struct else "",
                room=next(m.name for m in view.record.constants if "_PAYLOAD_MAX" in m.name),
                decode=view.decode,
                encode=view.encode,
                ok=f"{name.upper()}_OK",
            )
        )
        for payload, _ in case.contents():
            literal = ", ".join(map(str, payload)) or "0"
            trip = f"trip_{view.name}((const uint8_t[]){{{literal}}}, {len(payload)})"
            calls.append(f"    if (!{trip}) {{ return {min(len(calls) + 1, 255)}; }}")
    head = f'#include "{name}.h"\n#include <string.h>\n'
    main = ["int main(void) {", *calls, "    return 0;", "}", ""]
    (tmp_path / "main.c").write_text("\n".join([head, *functions, *main]))
    execute(machine, ["main.c", f"{name}.c"], tmp_path)


def execute(machine: str, sources: list[str], folder: Path) -> None:
    compiler, runner = MACHINES[machine]
    run([require_tool(compiler), *FLAGS, "-static", *sources, "-o", "main"], folder)
    run([*map(require_tool, runner), folder / "main"], folder)


def test_names_of_values_are_no_words_of_a_language(tmp_path: Path) -> None:
    path = tmp_path / "words.yaml"
    path.write_text(
        "protocol: words\nendpoints: {board: Board}\n"
        "transparency: slip\n"
        "frame: {payload: {}, end: {literal: 0xC0}}\n"
        "messages:\n  state:\n    from: board\n    fields:\n"
        "      mode: {type: uint8, values: {none: 0, default: 1, static: 2, float: 3, self: 4}}\n"
        "      run: {type: uint8, bits: {low: {bits: 0..3, values: {function: 0, union: 1}}}}\n",
        encoding="utf-8",
    )
    protocol = compile_file(path).protocol
    assert protocol is not None
    assert [entry.name for entry in module_of(protocol).StateMode] == [
        "NONE", "DEFAULT", "STATIC", "FLOAT", "SELF",
    ]  # fmt: skip
    (header,) = emit([protocol], COptions(style="single"))
    (tmp_path / "words.h").write_text(header.text, encoding="utf-8")
    names = "WORDS_STATE_MODE_STATIC + WORDS_STATE_MODE_SELF + WORDS_STATE_RUN_LOW_UNION"
    include = '#define WORDS_IMPLEMENTATION\n#include "words.h"\n'
    text = f"{include}int main(void) {{ return {names} - 7; }}\n"
    (tmp_path / "main.c").write_text(text, encoding="utf-8")
    run([require_tool("cc"), *FLAGS, "main.c", "-o", "main"], tmp_path)
    run([tmp_path / "main"], tmp_path)


def written(path: Path, folder: Path) -> Path:
    write_sources(protocol_of(path), folder)
    return folder


def run(command: Sequence[str | Path], folder: Path) -> None:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
