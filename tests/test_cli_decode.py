"""`protogen decode` and back: events as text and as JSON lines, from every kind of input."""

from __future__ import annotations

import json
from itertools import groupby
from pathlib import Path

import pytest
from cli_support import ROOT, run, start
from compiled import module_at, protocol_of
from hypothesis import assume, given
from hypothesis import strategies as st

from protogen.cli.wire import codec
from protogen.cli.wire.tagged import Piece, tagged_pieces
from protogen.recording import Recorder

MATTY = str(ROOT / "schemas" / "matty.yaml")
RFLEX = str(ROOT / "schemas" / "rflex.yaml")
RN1 = str(ROOT / "schemas" / "rn1.yaml")

# go: counter 1, speed 500 = 01F4, steer -250 = FF06; 06 01 47 F4 01 06 FF add up to 48 modulo 256.
GO = "55 06 01 47 F4 01 06 FF B8"
# stop with a checksum of 00 instead of AA, and an unknown command Z: 02 05 5A add up to 61.
BAD = "55 02 01 53 00"
STRANGE = "55 02 05 5A 9F"
CAPTURE = bytes.fromhex(f"0011 {GO} {BAD} {STRANGE}")


def test_text_has_offset_name_and_values() -> None:
    result = run("decode", MATTY, "--sender", "pc", "--hex", CAPTURE.hex())
    assert result.exit_code == 0
    assert result.output.splitlines() == [
        "       0  invalid   noise  00 11",
        "       2  go        @counter=1 speed=500mm/s steer=-2.5deg",
        "      11  invalid   checksum: crc is 00, not aa  55 02 01 53 00",
        "      16  unknown   @counter=5 @command=90 payload=hex:",
    ]


def test_text_names_values() -> None:
    # rn1 lidar: status 3, a distance of none, one of 5008, then 358 of none.
    frame = "84 03 0000 1027" + "0000" * 358
    result = run("decode", RN1, "--sender", "brain", "--hex", frame)
    assert "lidar" in result.output
    assert "status=initialized|speed_in_spec distances=[no_datapoint, 5008mm," in result.output
    assert result.output.rstrip().endswith("... 360 in all]")


def test_long_noise_is_shortened() -> None:
    result = run("decode", MATTY, "--sender", "pc", "--hex", "00" * 40)
    assert result.output.endswith("00 ... 40 bytes\n")


def test_lines_of_json() -> None:
    result = run("decode", MATTY, "--sender", "pc", "--format", "jsonl", input=CAPTURE)
    lines = result.stdout.splitlines()
    assert lines[1] == (
        '{"offset": 2, "size": 9, "event": "message", "message": "go", "sender": "pc", '
        '"parts": {"counter": 1, "command": 71}, "fields": {"speed": 500, "steer": -250}}'
    )
    assert [json.loads(line) for line in lines][::2] == [
        {
            "offset": 0,
            "size": 2,
            "event": "invalid",
            "sender": "pc",
            "reason": "noise",
            "raw": "0011",
        },
        {
            "offset": 11,
            "size": 5,
            "event": "invalid",
            "sender": "pc",
            "reason": "checksum",
            "raw": "5502015300",
        },
    ]
    assert json.loads(lines[3])["event"] == "unknown"
    assert json.loads(lines[3])["parts"] == {"counter": 5, "command": 90}


def test_file_and_standard_input_are_the_same(tmp_path: Path) -> None:
    file = tmp_path / "capture.bin"
    file.write_bytes(CAPTURE)
    from_file = start("decode", MATTY, str(file), "--sender", "pc").stdout
    assert from_file == start("decode", MATTY, "-", "--sender", "pc", input=CAPTURE).stdout
    assert from_file == start("decode", MATTY, "--sender", "pc", input=CAPTURE).stdout
    assert from_file.count(b"\n") == 4


def test_hex_file() -> None:
    text = f"# a capture\n0x00, 0x11\n{GO}\n".encode()
    result = run("decode", MATTY, "--sender", "pc", "--input", "hex", input=text)
    assert [line.split()[1] for line in result.output.splitlines()] == ["invalid", "go"]


def test_strict_fails_if_any_byte_is_in_no_frame() -> None:
    arguments = ("decode", MATTY, "--sender", "pc", "--strict", "--hex")
    assert run(*arguments, GO).exit_code == 0
    assert run(*arguments, STRANGE).exit_code == 0
    assert run(*arguments, f"00 {GO}").exit_code == 1
    assert run(*arguments[:-2], "--hex", f"00 {GO}").exit_code == 0


