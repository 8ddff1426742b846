"""Prints a header and a source for each protocol, or one header that holds both."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from pathlib import PurePosixPath

import msgspec
from jinja2 import Environment

from protogen.copying import replace
from protogen.model.frame_plan import StartRule
from protogen.model.protocol import Protocol
from protogen.passes.selection import narrow, select
from protogen.targets.banner import C, banner
from protogen.targets.c.cpp.view import cpp_module
from protogen.targets.c.decoders.members import candidate_members, members_of, memory_of
from protogen.targets.c.frame import expressions
from protogen.targets.c.frame.fill import EVENTS, Fill
from protogen.targets.c.frame.framing import FramingView, framing_view
from protogen.targets.c.frame.stuffing import StuffingKind
from protogen.targets.c.lines import mentions, prototype
from protogen.targets.c.module import Module, view
from protogen.targets.c.named import string
from protogen.targets.c.options import COptions
from protogen.targets.c.package import package_files
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.protocol_names import choose_writer, names_of
from protogen.targets.c.spelling import Names
from protogen.targets.c.wrapping import wrapped
from protogen.targets.output import File
from protogen.targets.printing import environment

_BAUD = 115200
"""Baud rate of a sketch where the schema does not say."""


class Unit(msgspec.Struct, frozen=True):
    """A protocol with everything that is printed of it."""

    protocol: Protocol
    whole: Protocol
    """With what was not chosen."""
    names: Names
    module: Module
    framing: FramingView


def emit(protocols: Sequence[Protocol], options: COptions = COptions()) -> tuple[File, ...]:  # noqa: B008
    """The files of these protocols, and with the split style those that make them a package."""
    units = [unit_of(protocol, options) for protocol in protocols]
    files = [file for unit in units for file in _files(unit, options)]
    if options.style == "split" and units:
        named = [unit.names.file for unit in units]
        files += package_files([unit.protocol for unit in units], named, c_environment())
        files += [_sketch(unit) for unit in units]
    return tuple(files)


def unit_of(protocol: Protocol, options: COptions) -> Unit:
    """Views of the chosen part of a protocol."""
    names = names_of(protocol)
    chosen = select(protocol, options.only, options.senders)
    if options.events == "messages" and options.only is None:
        chosen = narrow(chosen)
    choose_writer(names, chosen)
    helpers = Helpers(names)
    module = view(chosen, options, names, helpers)
    framing = framing_view(chosen, module.messages, module.sinks, options, names, helpers)
    # What frames call as well is needed where messages are copied as a whole, too.
    module = replace(module, helpers=helpers.texts[: len(module.helpers)])
    return Unit(chosen, protocol, names, module, framing)


def _files(unit: Unit, options: COptions) -> tuple[File, ...]:
    files = _c_files(unit, options)
    return (*files, _cpp_header(unit)) if options.hpp else files


def _c_files(unit: Unit, options: COptions) -> tuple[File, ...]:
    name = unit.names.file
    header, source = _print(unit.module, unit.framing, options)
    first = banner(C, [unit.protocol])
    if options.style == "single":
        text = c_environment().get_template("single.h.j2")
        both = text.render(header=header, source=source, upper=unit.module.upper)
        return (File(PurePosixPath(f"{name}.h"), both, first),)
    files = (
        File(PurePosixPath(f"{name}.c"), source, first),
        File(PurePosixPath(f"{name}.h"), header, first),
    )
    if not options.stubs:
        return files
    return (*files, File(PurePosixPath(f"{name}_stubs.c"), _stubs(unit), None, once=True))


def texts(
    protocol: Protocol, options: COptions, *, payloads_only: bool = False, fill: Fill = EVENTS
) -> tuple[str, str]:
    """The text of the header and that of the source; with `payloads_only` they know no frames."""
    unit = unit_of(protocol, options)
    return _print(unit.module, None if payloads_only else unit.framing, options, fill)


def _print(
    module: Module, framing: FramingView | None, options: COptions, fill: Fill = EVENTS
) -> tuple[str, str]:
    given = {"module": module, "options": options, "framing": framing, "fill": fill}
    environment = c_environment()
    return (
        wrapped(environment.get_template("header.h.j2").render(given)),
        wrapped(environment.get_template("source.c.j2").render(given)),
    )


def _stubs(unit: Unit) -> str:
    """A source with an empty body for each handler."""
    template = c_environment().get_template("frame/stubs.c.j2")
    return template.render(module=unit.module, framing=unit.framing)


def _cpp_header(unit: Unit) -> File:
    """The header for C++ over that of C."""
    cpp = cpp_module(unit.whole, unit.protocol, unit.names, unit.module, unit.framing)
    template = c_environment().get_template("cpp/header.hpp.j2")
    text = wrapped(template.render(module=unit.module, cpp=cpp))
    return File(PurePosixPath(f"{unit.names.file}.hpp"), text, banner(C, [unit.protocol]))


def _sketch(unit: Unit) -> File:
    """An Arduino sketch that receives what the first endpoint sends."""
    name = unit.names.file
    template = c_environment().get_template("package/sketch.ino.j2")
    baud = unit.protocol.link.baud or _BAUD
    text = template.render(module=unit.module, framing=unit.framing, baud=baud)
    return File(PurePosixPath("examples", name, f"{name}.ino"), text, banner(C, [unit.protocol]))


@cache
def c_environment() -> Environment:
    """The templates of C, with the functions that they call."""
    found = environment("protogen.targets.c")
    found.globals["prototype"] = prototype
    found.globals["members"] = members_of
    found.globals["candidate_members"] = candidate_members
    found.globals["memory"] = memory_of
    found.globals["Start"] = StartRule
    found.globals["Kind"] = StuffingKind
    found.filters["hex"] = expressions.byte
    found.filters["octets"] = expressions.octets
    found.filters["byte_at"] = expressions.byte_at
    found.filters["differs"] = expressions.differs
    found.filters["equals"] = expressions.equals
    found.filters["plus"] = expressions.plus
    found.filters["mentions"] = mentions
    found.filters["literal"] = string
    return found
