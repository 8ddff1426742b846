"""Runs the blocks of a page in their order, in one folder.

    console   `$ command` lines, each with what it prints
    python    statements; a page shares its names (see `doc_python`)
    javascript  `// NAME.mjs` in the first line: a program of node
    typescript  `// NAME.ts` in the first line: a source that compiles strictly
    text      what the Python or the JavaScript in front of it prints
    c         `/* NAME.c */` in the first line: a source, compiled together with the generated C of
              the headers that it includes. A program exits with 0. A source without `main` is
              linked with `doc_programs/NAME.c`, which stands in for the rest of the firmware.
              A source that a command of the page compiles is only written.
    cpp       `// NAME.ino` in the first line: an Arduino sketch, linked in the same way;
              `// NAME.cpp`: a program over the generated C of the `.hpp` that it includes
    toml      `# NAME.toml` in the first line: a file
    markdown  `<!-- NAME.md -->` in the first line: a file
    xml       `<!-- NAME.xml -->` in the first line: a file

In what is expected, `...` stands for any text, and alone on a line for any lines.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Self

from cli_support import PATIENCE
from doc_pages import FILES, ROOT, Block, Page, agrees
from tooling import require_tool
from typescript_engine import require_npm

PROGRAMS = ROOT / "tests" / "doc_programs"
BOARDS = ("arm-none-eabi-gcc", "avr-gcc", "qemu-system-arm")
"""Tools for boards, which not every machine has."""
_WARNINGS = ("-Wall", "-Wextra", "-Werror")


class Runner:
    """A page in its folder, with the Python process that its blocks share."""

    def __init__(self, workspace: Path) -> None:
        self._workspace = workspace
        self._python: subprocess.Popen[str] | None = None
        self._printed = ""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        if self._python:
            self._python.communicate(timeout=PATIENCE)

    def run(self, page: Page) -> None:
        """Run all blocks of a page."""
        for tool in filter(page.needs, BOARDS):
            require_tool(tool)
        for block in page.blocks:
            if block.language in FILES or (block.language == "c" and page.compiles(block)):
                (self._workspace / block.file).write_text(block.text, encoding="utf-8")
            elif step := getattr(self, f"_run_{block.language}", None):
                step(block)

    def command(self, command: Sequence[str | Path]) -> subprocess.CompletedProcess[str]:
        """Outcome of a command, with both streams in one."""
        return subprocess.run(
            command,
            cwd=self._workspace,
            env=self._environment(),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=PATIENCE,
            check=False,
        )

    def succeed(self, *command: str | Path) -> str:
        """Output of a command that has to succeed."""
        done = self.command(command)
        assert done.returncode == 0, f"{command}\n{done.stdout}"
        return done.stdout

    def _environment(self) -> dict[str, str]:
        path = f"{self._workspace / 'bin'}{os.pathsep}{os.environ['PATH']}"
        return {**os.environ, "PATH": path, "PYTHONPATH": str(ROOT), "NO_COLOR": "1"}

    def _run_console(self, block: Block) -> None:
        _, *pieces = re.split(r"^\$ ", block.text, flags=re.MULTILINE)
        for piece in pieces:
            command, _, expected = piece.partition("\n")
            done = self.command(["sh", "-c", command])
            assert agrees(expected, done.stdout), f"$ {command}\n{done.stdout}"

    def _run_python(self, block: Block) -> None:
        if self._python is None:
            self._python = subprocess.Popen(
                [sys.executable, "-P", str(ROOT / "tests" / "doc_python.py")],
                cwd=self._workspace,
                env={**self._environment(), "PYTHONPATH": f"{self._workspace}{os.pathsep}{ROOT}"},
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
            )
        assert self._python.stdin
        assert self._python.stdout
        self._python.stdin.write(json.dumps(block.text) + "\n")
        self._python.stdin.flush()
        self._printed, error = json.loads(self._python.stdout.readline())
        assert not error, f"{block.text}\n{error}"

    def _run_javascript(self, block: Block) -> None:
        self._install_package()
        (self._workspace / block.file).write_text(block.text, encoding="utf-8")
        self._printed = self.succeed(require_tool("node"), block.file)

    def _run_typescript(self, block: Block) -> None:
        self._install_package()
        (self._workspace / block.file).write_text(block.text, encoding="utf-8")
        (self._workspace / "package.json").write_text('{"type": "module"}', encoding="utf-8")
        flags = ["--strict", "--noEmit", "--target", "es2022", "--module", "nodenext"]
        self.succeed(require_npm("tsc"), *flags, block.file)

    def _install_package(self) -> None:
        """Do what npm does: the package is found by its name."""
        link = self._workspace / "node_modules" / "protogen-codecs"
        if not link.exists():
            link.parent.mkdir(exist_ok=True)
            link.symlink_to(self._workspace / "generated" / "typescript")

    def _run_text(self, block: Block) -> None:
        assert agrees(block.text, self._printed), self._printed

    def _run_c(self, block: Block) -> None:
        (self._workspace / block.file).write_text(block.text, encoding="utf-8")
        sources: list[str | Path] = [block.file]
        if "int main(" not in block.text:
            sources.append(PROGRAMS / block.file)
        used = re.findall(r'#include "(\w+)\.h"', block.text)
        sources += [f"generated/c/{name}.c" for name in used]
        compiler = require_tool("cc")
        self.succeed(compiler, "-std=c99", *_WARNINGS, "-Igenerated/c", *sources, "-o", "program")
        self.succeed("./program")

    def _run_cpp(self, block: Block) -> None:
        if block.file.endswith(".ino"):
            self._run_sketch(block)
            return
        (self._workspace / block.file).write_text(block.text, encoding="utf-8")
        names = re.findall(r'#include "(\w+)\.hpp"', block.text)
        objects = [f"{name}.o" for name in names]
        for name, made in zip(names, objects, strict=True):
            self.succeed(require_tool("cc"), "-c", f"generated/c/{name}.c", "-o", made)
        flags = ["-std=c++17", *_WARNINGS, "-Igenerated/c"]
        self.succeed(require_tool("g++"), *flags, block.file, *objects, "-o", "program")
        self.succeed("./program")

    def _run_sketch(self, block: Block) -> None:
        name = Path(block.file).stem
        (self._workspace / "sketch.cpp").write_text(
            f'#include "Arduino.h"\n{block.text}\n#include "{name}.cpp"\n', encoding="utf-8"
        )
        library, object_file = f"generated/c/{name}.c", f"{name}.o"
        self.succeed(require_tool("cc"), "-std=c99", "-Os", "-c", library, "-o", object_file)
        flags = ["-std=c++11", *_WARNINGS, "-Igenerated/c", f"-I{PROGRAMS}"]
        self.succeed(require_tool("g++"), *flags, "sketch.cpp", object_file, "-o", "sketch")
        self.succeed("./sketch")
