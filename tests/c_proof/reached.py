"""Functions of generated C that a program reaches, and all that there are.

Programs are preprocessed as Frama-C does it, so that what macros leave out is not reached.
"""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

from tooling import require_tool

from c_proof.generated import Generated

_FUNCTION = re.compile(r"^(?=\w)[^;{}()\n]*\b(\w+)\([^;{}]*\) ?\{.*?^\}", re.MULTILINE | re.DOTALL)
_ATTRIBUTE = re.compile(r"__attribute__\(\([\w, ()]*?\)\) ?")
_NAME = re.compile(r"\b\w+\b")
_ANALYSER = '#include "__fc_builtin.h"\n'


def functions_of(made: Generated) -> dict[str, str]:
    """All functions with their text: with names, counters and frames that are taken whole.

    Without SSE2, which no proof follows.
    """
    upper = made.protocol.name.upper()
    text = f"#define {upper}_NAMES\n#define {upper}_COUNTERS\n" + "".join(
        f'#include "{file.name}"\n' for file in made.files
    )
    return _functions(_preprocessed(made, text))


def reached(made: Generated, program: str) -> set[str]:
    """Functions that the program's `main` calls, and those that these do."""
    functions = _functions(_preprocessed(made, program.replace(_ANALYSER, "")))
    found: set[str] = set()
    left = {"main"}
    while left:
        name = left.pop()
        found.add(name)
        left |= set(_NAME.findall(functions[name])) & functions.keys() - found
    return found


def _functions(text: str) -> dict[str, str]:
    plain = _ATTRIBUTE.sub("", text)
    return {found[1]: found[0] for found in _FUNCTION.finditer(plain)}


def _preprocessed(made: Generated, text: str) -> str:
    path = Path(made.folder, "preprocessed.c")
    path.write_text(text, encoding="utf-8")
    command = [require_tool("gcc"), "-std=c99", "-E", "-P", "-U__SSE2__", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return done.stdout
