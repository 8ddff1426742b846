"""Definitions of messages in the language of `.msg` files, as MCAP holds them (`ros2msg`)."""

from __future__ import annotations

from collections.abc import Iterator

from protogen.convert.ros2.layout import ListOf, Member, Message, Number, RosType, String

_SEPARATOR = "=" * 80


def definition_of(message: Message, package: str) -> str:
    """The definition of a message, and behind it those of the messages inside of it."""
    texts = ["\n".join(_lines(message, package))]
    texts += [
        "\n".join([f"MSG: {package}/{inner.name}", *_lines(inner, package)])
        for inner in message.inner
    ]
    return f"\n{_SEPARATOR}\n".join(texts) + "\n"


def _lines(message: Message, package: str) -> Iterator[str]:
    if message.comment:
        yield f"# {' '.join(message.comment.split())}"
    for member in message.members:
        word = _word(member.type, package)
        if member.flag is not None:
            yield f"bool {member.flag}"
        for constant in member.constants:
            yield f"{_number(member.type)} {constant.name}={constant.value}"
        yield f"{word} {member.name}{_remark(member)}"


def _remark(member: Member) -> str:
    return f"  # {member.comment}" if member.comment else ""


def _number(type: RosType) -> str:
    """The type of the numbers that constants name, also where they are in lists."""
    while not isinstance(type, Number):
        assert not isinstance(type, String)
        type = type.element if isinstance(type, ListOf) else type.members[0].type
    return type.word


def _word(type: RosType, package: str) -> str:
    match type:
        case Number(word=word):
            return word
        case String():
            return "string"
        case ListOf(element=element, count=count):
            return f"{_word(element, package)}[{'' if count is None else count}]"
        case Message(name=name):
            return f"{package}/{name}"