def test_the_only_sender_need_not_be_named(tmp_path: Path) -> None:
    schema = tmp_path / "one.yaml"
    schema.write_text("""\
protocol: one
endpoints: {pc: Computer}
frame:
  id: {type: uint8, id: true, range: [1, 1]}
  payload: {}
  check: {type: uint8, algorithm: xor-8, covers: id}
messages:
  ping: {id: 1, from: pc}
""")
    result = run("decode", str(schema), "--hex", "01 01")
    assert result.output == "       0  ping\n"


MERGED = """\
protocol: merged
endpoints: {board: The board}
byte_order: big
frame:
  id: {type: uint8, id: true}
  payload: {}
  crc: {type: uint16, algorithm: ALGORITHM, covers: [id, payload]}
  end: {literal: 0xC0}
transparency: slip
messages:
  text: {id: 1, from: board, fields: {data: {type: bytes, size: {fill: true, max: 40}}}}
"""


@pytest.mark.parametrize(
    ("algorithm", "first", "second", "kind"),
    [
        ("CRC-16/XMODEM", "01 6F 6E 65 D5 C8", "01 74 77 6F 7E FB C0", "text"),
        ("CRC-16/IBM-3740", "01 6F 6E 65 51 08", "01 74 77 6F FA 3B C0", "invalid"),
    ],
)
def test_a_crc_without_init_does_not_see_a_lost_end(
    tmp_path: Path, algorithm: str, first: str, second: str, kind: str
) -> None:
    # What docs/reference/decoder.md warns of: two good frames, without the C0 between them.
    schema = tmp_path / "merged.yaml"
    schema.write_text(MERGED.replace("ALGORITHM", algorithm))
    (whole,) = run("decode", str(schema), "--hex", f"{first} {second}").output.splitlines()
    assert whole.split()[:2] == ["0", kind]
    parted = run("decode", str(schema), "--hex", f"{first} C0 {second}").output.splitlines()
    assert [line.split()[1] for line in parted] == ["text", "text"]


# --- logs of both directions ----------------------------------------------------------------------

LOG = """\
# startup, from the document
Linux: 1B 02 05 05 00 04 00 00 27 10 37 1B 03

Flex : 1B 02 05 05 00 08 00 00 00
flex: 00 03 63 87 27 C0 1B 03
"""


def test_tagged_log() -> None:
    result = run("decode", RFLEX, "--tagged", input=LOG)
    assert result.exit_code == 0
    assert result.output.splitlines() == [
        "       0  linux  initialize_digital_io             @number=5 unknown=10000",
        "       0  flex   confirm_initialize_digital_io     @number=5 unknown=0 timestamp=56854311",
    ]


def test_tagged_log_of_one_sender() -> None:
    result = run("decode", RFLEX, "--input", "tagged", "--sender", "flex", input=LOG)
    assert [line.split()[1] for line in result.output.splitlines()] == [
        "confirm_initialize_digital_io"
    ]


def test_lines_that_can_not_be_used_are_reported() -> None:
    log = LOG + "robot: 00\n1B 02\nflex: 1B 0G\n"
    result = run("decode", RFLEX, "--tagged", input=log)
    assert result.exit_code == 1
    mend = "no sender, or two, in front of the bytes: write `linux: 1B 02` with one of linux, flex"
    assert result.stderr.splitlines() == [
        f"warning: line 6: {mend}",
        f"warning: line 7: {mend}",
        "warning: line 8, column 11: `G` is no hex digit and no separator",
    ]


def test_many_bad_lines_are_counted() -> None:
    result = run("decode", RFLEX, "--tagged", input="x\n" * 50)
    lines = result.stderr.splitlines()
    assert len(lines) == 21
    assert lines[-1] == "warning: 30 more lines can't be used"


@pytest.mark.parametrize(
    "front",
    [
        "pc:",
        "PC : ",
        "[pc]",
        "[pc]: ",
        "pc> ",
        "12:00:01.5 pc: ",
        "2024-05-01T12:00 <pc> ",
        "\t(1) pc>",
    ],
)
def test_forms_of_a_tag(front: str) -> None:
    result = run("decode", MATTY, "--tagged", input=f"{front}{GO}\n")
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout.split()[:3] == ["0", "pc", "go"]


@pytest.mark.parametrize(
    "front",
    ["pc -> esp: ", "pc->esp: ", "pc: esp: ", "xpc: ", "pc ", "esp-pc: ", "# pc: ", "x # pc:"],
)
def test_no_sender_is_guessed(front: str) -> None:
    result = run("decode", MATTY, "--tagged", input=f"{front}{GO}\n")
    assert result.stdout == ""
    assert result.exit_code == (0 if front.startswith("#") else 1)


