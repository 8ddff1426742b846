"""EVA finds nothing that could go wrong in generated decoders, whatever they are given.

`PROTOGEN_PROVE_ALL=1` also proves the framings of the tests, and all of it for words of 64 and of
16 bits, with and without invalid events.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from c_proof.annotations import OPTIONS, annotated, contracted, fed, followed, sums_in
from c_proof.drivers import (
    SUMMED,
    Driver,
    decode_driver,
    first_driver,
    known_in,
    push_driver,
    sums_driver,
)
from c_proof.eva import MACHINES, Report, analyse
from c_proof.generated import Generated, generate
from c_proof.in_place import in_place_driver
from c_proof.needs import needs
from c_proof.others import others_driver
from c_proof.sending import filled, send_driver, unrolled
from compiled import DIALECTS, DOCUMENTS, ROOT, SCHEMAS, name_of, protocol_of
from tooling import PROVE_ALL

from protogen.copying import replace
from protogen.targets.c.options import EVENTS, COptions, Events

WIDE, NARROW = MACHINES
SLOW = ("dagny_library", "rflex_drivers")
"""Cases that take minutes: long arrays that fill payloads; some documents have them too."""
SLOW_ALL = ("dagny",)
"""Documents whose decoder takes long: with all events it is proved for wide words, with messages
alone for narrow ones. The other documents have all four."""
CONSTRUCTS = [
    ROOT / "tests" / "framings" / f"{name}.yaml"
    for name in ("packed_bits", "digits_line", "written_line")
]
"""Schemas of what no document has, and C has to parse."""
ELEMENTS = ROOT / "tests" / "c_schemas" / "elements.yaml"
"""Floats in arrays."""
WRITTEN = ROOT / "tests" / "c_proof" / "written.yaml"
"""Arrays whose number of elements varies, in frames that are stuffed and that are not."""
NUMBERS_FIRST = ROOT / "tests" / "c_proof" / "first.yaml"
"""Arrays whose numbers of elements are given first."""
TRIMMED = ROOT / "tests" / "framings" / "trimmed_stuffed.yaml"
"""Payloads that a decoder fills up in its buffer."""
DIGITS = ROOT / "tests" / "framings" / "digit_words.yaml"
"""Digits around a payload, which a decoder reads and compares."""
COBS = ROOT / "tests" / "framings" / "cobs.yaml"
HDLC = ROOT / "tests" / "framings" / "hdlc.yaml"
"""Frames that are judged at their end, where messages alone are asked for."""
PROBE = ROOT / "benchmarks" / "c" / "probe.yaml"
"""Frames whose bytes are looked through again where a start was a false one."""
IDLE = ROOT / "tests" / "framings" / "idle_end.yaml"
"""Frames that only a silence ends, so that a decoder holds one byte more than they have."""
BITS = ROOT / "tests" / "c_schemas" / "part_bits.yaml"
"""Parts of frames whose bits are parts, which a decoder reads and compares."""
MIRRORS = ROOT / "tests" / "c_schemas" / "mirrors.yaml"
"""Parts of frames that follow from others, with which a decoder compares them."""
FORMS = ROOT / "tests" / "framings" / "trimmed_forms.yaml"
"""Two forms of frame, for which there is one decoder beside those of each form.

