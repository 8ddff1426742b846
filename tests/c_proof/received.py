"""What users do with a payload that was received, for EVA: read its elements, and dispatch it.

What reads an element straight out of a payload gets any index below the number of elements, as its
comment asks. `dispatch` gets each payload of which its contract asks no more (`contracts.py`), or
each that `decode` takes. Longer payloads whose size varies are not dispatched: that would only take
the time of `load` once more, which `decode` calls for all of them.
"""

from __future__ import annotations

import re

from test_c_accessors import count_of

from protogen.model.messages import Message
from protogen.model.protocol import Protocol
from protogen.targets.c.protocol_names import names_of

_ACCESSOR = re.compile(
    r"static inline [\w ]+ (\w+)_at\( ?const uint8_t \*payload, size_t index"
    r"(?:, struct (\w+) \*out)?\)"
)
_READS = """        const size_t count_{number} = {count};
        if (count_{number} > 0U) {{
            const size_t index =
                Frama_C_unsigned_int_interval(0, (unsigned int)(count_{number} - 1U));
{reads}        }}
"""
_VALUE = "            (void){function}(payload, index);\n"
_STRUCT = """            struct {struct} element;
            {function}(payload, index, &element);
"""
SHORT = 64
"""The longest payloads of varying size that are dispatched."""
_EVENT = """    if ({asked}) {{
        struct {sender}_event event;
        Frama_C_make_unknown((char *)&event, sizeof event);
        event.message = {constant};
        event.payload = payload;
        event.payload_size = size;
        {sender}_dispatch(NULL, &event);
    }}
"""


def reads(protocol: Protocol, message: Message, prefix: str, flat_header: str) -> str:
    structs, names = dict(_ACCESSOR.findall(flat_header)), names_of(protocol)
    statements: list[str] = []
    for number, field in enumerate(message.fields):
        function = f"{prefix}_{field.name}"
        if function in structs:
            given = {"function": f"{function}_at", "struct": structs[function]}
            reads = (_STRUCT if given["struct"] else _VALUE).format(**given)
            count = count_of(message.fields, field, names)
            statements.append(_READS.format(number=number, count=count, reads=reads))
    return "".join(statements)


def events(protocol: Protocol, message: Message, flat_header: str, asked: str | None) -> str:
    """Dispatching of payloads, unless numbers of the frame say how long they are.

    It gets those of which no more is asked than this; or, without that, those that were taken.
    """
    senders = names_of(protocol).senders
    constant = f"{protocol.name}_message_{message.name}".upper()
    if any(field.part for field in message.fields) or f" {constant}" not in flat_header:
        return ""
    short = "" if message.sizes.fixed is not None else f" && size <= {SHORT}"
    asked = f"({asked or 'taken'}){short}"
    return "".join(
        _EVENT.format(sender=senders[sender.name], constant=constant, asked=asked)
        for sender in protocol.senders
        if sender.sends(message) and f" {senders[sender.name]}_dispatch(" in flat_header
    )