def test_a_long_line_is_read_in_pieces() -> None:
    pieces = iter([b"pc: 55", *[b" 02" * 20_000] * 50, b"\nesp: 01"])
    found = list(tagged_pieces(pieces, ("pc", "esp"), pytest.fail))
    assert max(len(piece.data) for piece in found) < 100_000
    assert (
        b"".join(piece.data for piece in found if piece.sender == "pc") == b"\x55" + b"\2" * 10**6
    )
    assert found[-1] == Piece("esp", b"\1")


def test_a_fault_in_a_long_line_ends_it() -> None:
    complaints: list[str] = []
    pieces = iter([b"pc: 55", *[b" 02" * 30_000] * 3, b" 0G", b" 02" * 30_000, b"\nesp: 01"])
    found = list(tagged_pieces(pieces, ("pc", "esp"), complaints.append))
    assert complaints == ["line 1, column 270009: `G` is no hex digit and no separator"]
    assert found[-1] == Piece("esp", b"\1")


# --- silences in logs with times ------------------------------------------------------------------

TIMED = """
protocol: meter
link: {baud: 9600, idle_timeout: 20 ms}
endpoints: {meter: Meter, reader: Reader}
byte_order: big
frame:
  length:   {type: uint8, counts: payload}
  id:       {type: uint8, id: true}
  payload:  {}
  checksum: {type: uint8, algorithm: sum-8, covers: length..payload}
messages:
  level: {id: 1, from: meter, fields: {level: uint16}}
  ask:   {id: 2, from: reader}
"""
"""A byte of 10 bits takes 1.04 ms."""
LEVEL = "02 01 00 07 0A"  # 2 + 1 + 0 + 7


@pytest.fixture(name="meter")
def schema_of_a_meter(tmp_path: Path) -> str:
    path = tmp_path / "meter.yaml"
    path.write_text(TIMED)
    return str(path)


def kinds(*args: str, input: str) -> list[str]:
    result = run("decode", *args, "--format", "jsonl", input=input)
    assert result.exit_code == 0, result.output
    events = map(json.loads, result.stdout.splitlines())
    return [event.get("message", event["event"]) for event in events]


@pytest.mark.parametrize(
    ("second", "expected"),
    [
        ("(100.019999999)", ["level"]),
        # The three bytes behind it take 3.125 ms, which are no silence.
        ("(100.023124999)", ["level"]),
        ("(100.023125)", ["invalid", "invalid"]),
        ("(99)", ["level"]),
    ],
)
def test_a_silence_ends_what_came_before(meter: str, second: str, expected: list[str]) -> None:
    log = f"(100) ttyUSB0 02 01\n{second} ttyUSB0 00 07 0A\n"
    found = kinds(meter, "--sender", "meter", "--input", "log", "--timed", input=log)
    # What is no frame is told in as many pieces as it was given up in.
    assert [kind for kind, _ in groupby(found)] == [kind for kind, _ in groupby(expected)]
    assert kinds(meter, "--sender", "meter", "--input", "log", input=log) == ["level"]


@pytest.mark.parametrize(
    ("first", "second", "is_silent"),
    [
        ("12:00:01.5", "12:00:01.510", False),
        ("12:00:01.5", "12:00:01.530", True),
        ("12:00:01,5", "12:00:01,530", True),
        ("[12:00:01.5]", "[12:00:01.510]", False),
        ("23:59:59.995", "0:00:00.005", False),
        ("23:59:59.995", "0:00:01", True),
        ("2024-02-29T23:59:59.995", "2024-03-01 00:00:00.005Z", False),
        ("2024-02-29T23:59:59.995", "2024-03-01 00:00:00.125Z", True),
        ("(1700000000.99)", "(1700000001)", False),
        ("1700000000.99", "1700000001.1", True),
    ],
)
def test_ways_to_write_a_time(meter: str, first: str, second: str, is_silent: bool) -> None:
    log = f"{first} meter: 02 01\n{first} reader: 00 02 02\n{second} meter: 00 07 0A\n"
    found = kinds(meter, "--tagged", "--timed", input=log)
    assert ("level" in found) is not is_silent
    assert "ask" in found


IDLE = """
protocol: bus
link: {baud: 9600, idle_timeout: 20 ms}
max_frame: 64
endpoints: {station: Station}
frame:
  id:      {type: uint8, id: true}
  payload: {}
  sum:     {type: uint8, algorithm: sum-8, covers: [id, payload]}
  end:     {idle: 3.5 characters}
messages:
  ready: {id: 1, from: station}
"""


