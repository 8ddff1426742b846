"""C compilers: the one that `CC` names, the system's, or the one of the package `ziglang`."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

import msgspec

from protogen.native.errors import NativeError, NoCompilerError

FLAGS = ("-std=c99", "-O3", "-w", "-fPIC", "-shared", "-fvisibility=hidden")
_ZIG_FLAGS = ("-mcpu=baseline", "-fno-sanitize=undefined", "-g0")
"""Zig compiles for the machine it runs on and with checks, unless it is told otherwise."""
_USUAL = ("cc", "gcc", "clang")
_SECONDS = 300
"""No compiler takes so long for one source."""
_PROBE = "#include <stdint.h>\n#include <stdlib.h>\n#include <string.h>\n"
"""Headers that a compiler without its C library lacks."""
_HELP = "pip install 'protogen-serial[compiler]' brings a C compiler"


class Compiler(msgspec.Struct, frozen=True):
    """Call of a compiler."""

    command: tuple[str, ...]
    flags: tuple[str, ...] = FLAGS

    @property
    def identity(self) -> str:
        """Changes whenever the compiler does."""
        program = Path(self.command[0]).resolve()
        status = program.stat()
        words = (*self.command, program, status.st_size, status.st_mtime_ns, *self.flags)
        return " ".join(map(str, words))

    @property
    def works(self) -> bool:
        """True if it makes a library of a source that includes headers of the C library."""
        with TemporaryDirectory(prefix="protogen-") as name:
            source = Path(name, "probe.c")
            source.write_text(_PROBE, encoding="utf-8")
            try:
                self.build(source, Path(name, "probe.so"))
            except NativeError:
                return False
        return True

    def build(self, source: Path, library: Path) -> None:
        """Compile a shared library. Raises NativeError with what the compiler says."""
        command = [*self.command, *self.flags, "-o", str(library), str(source)]
        try:
            done = subprocess.run(
                command,
                capture_output=True,
                text=True,
                errors="replace",
                check=False,
                timeout=_SECONDS,
            )
        except (OSError, subprocess.TimeoutExpired) as error:
            raise NativeError(f"{self.command[0]} does not run: {error}") from None
        if done.returncode:
            lines = done.stderr.strip().splitlines() or [f"exit code {done.returncode}"]
            # gcc says in front of it in which function that is.
            first = next((line for line in lines if "error" in line), lines[0])
            raise NativeError(f"{self.command[0]} does not compile the decoder: {first}")
        if not library.exists():
            raise NativeError(f"{self.command[0]} ends without an error, but makes no library")


def compilers() -> tuple[Compiler, ...]:
    """The compilers that may be used, the first that works before the others.

    `CC` names the only one. Else they are those on the PATH, then the one of the package
    `ziglang`. Raises NativeError where `CC` names none, NoCompilerError where there is none.
    """
    given = os.environ.get("CC", "")
    try:
        words = shlex.split(given)
    except ValueError:
        raise NativeError(f"CC is no command: {given!r}") from None
    if words:
        program = shutil.which(words[0])
        if program is None:
            raise NativeError(f"there is no C compiler {words[0]!r}, as CC says")
        return (Compiler((program, *words[1:])),)
    programs = filter(None, map(shutil.which, _USUAL))
    found = (*(Compiler((program,)) for program in programs), *ziglang())
    if not found:
        raise NoCompilerError(f"there is no C compiler: no cc, gcc or clang on the PATH; {_HELP}")
    return found


def ziglang() -> tuple[Compiler, ...]:
    """The compiler of the package `ziglang`, if that is installed."""
    spec = find_spec("ziglang")
    for folder in () if spec is None else spec.submodule_search_locations or ():
        program = shutil.which("zig", path=folder)
        if program is not None:
            return (Compiler((program, "cc"), FLAGS + _ZIG_FLAGS),)
    return ()


def working(found: tuple[Compiler, ...]) -> Compiler:
    """The first compiler that works; a single one is taken as it is, and says itself what is wrong.

    Raises NoCompilerError where none of several works.
    """
    if len(found) == 1:
        return found[0]
    for item in found:
        if item.works:
            return item
    names = ", ".join(item.command[0] for item in found)
    raise NoCompilerError(f"no C compiler works of {names}; {_HELP}")
