"""Generates the C of a protocol, compiles it for a machine, and measures its structs."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import msgspec

from protogen.errors import UserError
from protogen.footprint.elf import Elf, read_elf
from protogen.footprint.machines import Machine
from protogen.model.protocol import Protocol
from protogen.targets.c.emit import texts
from protogen.targets.c.options import COptions
from protogen.targets.c.protocol_names import names_of

_FLAGS = ("-std=c99", "-Os", "-ffunction-sections", "-fdata-sections", "-fstack-usage")
_QUIET = ("-fno-asynchronous-unwind-tables", "-fno-stack-protector", "-fcf-protection=none")
"""Flags against code that some hosts add to each function, and controllers do not have."""


class NoCompilerError(UserError):
    """The compiler of a machine is not on the PATH."""


class CompilerError(Exception):
    """The compiler refused the program; the text is what it said."""


class Build(msgspec.Struct, frozen=True):
    """A compiled protocol."""

    elf: Elf
    frames: dict[str, int]
    """The bytes of stack that each function takes for itself."""
    sizes: dict[str, int]
    """The bytes of each struct that was asked for."""
    compiler: str
    """The compiler's name and version."""


def build(protocol: Protocol, options: COptions, machine: Machine, structs: Sequence[str]) -> Build:
    """Compile a protocol. Raises NoCompilerError, or CompilerError where it does not compile."""
    compiler = shutil.which(machine.compiler)
    if compiler is None:
        raise NoCompilerError(
            f"{machine.compiler}, the compiler for {machine.title}, is not installed",
            f"on Debian or Ubuntu: apt install {machine.package}",
        )
    name = names_of(protocol).file
    header, source = texts(protocol, options)
    with TemporaryDirectory(prefix="protogen-size-") as made:
        folder = Path(made)
        (folder / f"{name}.h").write_text(header, encoding="utf-8")
        (folder / f"{name}.c").write_text(source, encoding="utf-8")
        (folder / "structs.c").write_text(_structs_source(name, structs), encoding="utf-8")
        flags = _accepted(compiler, machine, folder)
        elf = _compile(compiler, flags, folder, name)
        probe = _compile(compiler, flags, folder, "structs")
        frames = _stack_frames((folder / f"{name}.su").read_text(encoding="utf-8"))
    named = {symbol.name: symbol.size for symbol in probe.symbols}
    sizes = {struct: named[_variable(index)] for index, struct in enumerate(structs)}
    return Build(elf, frames, sizes, _version(compiler))


def _variable(index: int) -> str:
    return f"size_of_{index}"


def _structs_source(name: str, structs: Sequence[str]) -> str:
    """A program with an array as large as each struct, so that nothing has to run."""
    lines = [f'#include "{name}.h"']
    lines += [f"char {_variable(index)}[sizeof({tag})];" for index, tag in enumerate(structs)]
    return "\n".join(lines) + "\n"


def _accepted(compiler: str, machine: Machine, folder: Path) -> tuple[str, ...]:
    """The flags, with those for quiet functions that this compiler knows."""
    source = folder / "empty.c"
    source.write_text("typedef int nothing;\n", encoding="utf-8")
    always = (*machine.flags, *_FLAGS)
    known = [flag for flag in _QUIET if _takes(compiler, (*machine.flags, flag), source)]
    return (*always, *known)


def _takes(compiler: str, flags: Sequence[str], source: Path) -> bool:
    command = [compiler, *flags, "-fsyntax-only", str(source)]
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


def _compile(compiler: str, flags: Sequence[str], folder: Path, name: str) -> Elf:
    command = [compiler, *flags, "-c", f"{name}.c", "-o", f"{name}.o"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise CompilerError(done.stderr.strip())
    return read_elf((folder / f"{name}.o").read_bytes())


def _stack_frames(text: str) -> dict[str, int]:
    """Lines that `-fstack-usage` wrote: file:line:column:function, bytes and how they are known."""
    frames: dict[str, int] = {}
    for line in text.splitlines():
        place, size, _ = line.split("\t")
        frames[place.rsplit(":", 1)[-1]] = int(size)
    return frames


def _version(compiler: str) -> str:
    command = [compiler, "--version"]
    said = subprocess.run(command, capture_output=True, text=True, check=False).stdout
    return said.splitlines()[0] if said else compiler
