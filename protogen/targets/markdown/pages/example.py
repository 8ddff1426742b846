"""An example as a page shows it: its bytes, and what they are."""

from __future__ import annotations

import msgspec

from protogen.model.messages import Contradiction, Example, Message
from protogen.model.protocol import Protocol
from protogen.targets.escape import markdown
from protogen.targets.markdown.pages.example_bytes import bytes_table
from protogen.targets.markdown.text.anchors import example_anchor
from protogen.targets.markdown.text.origin import about_line
from protogen.targets.markdown.text.table import Table
from protogen.targets.markdown.text.words import code, hex_bytes, sentence

_LINE = 16
_FAILURES = {
    "values": "Its bytes hold other values than the document gives.",
    "unknown": "No message has its identity.",
}
_MOST_LINES = 32
"""Lines of an example's bytes that are printed; the table shows its parts anyway."""


class ExampleView(msgspec.Struct, frozen=True, kw_only=True):
    """An example, annotated."""

    anchor: str
    title: str
    about: str
    dump: tuple[str, ...]
    table: Table | None
    contradiction: str


def example_view(protocol: Protocol, message: Message, example: Example) -> ExampleView:
    """Return an example with its bytes cut into what they mean."""
    return ExampleView(
        anchor=example_anchor(message.name, example.name),
        title=example.name,
        about=about_line(example.about, _coverage(example)),
        dump=_dump(example.bytes),
        table=bytes_table(protocol, message, example),
        contradiction=_contradiction(example.contradicts),
    )


def _coverage(example: Example) -> str:
    if example.covers is None:
        return ""
    first, last = code(example.covers[0]), code(example.covers[-1])
    return f"Bytes of {first if first == last else f'{first} to {last}'}"


def _dump(data: bytes) -> tuple[str, ...]:
    """Print bytes in lines, with the characters behind them where all can be seen."""
    runs = [data[start : start + _LINE] for start in range(0, len(data), _LINE)]
    seen = all(0x20 <= byte < 0x7F for byte in data)
    width = len(hex_bytes(runs[0])) if runs else 0
    lines = [
        f"{hex_bytes(run):{width}}  {run.decode('ascii')}" if seen else hex_bytes(run)
        for run in runs
    ]
    more = [f"... {len(data)} bytes in all"] if len(lines) > _MOST_LINES else []
    return (*lines[:_MOST_LINES], *more)


def _contradiction(contradiction: Contradiction | None) -> str:
    if contradiction is None:
        return ""
    reads = ", ".join(
        f"{code(name)} as {code(value)}" for name, value in (contradiction.reads or {}).items()
    )
    read = f" The schema reads {reads}." if reads else ""
    failure = _FAILURES.get(contradiction.fails, f"A receiver rejects it ({contradiction.fails}).")
    return f"{failure}{read} {sentence(markdown(contradiction.why))}"
