"""`protogen open`: the page of a schema in a browser."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from protogen.cli.exits import CLEAN
from protogen.cli.options import HexText, SchemaFile, SenderOfBytes
from protogen.convert.inputs.hex_digits import parse_hex

if TYPE_CHECKING:
    from protogen.model.protocol import Protocol

EXAMPLE = "Example: protogen open schemas/matty.yaml --sender esp --hex 55020141BC"


def open(schema: SchemaFile, sender: SenderOfBytes = None, hex: HexText = None) -> int:
    """Make the page of a schema in a temporary folder, and open it.

    The page is that of the target `html`: what there is to read, and a bench that decodes and
    encodes. It needs no network. With bytes, the bench shows them.
    """
    from protogen.cli.schemas import find_senders, open_protocol

    protocol = open_protocol(schema)
    if sender is not None:
        find_senders(protocol, sender)
    open_page(protocol, sender, None if hex is None else parse_hex(hex))
    return CLEAN


def open_page(protocol: Protocol, sender: str | None, data: bytes | None) -> None:
    """Open the page of a protocol, whose bench shows the bytes, and say where it is."""
    import webbrowser
    from tempfile import mkdtemp
    from urllib.parse import urlencode

    from protogen.targets.html.emit import emit

    folder = Path(mkdtemp(prefix="protogen-"))
    for file in emit([protocol]):
        (folder / file.path).write_bytes(file.bytes)
    url = (folder / f"{protocol.name}.html").as_uri()
    if data is not None:
        url += "#" + urlencode({"d": sender or "any", "hex": data.hex(" ")})
    is_open = webbrowser.open(url)
    typer.echo(url if is_open else f"no browser was found; the page is {url}")
