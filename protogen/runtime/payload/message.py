"""Bases of the generated messages."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Self

from protogen.runtime.attributes import attribute, held_argument
from protogen.runtime.errors import DecodeError, EncodeError, NeedsReference, PayloadFault
from protogen.runtime.identities import Identities
from protogen.runtime.payload.number import GivenValue
from protogen.runtime.values import Frozen, Value

if TYPE_CHECKING:
    from protogen.runtime.constructs import Construct
    from protogen.runtime.payload.records import FieldRules, StructRule
    from protogen.runtime.payload.rules import Scope, Violation


def _rule(record: type[Record]) -> tuple[StructRule, Scope]:
    """The rule for all fields, and the scope around them, which is empty.

    It is imported where values have to be looked at one by one.
    """
    from protogen.runtime.payload.records import StructRule
    from protogen.runtime.payload.rules import Scope

    return StructRule(record), Scope()


class Sizes(Frozen):
    """Sizes in bytes: `least`, `least + step`, ... up to `greatest`."""

    __slots__ = ("greatest", "least", "step")

    least: int
    greatest: int
    step: int

    def __init__(self, least: int, greatest: int, step: int = 1) -> None:
        self._set(least, greatest, step)

    @property
    def fixed(self) -> int | None:
        """The size, where there is only one."""
        return self.least if self.least == self.greatest else None

    def __contains__(self, size: int) -> bool:
        return size in range(self.least, self.greatest + 1, self.step)

    def __str__(self) -> str:
        if self.fixed is not None:
            return str(self.fixed)
        steps = f" in steps of {self.step}" if self.step > 1 else ""
        return f"{self.least}..{self.greatest}{steps}"


class Record(Value):
    """Fields with a rule for each: a message, or a struct inside of one."""

    __slots__ = ()

    def __init__(self) -> None:
        """Without fields, unless the class has some."""

    if TYPE_CHECKING:
        FORMAT: ClassVar[Construct]
        """The construct declaration: how the fields lie on the wire."""
        RULES: ClassVar[FieldRules]
        """Rules for the fields' values, in wire order."""

    def violations(self) -> list[Violation]:
        """Values that the schema does not foresee: out of range, or without a name.

        A decoder keeps them. Strict encoding refuses the forbidden ones among them.
        """
        rule, scope = _rule(type(self))
        return rule.violations(self, scope)

    def to_dict(self) -> dict[str, Any]:
        """The fields for JSON.

        Numbers are raw; bytes are hexadecimal text; not-a-number and the infinities, for which
        JSON has no numbers, are the texts `nan`, `inf` and `-inf`; structs are mappings.
        """
        rule, scope = _rule(type(self))
        return rule.to_json(self, scope)

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        """The record of what `to_dict` gives; names of values may stand for their numbers.

        Raises EncodeError with the field's path where a field is missing, unknown or of another
        kind. Whether the values can be sent is asked when they are.
        """
        rule, scope = _rule(cls)
        record: Self = rule.from_json(data, scope)
        return record


