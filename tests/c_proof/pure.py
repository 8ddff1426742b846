"""Contracts of what changes nothing but its own variables, such as the run of a checksum."""

from __future__ import annotations

import re

from c_proof.contracts import Contracts

_CALL = re.compile(r"\b(\w+)\(")
_LEFT = r"invariant size <= \at(size, Pre) && data == \at(data, Pre) + (\at(size, Pre) - size)"
"""What holds of the bytes that are left, of which the first is at `data`."""
_IN_WORDS = r"invariant size == \at(size, Pre) && data == \at(data, Pre) && index <= size"
_IN_BLOCK = f"{_IN_WORDS} && index <= end && end <= size && (end - index) % 8 == 0"


def purify(made: Contracts, function: str) -> None:
    """Contracts for what a function calls that changes nothing but its own variables."""
    for called in dict.fromkeys(_CALL.findall(made.body(function))):
        if called in made.functions or not made.has(called):
            continue
        head = made.body(called).partition("{")[0]
        if "*" in re.sub(r"const \w+ \*|const struct \w+ \*", "", head) or " put" in head:
            continue
        if re.search(r"const uint8_t \*data, size_t size\)", head):
            made.put_safe(
                called, r"requires \valid_read(data + (0 .. size - 1))", r"assigns \nothing"
            )
            _run_contract(made, called)
        elif re.search(r"\w \*", head.replace("const struct", "")) is None:
            made.put_safe(called, r"assigns \nothing")
            made.loops(called)
        else:
            made.put(called, r"assigns \nothing")
            made.loops(called)
        purify(made, called)


def _run_contract(made: Contracts, run: str) -> None:
    """Bounds of the loops that take a checksum's bytes: words first on hosts, then what is left."""
    made.loops(run, _LEFT)
    lines = made.body(run).splitlines(keepends=True)
    for index, line in enumerate(lines[:-1]):
        if _LEFT in line and "index" in lines[index + 1]:
            bounds = _IN_BLOCK if "index < end" in lines[index + 1] else _IN_WORDS
            lines[index] = line.replace(_LEFT, bounds)
    made.change(run, "".join(lines))
