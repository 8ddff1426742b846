"""Reads of an object file what a cost needs: sections, symbols and relocations.

With a section for each function and each constant, a relocation says who needs what.
"""

from __future__ import annotations

from collections.abc import Iterator
from struct import Struct

import msgspec

_WRITE, _ALLOC, _EXEC = 1, 2, 4
_SYMTAB, _RELA, _NOBITS, _REL = 2, 4, 8, 9
_NOT_PLACED = 0xFF00
"""Section numbers from here on are no sections: absolute or common symbols."""
_FUNCTION, _OBJECT = 2, 1


class Section(msgspec.Struct, frozen=True):
    """A piece of the program that the linker takes or leaves as a whole."""

    index: int
    name: str
    size: int
    is_code: bool
    is_writable: bool
    is_stored: bool
    """True if the file holds its bytes, which then are in flash."""


class Symbol(msgspec.Struct, frozen=True):
    """A name: of a function, of data, or of something that another file has."""

    name: str
    section: int | None
    size: int
    is_function: bool


class Reference(msgspec.Struct, frozen=True):
    """A place in a section that needs the address of a symbol."""

    section: int
    type: int
    symbol: Symbol


class Elf(msgspec.Struct, frozen=True):
    """An object file."""

    sections: tuple[Section, ...]
    """Those that end up in memory."""
    symbols: tuple[Symbol, ...]
    references: tuple[Reference, ...]


class _Header(msgspec.Struct, frozen=True):
    name: int
    type: int
    flags: int
    offset: int
    size: int
    link: int
    info: int


class _Reader:
    """The layout of one word size and byte order."""

    def __init__(self, data: bytes) -> None:
        if data[:4] != b"\x7fELF":
            raise ValueError("this is no ELF file")
        self.data = data
        self.wide = data[4] == 2
        order = "<" if data[5] == 1 else ">"
        self.head = Struct(order + ("QQQIHHHHHH" if self.wide else "IIIIHHHHHH"))
        self.section = Struct(order + ("IIQQQQIIQQ" if self.wide else "IIIIIIIIII"))
        self.symbol = Struct(order + ("IBBHQQ" if self.wide else "IIIBBH"))
        self.rel = Struct(order + ("QQ" if self.wide else "II"))
        self.rela = Struct(order + ("QQq" if self.wide else "IIi"))

    def headers(self) -> list[_Header]:
        head = self.head.unpack_from(self.data, 24)
        table, count = head[2], head[8]
        found = []
        for number in range(count):
            fields = self.section.unpack_from(self.data, table + number * self.section.size)
            name, type_, flags, _, offset, size, link, info, _, _ = fields
            found.append(_Header(name, type_, flags, offset, size, link, info))
        return found

    def text(self, strings: _Header, at: int) -> str:
        begin = strings.offset + at
        return self.data[begin : self.data.index(b"\0", begin)].decode()

    def names(self) -> int:
        """The number of the section that holds the names of sections."""
        return int(self.head.unpack_from(self.data, 24)[9])

    def read(self, header: _Header, layout: Struct) -> Iterator[tuple[int, ...]]:
        return layout.iter_unpack(self.data[header.offset : header.offset + header.size])


def read_elf(data: bytes) -> Elf:
    """Return what an object file holds. Raises ValueError where it is none."""
    reader = _Reader(data)
    headers = reader.headers()
    strings = headers[reader.names()]
    names = [reader.text(strings, header.name) for header in headers]
    symbols = [
        _symbol(reader, fields, headers[header.link], names)
        for header in headers
        if header.type == _SYMTAB
        for fields in reader.read(header, reader.symbol)
    ]
    sections = tuple(
        _section(index, names[index], header)
        for index, header in enumerate(headers)
        if header.flags & _ALLOC
    )
    return Elf(sections, tuple(symbols), tuple(_references(reader, headers, symbols)))


def _section(index: int, name: str, header: _Header) -> Section:
    flags = header.flags
    is_code, is_writable = bool(flags & _EXEC), bool(flags & _WRITE)
    return Section(index, name, header.size, is_code, is_writable, header.type != _NOBITS)


def _symbol(
    reader: _Reader, fields: tuple[int, ...], strings: _Header, sections: list[str]
) -> Symbol:
    if reader.wide:
        name, info, _, index, _, size = fields
    else:
        name, _, size, info, _, index = fields
    placed = 0 < index < _NOT_PLACED
    text = reader.text(strings, name)
    if not text and placed:
        text = sections[index]
    return Symbol(text, index if placed else None, size, info & 15 == _FUNCTION)


def _references(
    reader: _Reader, headers: list[_Header], symbols: list[Symbol]
) -> Iterator[Reference]:
    shift, mask = (32, 0xFFFFFFFF) if reader.wide else (8, 0xFF)
    for header in headers:
        if header.type not in (_REL, _RELA):
            continue
        layout = reader.rela if header.type == _RELA else reader.rel
        for fields in reader.read(header, layout):
            yield Reference(header.info, fields[1] & mask, symbols[fields[1] >> shift])
