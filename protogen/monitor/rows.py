"""The table of messages and the line of status, as texts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.text import Text

from protogen.model.reading.readings import readings

if TYPE_CHECKING:
    from protogen.link.statistics import MessageStatistics
    from protogen.model.protocol import Protocol
    from protogen.monitor.session import Session

_SECOND = 10**9

COLUMNS: tuple[tuple[str, int | None], ...] = (
    ("message", None),
    ("count", None),
    ("per s", 6),
    ("jitter", 6),
    ("last", 6),
    ("gaps", 4),
    ("values", None),
)
"""Titles of the columns, with widths where they are fixed."""


def cells_of(protocol: Protocol, item: MessageStatistics, now: int) -> list[Text]:
    """What the table says of one kind of message."""
    name = item.name if len(protocol.sending) == 1 else f"{item.sender} {item.name}"
    return [
        Text(name, style="bold cyan"),
        _right(f"{item.count}"),
        _right(rate_text(item.rate(now))),
        _right(jitter_text(item.jitter) if item.count > 2 else ""),
        _right(age_text(now - item.when)),
        Text(f"{item.gaps or ''}", style="bold red", justify="right"),
        _values(protocol, item),
    ]


def rate_text(rate: float) -> str:
    """How many a second, with three digits that count."""
    if rate >= 100:
        return f"{rate:.0f}"
    return f"{rate:.1f}" if rate >= 10 else f"{rate:.2f}"


def jitter_text(seconds: float) -> str:
    """A time in no more than six characters."""
    if seconds < 0.1:
        return f"{seconds * 1e3:.1f}ms"
    return f"{seconds * 1e3:.0f}ms" if seconds < 1 else f"{seconds:.1f}s"


def age_text(passed: int) -> str:
    """How long ago, from nanoseconds."""
    seconds = max(0, passed) / _SECOND
    if seconds < 10:
        return f"{seconds:.1f}s"
    return f"{seconds:.0f}s" if seconds < 600 else f"{seconds / 60:.0f}min"


def line_status(session: Session, now: int, *, is_paused: bool) -> Text:
    """Ports with their load, and what was no message."""
    statistics = session.statistics
    parts = [session.codec.protocol.name]
    for source, port in session.ends.items():
        load = statistics.load(source, now)
        own = statistics.sources.get(source)
        speed = f"{own.per_second(now):,} B/s" if own else "silent"
        busy = f", {load:.0%} busy" if load is not None else ""
        parts.append(f"{source + '=' if source else ''}{port} {speed}{busy}")
    if statistics.unknown:
        parts.append(f"{statistics.unknown} unknown")
    if statistics.invalid:
        reasons = ", ".join(f"{number} {name}" for name, number in statistics.invalid.items())
        parts.append(f"{statistics.invalid_bytes} bytes invalid ({reasons})")
    if session.is_over:
        parts.append(str(session.error) if session.error else "the input has ended")
    if is_paused:
        parts.append("PAUSED")
    return Text("  ".join(parts), no_wrap=True, overflow="ellipsis")


def fields_of(protocol: Protocol, item: MessageStatistics) -> Text:
    """The last values, one in each line; those that have changed are marked."""
    plan = protocol.message(item.name).plan
    text = Text()
    changed = item.changed
    for name, value in readings(plan, item.values):
        text.append(f"{name}: ", style="dim")
        text.append(f"{value}{' *' if name in changed else ''}\n")
    return text


def _values(protocol: Protocol, item: MessageStatistics) -> Text:
    """The last values; those that have changed are marked."""
    plan = protocol.message(item.name).plan
    text = Text(no_wrap=True)
    changed = item.changed
    for name, value in readings(plan, item.values):
        is_new = name in changed
        text.append(f"{name}=", style="dim")
        text.append(f"{value}{'*' if is_new else ''} ", style="bold" if is_new else "")
    return text


def _right(text: str) -> Text:
    return Text(text, justify="right")
