"""Complaints of compilers and style checkers about generated C: only those stated with reasons.

What the target deviates from is stated beside it: protogen/targets/c/.clang-tidy and README.md.
`PROTOGEN_PROVE_ALL=1` lets the analyzer of Clang go as deep as it does for users.
"""

from __future__ import annotations

import re
import subprocess
from collections.abc import Sequence
from pathlib import Path

import pytest
from c_proof.generated import Generated, generate
from compiled import DOCUMENTS, FRAMINGS, ROOT, SCHEMAS, covering, name_of, protocol_of
from tooling import PROVE_ALL, require_tool

from protogen.targets.c.options import EVENTS, STYLES, COptions, Events, Style

TARGET = ROOT / "protogen" / "targets" / "c"
WARNINGS = (
    "-Wall",
    "-Wextra",
    "-Wpedantic",
    "-Wconversion",
    "-Wsign-conversion",
    "-Wshadow",
    "-Werror",
)
C99 = {
    "gcc": ("-std=c99", "-O3"),
    "clang": ("-std=c99", "-Os"),
    "avr-gcc": ("-std=c99", "-Os", "-mmcu=atmega328p"),
    "arm-none-eabi-gcc": ("-std=c99", "-Os", "-mcpu=cortex-m0", "-mthumb"),
}
OPTIMISING = ("gcc", "avr-gcc")
"""Compilers that warn of more when they optimise, one for each width of `int`. That for Arm, whose
pointers are narrower than those of the first, only has to take the types."""
COMPILED = ("-S", "-o", "unit.s")
"""Up to machine code as text, for what GCC only says when it optimises."""
PARSED = ("-fsyntax-only",)
"""Up to where types are checked: all that Clang warns of, or that a header can be warned of."""
TAGGED = ROOT / "tests" / "c_schemas" / "tagged.yaml"
LINTED = [*SCHEMAS, TAGGED]
KINDS = [(style, events) for style in STYLES for events in EVENTS]
CASES = [
    (path, style, events)
    for path in LINTED
    for style, events in KINDS
    if (style, events) == KINDS[0] or path in covering()
]
"""All schemas are printed in the first way, and some of each kind in the others."""
TIDIED = [*DOCUMENTS, *(path for path in FRAMINGS if path.stem in ("cobs", "hdlc", "hex_lines"))]
_MISRA = re.compile(r"misra-c2012-(\d+\.\d+)")
_STATED = re.compile(r"^\| (\d+\.\d+)(, in no document)? \|", re.MULTILINE)


def quiet(command: Sequence[str | Path], folder: Path | None = None) -> None:
    """Run a program that must find nothing to say."""
    done = subprocess.run(
        [str(word) for word in command], capture_output=True, text=True, check=False, cwd=folder
    )
    said = done.stdout + done.stderr
    assert done.returncode == 0, said
    assert "warning:" not in said, said


def translation_units(made: Generated, folder: Path, suffix: str) -> list[Path]:
    """Sources that use the header, and between them all of the generated code."""
    name = made.protocol.name
    include = f'#include "{name}.h"\n'
    user = folder / f"user.{suffix}"
    user.write_text(include * 2, encoding="utf-8")
    if made.source is None:
        whole = folder / f"whole.{suffix}"
        define = f"#define {name.upper()}_IMPLEMENTATION\n"
        whole.write_text(f"{define}{include}{include}", encoding="utf-8")
        return [user, whole]
    return [user] if suffix == "cc" else [user, made.source]


@pytest.mark.parametrize(("path", "style", "events"), CASES, ids=name_of)
def test_no_compiler_warns(path: Path, style: Style, events: Events, tmp_path: Path) -> None:
    options = COptions(style=style, events=events, stubs=True)
    made = generate(protocol_of(path), tmp_path, options)
    units = translation_units(made, tmp_path, "c")
    if made.stubs is not None:
        units.append(made.stubs)
    # A single header holds the same code, as is tested below: one compiler takes what is around it.
    compilers = C99 if style == "split" or path in DOCUMENTS else {"gcc": C99["gcc"]}
    macro = made.protocol.name.upper()
    more = [f"-D{macro}_NAMES", f"-D{macro}_COUNTERS"]
    for compiler, flags in compilers.items():
        check = [
            require_tool(compiler),
            *flags,
            *WARNINGS,
            *(more if compiler == "clang" else []),
        ]
        compiled = [made.source] if made.source and compiler in OPTIMISING else []
        for unit in compiled:
            quiet([*check, *COMPILED, unit], tmp_path)
        quiet([*check, *PARSED, *(unit for unit in units if unit not in compiled)], tmp_path)
    sources = translation_units(made, tmp_path, "cc")
    quiet([require_tool("g++"), "-std=c++11", *WARNINGS, *more, *PARSED, *sources], tmp_path)