Of payloads that are filled up in room of their own, EVA does not see that they are as long as their
events say.
"""
SEQUENCES = ROOT / "tests" / "framings" / "sequences_marked.yaml"
"""Frames in which sequences of bytes are replaced."""
SIZED = ROOT / "tests" / "framings" / "sized_arrays.yaml"
"""Arrays whose number of bytes is told, which a decoder checks."""
TOLD = ROOT / "tests" / "told_schemas" / "answers.yaml"
"""Frames whose identity is told, at any time."""
LENGTHS = ROOT / "tests" / "told_schemas" / "lengths.yaml"
"""Frames whose length is told, at any time: also to a decoder of two forms."""
HELD = ROOT / "tests" / "framings" / "part_fields.yaml"
"""Numbers of the frame that are fields, which a decoder gives to the check of a payload."""
TOLD_BY_PARTS = ROOT / "tests" / "framings" / "part_fields_alone.yaml"
"""Fields that a number of the frame counts, one alone: EVA takes each of its values apart."""
DECODES = [
    (path, machine)
    for path in (*DOCUMENTS, *DIALECTS, *CONSTRUCTS, TOLD_BY_PARTS)
    for machine in MACHINES[: 1 + PROVE_ALL]
    if PROVE_ALL or path.stem not in SLOW
]
PUSHES: list[tuple[Path, Events, str]] = (
    [
        (path, events, machine)
        for path in (*SCHEMAS, BITS, MIRRORS, TOLD, LENGTHS)
        for events in EVENTS
        for machine in MACHINES
    ]
    if PROVE_ALL
    else [
        *((path, EVENTS[0], WIDE) for path in (*DOCUMENTS, *DIALECTS, *CONSTRUCTS, DIGITS, IDLE)),
        *((path, "messages", NARROW) for path in (*DOCUMENTS, *DIALECTS)),
        *((path, "all", NARROW) for path in DOCUMENTS if path.stem not in SLOW_ALL),
        (TRIMMED, "messages", WIDE),
        (SEQUENCES, "messages", WIDE),
        (SIZED, "messages", WIDE),
        (BITS, "messages", WIDE),
        (COBS, "messages", WIDE),
        (HDLC, "messages", NARROW),
        (PROBE, "messages", NARROW),
        (MIRRORS, "messages", NARROW),
        (HELD, "all", WIDE),
        (FORMS, "messages", WIDE),
        (TOLD, "all", WIDE),
        (TOLD, "messages", NARROW),
        (LENGTHS, "messages", WIDE),
    ]
)
FIRST = [ROOT / "schemas" / f"{name}.yaml" for name in ("matty", "rn1")]
"""Whose smallest frames are small enough to follow each way through the decoder alone."""
MATTY = ROOT / "schemas" / "matty.yaml"


FED = (*DOCUMENTS, *DIALECTS, COBS, HDLC, PROBE)
"""Those whose decoders get several bytes at once, too: of documents and dialects, and one for each
way in which a decoder that is polled is printed."""
LOADED = ("matty", "uherobot", "uherobot_daemon", "probe")
"""Those whose events are dispatched. In others that copies arrays of any number of elements: EVA
does not see that this is what the size of the payload says; they are dispatched behind `decode`."""
CONTRACTED = {path.stem for path in (*DOCUMENTS, *DIALECTS)}
"""Protocols whose contracts say what `load` asks of a payload (`test_c_contracts.py`)."""
UHEROBOT = ROOT / "schemas" / "uherobot.yaml"

SUMMING = [
    *(ROOT / "schemas" / f"{name}.yaml" for name in ("dagny", "matty")),
    *(ROOT / "tests" / "framings" / f"{name}.yaml" for name in ("folded_sums", "forms")),
    HDLC,
    PROBE,
]
"""One for each way in which a checksum takes a byte, but for Fletcher's."""
SMALL = [
    *sorted((ROOT / "tests" / "c_proof" / "schemas").glob("*.yaml")),
    ROOT / "tests" / "framings" / "terminated_alone.yaml",
]
"""Payloads of few bytes, so that each place where a part of them ends can be followed alone."""


def decode_driver_of(made: Generated) -> Driver:
    """The driver of all `decode` functions, as they are now."""
    assert made.source is not None
    header, source = (path.read_text(encoding="utf-8") for path in (made.header, made.source))
    asked = needs(made.protocol, header) if made.protocol.name in CONTRACTED else {}
    return decode_driver(made.protocol, header, source, asked)


def prove(made: Generated, driver: Driver, machine: str = WIDE, *, first: bool = False) -> Report:
    """Analyse a driver of generated code: all of it, or up to its first alarm."""
    assert made.source is not None
    plain = made.source.read_text(encoding="utf-8")
    made.source.write_text(contracted(plain), encoding="utf-8")
    sums = sums_in(plain)
    options = (*driver.options, *([f"-eva-use-spec={','.join(sums)}"] if sums else []))
    return prove_as_it_is(made, replace(driver, options=options), machine, first=first)


