"""The picture of `bench_python.py`: how long a message takes in a stream, by contender."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

import matplotlib as mpl

mpl.use("Agg")
from matplotlib import pyplot

_FIRST = "protogen"
_OURS, _HAND, _PEER = "#c8442c", "#4a7ba6", "#9aa5ad"
_REFERENCE = "#e3a79b"
_PAPER = {"facecolor": "white", "edgecolor": "none", "pad": 0.5}


def plot(found: Mapping[str, Mapping[str, list[float]]], names: Sequence[str], path: Path) -> None:
    """One panel for each case, one bar for each contender, the same scale for all."""
    shown = [name for name in names if any(name in times for times in found.values())]
    shown.sort(key=lambda name: _rank(found, name, _FIRST))
    figure, axes = pyplot.subplots(
        1, len(found), figsize=(16, 0.42 * len(shown) + 1.7), sharey=True, sharex=True
    )
    for axis, (case, times) in zip(axes, found.items(), strict=True):
        _panel(axis, case, times, shown)
    figure.supxlabel("ns per message, logarithmic; shorter is faster", fontsize=11)
    figure.tight_layout()
    figure.savefig(path, dpi=110, metadata={"Software": None})
    pyplot.close(figure)


def _rank(found: Mapping[str, Mapping[str, list[float]]], name: str, base: str) -> float:
    """Times by which it is slower than generated Python it is, of the cases that it has."""
    factors = [
        median(times[name]) / median(times[base]) for times in found.values() if name in times
    ]
    return median(factors)


def _panel(axis: Any, case: str, times: Mapping[str, list[float]], names: Sequence[str]) -> None:
    for place, name in enumerate(names):
        if name not in times:
            axis.text(
                1.25, place, "does not fit" if name == "libsbp" else "-", va="center", fontsize=9
            )
            continue
        value = median(times[name])
        axis.barh(place, value, color=_color(name), height=0.72)
        axis.text(value * 1.15, place, f"{value:,.0f}", va="center", fontsize=9, bbox=_PAPER)
    axis.axvline(median(times[_FIRST]), color=_OURS, linewidth=0.8, linestyle=":", zorder=0)
    axis.set_title(case, fontsize=12)
    axis.set_xscale("log")
    axis.set_xlim(1, 2e7)
    axis.set_xticks([1, 1e2, 1e4, 1e6])
    axis.set_yticks(range(len(names)), [name.replace("`", "") for name in names], fontsize=10)
    axis.invert_yaxis()
    for side in ("top", "right"):
        axis.spines[side].set_visible(False)


def _color(name: str) -> str:
    if name == "protogen, `construct`":
        return _REFERENCE
    if name.startswith("protogen"):
        return _OURS
    return _HAND if name.startswith("hand") else _PEER
