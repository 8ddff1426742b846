"""Programs for EVA that call what is neither a codec nor a decoder: names, counters, pieces.

They are made from the text of the C alone. An enum has any number, as one that came from elsewhere
may; a struct has any bytes; and what takes the bytes of a frame refuses any of them.
"""

from __future__ import annotations

import re

from c_proof.drivers import HEAD, Driver, program
from protogen.model.protocol import Protocol

_ASKED = re.compile(
    r"^(?:[A-Z]\w*_API |static |static inline )(?:const )?(?:struct |enum )?\w+ \*?"
    r"(\w+_(?:name|refused|clear|lose|tally|took|count|counted|counters))\(([^){;]*)\)(?:;| \{)",
    re.MULTILINE,
)
"""What has a name for a value or a field, and what counts."""
_POINTER = re.compile(r"(const )?struct (\w+) \*(\w+)")
_STRUCT = r"^struct {name} \{{\n(?:.*\n)*?\}};\n"
_TRUTH = re.compile(r"^ +bool (\w+);", re.MULTILINE)
_PROOF = """
static void prove_{function}(void) {{
{values}    {call};
}}
"""
_NAME = "sink = (uint8_t){call}[0]"
_REFUSED = """const char *const name = {call};
    if (name != NULL) {{
        sink = (uint8_t)name[0];
    }}"""
_PIECES = """
static bool offered(void *user, uint8_t byte) {{
    *(uint8_t *)user = byte;
    return any != 0;
}}

static void prove_{name}_transmit(void) {{
    static uint8_t last;
    struct {name}_transmission frame = {{offered, &last, 0, 0}};
    while (any != 0) {{
        while (any != 0) {{
            {name}_transmit(&frame, (uint8_t)any);
        }}
        (void){name}_transmitted(&frame);
    }}
}}
"""


def others_driver(protocol: Protocol, header: str, source: str) -> Driver:
    """Each name of any number, any counters of any struct, and any pieces of frames."""
    name, upper = protocol.name, protocol.name.upper()
    head = HEAD.format(name=name, upper=upper)
    # With the `feed` that takes frames whole, as that counts by itself.
    head = f"#define {upper}_NAMES\n#define {upper}_COUNTERS\n{head[head.index('#include') :]}"
    parts, proofs = [head, _PIECES.format(name=name)], [f"{name}_transmit"]
    for function, parameters in dict(_ASKED.findall(f"{header}\n{source}")).items():
        parts.append(_proof(header, function, parameters))
        proofs.append(function)
    return program(parts, proofs)


def _proof(header: str, function: str, parameters: str) -> str:
    values, given = "", []
    for parameter in re.split(r",\s*", parameters.strip()):
        pointer = _POINTER.fullmatch(parameter)
        if pointer is None:
            given.append(f"({parameter.rpartition(' ')[0]})any")
            continue
        struct, value = pointer[2], pointer[3]
        values += f"    struct {struct} {value};\n"
        values += f"    Frama_C_make_unknown((char *)&{value}, sizeof {value});\n"
        values += "".join(
            f"    {value}.{member} = any != 0;\n" for member in _truths(header, struct)
        )
        given.append(f"&{value}")
    call = f"{function}({', '.join(given)})"
    kind = function.rpartition("_")[2]
    text = {"name": _NAME, "refused": _REFUSED}.get(kind, "(void){call}")
    return _PROOF.format(function=function, values=values, call=text.format(call=call))


def _truths(header: str, struct: str) -> list[str]:
    """Members that are true or false, of which C has no others."""
    found = re.search(_STRUCT.format(name=struct), header, re.MULTILINE)
    return _TRUTH.findall(found.group()) if found else []