def prove_as_it_is(
    made: Generated, driver: Driver, machine: str = WIDE, *, first: bool = False
) -> Report:
    """Analyse a driver, and all functions that it calls."""
    source = made.folder / "driver.c"
    source.write_text(driver.text, encoding="utf-8")
    assert made.source is not None
    generated = made.source.read_text(encoding="utf-8")
    options = known_in(f"{driver.text}{generated}", driver.options)
    return analyse(source, made.folder, machine, *options, first=first)


def prove_sums(made: Generated, machine: str = WIDE, *, first: bool = False) -> Report:
    """Analyse what runs checksums over bytes."""
    assert made.source is not None
    plain = made.source.read_text(encoding="utf-8")
    made.source.write_text(followed(plain, SUMMED), encoding="utf-8")
    driver = sums_driver(made.protocol, sums_in(plain))
    return prove_as_it_is(made, driver, machine, first=first)


@pytest.mark.parametrize("path", SUMMING, ids=name_of)
@pytest.mark.parametrize("machine", MACHINES)
def test_no_bytes_harm_what_sums_them_up(path: Path, machine: str, tmp_path: Path) -> None:
    report = prove_sums(generate(protocol_of(path), tmp_path), machine)
    assert (report.alarms, report.found) == (0, ())


def test_a_sum_of_bytes_too_far_away_is_found(tmp_path: Path) -> None:
    made = generate(protocol_of(MATTY), tmp_path)
    assert made.source is not None
    changed(made.source, r"data\+\+;", "data = &data[2];")
    report = prove_sums(made, first=True)
    assert report.alarms > 0


@pytest.mark.parametrize(("path", "machine"), DECODES, ids=name_of)
def test_no_payload_harms_a_decode_function(path: Path, machine: str, tmp_path: Path) -> None:
    protocol = protocol_of(path)
    made = generate(protocol, tmp_path)
    driver = decode_driver_of(made)
    assert len(driver.proves) == len(protocol.messages)
    report = prove(made, driver, machine)
    assert (report.alarms, report.found) == (0, ())


def prove_small(made: Generated, *, first: bool = False) -> Report:
    """Analyse `decode` of payloads that say where they end, one place at a time."""
    assert made.source is not None
    driver = decode_driver_of(made)
    plain = made.source.read_text(encoding="utf-8")
    made.source.write_text(annotated(plain), encoding="utf-8")
    return prove(made, replace(driver, options=OPTIONS), first=first)


@pytest.mark.parametrize("path", SMALL, ids=name_of)
def test_no_small_payload_that_says_where_it_ends_harms_decode(path: Path, tmp_path: Path) -> None:
    protocol = protocol_of(path)
    report = prove_small(generate(protocol, tmp_path))
    assert (report.alarms, report.found) == (0, ())


@pytest.mark.parametrize("path", SMALL, ids=name_of)
def test_annotations_are_comments(path: Path, tmp_path: Path) -> None:
    made = generate(protocol_of(path), tmp_path)
    assert made.source is not None
    plain = made.source.read_text(encoding="utf-8")
    with_comments = annotated(plain)
    assert with_comments.count("//@ split") > 1
    assert re.sub(r" +//@ (split .*;\n +;|slevel merge;)\n", "", with_comments) == plain


def prove_sending(made: Generated, *, first: bool = False) -> Report:
    """Analyse what encodes and sends messages of up to `GREATEST` bytes."""
    assert made.source is not None
    header, source = (path.read_text(encoding="utf-8") for path in (made.header, made.source))
    made.source.write_text(unrolled(source), encoding="utf-8")
    made.header.write_text(filled(header), encoding="utf-8")
    return prove(
        made, send_driver(made.protocol, header, source, stuffs_great=PROVE_ALL), first=first
    )


def plain_driver(made: Generated, path: Path) -> Driver:
    """The driver of decoders that get bytes one at a time."""
    header = made.header.read_text(encoding="utf-8")
    return push_driver(made.protocol, header, reads_ends=path != FORMS)


def whole_driver(made: Generated, *, loads: bool = True) -> Driver:
    """The driver of decoders that also get several at a time, and of what takes their events."""
    assert made.source is not None
    header = made.header.read_text(encoding="utf-8")
    plain = made.source.read_text(encoding="utf-8")
    made.source.write_text(fed(plain, header), encoding="utf-8")
    return push_driver(made.protocol, header, feeds=True, loads=loads)


