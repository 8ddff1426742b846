"""Codecs of all contenders, generated and built."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

from c_costs.nanopb import nanopb
from c_costs.protocols import FOLDER, PROTOCOLS, TOGETHER, Protocol
from c_costs.toolchains import Toolchain, run

INLINED = ("-DEXPERT_API=static inline",)


@dataclass(frozen=True)
class Subject:
    """A codec for the messages of a protocol."""

    kind: str
    protocol: Protocol
    header: Path
    """Its functions, in the words of `harness/bench.h`."""
    folders: tuple[Path, ...]
    sources: tuple[Path, ...]
    flags: tuple[str, ...] = ()
    lto_flags: tuple[str, ...] = ()
    """Those that go with `-flto`."""


class Workshop:
    """A folder where everything is generated and built."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._built = 0

    def subject(self, kind: str, protocol: Protocol) -> Subject:
        makers = {
            "expert": self._expert,
            "included": self._included,
            "inlined": self._inlined,
            "sse2": self._sse2,
            "mavlink": self._mavlink,
            "nanopb": self._nanopb,
        }
        make = makers.get(kind)
        return make(protocol) if make else self._protogen(kind, protocol)

    def together(self, kind: str, parts: Sequence[Subject]) -> Subject:
        """One program with the messages of several subjects."""
        if kind in ("mavlink", "nanopb"):
            return self.subject(kind, TOGETHER)
        if kind == "included":
            apart = [self.subject("messages", part.protocol) for part in parts]
            return self._in_one_source(self.together("messages", apart))
        name = kind if kind in ("expert", "inlined") else "protogen"
        header = FOLDER / "subjects" / f"use_{name}_all.h"
        folders = tuple(folder for part in parts for folder in part.folders)
        sources = tuple(source for part in parts for source in part.sources)
        lto = tuple(flag for part in parts for flag in part.lto_flags)
        return Subject(kind, TOGETHER, header, folders, sources, parts[0].flags, lto)

    def _protogen(self, events: str, protocol: Protocol) -> Subject:
        output = self.folder / events / protocol.name
        only = [word for name in protocol.messages for word in ("--only", name)]
        options = ["--target", "c", "--events", events, "--sender", protocol.sender, *only]
        command = [sys.executable, "-m", "protogen", "generate", str(protocol.schema)]
        run([*command, "-o", str(output), "--quiet", *options])
        source = output / "c" / f"{protocol.name}.c"
        header = FOLDER / "subjects" / f"use_protogen_{protocol.name}.h"
        flags = ("-DBENCH_POLLS",) if _is_polled(source.with_suffix(".h")) else ()
        lto = (f"-D{protocol.name.upper()}_APART=static",)
        return Subject(events, protocol, header, (source.parent,), (source,), flags, lto)

    def _included(self, protocol: Protocol) -> Subject:
        """The generated source as a part of the application's, all of it static."""
        return self._in_one_source(self._protogen("messages", protocol))

    def _in_one_source(self, own: Subject) -> Subject:
        lines = [f'#include "{path}"' for path in (*own.sources, own.header)]
        header = self.folder / f"use_included_{own.protocol.name}.h"
        header.write_text("\n".join(lines) + "\n", encoding="utf-8")
        flags = [*own.flags, *(flag for path in own.sources for flag in _all_static(path.stem))]
        return Subject("included", own.protocol, header, own.folders, (), tuple(flags))

    def _expert(self, protocol: Protocol) -> Subject:
        folder = FOLDER / "expert"
        header = FOLDER / "subjects" / f"use_expert_{protocol.name}.h"
        return Subject(
            "expert", protocol, header, (folder,), (folder / f"expert_{protocol.name}.c",)
        )

    def _inlined(self, protocol: Protocol) -> Subject:
        """The expert's source as a part of the application's, all of it static."""
        header = FOLDER / "subjects" / f"use_inlined_{protocol.name}.h"
        return Subject("inlined", protocol, header, (FOLDER / "expert",), (), INLINED)

    def _sse2(self, protocol: Protocol) -> Subject:
        """It encodes as the other expert does, and takes single bytes as that does."""
        other = self._expert(protocol)
        source = FOLDER / "expert" / f"sse2_{protocol.name}.c"
        header = FOLDER / "subjects" / f"use_sse2_{protocol.name}.h"
        return Subject("sse2", protocol, header, other.folders, (*other.sources, source))

    def _nanopb(self, protocol: Protocol) -> Subject:
        runtime = nanopb()
        assert runtime is not None
        sends_lidar = protocol.name in ("rn1", TOGETHER.name)
        flags = ["-DPB_FIELD_16BIT", "-DPB_NO_ERRMSG"]
        flags += [] if sends_lidar else ["-DPB_BUFFER_ONLY"]
        sources = tuple(runtime / f"pb_{name}.c" for name in ("common", "encode", "decode"))
        header = FOLDER / "subjects" / f"use_nanopb_{protocol.name}.h"
        folders = (runtime, FOLDER / "nanopb")
        return Subject("nanopb", protocol, header, folders, sources, tuple(flags))

    def _dialect(self, protocol: Protocol) -> Path:
        """A dialect's definition; the one of all messages is made of the others."""
        folder = FOLDER / "mavlink"
        if protocol is not TOGETHER:
            return folder / f"{protocol.name}.xml"
        trees = [
            ElementTree.parse(folder / f"{item.name}.xml").getroot()
            for item in PROTOCOLS
            if item.has_peers
        ]
        whole = trees[0].find("messages")
        assert whole is not None
        whole.extend(message for tree in trees[1:] for message in tree.iter("message"))
        for number, message in enumerate(whole, 1):
            message.set("id", str(number))
        found = self.folder / f"{protocol.name}.xml"
        ElementTree.ElementTree(trees[0]).write(found)
        return found

    def _mavlink(self, protocol: Protocol) -> Subject:
        output = self.folder / "mavlink" / protocol.name
        definition = self._dialect(protocol)
        command = [sys.executable, "-m", "pymavlink.tools.mavgen", "--lang=C"]
        run([*command, "--wire-protocol=2.0", "-o", str(output), str(definition)])
        header = FOLDER / "subjects" / f"use_mavlink_{protocol.name}.h"
        return Subject("mavlink", protocol, header, (output, FOLDER / "subjects"), ())

    def build(
        self, toolchain: Toolchain, harness: str, subject: Subject, *more: str | Path
    ) -> Path:
        """Compile and link a harness with a subject."""
        self._built += 1
        program = self.folder / f"program{self._built}"
        folders = [f"-I{folder}" for folder in (FOLDER / "harness", *subject.folders)]
        flags = (*subject.flags, *(subject.lto_flags if toolchain.has_lto else ()))
        command = [
            *(toolchain.compiler, *toolchain.flags, *flags, *folders, *map(str, more)),
            f'-DSUBJECT="{subject.header}"',
            f"-DBENCH_MESSAGE_SIZE={subject.protocol.memory}",
            str(FOLDER / "harness" / f"{harness}.c"),
            *map(str, subject.sources),
            *("-o", str(program)),
        ]
        run(command)
        return program


def _all_static(name: str) -> Sequence[str]:
    """What a source defines that includes a generated one."""
    macros = ("API=static inline", "APART=static", "NO_WEAK", "NO_HANDLERS")
    return [f"-D{name.upper()}_{macro}" for macro in macros]


def _is_polled(header: Path) -> bool:
    """Whether `push` of a generated decoder returns what is complete, and calls nobody."""
    return "_decoder_event(" in header.read_text(encoding="utf-8")


def frames_of(host: Path, which: int, count: int) -> list[bytes]:
    """Frames of random messages, as a program on this machine makes them."""
    lines = run([str(host), "frames", str(which), str(count)]).split()
    return [bytes.fromhex(line) for line in lines]