def test_the_silence_that_ends_frames_goes_before_that_of_the_line(tmp_path: Path) -> None:
    """3.5 characters of 10 bits are 3.65 ms, and two bytes take 2.08 ms."""
    path = tmp_path / "bus.yaml"
    path.write_text(IDLE)
    log = "".join(f"({time}) bus0 01 01\n" for time in (1, 1.0057, 1.0115, 1.0173))
    found = kinds(str(path), "--input", "log", "--timed", input=log)
    assert found == ["invalid", "ready", "ready", "ready"]
    whole = IDLE.replace(", idle_timeout: 20 ms", "")
    path.write_text(whole)
    assert kinds(str(path), "--input", "log", "--timed", input=log) == found


def test_frames_without_the_silences_between_them_are_told_of_with_a_hint(tmp_path: Path) -> None:
    path = tmp_path / "bus.yaml"
    path.write_text(IDLE)
    hint = "hint: only a silence ends a frame of station; --timed takes it from a log with times\n"
    assert run("decode", str(path), "--hex", "0101 0101").stderr == hint
    assert run("decode", str(path), "--hex", "0101").stderr == ""
    log = "(1) bus0 02\n(2) bus0 01 01\n"
    assert run("decode", str(path), "--input", "log", "--timed", input=log).stderr == ""


def test_a_recording_is_known_by_its_first_bytes(meter: str, tmp_path: Path) -> None:
    with Recorder(tmp_path / "run.pgrec") as recorder:
        recorder.write(bytes.fromhex("02 01"), t_ns=100 * 10**9, source="meter")
        recorder.write(b"", t_ns=1, source="nobody")
        recorder.write(bytes.fromhex("00 07 0A"), t_ns=100_019_999_999, source="meter")
    for options in ((), ("--timed",), ("--input", "record")):
        assert kinds(meter, *options, str(tmp_path / "run.pgrec"), input="") == ["level"]
    early, late = ((100 * 10**9 + ns).to_bytes(8, "little") for ns in (19_999_999, 23_125_000))
    late_file = tmp_path / "late.pgrec"
    late_file.write_bytes((tmp_path / "run.pgrec").read_bytes().replace(early, late))
    assert set(kinds(meter, "--timed", str(late_file), input="")) == {"invalid"}


def test_bytes_of_a_line_without_a_time_are_decoded_and_complained_of(meter: str) -> None:
    result = run("decode", meter, "--tagged", "--timed", input=f"pump meter: {LEVEL}\n")
    assert result.exit_code == 1
    assert result.stdout.split()[1:] == ["meter", "level", "level=7"]
    mend = "no time in front: write `12:00:01.5 meter: 1B 02`"
    assert result.stderr == f"warning: line 1: {mend}\n"


@pytest.mark.parametrize(
    ("args", "problem"),
    [
        ((RFLEX, "--tagged", "--timed"), "does not say which silence ends a frame"),
        ((MATTY, "--timed"), "--timed needs to know when the bytes were sent"),
        ((MATTY, "--timed", "--hex", "55"), "--timed needs to know when the bytes were sent"),
        ((MATTY, "--input", "log", "--hex", "55"), "--input log is for files with times"),
        ((MATTY, "--input", "log", "--tagged"), "--tagged and --input log exclude each other"),
    ],
)
def test_timed_needs_times_and_a_silence(args: tuple[str, ...], problem: str) -> None:
    result = run("decode", *args, input="")
    assert result.exit_code == 2
    assert problem in result.stderr


def test_lines_of_a_log_are_of_the_sender_that_they_name(meter: str) -> None:
    log = f"(1) meter {LEVEL}\n(2) reader 00 02 02\n(3) can0 {LEVEL}\n"
    assert kinds(meter, "--input", "log", input=log) == ["level", "ask", "level"]
    # What names an interface is from the sender that is asked for, which has no such message.
    found = kinds(meter, "--input", "log", "--sender", "reader", input=log)
    assert found == ["ask", "unknown"]


# --- there and back -------------------------------------------------------------------------------


def back(schema: str, sender: str, capture: bytes) -> bytes:
    lines = run("decode", schema, "--sender", sender, "--format", "jsonl", input=capture).stdout
    result = run("encode", schema, "--format", "raw", input=lines)
    assert result.exit_code == 0, result.output
    return result.stdout_bytes


SENDERS = [
    ("rn1", "host"),
    ("rn1", "brain"),
    ("uherobot", "board"),
    ("dagny", "robot"),
    ("rflex", "flex"),
    ("matty", "pc"),
]


