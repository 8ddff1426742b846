"""The contenders of `bench_python.py`: everything that decodes and encodes the same messages."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from peers.cases import Case
    from peers.contender import Contender

MAKERS = (
    "ours.fast",
    "ours.reference",
    "by_hand.slotted",
    "by_hand.tuples",
    "by_hand.numpy",
    "with_construct.interpreted",
    "with_construct.compiled",
    "with_kaitai.contender",
    "with_mavlink.contender",
    "with_sbp.contender",
    "with_scapy.contender",
    "columns.pure",
    "columns.native",
)
"""Modules of this package, and the functions that make their contenders."""


def made(maker: str, case: Case) -> Contender | None:
    """A contender; None where it has no such message. Raises ImportError where it is not there."""
    module, function = maker.split(".")
    contender: Contender | None = getattr(import_module(f"peers.{module}"), function)(case)
    return contender
