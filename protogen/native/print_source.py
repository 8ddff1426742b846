"""C that prints rows: a function for each table, of steps."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from importlib.resources import files

from protogen.native.print_steps import Steps, block, indented

_PARAMETERS = "const struct job *job, const struct rows *rows, uint8_t *out, const uint8_t *end"


def source_of(tables: Sequence[Steps], quoted: Iterable[int]) -> str:
    """The source of a library that prints the rows of tables.

    `quoted`: the ASCII characters for which a value of CSV needs quotes.
    """
    helpers = files("protogen.native").joinpath("templates", "printer.c").read_text("utf-8")
    tests = " || ".join(f"character == {code}" for code in quoted)
    lines = [
        f"#define NEEDS_QUOTES(character) ({tests or 0})",
        helpers,
        *(line for number, steps in enumerate(tables) for line in _function(number, steps)),
        "static uint8_t *put_row(" + _PARAMETERS + ") {",
        "    switch (rows->table) {",
    ]
    for number in range(len(tables)):
        lines += [f"    case {number}:", f"        return put_{number}(job, rows, out, end);"]
    lines += ["    default:", "        return NULL;", "    }", "}"]
    return "\n".join([*lines, ""])


def _function(number: int, steps: Steps) -> Iterator[str]:
    yield f"static __attribute__((noinline)) uint8_t *put_{number}({_PARAMETERS}) {{"
    yield "    const uint8_t *const at_0 = rows->rows + (size_t)rows->next * rows->stride;"
    yield "    int is_odd = 0;"
    yield "    (void)job;"
    yield "    (void)is_odd;"
    yield from indented(block(steps))
    yield "    return out;"
    yield "}"