@pytest.mark.parametrize(("path", "events", "machine"), PUSHES, ids=name_of)
def test_no_input_harms_a_decoder(path: Path, events: Events, machine: str, tmp_path: Path) -> None:
    protocol = protocol_of(path)
    made = generate(protocol, tmp_path, COptions(events=events))
    if path in FED:
        driver = whole_driver(made, loads=path.stem in LOADED)
    else:
        driver = plain_driver(made, path)
    together = [name for name in protocol.sending if len(protocol.forms(name)) > 1]
    assert len(driver.proves) == len(protocol.senders) + len(together)
    report = prove(made, driver, machine)
    assert (report.alarms, report.found) == (0, ())


@pytest.mark.parametrize("path", [*DOCUMENTS, *DIALECTS], ids=name_of)
def test_no_message_harms_what_encodes_and_sends_it(path: Path, tmp_path: Path) -> None:
    report = prove_sending(generate(protocol_of(path), tmp_path))
    assert (report.alarms, report.found) == (0, ())


@pytest.mark.parametrize("path", FIRST, ids=name_of)
def test_no_event_has_bytes_that_were_not_received(path: Path, tmp_path: Path) -> None:
    protocol = protocol_of(path)
    made = generate(protocol, tmp_path, COptions(events="messages"))
    report = prove(made, first_driver(protocol, made.header.read_text(encoding="utf-8")))
    assert (report.alarms, report.found) == (0, ())


@pytest.mark.parametrize(
    ("document", "only"),
    [
        ("matty", "status"),
        ("rflex", "request_system_status"),
        ("rn1", "gyro"),
        ("dagny", "motor"),
    ],
)
def test_no_input_harms_a_decoder_of_one_message(document: str, only: str, tmp_path: Path) -> None:
    """Its frames have one size, which it does not keep. Fed and dispatched, too."""
    protocol = protocol_of(ROOT / "schemas" / f"{document}.yaml")
    made = generate(protocol, tmp_path, COptions(events="messages", only=(only,)))
    driver = whole_driver(made)
    report = prove(made, driver, NARROW)
    assert (report.alarms, report.found) == (0, ())


def prove_others(made: Generated, *, first: bool = False) -> Report:
    """Analyse names, counters, and frames that go out in pieces."""
    assert made.source is not None
    header, source = (path.read_text(encoding="utf-8") for path in (made.header, made.source))
    return prove_as_it_is(made, others_driver(made.protocol, header, source), first=first)


@pytest.mark.parametrize("events", EVENTS)
@pytest.mark.parametrize("path", [*DOCUMENTS, *DIALECTS], ids=name_of)
def test_no_value_harms_names_counters_and_frames_in_pieces(
    path: Path, events: Events, tmp_path: Path
) -> None:
    report = prove_others(generate(protocol_of(path), tmp_path, COptions(events=events)))
    assert (report.alarms, report.found) == (0, ())


def test_a_value_without_a_name_is_found(tmp_path: Path) -> None:
    made = generate(protocol_of(MATTY), tmp_path)
    assert made.source is not None
    changed(made.source, r'return "\?";', "return NULL;")
    assert prove_others(made, first=True).alarms > 0


def prove_in_place(made: Generated, machine: str = WIDE, *, first: bool = False) -> Report:
    """Analyse what writes messages field by field in their frames."""
    assert made.source is not None
    made.source.write_text(unrolled(made.source.read_text(encoding="utf-8")), encoding="utf-8")
    header = made.header.read_text(encoding="utf-8")
    return prove(made, in_place_driver(made.protocol, header), machine, first=first)


def test_no_input_harms_a_decoder_that_keeps_the_last_bytes(tmp_path: Path) -> None:
    """Small frames of several messages, pushed, fed and dispatched."""
    protocol = protocol_of(ROOT / "schemas" / "dagny.yaml")
    only = ("motor", "steering", "reflex", "power")
    made = generate(protocol, tmp_path, COptions(events="messages", only=only))
    assert made.source is not None
    assert "decoder->passed" in made.source.read_text(encoding="utf-8")
    report = prove(made, whole_driver(made), NARROW)
    assert (report.alarms, report.found) == (0, ())