@pytest.mark.parametrize("level", ["-O2", "-O3"])
@pytest.mark.parametrize("name", ["rn1", "rn1_firmware"])
def test_no_compiler_warns_of_vectors(name: str, level: str, tmp_path: Path) -> None:
    source = ROOT / "generated" / "c" / f"{name}.c"
    define = f"-D{name.upper()}_SSE2=1"
    for compiler in ("gcc", "clang"):
        flags = ("-std=c99", level, *WARNINGS, define, "-S", "-o", tmp_path / "unit.s")
        quiet([require_tool(compiler), *flags, source])


@pytest.mark.parametrize("events", EVENTS)
@pytest.mark.parametrize("path", LINTED, ids=name_of)
def test_a_single_header_holds_the_code_of_the_source(
    path: Path, events: Events, tmp_path: Path
) -> None:
    """So what compilers say of one when they optimise, they say of the other."""
    two, one = tmp_path / "two", tmp_path / "one"
    two.mkdir()
    one.mkdir()
    split = generate(protocol_of(path), two, COptions(style="split", events=events))
    single = generate(protocol_of(path), one, COptions(style="single", events=events))
    assert split.source is not None
    head, include, code = split.source.read_text(encoding="utf-8").partition(
        f'#include "{split.protocol.name}.h"\n'
    )
    assert include and head.count("\n") < 2
    assert code in single.header.read_text(encoding="utf-8")


@pytest.mark.parametrize("path", DOCUMENTS, ids=name_of)
def test_cplusplus_calls_generated_c(path: Path, tmp_path: Path) -> None:
    protocol = protocol_of(path)
    made = generate(protocol, tmp_path)
    assert made.source is not None
    calls = "".join(
        f"    {{ static {prefix}_decoder decoder = {prefix.upper()}_DECODER_INIT;\n"
        f"      {prefix}_decoder_init(&decoder, {prefix}_dispatch, nullptr);\n"
        f"      {prefix}_decoder_push(&decoder, 0x55); }}\n"
        for prefix in (f"{protocol.name}_{sender.name}" for sender in protocol.senders)
    )
    main = tmp_path / "main.cc"
    text = f'#include "{protocol.name}.h"\nint main() {{\n{calls}    return 0;\n}}\n'
    main.write_text(text, encoding="utf-8")
    objects = [tmp_path / "c.o", tmp_path / "main.o"]
    quiet([require_tool("gcc"), "-std=c99", "-c", "-o", objects[0], made.source])
    quiet([require_tool("g++"), "-std=c++11", *WARNINGS, "-c", "-o", objects[1], main])
    quiet([require_tool("g++"), "-o", tmp_path / "program", *objects])
    quiet([tmp_path / "program"])


@pytest.mark.parametrize(
    ("path", "style", "events"),
    [case for case in CASES if case[1] == "split" or case[0] in DOCUMENTS],
    ids=name_of,
)
def test_the_style_is_the_one_that_is_shipped(
    path: Path, style: Style, events: Events, tmp_path: Path
) -> None:
    options = COptions(style=style, events=events, stubs=True)
    made = generate(protocol_of(path), tmp_path, options)
    style_file = f"--style=file:{TARGET / '.clang-format'}"
    stubs = [] if made.stubs is None else [made.stubs]
    quiet([require_tool("clang-format"), style_file, "--dry-run", "-Werror", *made.files, *stubs])


DEPTH = () if PROVE_ALL else ("-Xclang", "-analyzer-config", "-Xclang", "max-nodes=40000")
"""States in which the analyzer follows each function. Its default is 225,000, with which it takes
several times as long; EVA, which gives up nowhere, goes through our schemas in test_c_proof.py."""


