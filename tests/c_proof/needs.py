"""What `load` asks of a payload, for contracts and for drivers of EVA."""

from __future__ import annotations

import re

from protogen.model.protocol import Protocol

NEEDS = {
    ("rn1", "maintenance"): "(payload[3] != 65 || size == 7) && (payload[3] != 83 || size == 5)",
    ("rn1_firmware", "maintenance"): "(payload[3] != 83 || size == 5)",
    ("rflex", "sonar_data"): "(size - 8) % 3 == 0",
    ("rflex_drivers", "sonar_data"): "(size - 8) % 3 == 0",
    ("rflex_drivers", "lcd_dump"): "size == 6 + payload[5]",
}
"""What `load` asks of a payload whose size is one of those that its message can have."""
_SIZES = re.compile(r"#define (\w+)_PAYLOAD_MIN (\d+)[uU]\s[^#]*#define \1_PAYLOAD_MAX (\d+)[uU]")


def sizes(header: str) -> dict[str, tuple[int, int]]:
    """Least and greatest size of each message's payload, by the message's prefix."""
    flat = re.sub(r"\\\n", " ", header)
    return {upper: (int(least), int(most)) for upper, least, most in _SIZES.findall(flat)}


def needs(protocol: Protocol, header: str) -> dict[str, str]:
    """What each message's `load` asks of a payload, in words that C and ACSL share."""
    found = {}
    for upper, (least, most) in sizes(header).items():
        message = upper.lower().removeprefix(f"{protocol.name}_")
        fits = f"{least} <= size && size <= {most}"
        more = NEEDS.get((protocol.name, message))
        found[message] = f"{fits} && {more}" if more else fits
    return found


def predicates(asked: dict[str, str], upper: str) -> str:
    predicates = [
        f"predicate {message}_fits(uint8_t *payload, integer size) = {needed};"
        for message, needed in asked.items()
    ]
    cases = [
        f"(message == {upper}_MESSAGE_{message.upper()} ==> {message}_fits(payload, size))"
        for message in asked
    ]
    holds = "predicate holds(integer message, uint8_t *payload, integer size) =\n        "
    predicates.append(holds + " &&\n        ".join(cases) + ";")
    return "/*@\n" + "".join(f"    {predicate}\n" for predicate in predicates) + "*/\n"
