"""Cost of each message and each decoder of a protocol.

What only one function needs is counted with it. What several need, of one message or decoder,
counts as shared there; what messages and decoders have in common has a row of its own.
"""

from __future__ import annotations

from collections.abc import Sequence

import msgspec

from protogen.footprint.build import Build, build
from protogen.footprint.elf import Section
from protogen.footprint.graph import Graph
from protogen.footprint.machines import Machine
from protogen.model.protocol import Protocol
from protogen.targets.c.decoders.decoder import DecoderView
from protogen.targets.c.decoders.forms import FormsDecoder
from protogen.targets.c.emit import Unit, unit_of
from protogen.targets.c.options import COptions


class FunctionCost(msgspec.Struct, frozen=True):
    """A function with what it alone needs."""

    role: str
    """`encode`, `decode`, `frame` or `send` of a message; `push` and others of a decoder."""
    name: str
    flash: int
    stack: int
    """The deepest that it goes, with all that it calls, without the user's functions."""


class Cost(msgspec.Struct, frozen=True):
    """A message or a decoder."""

    name: str
    functions: tuple[FunctionCost, ...]
    shared: int
    """Flash that several of its functions need, and nobody else."""
    struct: int
    """Bytes of its struct."""

    @property
    def flash(self) -> int:
        """All flash that nobody else needs."""
        return self.shared + sum(function.flash for function in self.functions)

    @property
    def stack(self) -> int:
        """The deepest of its functions."""
        return max((function.stack for function in self.functions), default=0)

    def of(self, role: str) -> tuple[FunctionCost, ...]:
        """The functions of a role: a message that several send has several frames."""
        return tuple(function for function in self.functions if function.role == role)


class Report(msgspec.Struct, frozen=True):
    """Cost of a protocol."""

    protocol: str
    machine: Machine
    compiler: str
    messages: tuple[Cost, ...]
    decoders: tuple[Cost, ...]
    shared: int
    """Flash that messages and decoders have in common."""
    handlers: int
    """Flash of the generated `dispatch` functions and the empty handlers."""
    flash: int
    """All of it, where a program uses every function."""
    static: int
    """RAM that is taken whether or not a decoder is made."""
    external: tuple[str, ...]
    """Functions of the compiler's library, which are not counted."""

    @property
    def ram(self) -> int:
        """RAM of all decoders, and static data."""
        return self.static + sum(decoder.struct for decoder in self.decoders)


class _Owner(msgspec.Struct, frozen=True):
    """A message or a decoder, before anything is measured."""

    name: str
    roles: tuple[tuple[str, str], ...]
    """Roles and names of functions."""
    struct: str | None = None


def report(protocol: Protocol, options: COptions, machine: Machine) -> Report:
    """Compile a protocol and say what it costs. Raises what `build` raises."""
    unit = unit_of(protocol, options)
    owners, handlers = (_messages(unit), _decoders(unit)), _handlers(unit)
    structs = [owner.struct for kind in owners for owner in kind if owner.struct is not None]
    made = build(protocol, options, machine, structs)
    account = _Account(made, [*owners[0], *owners[1]])
    messages, decoders = (tuple(map(account.cost, kind)) for kind in owners)
    graph = account.graph
    flash = graph.flash(graph.sections)
    # What handlers need and neither a message nor a decoder does.
    own = frozenset().union(*map(graph.reach, handlers)) - account.users.keys()
    dispatching = graph.flash(own)
    owned = sum(cost.flash for cost in (*messages, *decoders))
    in_ram = (item for item in graph.sections.values() if _is_in_ram(item, machine))
    return Report(
        protocol=protocol.name,
        machine=machine,
        compiler=made.compiler,
        messages=messages,
        decoders=decoders,
        shared=flash - dispatching - owned,
        handlers=dispatching,
        flash=flash,
        static=sum(item.size for item in in_ram),
        external=tuple(sorted(graph.external - {*handlers, ""})),
    )


def _is_in_ram(section: Section, machine: Machine) -> bool:
    is_constant = section.name.startswith(".rodata")
    return section.is_writable or (machine.constants_in_ram and is_constant)


def _messages(unit: Unit) -> list[_Owner]:
    frames = unit.framing.messages
    owners = []
    for message in unit.module.messages:
        roles = [("encode", message.encode), ("decode", message.decode)]
        own = [frame for frame in frames if frame.message.name == message.name]
        roles += [("frame", frame.called.function) for frame in own]
        roles += [("send", frame.called.send) for frame in own if frame.streams]
        owners.append(_Owner(message.name, tuple(roles), message.struct or None))
    return owners


def _decoders(unit: Unit) -> list[_Owner]:
    """Those of single forms of frame, and those of all forms of an endpoint's."""
    roles = ("init", "push", "feed", "flush")
    decoders: list[DecoderView | FormsDecoder] = [*unit.framing.decoders, *unit.framing.together]
    return [
        _Owner(
            decoder.name,
            tuple(
                (role, f"{decoder.prefix}_decoder_{role}")
                for role in (*roles, *(["next"] if decoder.gives_more else []))
            ),
            f"struct {decoder.prefix}_decoder",
        )
        for decoder in decoders
    ]


def _handlers(unit: Unit) -> list[str]:
    """The generated `dispatch` functions and the empty handlers."""
    dispatches = unit.framing.dispatches
    functions = [f"{dispatch.decoder.prefix}_dispatch" for dispatch in dispatches]
    functions += [f"{decoder.prefix}_dispatch" for decoder in unit.framing.together]
    functions += [f"{prefix}_decoder_dispatch" for prefix in unit.framing.polled]
    return functions + [item.function for dispatch in dispatches for item in dispatch.handlers]


class _Account:
    """Divides the sections among those who need them."""

    def __init__(self, made: Build, owners: Sequence[_Owner]) -> None:
        self.graph = Graph(made)
        self.users: dict[int, set[_Owner]] = {}
        self._sizes = made.sizes
        for owner in owners:
            for _, function in owner.roles:
                for section in self.graph.reach(function):
                    self.users.setdefault(section, set()).add(owner)

    def cost(self, owner: _Owner) -> Cost:
        """Cost of what nobody else needs."""
        graph = self.graph
        own = {section for section, users in self.users.items() if users == {owner}}
        reaches = [graph.reach(function) & own for _, function in owner.roles]
        functions = []
        for index, (role, name) in enumerate(owner.roles):
            others = frozenset().union(*(reaches[:index] + reaches[index + 1 :]))
            alone = own & {*(reaches[index] - others), graph.place(name)}
            functions.append(FunctionCost(role, name, graph.flash(alone), graph.stack(name)))
        shared = graph.flash(own) - sum(function.flash for function in functions)
        struct = 0 if owner.struct is None else self._sizes[owner.struct]
        return Cost(owner.name, tuple(functions), shared, struct)
