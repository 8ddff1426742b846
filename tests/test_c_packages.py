"""The folder of generated C is a package: for CMake, Arduino, PlatformIO and Zephyr."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import pytest
import yaml
from tooling import require_tool

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
    const struct matty_stop stop = {0};
    uint8_t frame[MATTY_STOP_FRAME_ROOM];
    size_t size = 0;
    size_t index;
    if (matty_stop_frame(&stop, 7, frame, sizeof frame, &size) != MATTY_OK) {
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


@pytest.mark.parametrize("name", NAMES)
def test_the_sketch_is_cpp_that_uses_the_library(name: str, tmp_path: Path) -> None:
    """The Arduino core is stood in for by its declarations; the real compiler checks the rest."""
    core = (
        "#include <stdint.h>\n#include <stddef.h>\n"
        "#define HIGH 1\n#define LOW 0\n#define OUTPUT 1\n#define LED_BUILTIN 13\n"
        'extern "C" void pinMode(int, int);\nextern "C" void digitalWrite(int, int);\n'
        "struct Port { void begin(long); int available(); int read(); };\nextern Port Serial;\n"
    )
    sketch = tmp_path / "sketch.cpp"
    sketch.write_text(core + (GENERATED / "examples" / name / f"{name}.ino").read_text())
    compiler = require_tool("g++")
    flags = ["-std=c++11", "-Wall", "-Wextra", "-Werror", "-fsyntax-only"]
    run([compiler, *flags, f"-I{GENERATED}", str(sketch)])


def test_the_libraries_list_every_protocol() -> None:
    platformio = json.loads((GENERATED / "library.json").read_text())
    assert sorted(platformio["headers"]) == [f"{name}.h" for name in NAMES]
    assert {f"+<{name}.c>" for name in NAMES} < set(platformio["build"]["srcFilter"])
    lines = (GENERATED / "library.properties").read_text().splitlines()
    arduino = dict(line.split("=", 1) for line in lines if not line.startswith("#"))
    wanted = {"name", "version", "author", "maintainer", "sentence", "architectures", "includes"}
    assert wanted < set(arduino)
    assert sorted(arduino["includes"].split(",")) == [f"{name}.h" for name in NAMES]
    zephyr = yaml.safe_load((GENERATED / "zephyr" / "module.yml").read_text())
    assert (GENERATED / zephyr["build"]["kconfig"]).is_file()
    assert (GENERATED / zephyr["build"]["cmake"] / "CMakeLists.txt").is_file()