@pytest.mark.parametrize("path", TIDIED, ids=name_of)
def test_clang_tidy_finds_nothing(path: Path, tmp_path: Path) -> None:
    made = generate(protocol_of(path), tmp_path)
    assert made.source is not None
    tidy = [require_tool("clang-tidy"), "--quiet", f"--config-file={TARGET / '.clang-tidy'}"]
    done = subprocess.run(
        [*tidy, str(made.source), "--", "-std=c99", *DEPTH],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout
    assert "warning:" not in done.stdout, done.stdout


WITHOUT_EXTENSIONS = ("-U__GNUC__", "-U__clang__")
"""Behind these are empty handlers and hints on which way is taken, alike in all schemas."""
WITHOUT_FLASH = ("-U__AVR__",)
"""Behind this are the macros that read tables out of flash, one for each size of an entry."""


def has_flash_of_its_own(made: Generated, path: Path) -> bool:
    """True if tables are read out of flash, as in no other schema, where there is no GNU C."""
    assert made.source is not None
    text = made.source.read_text(encoding="utf-8")
    return path in covering() and "#if defined(__AVR__)\n" in text


def deviations(made: Generated, *options: str) -> dict[str, str]:
    """The MISRA rules that cppcheck finds the generated code to deviate from, each with a place."""
    assert made.source is not None
    addon = ["--addon=misra", "--enable=style", "--std=c99"]
    shown = ["--quiet", "--template={file}:{line}: {id}"]
    done = subprocess.run(
        [require_tool("cppcheck"), *addon, *shown, *options, made.source.name],
        capture_output=True,
        text=True,
        check=False,
        cwd=made.folder,
    )
    assert done.returncode == 0, done.stderr
    return {rule: line for line in done.stderr.splitlines() for rule in _MISRA.findall(line)}


ROVER = ROOT / "benchmarks" / "c" / "rover.yaml"
"""The protocol of the README: COBS and a CRC."""
HELD = (*DOCUMENTS, ROVER)
"""Those that deviate from no rule that is stated of other schemas alone."""


@pytest.mark.parametrize("path", [*HELD, *FRAMINGS], ids=name_of)
def test_misra_deviations_are_stated(path: Path, tmp_path: Path) -> None:
    made = generate(protocol_of(path), tmp_path)
    macro = made.protocol.name.upper()
    options: tuple[str, ...] = ()
    if path != DOCUMENTS[0]:
        # Without extensions no handler is weak, so that the code without weak ones is the same.
        # With names there is all that is there without them.
        options = (*WITHOUT_EXTENSIONS, f"-U{macro}_NO_WEAK", f"-D{macro}_NAMES", "--force")
        if not has_flash_of_its_own(made, path):
            options = (*options, *WITHOUT_FLASH)
    check_stated(path, deviations(made, *options))


POLLED = ("dagny", "matty", "rover", "uherobot", "bounded_head", "cobs", "mavlink_like")
"""Of each way in which a decoder that is polled is printed, a schema."""


@pytest.mark.parametrize(
    "path", [it for it in (*HELD, *FRAMINGS) if it.stem in POLLED], ids=name_of
)
def test_misra_deviations_of_polled_decoders_are_stated(path: Path, tmp_path: Path) -> None:
    made = generate(protocol_of(path), tmp_path, COptions(events="messages"))
    macro = made.protocol.name.upper()
    defined = (f"-D{macro}_COUNTERS", f"-D{macro}_FAST_FEED=1")
    check_stated(path, deviations(made, *WITHOUT_EXTENSIONS, *WITHOUT_FLASH, *defined))


def check_stated(path: Path, found: dict[str, str]) -> None:
    """Each rule that a schema's C deviates from is in the list, and may be in this schema."""
    rows = _STATED.findall((TARGET / "README.md").read_text(encoding="utf-8"))
    stated = {rule for rule, limit in rows if not limit or path not in HELD}
    assert "15.5" in found, "the addon was not run"
    assert set(found) <= stated, {rule: found[rule] for rule in set(found) - stated}