BEGUN = [
    (path, machine) for path in (ROOT / "schemas" / "rn1.yaml", ELEMENTS) for machine in MACHINES
]
BEGUN += [
    (path, machine)
    for path in (WRITTEN, NUMBERS_FIRST)
    for machine in (MACHINES if PROVE_ALL else MACHINES[:1])
]
"""Numbers of elements that vary take half a minute for each machine."""


@pytest.mark.parametrize(("path", "machine"), BEGUN, ids=name_of)
def test_no_index_and_no_value_harms_a_frame_that_was_begun(
    path: Path, machine: str, tmp_path: Path
) -> None:
    report = prove_in_place(generate(protocol_of(path), tmp_path), machine)
    assert (report.alarms, report.found) == (0, ())


# --- faults that have to be seen ------------------------------------------------------------------


def changed(path: Path, pattern: str, replacement: str) -> str:
    """Change a generated file; returns what it was."""
    before = path.read_text(encoding="utf-8")
    after, count = re.subn(pattern, replacement, before)
    assert count, f"{path.name} has no {pattern}"
    path.write_text(after, encoding="utf-8")
    return before


def test_a_feed_that_reads_a_byte_too_many_is_found(tmp_path: Path) -> None:
    made = generate(protocol_of(MATTY), tmp_path)
    assert made.source is not None
    changed(made.source, r"while \(index < size\)", "while (index <= size)")
    report = prove(made, whole_driver(made), first=True)
    assert any("uninitialized" in found or "out of bounds" in found for found in report.found)


def test_a_load_that_writes_a_byte_too_many_is_found(tmp_path: Path) -> None:
    made = generate(protocol_of(MATTY), tmp_path, COptions(events="messages"))
    assert made.source is not None
    changed(made.source, r"(_copy\(message->nmea, [^;]*size)\);", r"\1 + 1U);")
    report = prove(made, whole_driver(made), first=True)
    assert any("out of bounds" in found for found in report.found)


@pytest.mark.parametrize(
    ("pattern", "fault"),
    [
        (
            r"return 2U \* content;",
            "return 2U * content - 1U;",
        ),  # Of these two bytes, one was to spare.
        (r"capacity < 21U", "capacity < 20U"),
    ],
)
def test_a_frame_that_needs_more_than_it_asks_for_is_found(
    pattern: str, fault: str, tmp_path: Path
) -> None:
    made = generate(protocol_of(UHEROBOT), tmp_path)
    assert made.source is not None
    changed(made.source, pattern, fault)
    assert any("out of bounds" in found for found in prove_sending(made, first=True).found)


def test_an_index_that_is_too_great_by_one_is_found(tmp_path: Path) -> None:
    made = generate(protocol_of(ROOT / "schemas" / "rn1.yaml"), tmp_path)
    changed(made.header, r"if \(index >= 360U\)", "if (index > 360U)")
    assert any("out of bounds write" in found for found in prove_in_place(made, first=True).found)


def test_an_index_past_a_number_that_was_worked_out_is_found(tmp_path: Path) -> None:
    made = generate(protocol_of(NUMBERS_FIRST), tmp_path)
    changed(made.header, r"if \(index >= amount\)", "if (index > amount)")
    assert any("out of bounds write" in found for found in prove_in_place(made, first=True).found)


def test_a_buffer_that_is_too_small_by_a_byte_is_found(tmp_path: Path) -> None:
    made = generate(protocol_of(MATTY), tmp_path)
    header = changed(made.header, r"uint8_t buffer\[126\];", "uint8_t buffer[125];")
    report = prove(made, push_driver(made.protocol, header), first=True)
    assert report.alarms > 0
    assert any("out of bounds" in found for found in report.found)


def test_a_buffer_that_a_polled_decoder_writes_behind_is_found(tmp_path: Path) -> None:
    made = generate(protocol_of(MATTY), tmp_path, COptions(events="messages"))
    header = changed(made.header, r"uint8_t buffer\[124\];", "uint8_t buffer[123];")
    report = prove(made, push_driver(made.protocol, header), first=True)
    assert any("out of bounds" in found for found in report.found)