@pytest.mark.parametrize(("name", "sender"), SENDERS)
@given(data=st.binary(max_size=120))
def test_any_bytes_come_back(name: str, sender: str, data: bytes) -> None:
    assume(not data.startswith(b"PGREC"))  # Of a recording, the bytes of its records are read.
    path = ROOT / "schemas" / f"{name}.yaml"
    made = codec.Codec(protocol_of(path), module_at(path))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(codec, "open_codec", lambda schema: made)  # Once for all captures.
        assert back(str(path), sender, data) == data


def test_a_capture_comes_back_through_a_pipe(tmp_path: Path) -> None:
    capture = CAPTURE * 200 + b"\x55\x06"
    lines = start("decode", MATTY, "--sender", "pc", "--format", "jsonl", input=capture).stdout
    result = start("encode", MATTY, "--format", "raw", input=lines)
    assert (result.returncode, result.stdout) == (0, capture)


def test_each_direction_of_a_log_comes_back() -> None:
    lines = run("decode", RFLEX, "--tagged", "--format", "jsonl", input=LOG).stdout
    linux = run("encode", RFLEX, "--sender", "linux", input=lines).stdout
    flex = run("encode", RFLEX, "--sender", "flex", input=lines).stdout
    assert linux == "1B 02 05 05 00 04 00 00 27 10 37 1B 03\n"
    assert flex == "1B 02 05 05 00 08 00 00 00 00 03 63 87 27 C0 1B 03\n"


@pytest.mark.parametrize("command", ["decode", "explain"])
def test_frames_that_only_one_can_have_sent_need_no_sender(command: str) -> None:
    said = run(command, MATTY, "--hex", "55020141BC", "--sender", "esp")
    guessed = run(command, MATTY, "--hex", "55020141BC")
    assert guessed.exit_code == 0, guessed.stderr
    named = "0  esp  ack" if command == "decode" else "0  ack"
    assert guessed.stdout == said.stdout.replace("0  ack", named)


# --- mistakes -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "messages"),
    [
        (
            ["--sender", "esq", "--hex", "00"],
            ["`matty` has no sender `esq`; it has pc, esp", "did you mean `esp`?"],
        ),
        (["--sender", "pc", "--hex", "0x"], ["line 1, column 2: `x` is"]),
        (
            ["--hex", "00", "--tagged"],
            ["--hex is bytes of one sender, --tagged is for lines", "leave out --tagged and give"],
        ),
        (["--sender", "pc", "--hex", "00", "--tagged"], ["--hex is bytes of one sender"]),
        (["--hex", "00", "--input", "tagged"], ["--hex is bytes of one sender"]),
        (["--tagged", "--input", "hex"], ["--tagged and --input hex exclude each other"]),
        (["--sender", "pc", "--format", "xml"], ["'xml' is not one of 'text', 'jsonl'"]),
        (["--sender", "pc", "a.bin", "--hex", "00"], ["there are two captures: a.bin and --hex"]),
        (["--sender", "pc", "--hex", "\udcff"], ["is no hex digit and no separator"]),
        (["--sender", "pc", "missing.bin"], ["missing.bin: No such file or directory"]),
        (["--sender", "pc", "."], ["Is a directory"]),
        (["--sender", "pc", "--input", "wav"], ["wav"]),
    ],
)
def test_mistakes_in_the_call(arguments: list[str], messages: list[str]) -> None:
    result = run("decode", MATTY, *arguments)
    assert result.exit_code == 2
    for message in messages:
        assert message in result.stderr


def test_bad_hex_in_a_file_comes_behind_the_events_before_it() -> None:
    text = f"{GO}\n{GO} 5X".encode()
    result = run("decode", MATTY, "--sender", "pc", "--input", "hex", input=text)
    assert result.exit_code == 2
    assert "line 2, column 29: `X` is no hex digit and no separator" in result.stderr


def test_schema_that_is_not_there() -> None:
    result = run("decode", "nowhere.yaml", "--sender", "pc", "--hex", "00")
    assert (result.exit_code, result.stderr) == (2, "error: there is no schema `nowhere.yaml`\n")


def test_schema_with_an_error(tmp_path: Path) -> None:
    schema = tmp_path / "bad.yaml"
    schema.write_text("protocol: bad\ncolour: red\n")
    result = run("decode", str(schema), "--sender", "pc", "--hex", "00")
    assert result.exit_code == 1
    assert "bad.yaml:2:1: error[" in result.stderr
