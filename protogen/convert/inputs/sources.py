"""Captures: their format, found out from their first bytes and name, and their reading.

    bytes in front of the rest            it is
    1F 8B, or 28 B5 2F FD                 compressed by gzip, or by zstd, maybe behind frames that
                                          it skips; then what is inside
    50 47 52 45 43 00 (`PGREC`)           a recording, see `protogen/recording/format.py`
    `(1700000000.25) ...`                 a log of text with times, see `text_logs.py`; comments
                                          and empty lines may stand in front

A name that ends in `.hex` means hex digits. Digits alone do not: there are protocols whose raw
bytes are hex digits. All else is the raw bytes of the line.
"""

from __future__ import annotations

import errno
import os
import stat
import sys
import zlib
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from itertools import chain
from pathlib import Path, PurePosixPath

import msgspec

from protogen.convert.errors import ConvertError, needed
from protogen.convert.formats import InputKind
from protogen.convert.inputs.chunks import PIECE, Chunk, joined
from protogen.convert.inputs.compression import SUFFIXES, Packing, packing_of, unpacked
from protogen.convert.inputs.hex_digits import HexError, HexReader
from protogen.convert.inputs.recordings import recorded_pieces
from protogen.convert.inputs.remote_files import Stream, asked, open_stored
from protogen.convert.inputs.text_lines import decoded, encoding_of, lines_of
from protogen.convert.inputs.text_logs import BEGIN, Complain, log_pieces
from protogen.convert.runs.table_names import STANDARD_INPUT, plain_name
from protogen.recording.reader import is_recording

_HEAD = 1 << 12
"""Bytes that are looked at to find out what a capture is."""
_WORDS = {
    InputKind.RAW: "raw bytes",
    InputKind.HEX: "hex digits",
    InputKind.LOG: "a text log with times",
    InputKind.RECORD: "a recording",
}
_KINDS = {".hex": InputKind.HEX}


class Source(msgspec.Struct, frozen=True):
    """Origin of a capture: a path, a URL that fsspec knows, or `-`."""

    place: str

    @property
    def is_standard_input(self) -> bool:
        """True if the capture comes through a pipe."""
        return self.place == STANDARD_INPUT

    @property
    def is_url(self) -> bool:
        """True if fsspec has to open it."""
        return "://" in self.place

    @property
    def name(self) -> str:
        """The name that its tables get, if no other capture has it: that of the file, bare."""
        return plain_name(self.place)

    @property
    def identity(self) -> str:
        """The place, whatever the working folder is."""
        if self.is_standard_input or self.is_url:
            return self.place
        return str(Path(os.path.normpath(self.place)).absolute())

    def stamp(self) -> tuple[int | None, int | str | None]:
        """Size in bytes, and what differs when the capture changes; None where that is not known.

        That is the time in ns of the last change, and of a URL what tells its file system.

        Raises ConvertError where nothing is there.
        """
        if self.is_standard_input:
            return None, None
        with _translated(self.place):
            if self.is_url:
                return _url_stamp(self.place)
            status = Path(self.place).stat()
        known = stat.S_ISREG(status.st_mode)
        return (status.st_size, status.st_mtime_ns) if known else (None, None)


@contextmanager
def _translated(place: str) -> Iterator[None]:
    try:
        yield
    except FileNotFoundError:
        # File systems of fsspec say no more than the name.
        raise ConvertError(f"{place}: {os.strerror(errno.ENOENT)}") from None
    except (OSError, EOFError) as error:
        reason = getattr(error, "strerror", None) or str(error) or "can't be read"
        raise ConvertError(f"{place}: {reason}") from None
    except zlib.error as error:
        raise ConvertError(f"{place}: its compression is damaged: {error}") from None
    except Exception as error:
        # The package is optional, so its exception has no name here.
        if type(error).__name__ != "ZstdError":
            raise
        raise ConvertError(f"{place}: its compression is damaged: {error}") from None


def expanded(places: Iterable[str]) -> list[str]:
    """The places, where URLs with `*` stand for all files like them, by name; shells know no URLs.

    Raises ConvertError where there is none.
    """
    return [found for place in places for found in _expanded(place)]


def _expanded(place: str) -> list[str]:
    if not _is_pattern(place):
        return [place]
    fsspec = needed("fsspec.core", f"reading {place}")
    with _translated(place), asked(place):
        filesystem, path = fsspec.url_to_fs(place)
        known = filesystem.glob(path, detail=True)
    # Stores show a folder as something of its own.
    found = sorted(name for name, facts in known.items() if facts.get("type") != "directory")
    if not found:
        raise ConvertError(f"{place}: there is no such file")
    if place.endswith(path):  # Names have no host and no user, which may stand in front.
        return [place.removesuffix(path) + name for name in found]
    return [filesystem.unstrip_protocol(name) for name in found]


def _is_pattern(place: str) -> bool:
    # What `::` joins, as a cache in front of a store, has names that lead to no file alone.
    if "://" not in place or "::" in place:
        return False
    # Behind `?`, a `*` is a part of the address.
    return "*" in (place.partition("?")[0] if place.startswith(_WEB) else place)


_WEB = ("http://", "https://")


