"""Cost of each message and each decoder of a protocol.

What only one function needs is counted with it. What several need, of one message or decoder,
counts as shared there; what messages and decoders have in common has a row of its own.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import msgspec

from protogen.footprint.build import Build, build
from protogen.footprint.graph import Graph
from protogen.footprint.machines import Machine
from protogen.model.protocol import Protocol
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
        """RAM of one decoder of each sender, and static data."""
        return self.static + sum(decoder.struct for decoder in self.decoders)


class _Owner(msgspec.Struct, frozen=True):
    """A message, a decoder or all handlers, before anything is measured."""

    name: str
    roles: tuple[tuple[str, str], ...]
    """Roles and names of functions."""
    struct: str | None = None


def report(protocol: Protocol, options: COptions, machine: Machine) -> Report:
    """Compile a protocol and say what it costs. Raises what `build` raises."""
    unit = unit_of(protocol, options)
    messages, decoders = _messages(unit), _decoders(unit)
    structs = [owner.struct for owner in (*messages, *decoders) if owner.struct is not None]
    made = build(protocol, options, machine, structs)
    return _Account(made, messages, decoders, _handlers(unit)).report(unit, machine)


def _messages(unit: Unit) -> list[_Owner]:
    frames = unit.framing.messages
    owners = []
    for message in unit.module.messages:
        roles = [("encode", message.encode), ("decode", message.decode)]
        own = [frame for frame in frames if frame.message.name == message.name]
        roles += [("frame", frame.function) for frame in own]
        roles += [("send", frame.send) for frame in own if frame.sends]
        owners.append(_Owner(message.name, tuple(roles), message.struct))
    return owners


def _decoders(unit: Unit) -> list[_Owner]:
    roles = ("init", "push", "feed", "flush")
    return [
        _Owner(
            decoder.name,
            tuple((role, f"{decoder.prefix}_decoder_{role}") for role in roles),
            f"struct {decoder.prefix}_decoder",
        )
        for decoder in unit.framing.decoders
    ]


def _handlers(unit: Unit) -> _Owner:
    dispatches = unit.framing.dispatches
    functions = [f"{dispatch.decoder.prefix}_dispatch" for dispatch in dispatches]
    functions += [item.function for dispatch in dispatches for item in dispatch.handlers]
    return _Owner("handlers", tuple(("handler", function) for function in functions))


class _Account:
    """Divides the sections among those who need them."""

    def __init__(
        self,
        made: Build,
        messages: Sequence[_Owner],
        decoders: Sequence[_Owner],
        handlers: _Owner,
    ) -> None:
        self.made = made
        self.graph = Graph(made)
        self.messages = messages
        self.decoders = decoders
        self.handlers = handlers
        self.users: dict[int, set[tuple[str, str]]] = {}
        for kind, owner in self._counted():
            for _, function in owner.roles:
                self._claim((kind, owner.name), function)

    def _counted(self) -> Iterable[tuple[str, _Owner]]:
        yield from (("message", owner) for owner in self.messages)
        yield from (("decoder", owner) for owner in self.decoders)

    def _claim(self, user: tuple[str, str], function: str) -> None:
        for section in self._reach(function):
            self.users.setdefault(section, set()).add(user)

    def _reach(self, function: str) -> frozenset[int]:
        place = self.graph.place(function)
        return frozenset() if place is None else self.graph.reach([place])

    def report(self, unit: Unit, machine: Machine) -> Report:
        graph = self.graph
        flash = graph.flash(graph.sections)
        messages = tuple(self._cost("message", owner) for owner in self.messages)
        decoders = tuple(self._cost("decoder", owner) for owner in self.decoders)
        handlers = graph.flash(self._handler_sections())
        own = sum(cost.flash for cost in (*messages, *decoders))
        return Report(
            protocol=unit.protocol.name,
            machine=machine,
            compiler=self.made.compiler,
            messages=messages,
            decoders=decoders,
            shared=flash - handlers - own,
            handlers=handlers,
            flash=flash,
            static=self._static(machine),
            external=tuple(sorted(graph.external - _handler_names(self.handlers))),
        )

    def _cost(self, kind: str, owner: _Owner) -> Cost:
        own = {section for section, users in self.users.items() if users == {(kind, owner.name)}}
        reaches = [self._reach(function) & own for _, function in owner.roles]
        functions = []
        taken = 0
        for index, (role, name) in enumerate(owner.roles):
            others = frozenset().union(*(reaches[:index] + reaches[index + 1 :]))
            place = self.graph.place(name)
            alone = (reaches[index] - others) | ({place} & own if place is not None else set())
            flash = self.graph.flash(alone)
            taken += flash
            functions.append(FunctionCost(role, name, flash, self.graph.stack(name)))
        struct = 0 if owner.struct is None else self.made.sizes[owner.struct]
        return Cost(owner.name, tuple(functions), self.graph.flash(own) - taken, struct)

    def _handler_sections(self) -> frozenset[int]:
        """Sections that handlers need and neither a message nor a decoder does."""
        reached = (self._reach(function) for _, function in self.handlers.roles)
        return frozenset().union(*reached) - self.users.keys()

    def _static(self, machine: Machine) -> int:
        sections = self.graph.sections.values()
        return sum(item.size for item in sections if _in_ram(item.name, machine, item.is_writable))


def _in_ram(name: str, machine: Machine, is_writable: bool) -> bool:
    return is_writable or (machine.constants_in_ram and name.startswith(".rodata"))


def _handler_names(handlers: _Owner) -> set[str]:
    return {function for _, function in handlers.roles} | {""}
