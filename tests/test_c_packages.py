"""The folder of generated C is a package: for CMake, Arduino, PlatformIO and Zephyr."""

from __future__ import annotations

import json
import os
import re
import subprocess
from pathlib import Path
from urllib.parse import urlsplit

import pytest
import yaml
from compiled import DOCUMENTS, protocol_of
from tooling import require_arduino_core, require_tool

from protogen.targets.c.emit import emit
from protogen.targets.c.options import COptions

ROOT = Path(__file__).resolve().parent.parent
GENERATED = ROOT / "generated" / "c"
NAMES = sorted(path.stem for path in GENERATED.glob("*.h"))

USER = """\
cmake_minimum_required(VERSION 3.20)
project(user LANGUAGES C)
find_package(protogen CONFIG REQUIRED PATHS "{folder}" NO_DEFAULT_PATH)
{libraries}
add_executable(user user.c)
target_link_libraries(user PRIVATE {library})
"""

# The frame of `stop` with counter 7, by hand: the payload is empty, so the length is 2 (counter and
# command); 07 + 53 + 02 = 5C, and its negation is A4.
PROGRAM = """\
#include <stdio.h>
#include "matty.h"

int main(void) {
    uint8_t frame[MATTY_STOP_FRAME_ROOM];
    const size_t size = matty_stop_frame(7, frame, sizeof frame);
    size_t index;
    if (size == 0) {
        return 1;
    }
    for (index = 0; index < size; index++) {
        printf("%02X ", frame[index]);
    }
    return 0;
}
"""
FRAME = "55 02 07 53 A4 "


def run(command: list[str], **more: object) -> str:
    done = subprocess.run(command, capture_output=True, text=True, check=False, **more)  # type: ignore[call-overload]
    assert done.returncode == 0, done.stdout + done.stderr
    return str(done.stdout)


def build_with_cmake(folder: Path, libraries: str, library: str) -> str:
    """Build the user's program, and return what it prints."""
    cmake = require_tool("cmake")
    text = USER.format(folder=GENERATED, libraries=libraries, library=library)
    (folder / "CMakeLists.txt").write_text(text)
    (folder / "user.c").write_text(PROGRAM)
    run([cmake, "-S", str(folder), "-B", str(folder / "build")])
    run([cmake, "--build", str(folder / "build")])
    return run([str(folder / "build" / "user")])


def test_cmake_finds_a_library_for_each_protocol(tmp_path: Path) -> None:
    assert build_with_cmake(tmp_path, "", "protogen::matty") == FRAME


def test_a_linker_can_leave_out_what_nobody_calls(tmp_path: Path) -> None:
    build_with_cmake(tmp_path, "", "protogen::matty")
    (archive,) = (tmp_path / "build").rglob("libprotogen_matty.a")
    sections = run([require_tool("objdump"), "-h", str(archive)])
    assert {".text.matty_stop_frame", ".text.matty_pc_decoder_push"} <= set(sections.split())