def test_an_event_that_is_not_filled_is_found(tmp_path: Path) -> None:
    made = generate(protocol_of(MATTY), tmp_path, COptions(events="messages"))
    header = changed(made.header, r"    event->payload = .*;\n", "")
    report = prove(made, push_driver(made.protocol, header), first=True)
    assert any("uninitialized" in found for found in report.found)


def test_more_payload_than_was_received_is_found(tmp_path: Path) -> None:
    """It is in the buffer all right, but from an earlier frame, or from nowhere."""
    made = generate(protocol_of(MATTY), tmp_path, COptions(events="messages"))
    header = changed(made.header, r"(event->payload_size = payload);", r"\1 + 2U;")
    report = prove(made, first_driver(made.protocol, header), first=True)
    assert any("event->payload + i" in found for found in report.found), report.found


def test_a_member_that_is_too_small_by_an_element_is_found(tmp_path: Path) -> None:
    made = generate(protocol_of(MATTY), tmp_path)
    changed(made.header, r"\bnmea\[121\];", "nmea[120];")
    report = prove(made, decode_driver_of(made), first=True)
    assert report.alarms > 0


def test_an_element_that_is_read_behind_a_payload_is_found(tmp_path: Path) -> None:
    made = generate(protocol_of(UHEROBOT), tmp_path)
    changed(made.header, r"at = payload \+ 4U \+ 2U \* index;", "at = payload + 5U + 2U * index;")
    report = prove(made, decode_driver_of(made), first=True)
    assert any("out of bounds read" in found for found in report.found)


def test_a_dispatch_that_loads_more_than_was_decoded_is_found(tmp_path: Path) -> None:
    made = generate(protocol_of(UHEROBOT), tmp_path)
    assert made.source is not None
    changed(made.source, r"_load\(&message, event->payload", r"_load(&message, event->payload + 1")
    report = prove(made, decode_driver_of(made), first=True)
    assert any("out of bounds read" in found for found in report.found)


def test_a_size_that_is_not_checked_is_found(tmp_path: Path) -> None:
    made = generate(protocol_of(MATTY), tmp_path)
    assert made.source is not None
    changed(made.source, r"(size != )18([uU]\) \{\s+return MATTY_ERROR_SIZE)", r"\g<1>17\2")
    report = prove(made, decode_driver_of(made), first=True)
    assert report.alarms > 0
    assert any("out of bounds read" in found for found in report.found)


def test_a_decoder_that_forgets_a_bound_is_found(tmp_path: Path) -> None:
    """The length that a frame may have at most."""
    made = generate(protocol_of(MATTY), tmp_path)
    assert made.source is not None
    changed(made.source, r"length > 123U", "length > 124U")
    report = prove(
        made, push_driver(made.protocol, made.header.read_text(encoding="utf-8")), first=True
    )
    assert report.alarms > 0


@pytest.mark.parametrize(
    ("name", "pattern", "fault"),
    [
        ("terminated", r"length > 2U\)", "length > 3U)"),
        ("terminated", r"length == size - at", "length == size + 1U - at"),
        ("separated", r"length_3 > 2U", "length_3 > 3U"),
    ],
)
def test_a_check_of_an_end_that_is_wrong_by_one_is_found(
    name: str, pattern: str, fault: str, tmp_path: Path
) -> None:
    made = generate(protocol_of(ROOT / f"tests/c_proof/schemas/{name}.yaml"), tmp_path)
    assert made.source is not None
    changed(made.source, pattern, fault)
    report = prove_small(made, first=True)
    assert any("out of bounds" in found for found in report.found)


@pytest.mark.parametrize(("name", "member"), [("last_elements", "hops"), ("sized", "words")])
def test_an_array_that_is_too_small_for_what_a_check_allows_is_found(
    name: str, member: str, tmp_path: Path
) -> None:
    made = generate(protocol_of(ROOT / f"tests/c_proof/schemas/{name}.yaml"), tmp_path)
    one_less = {"hops": "hops[2];", "words": "words[1];"}[member]
    changed(made.header, rf"\b{member}\[\d\];", one_less)
    report = prove_small(made, first=True)
    assert any("out of bounds" in found for found in report.found)
