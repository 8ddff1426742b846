"""Programs that some tests need and that not every machine has, or has in working order."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

PROVE_ALL = bool(os.environ.get("PROTOGEN_PROVE_ALL"))
"""True if proofs are asked for that take minutes each."""
STRICT = "PROTOGEN_REQUIRE_TOOLS"
"""Set this environment variable to make a missing tool fail a test instead of skipping it."""

PATIENCE = 120
PROGRAM = "#include <stdint.h>\n#include <string.h>\nint main(void) { return 0; }\n"
ARDUINO_CORE = Path("/usr/share/arduino/hardware/arduino/avr")
"""Where Debian has Arduino's own sources for AVR."""
HOST = ("cc", "gcc", "clang", "g++")
"""Compilers whose programs run here."""
_LEAST: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(HOST, ()),
    "avr-gcc": ("-mmcu=atmega328p",),
    "arm-none-eabi-gcc": ("-mcpu=cortex-m0", "-mthumb", "-c"),
    "s390x-linux-gnu-gcc": ("-static",),
}
"""Flags with which each compiler has to make a program, or an object, whatever a test gives it."""
_CALLS: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("clang-format", "clang-tidy", "cmake", "cppcheck", "git"), ("--version",)),
    **dict.fromkeys(("avr-size", "avr-nm", "size", "nm"), ("--version",)),
    **dict.fromkeys(("qemu-s390x", "qemu-system-arm"), ("--version",)),
    "chromium": ("--version",),
    "frama-c": ("-version",),
    **dict.fromkeys(("why3", "z3"), ("--version",)),
}
"""Arguments with which a program in working order exits with 0."""


def require_tool(name: str) -> str:
    """Path of a program that works; without it, skip the test or fail."""
    found = shutil.which(name)
    if found is None:
        unavailable(f"the program {name} is not installed")
        raise AssertionError
    if name in _LEAST:
        return require_compiler(name, *_LEAST[name])
    if name in _CALLS and (said := _failure(found, *_CALLS[name])):
        unavailable(f"the program {name} does not work: {said}")
    return found


def require_compiler(
    name: str, *flags: str, source: str = PROGRAM, arguments: tuple[str, ...] = ()
) -> str:
    """Path of a compiler that makes a working program with these flags; else skip or fail.

    The program is run with the arguments where it can run here.
    """
    found = shutil.which(name)
    if found is None:
        unavailable(f"the program {name} is not installed")
        raise AssertionError
    is_run = name in HOST and "-c" not in flags
    if said := _failed_trial(found, flags, source, arguments if is_run else None):
        unavailable(f"{' '.join([name, *flags])} does not work: {said}")
    return found


def require_module(name: str) -> None:
    """Skip the test, or fail, unless the Python module can be imported."""
    if importlib.util.find_spec(name) is None:
        unavailable(f"the Python module {name} is not installed")


def require_arduino_core() -> Path:
    """Folder of Arduino's own sources; without them, skip the test or fail."""
    if not ARDUINO_CORE.is_dir():
        unavailable("Debian's package arduino-core-avr is not installed")
    return ARDUINO_CORE


def unavailable(reason: str) -> None:
    """Skip the test, or fail where no tool may be missing."""
    if os.environ.get(STRICT):
        pytest.fail(f"{reason}, and {STRICT} is set")
    pytest.skip(reason)


@cache
def _failed_trial(
    compiler: str, flags: tuple[str, ...], source: str, arguments: tuple[str, ...] | None
) -> str:
    """Output of a compiler, or of its program, where that fails; empty if it works."""
    with TemporaryDirectory(prefix="protogen-trial-") as folder:
        file, program = Path(folder, "trial.c"), Path(folder, "trial")
        if Path(compiler).name.endswith("++"):
            file = file.with_suffix(".cc")
        file.write_text(source, encoding="utf-8")
        said = _failure(compiler, str(file), "-o", str(program), *flags)
        if said or arguments is None:
            return said
        return _failure(str(program), *arguments)


@cache
def _failure(*command: str) -> str:
    """Output of a command that fails; empty if it succeeds."""
    try:
        done = subprocess.run(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            timeout=PATIENCE,
            check=False,
        )
    except OSError as error:
        return str(error)
    return "" if done.returncode == 0 else done.stdout or f"it exits with {done.returncode}"