def test_cmake_generates_from_a_schema_and_again_when_it_changes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for source in ("matty.yaml", "dialects/matty_v4.yaml"):
        target = tmp_path / "schemas" / source
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text((ROOT / "schemas" / source).read_text())
    programs = ROOT / ".venv" / "bin"
    monkeypatch.setenv("PATH", f"{programs}{os.pathsep}{os.environ['PATH']}")
    schema = tmp_path / "schemas" / "matty.yaml"
    libraries = f'protogen_generate(codec "{schema}" OPTIONS --only stop)'
    assert build_with_cmake(tmp_path, libraries, "codec") == FRAME
    # The examples of the document start with 55: this change is refused, where it is seen.
    schema.write_text(schema.read_text().replace("literal: 0x55", "literal: 0x57"))
    again = subprocess.run(
        [require_tool("cmake"), "--build", str(tmp_path / "build")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert again.returncode != 0
    assert "error[PG" in again.stdout + again.stderr


@pytest.fixture
def polled(tmp_path: Path) -> Path:
    """A library of decoders that are polled, and of such that are not."""
    documents = [path for path in DOCUMENTS if path.stem in ("matty", "dagny")]
    for file in emit([protocol_of(path) for path in documents], COptions(events="messages")):
        target = tmp_path / file.path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(file.bytes)
    return tmp_path


def test_the_sketches_are_cpp_that_uses_the_library(polled: Path) -> None:
    """Arduino's own core declares what they call."""
    check_sketches(GENERATED, len(NAMES))
    check_sketches(polled, 2)


def check_sketches(library: Path, count: int) -> None:
    sketches = sorted(library.glob("examples/*/*.ino"))
    assert len(sketches) == count
    arduino = require_arduino_core()
    core = [f"-I{arduino / name}" for name in ("cores/arduino", "variants/standard")]
    board = ["-mmcu=atmega328p", "-DF_CPU=16000000L", "-DARDUINO=10808", "-include", "Arduino.h"]
    flags = ["-std=gnu++11", "-fpermissive", "-Os", "-Wall", "-Wextra", "-Werror", "-fsyntax-only"]
    compiler = require_tool("avr-g++")
    run([compiler, *board, *flags, *core, f"-I{library}", "-x", "c++", *map(str, sketches)])


def test_the_libraries_list_every_protocol() -> None:
    platformio = json.loads((GENERATED / "library.json").read_text())
    assert sorted(platformio["headers"]) == [f"{name}.h" for name in NAMES]
    assert {f"+<{name}.c>" for name in NAMES} < set(platformio["build"]["srcFilter"])
    assert sorted(arduino_properties()["includes"].split(",")) == [f"{name}.h" for name in NAMES]
    zephyr = yaml.safe_load((GENERATED / "zephyr" / "module.yml").read_text())
    assert (GENERATED / zephyr["build"]["kconfig"]).is_file()
    assert (GENERATED / zephyr["build"]["cmake"] / "CMakeLists.txt").is_file()


def arduino_properties() -> dict[str, str]:
    lines = (GENERATED / "library.properties").read_text().splitlines()
    return dict(line.split("=", 1) for line in lines if line and not line.startswith("#"))


class TestArduinoLibrary:
    """What arduino-lint looks at, of rules that hold for a library that nobody publishes."""

    def test_has_every_field_that_is_needed_and_no_other(self) -> None:
        found = arduino_properties()
        assert {*found} == {
            *("name", "version", "author", "maintainer", "sentence", "paragraph"),
            *("category", "url", "architectures", "includes"),
        }
        assert all(value.strip() == value != "" for value in found.values())

    def test_has_a_name_that_others_may_take(self) -> None:
        name = arduino_properties()["name"]
        assert re.fullmatch(r"[A-Za-z][A-Za-z0-9_.-]{0,31}", name)
        assert not any(word in name.lower() for word in ("arduino", "library"))

    def test_says_what_it_is(self) -> None:
        found = arduino_properties()
        assert re.fullmatch(r"\d+\.\d+\.\d+", found["version"])
        assert found["category"] == "Communication"
        assert found["architectures"] == "*"
        assert found["sentence"] not in found["paragraph"]
        assert "arduino" not in found["maintainer"].lower()
        url = urlsplit(found["url"])
        assert (url.scheme, bool(url.netloc)) == ("https", True)

    def test_has_the_headers_that_it_names(self) -> None:
        included = arduino_properties()["includes"].split(",")
        assert all((GENERATED / name).is_file() for name in included)

    def test_is_flat(self) -> None:
        """Arduino compiles the sources of the folder itself where there is no `src`."""
        folders = {path.name for path in GENERATED.iterdir() if path.is_dir()}
        assert folders == {"examples", "zephyr"}
        assert not [path for path in GENERATED.rglob("*") if path.is_symlink()]
        assert not list(GENERATED.rglob("*.exe"))
        assert not list(GENERATED.rglob(".development"))
        assert len(list(GENERATED.rglob("library.properties"))) == 1

    def test_has_sketches_in_folders_of_their_names(self) -> None:
        sketches = list(GENERATED.rglob("*.ino"))
        assert sketches
        for sketch in sketches:
            assert sketch == GENERATED / "examples" / sketch.stem / sketch.name
            assert re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,62}", sketch.stem)