class Message(Record):
    """Base of the generated messages."""

    __slots__ = ()

    NAME: ClassVar[str]
    """The message's name in the schema."""
    SENDERS: ClassVar[tuple[str, ...]]
    """The endpoints that send it."""
    IDENTITY: ClassVar[tuple[int, ...]]
    """The values of the frame's identity parts, in wire order."""
    IDENTITIES: ClassVar[Identities | None] = None
    """All identities, where there are several; IDENTITY is the one that is sent by itself."""
    SPEC_HASH: ClassVar[str]
    """SHA-256, in hex, of its identity, its layout and what its values mean."""
    SIZES: ClassVar[Sizes]
    """The sizes that its payload can have."""
    CUT_SIZE: ClassVar[int | None] = None
    """Bytes that are known of a longer payload, where sizes vary by what is left out."""
    TELLS_ITS_END: ClassVar[bool] = False
    """True if sizes vary, and the fields say where they end."""
    HELD: ClassVar[Mapping[str, str]] = MappingProxyType({})
    """Fields that are numbers of the frame, with the names of these parts."""

    __read__: ClassVar[Callable[[bytes], Any] | None] = None
    """Gives the message of a payload, as the fast engine reads it. Raises where it can't."""
    __write__: ClassVar[Callable[[Any], bytes] | None] = None
    """Gives the payload of a message, as the fast engine makes it. Raises where it can't."""

    def __init_subclass__(cls, **others: Any) -> None:
        """No class encodes as its base does: only a module's own classes are its messages.

        What `others` say is for other bases.
        """
        super().__init_subclass__(**others)
        cls.__encode__ = Message.__encode__  # type: ignore[method-assign]
        cls.__read__ = cls.__write__ = None

    @classmethod
    def __known__(cls) -> int | None:
        """Bytes that are known of a payload; None where its fields say how long it is."""
        return cls.SIZES.fixed if cls.CUT_SIZE is None else cls.CUT_SIZE

    @classmethod
    def __held__(cls, numbers: Mapping[str, int]) -> dict[str, int]:
        """The fields that are numbers of the frame, as arguments, out of all numbers of one."""
        return {held_argument(name): numbers[part] for name, part in cls.HELD.items()}

    def __holds__(self) -> dict[str, int]:
        """The numbers of the frame that are fields, by the names of these parts."""
        return {part: int(getattr(self, attribute(name))) for name, part in self.HELD.items()}

    @classmethod
    def __known_of__(cls, payload: bytes, numbers: Mapping[str, int]) -> int | None:
        """Bytes that are known of this payload; None where its fields take all of it.

        `numbers` are those of the frame.

        Raises construct's kind of error where it is no payload: PayloadError.
        """
        if not cls.TELLS_ITS_END:
            return cls.__known__()
        from protogen.runtime.constructs import prefix_size  # It takes long to import.

        return prefix_size(cls.FORMAT, payload, cls.__held__(numbers))

    def __encode__(self, module: object, sender: str | None, *parts: GivenValue) -> bytes:
        """The frame, as the fast engine of this module makes it. Raises where it can't.

        A module gives each of its messages its own. Mocks, which have whatever they are asked for,
        have nothing that is called in this way.
        """
        raise NeedsReference

    def to_payload(self, strict: bool = True) -> bytes:
        """The payload's bytes.

        Raises EncodeError where a value is out of range or does not fit; with `strict=False` a
        value may be anything that fits the wire.
        """
        write = type(self).__write__
        if write is not None and strict:
            with suppress(Exception):  # The reference says what is wrong.
                return write(self)
        return build_payload(self, strict)

    @classmethod
    def from_payload(cls, payload: bytes, **held: int) -> Self:
        """The message of a payload's bytes. Raises DecodeError: size, value or encoding.

        `held` gives the fields that are parts of the frame.
        """
        read = cls.__read__
        if read is not None and type(payload) is bytes:
            with suppress(Exception):  # The reference says what is wrong.
                message: Self = read(payload)
                return message
        try:
            return cls.parse_payload(payload, **held)
        except PayloadFault as error:
            raise DecodeError(
                error.reason, error.problem, offset=error.offset, path=error.path
            ) from None

    @classmethod
    def parse_payload(cls, payload: bytes, **held: int) -> Self:
        """The same, but raises construct's kind of error: PayloadError."""
        from protogen.runtime.constructs import PayloadError, Whole  # It takes long to import.

        if len(payload) not in cls.SIZES:
            problem = f"{cls.NAME} has {cls.SIZES} bytes of payload, not {len(payload)}"
            raise PayloadError("size", "", min(len(payload), cls.SIZES.greatest), problem)
        raw = Whole(cls.FORMAT).parse(payload, **held)
        rule, scope = _rule(cls)
        message: Self = rule.from_wire(raw, scope)
        return message


def build_payload(message: Message, strict: bool = True) -> bytes:
    """The payload of a message as construct builds it. Raises EncodeError."""
    rule, scope = _rule(type(message))
    values = rule.to_wire(message, scope, strict)
    try:
        payload = bytes(type(message).FORMAT.build(values))
    except PayloadFault as error:
        raise EncodeError(error.path, error.problem) from None
    if len(payload) not in message.SIZES:
        problem = f"makes {len(payload)} bytes of payload; {message.NAME} has {message.SIZES}"
        raise EncodeError("", problem)
    return payload