_VERSIONS = (
    "ETag",
    "etag",
    "Content-MD5",
    "sha",
    "mtime",
    "LastModified",
    "last_modified",
    "Last-Modified",
    "updated",
    "modificationTime",
    "modify",
    "created",
)
"""Names that file systems have for a mark of a file's version, the most exact first."""


def _url_stamp(url: str) -> tuple[int | None, str | None]:
    fsspec = needed("fsspec.core", f"reading {url}")
    with asked(url):
        filesystem, path = fsspec.url_to_fs(url)
        known = filesystem.info(path)
    version = next((known[word] for word in _VERSIONS if known.get(word) is not None), None)
    return known.get("size"), None if version is None else str(version)


class Format(msgspec.Struct, frozen=True):
    """Format of a capture."""

    kind: InputKind
    packing: Packing

    @property
    def is_plain(self) -> bool:
        """True if the file's bytes are those of the line, so that any part can be read alone."""
        return self.kind is InputKind.RAW and self.packing is Packing.NONE

    def __str__(self) -> str:
        packed = f", {self.packing}" if self.packing else ""
        return f"{_WORDS[self.kind]}{packed}"


class Capture(msgspec.Struct):
    """A capture that was opened: what it is, and its bytes."""

    format: Format
    chunks: Iterator[Chunk]


@contextmanager
def opened(
    source: Source,
    kind: InputKind | None,
    sender: str,
    senders: Collection[str],
    complain: Complain,
    advance: Callable[[int], None] = lambda amount: None,
) -> Iterator[Capture]:
    """Open a capture, of the given kind or what it turns out to be, and read it piece by piece.

    `advance` is told of the bytes that were read from the file. Raises ConvertError.
    """
    with ExitStack() as opening:
        with _translated(source.place):
            stream = opening.enter_context(open_stream(source.place))
            head, packed = _begun(_read(stream, advance))
            packing = packing_of(head)
            head, pieces = _begun(unpacked(packed, packing, complain))
            found = kind or _kind(head, source.place)
        chunks = _chunks(pieces, found, sender, senders, complain, source.place)
        # What goes wrong in between, as writing does, is not the capture's fault.
        yield Capture(Format(found, packing), _named(chunks, source.place))


@contextmanager
def open_stream(place: str) -> Iterator[Stream]:
    """The bytes of a path, a URL or standard input."""
    if place == STANDARD_INPUT:
        yield sys.stdin.buffer
    elif "://" in place:
        with open_stored(place) as stored:
            yield stored
    else:
        with Path(place).open("rb", buffering=0) as file:
            yield file


def format_of(source: Source, kind: InputKind | None) -> Format:
    """Format of a capture, found out from its start alone. Raises ConvertError."""
    with opened(source, kind, "", (), lambda problem: None) as capture:
        return capture.format


def _read(stream: Stream, advance: Callable[[int], None]) -> Iterator[bytes]:
    """Pieces of a stream, each of what has come.

    To wait for more would be deaf to a Ctrl-C that arrives together with some bytes.
    """
    read = getattr(stream, "read1", stream.read)
    while piece := read(PIECE):
        advance(len(piece))
        yield piece


def _begun(pieces: Iterator[bytes]) -> tuple[bytes, Iterator[bytes]]:
    """The first bytes, at least those that show what a capture is, and all pieces.

    Pipes give what has been written so far, and unpacking what one member holds.
    """
    head = b""
    for piece in pieces:
        head += piece
        if len(head) >= _HEAD:
            break
    return head, chain([head] if head else [], pieces)


def _kind(head: bytes, place: str) -> InputKind:
    if is_recording(head):
        return InputKind.RECORD
    if BEGIN.match(head.decode(encoding_of(head), "replace")):
        return InputKind.LOG
    path = PurePosixPath(place)
    suffix = path.with_suffix("").suffix if path.suffix in SUFFIXES else path.suffix
    return _KINDS.get(suffix, InputKind.RAW)


def _chunks(
    pieces: Iterator[bytes],
    kind: InputKind,
    sender: str,
    senders: Collection[str],
    complain: Complain,
    place: str,
) -> Iterator[Chunk]:
    match kind:
        case InputKind.RAW:
            return _large(pieces)
        case InputKind.HEX:
            return _large(_hex(pieces, place))
        case InputKind.LOG:
            return joined(log_pieces(lines_of(pieces, place), sender, senders, complain))
        case InputKind.RECORD:
            return joined(recorded_pieces(pieces, sender, senders, complain))


def _large(pieces: Iterable[bytes]) -> Iterator[Chunk]:
    data = bytearray()
    for piece in pieces:
        if len(piece) >= PIECE and not data:
            yield Chunk(piece)
            continue
        data += piece
        if len(data) >= PIECE:
            yield Chunk(bytes(data))
            data.clear()
    if data:
        yield Chunk(bytes(data))


def _named(chunks: Iterator[Chunk], place: str) -> Iterator[Chunk]:
    """Let what goes wrong while reading say which capture it was."""
    with _translated(place):
        yield from chunks


def _hex(pieces: Iterable[bytes], place: str) -> Iterator[bytes]:
    reader = HexReader()
    try:
        for text in decoded(pieces):
            yield reader.feed(text)
        yield reader.finish()
    except HexError as error:
        raise ConvertError(f"{place}: {error}") from None
