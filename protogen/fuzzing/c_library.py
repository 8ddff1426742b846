"""Generated C in a shared library, compiled by the system's compiler."""

from __future__ import annotations

import ctypes
import io
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypeVar

from protogen.fuzzing.c_calls import Call, Calls
from protogen.fuzzing.c_driver import TEMPLATES, Driver
from protogen.fuzzing.c_values import Answers

T = TypeVar("T")

_COMPILERS = ("cc", "gcc", "clang")
_FLAGS = ("-std=c99", "-O0", "-fPIC", "-shared")
"""Some thousand calls take less time than any optimisation, which doubles that of the compiler."""
_ROOM = 1 << 16
"""Bytes of answers that are expected, most of the time."""


class CompileError(Exception):
    """The compiler refuses what was generated: a bug of the C target."""


def find_compiler() -> str | None:
    """The path of a C compiler, if there is one."""
    return next(filter(None, map(shutil.which, _COMPILERS)), None)


class CLibrary:
    """A driver that runs in this process. Raises CompileError."""

    def __init__(self, driver: Driver, compiler: str, flags: Sequence[str] | None = None) -> None:
        self.driver = driver
        self.calls = Calls(driver)
        self._folder = TemporaryDirectory(prefix="protogen-c-")
        folder = Path(self._folder.name)
        library = folder / "driver.so"
        sources = [*driver.write(folder), TEMPLATES / "driver_memory.c"]
        command = [
            compiler,
            *(flags or _FLAGS),
            f"-I{folder}",
            "-o",
            str(library),
            *map(str, sources),
        ]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise CompileError(done.stderr)
        self._answer = ctypes.CDLL(str(library)).driver_answer
        self._answer.argtypes = [ctypes.c_char_p, ctypes.c_size_t, ctypes.c_char_p, ctypes.c_size_t]
        self._answer.restype = ctypes.c_size_t
        self._room = _ROOM

    def do(self, call: Call[T]) -> T:
        """Make a call."""
        while True:
            answers = ctypes.create_string_buffer(self._room)
            size = self._answer(call.request, len(call.request), answers, self._room)
            if size <= self._room:
                return call.read(Answers(io.BytesIO(answers.raw[:size])))
            self._room = size
