"""Exceptions of making and reading frames, which say where and why."""

from __future__ import annotations

from typing import Literal, Self

Reason = Literal[
    "noise", "checksum", "length", "stuffing", "truncated", "size", "encoding", "value"
]
"""Reason why bytes are no frame."""

ByteFault = Literal["value", "encoding", "size"]
"""Reason why bytes are no value: a wrong one, a bit set that has to be clear, or too few."""


class CodecError(ValueError):
    """Root of all errors that a generated module raises for bytes or values."""


class EncodeError(CodecError):
    """A value can't be sent. `path` names the field or part; `problem` says what is allowed."""

    def __init__(self, path: str, problem: str) -> None:
        super().__init__(path, problem)
        self.path = path
        self.problem = problem

    def __str__(self) -> str:
        return f"{self.path}: {self.problem}" if self.path else self.problem

    def inside(self, outer: str) -> Self:
        """The same error as seen by what holds the field: `outer` is put before the path."""
        return type(self)(join_path(outer, self.path), self.problem)


class DecodeError(CodecError):
    """Bytes are not exactly one frame, or not the payload of this message.

    `reason` is one of the decoder's reasons, or `unknown`: a valid frame whose identity belongs to
    no message. `offset` counts bytes from the start of what was given; `path` names the field, if
    it is one.
    """

    def __init__(
        self, reason: Reason | Literal["unknown"], problem: str, *, offset: int = 0, path: str = ""
    ) -> None:
        super().__init__(reason, problem)
        self.reason: Reason | Literal["unknown"] = reason
        self.problem = problem
        self.offset = offset
        self.path = path

    def __str__(self) -> str:
        place = f"byte {self.offset}" + (f", {self.path}" if self.path else "")
        return f"{place}: {self.problem} ({self.reason})"


class PayloadFault(Exception):  # noqa: N818 - `constructs.PayloadError` is the error
    """Bytes that are not this payload, or a value that it can't hold: construct's kind of error.

    It stands here for those who take it up, and should not wait for construct.
    """

    reason: Reason
    problem: str
    path: str
    offset: int
    missing: int


class NeedsReference(Exception):  # noqa: N818 - it is no error: the reference decides
    """These bytes or values are not plainly in order."""


ANYTHING = Exception
"""Anything that the fast engine may raise; a message may be called like the exception."""


class ByteError(ValueError):
    """Bytes that stand for no value: what `Number.decode` and its kind raise."""

    def __init__(self, reason: ByteFault, problem: str) -> None:
        super().__init__(problem)
        self.reason: ByteFault = reason


def join_path(outer: str, inner: str) -> str:
    """`speed` in `wheels` is `wheels.speed`; `[2]` in `wheels` is `wheels[2]`."""
    if not outer or not inner or inner.startswith("["):
        return outer + inner
    return f"{outer}.{inner}"
