"""Tables of what is measured on this machine: speeds, and the frames found in noise."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from statistics import median

from c_costs.measure import Results
from c_costs.protocols import FED_KINDS, HAS_SSE2, KINDS, PROTOCOLS
from c_costs.tables import NOTHING, Ratio, header, messages, row

SHARE = 2
"""The most time that a fed buffer may take, by that of the expert with SSE2."""
FED = 1000
"""The megabytes a second that a buffer is to be fed at."""
_HEAD = "ns per frame (MB/s / ratio)"


def speed_table(results: Results, what: str) -> str:
    lines = header(_HEAD, "bytes", *KINDS.values())
    for protocol, _, message in messages():
        name = f"{protocol.label} {message}"
        lines.append(row([name, *_speeds(results, name, KINDS, what)]))
    return "\n".join(lines)


def feed_table(results: Results) -> str:
    lines = header(_HEAD, "bytes", *FED_KINDS.values(), "to half the speed of SSE2")
    for protocol, _, message in messages():
        name = f"{protocol.label} {message}"
        halves = HAS_SSE2 and protocol.has_peers
        half = f"{_half_ratio(results, name):.2f}" if halves else NOTHING
        cells = _speeds(results, name, FED_KINDS, "feed")
        lines.append(row([name, *cells, half]))
    return "\n".join(lines)


def _speeds(results: Results, name: str, kinds: Mapping[str, str], what: str) -> list[str]:
    """The bytes of a frame, and each contender's time for it."""
    cells = [
        _speed(results, kind, name, what) if (kind, name) in results.speeds else NOTHING
        for kind in kinds
    ]
    return [f"{results.speeds['messages', name].bytes:.1f}", *cells]


def _speed(results: Results, kind: str, name: str, what: str) -> str:
    item = results.speeds[kind, name]
    time = median(getattr(item, what))
    speed = f"{item.bytes / time * 1000:,.0f}"
    if kind == "expert":
        return f"{time:,.1f} ({speed})"
    return f"{time:,.1f} ({speed} / {time_ratio(results, name, what, kind):.2f})"


def time_ratio(results: Results, name: str, what: str, kind: str = "messages") -> float:
    """The median of the rounds' ratios of a contender's time to the expert's."""
    own: list[float] = getattr(results.speeds[kind, name], what)
    expert: list[float] = getattr(results.speeds["expert", name], what)
    return median(mine / theirs for mine, theirs in zip(own, expert, strict=True))


def _half_ratio(results: Results, name: str) -> float:
    """The median of the rounds' ratios of protogen's time to twice the expert's, both with SSE2."""
    own, other = results.speeds["vector", name].feed, results.speeds["sse2", name].feed
    return median(mine / (SHARE * theirs) for mine, theirs in zip(own, other, strict=True))


def fed_fast(results: Results) -> str:
    """How many messages are fed as fast as they are to be."""
    if not HAS_SSE2:
        return ""
    fed = [(p, message) for p, _, message in messages() if p.has_peers]
    halves = [_half_ratio(results, f"{p.label} {message}") for p, message in fed]
    fast = sum(value <= 1 for value in halves)
    vectors = [item for (kind, _), item in results.speeds.items() if kind == "vector"]
    quick = sum(item.bytes / median(item.feed) * 1000 >= FED for item in vectors)
    return (
        f"{fast} of {len(halves)} messages are fed at half the speed of the expert with SSE2 or "
        f"faster, and {quick} at {FED:,} MB/s."
    )


def recovery_table(results: Results) -> str:
    lines = header("found of undamaged", *KINDS.values())
    for protocol in PROTOCOLS:
        found = [results.recovery.get((kind, protocol.name)) for kind in KINDS]
        cells = [
            f"{item.found:,} of {item.undamaged:,}: {item.share}" if item else NOTHING
            for item in found
        ]
        lines.append(row([protocol.title, *cells]))
    return "\n".join(lines)


def time_ratios(results: Results) -> Iterator[Ratio]:
    for protocol, _, message in messages():
        name = f"{protocol.label} {message}"
        for what in ("push", "feed", "encode"):
            value = time_ratio(results, name, what)
            yield Ratio(f"this machine, {name}: {what}", value)


def misses(found: Iterator[Ratio]) -> str:
    """Figures above the aim, the worst in front; a figure that is not there is one of them."""
    figures = list(found)
    missed = sorted((item for item in figures if item.is_missed), key=lambda item: -item.value)
    if not missed:
        return f"None of {len(figures)} figures misses it."
    met = len(figures) - len(missed)
    lines = [f"* {item.name}: {item.value:.2f}" for item in missed]
    return "\n".join([f"{met} of {len(figures)} figures meet it. The others:", "", *lines])
