"""Arguments and options that several commands have."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

SchemaFile = Annotated[
    Path, typer.Argument(metavar="SCHEMA", help="The schema file, or library:NAME.")
]

SchemaPaths = Annotated[
    list[Path] | None,
    typer.Argument(
        metavar="SCHEMA",
        help="Schema files, folders of them, or library:NAME. Default: the project's schemas.",
    ),
]
CaptureFile = Annotated[
    Path, typer.Argument(metavar="FILE|-", help="The capture; - is standard input.")
]

SenderOfBytes = Annotated[
    str | None,
    typer.Option(metavar="NAME", help="The endpoint that sent the bytes. Default: any of them."),
]

HexText = Annotated[
    str | None,
    typer.Option("--hex", metavar="TEXT", help="The bytes in hex, instead of other input."),
]

ToldParts = Annotated[
    list[str] | None,
    typer.Option(
        "--told",
        metavar="PART=NUMBER",
        help="What the bytes do not say of their identity, such as what was asked for.",
    ),
]

Versions = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="[[OLD] NEW]",
        help="Schemas, folders, library:NAME or git:REV:PATH. Default: the project's schemas.",
    ),
]

Against = Annotated[
    str | None,
    typer.Option(metavar="VERSION", help="What NEW is held against: git:REV, or a path."),
]

Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but what is wrong.")]
