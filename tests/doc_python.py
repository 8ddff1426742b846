"""Runs the Python of a page, block by block; reads lines of JSON, answers with what was printed.

The comment behind an expression, or below it, is its value; `Error: message` is what it raises.
"""

from __future__ import annotations

import ast
import contextlib
import io
import json
import re
import sys
import tokenize
import traceback
import types
from typing import Any


class Unplugged(BaseException):
    """Ends a loop that reads the stand-in for a serial port."""


class Serial:
    """Gives a frame, bytes that are none, and the frame of an unknown message."""

    _pieces = (
        "09 82 01 FC 1C",  # a frame in two portions
        "E8 FF B8 EE 00",
        "17 00",
        "",  # a silence
        "04 7F",
        "70 8B 00",
    )

    def __init__(self, name: str, baud: int, timeout: float) -> None:
        self._left = list(self._pieces)
        self.in_waiting = 0

    def __enter__(self) -> Serial:
        return self

    def __exit__(self, *error: object) -> None:
        pass

    def read(self, size: int) -> bytes:
        assert size == 1
        if not self._left:
            raise Unplugged
        return bytes.fromhex(self._left.pop(0))


def run(text: str, names: dict[str, Any]) -> None:
    """Run a block, and compare its expressions with their comments."""
    comments = {
        token.start[0]: (
            token.string.removeprefix("#").strip(),
            not token.line[: token.start[1]].strip(),
        )
        for token in tokenize.generate_tokens(io.StringIO(text).readline)
        if token.type == tokenize.COMMENT
    }
    for item in ast.parse(text).body:
        be_patient()
        source = ast.get_source_segment(text, item) or ""
        expected = expected_value(item.end_lineno or 0, comments)
        with contextlib.suppress(Unplugged):
            if isinstance(item, ast.Expr) and expected:
                compare(source, expected, names)
            else:
                exec(compile(source, "<page>", "exec"), names)


def be_patient() -> None:
    """Let a busy machine have more time than the second in which a device answers."""
    requests = sys.modules.get("protogen.link.requests")
    if requests is not None:
        vars(requests)["DEFAULT_TIMEOUT"] = 60.0


def compare(source: str, expected: str, names: dict[str, Any]) -> None:
    """Evaluate an expression, and compare what comes of it with its comment."""
    try:
        value = repr(eval(f"({source})", names))
    except Exception as error:
        value = f"{type(error).__name__}: {error}"
    pattern = ".*".join(map(re.escape, expected.split("...")))
    assert re.fullmatch(pattern, value), f"{source}\n  is {value}\n not {expected}"


def expected_value(line: int, comments: dict[int, tuple[str, bool]]) -> str:
    """Comment that ends in a line, or those that stand alone below it."""
    if line in comments:
        return comments[line][0]
    found = []
    while (line := line + 1) in comments and comments[line][1]:
        found.append(comments[line][0])
    return " ".join(found)


def main() -> None:
    sys.modules["serial"] = types.SimpleNamespace(Serial=Serial)  # type: ignore[assignment]
    names: dict[str, Any] = {"__name__": "__main__"}
    for line in sys.stdin:
        printed, error = io.StringIO(), ""
        with contextlib.redirect_stdout(printed):
            try:
                run(json.loads(line), names)
            except Exception:
                error = traceback.format_exc()
        sys.stdout.write(json.dumps([printed.getvalue(), error]) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
