"""Spelling of the schema's names in C."""

from __future__ import annotations

from collections import ChainMap
from copy import copy

from protogen.c_language.words import foreign_words, headers
from protogen.model.names import free_name
from protogen.targets.naming import PROTOCOL, NameTable, Thing


class Names:
    """Names of a protocol's C, and what each of them stands for.

    Two of them, joined of words of the schema, can come to the same (`robot` with `mode_idle`,
    `robot_mode` with `idle`): the second is escaped.
    """

    def __init__(self, prefix: str) -> None:
        self.prefix = prefix
        self.writer = ""
        """The parameters of functions that send byte by byte."""
        self.writing = ""
        """Arguments with which these hand the writer on."""
        self.is_stateless = False
        """True if the writer is a function and its argument. All depend on the senders printed."""
        self.file = ""
        """The name of the files, but for its end."""
        self.senders: dict[str, str] = {}
        """What the names of each endpoint that sends begin with."""
        self.files = NameTable(headers())
        """Names of files."""
        self.tags = NameTable(foreign_words())
        """Structs, enums and unions, which C knows by these words."""
        self.others = NameTable(foreign_words())
        """Functions, variables, typedefs, macros and named values."""
        self.members = NameTable()
        """Members and parameters, none of which may hide one of the others."""
        self._members: dict[str, str] = {}

    def copy(self) -> Names:
        """Names that others can be added to without a change of these."""
        names = copy(self)
        names.tags, names.others = self.tags.copy(), self.others.copy()
        return names

    def claim_file(self, name: str) -> None:
        """The name of the files."""
        self.file = self.files.add(name, PROTOCOL)

    def claim_tag(self, thing: Thing, *words: str) -> str:
        """A struct or an enum: `rn1_gyro`."""
        return self.tags.add(self._joined(words), thing)

    def claim(self, thing: Thing, *words: str) -> str:
        """A function: `rn1_gyro_encode`."""
        return self.others.add(self._joined(words), thing)

    def claim_macro(self, thing: Thing, *words: str) -> str:
        """A macro or a named value: `RN1_GYRO_PAYLOAD_SIZE`."""
        return self.others.add(self._joined(words).upper(), thing)

    def values_of(self, name: str) -> str:
        """The named values of an enum or of flags, for people: `RN1_GYRO_STATUS_...`."""
        return self._joined((name, "...")).upper()

    def claim_type(self, thing: Thing, *words: str) -> str:
        """A typedef, which in C++ no struct may be called like."""
        return self.others.add(self.tags.add(self._joined(words), thing), thing)

    def claim_helper(self, *words: str) -> str:
        """A function of the source, which gets a number where its name is taken."""
        taken = ChainMap(self.others.things, self.members.things)
        return self.others.add(free_name(self._joined(words), taken))

    def claim_member(self, thing: Thing, name: str) -> None:
        """A member or parameter. Things of other records may have members of that name, too."""
        found = name
        while found in self.others.things:
            found += "_"
        self._members[name] = found
        self.members.things.setdefault(found, thing)
        if found != name:
            self.members.note(thing, found)

    def member(self, name: str) -> str:
        """The member or parameter for a field, a case or a part."""
        return self._members.get(name, name)

    def _joined(self, words: tuple[str, ...]) -> str:
        return "_".join((self.prefix, *words))


def from_sender(name: str) -> str:
    """The suffix that tells the functions for a sender from those for others of the message."""
    return f"_from_{name}"
