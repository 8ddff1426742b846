"""Targets that print side by side, in two processes."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from itertools import zip_longest
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

    from protogen.model.protocol import Protocol
    from protogen.targets import Target
    from protogen.targets.output import File

_MANY = 500
"""Messages from which on it takes longer to print than to start a process."""


def emit_all(targets: Sequence[Target], protocols: Sequence[Protocol]) -> list[tuple[File, ...]]:
    """Return the files of each target. Of many messages, every second target has its own process.

    Of Python, C, Markdown, TypeScript and HTML these are C and TypeScript.
    """
    messages = [message for protocol in protocols for message in protocol.messages]
    if len(messages) < _MANY or len(targets) < 2 or not _can_fork():
        return [target.emit(protocols) for target in targets]
    for message in messages:
        _ = message.plan  # Made once here, and not again in each process.
    begun = [_begin(target, protocols) for target in targets[1::2]]
    here = [target.emit(protocols) for target in targets[::2]]
    there = map(_end, begun, targets[1::2], [protocols] * len(begun))
    return [files for pair in zip_longest(here, there) for files in pair if files is not None]


def _can_fork() -> bool:
    """True where a process can begin with all that this one has, and there is a processor for it.

    On macOS the system's own libraries do not stand that.
    """
    return sys.platform == "linux" and len(os.sched_getaffinity(0)) > 1


def _begin(target: Target, protocols: Sequence[Protocol]) -> Connection:
    """Begin to print a target; the files come from the connection."""
    from multiprocessing import get_context

    context = get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    context.Process(target=_send, args=(sender, target, protocols), daemon=True).start()
    sender.close()
    return receiver


def _send(sender: Connection, target: Target, protocols: Sequence[Protocol]) -> None:
    with suppress(BaseException):  # Whoever waits for the files tries again, and reports it.
        sender.send(target.emit(protocols))


def _end(receiver: Connection, target: Target, protocols: Sequence[Protocol]) -> tuple[File, ...]:
    """Wait for the files of a target."""
    try:
        files: tuple[File, ...] = receiver.recv()
    except EOFError:
        return target.emit(protocols)
    return files
