"""The system's C compiler."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from protogen.native.errors import NativeError, NoCompilerError

FLAGS = ("-std=c99", "-O3", "-w", "-fPIC", "-shared", "-fvisibility=hidden")
_USUAL = ("cc", "gcc", "clang")
_SECONDS = 300
"""No compiler takes so long for one source."""


@dataclass(frozen=True, slots=True)
class Compiler:
    """How the compiler is called."""

    command: tuple[str, ...]

    @property
    def identity(self) -> str:
        """Changes whenever the compiler does."""
        program = Path(self.command[0]).resolve()
        status = program.stat()
        words = (*self.command, program, status.st_size, status.st_mtime_ns, *FLAGS)
        return " ".join(map(str, words))

    def build(self, source: Path, library: Path) -> None:
        """Compile a shared library. Raises NativeError with what the compiler says."""
        command = [*self.command, *FLAGS, "-o", str(library), str(source)]
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


def compiler() -> Compiler:
    """The one that `CC` names, else `cc`.

    Raises NativeError where there is none, NoCompilerError where `CC` names none either.
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
        return Compiler((program, *words[1:]))
    for name in _USUAL:
        program = shutil.which(name)
        if program is not None:
            return Compiler((program,))
    raise NoCompilerError("there is no C compiler: no cc, gcc or clang on the PATH")
