"""The inline functions that read an element of an array, held against decoders, on any machine."""

from __future__ import annotations

from pathlib import Path

import pytest
from c_library import write_sources
from c_structs import count_name
from compiled import ROOT, SCHEMAS, name_of, protocol_of
from test_c_codecs import FLAGS, MACHINES, SAMPLERS, Case, run
from tooling import require_compiler, require_tool

from protogen.c_language.expressions import FormulaPrinter
from protogen.model.payload_builder import plan_of
from protogen.model.types import Array, Field, Fill, Fixed, Marked, Struct
from protogen.targets.c.emit import unit_of
from protogen.targets.c.options import COptions
from protogen.targets.c.payload.accessors import is_readable
from protogen.targets.c.protocol_names import names_of
from protogen.targets.c.spelling import Names

ELEMENTS = ROOT / "tests" / "c_schemas" / "elements.yaml"
PATHS = [
    path
    for path in (*SCHEMAS, *SAMPLERS)
    if any(is_readable(step) for item in protocol_of(path).messages for step in item.plan.steps)
]
SANITIZED = ["-O2", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
WAYS = {
    **{
        name: (compiler, ["-static", "-O2"], runner)
        for name, (compiler, runner) in MACHINES.items()
    },
    "sanitized": ("clang", SANITIZED, []),
}
"""By name: a compiler, its flags, and what runs its programs."""

CHECK = """
static int check_{name}(const uint8_t *payload, size_t size{held}) {{
    static {struct} message;
    memset(&message, 0, sizeof message);
    if ({decode}(&message, payload, size{names}) != {ok}) {{
        return 0;
    }}
{loops}
    return 1;
}}
"""
LOOP = """
    for (size_t i = 0; i < {count}; i++) {{
        {type} found;
        memset(&found, 0, sizeof found);
        {read}
        if (memcmp(&found, &message.{field}[i], sizeof found) != 0) {{
            return 0;
        }}
    }}
"""
MAIN = """
int main(void) {{
{calls}
    return 0;
}}
"""


@pytest.mark.parametrize("path", PATHS, ids=name_of)
@pytest.mark.parametrize("way", WAYS)
def test_every_element_is_what_the_decoder_reads(way: str, path: Path, tmp_path: Path) -> None:
    compiler, flags, runner = WAYS[way]
    made = protocol_of(path)
    write_sources(made, tmp_path, payloads_only=True)
    (tmp_path / "main.c").write_text(program(path))
    sources = ["main.c", f"{made.name}.c"]
    run([require_compiler(compiler, *flags), *FLAGS, *flags, *sources, "-o", "main"], tmp_path)
    run([*map(require_tool, runner), tmp_path / "main"], tmp_path)


def program(path: Path) -> str:
    """Program that reads the elements of each payload in both ways; its code is 0 if they agree."""
    made = protocol_of(path)
    parts = [f'#include "{made.name}.h"\n#include <string.h>\n']
    calls: list[str] = []
    for item in unit_of(made, COptions()).module.messages:
        case = Case(path, made.message(item.name))
        fields = case.message.fields
        printed = "\n".join(item.accessors)
        prefix = item.struct.removeprefix("struct ")
        readable = [field for field in fields if f" {prefix}_{field.name}_at(" in printed]
        if not readable:
            continue
        loops = "".join(loop(prefix, names_of(made), fields, field) for field in readable)
        given = {"name": item.name, "struct": item.struct, "decode": item.decode, "loops": loops}
        given["held"] = "".join(f", {number.type} {number.name}" for number in item.held)
        given["names"] = "".join(f", {number.name}" for number in item.held)
        parts.append(CHECK.format(ok=f"{made.name.upper()}_OK", **given))
        for payload, numbers in case.contents():
            # Just as many bytes as there are, for the sanitizer.
            literal = ", ".join(map(str, payload)) or "0"
            held = "".join(f", {value}" for _, value in numbers)
            check = f"check_{item.name}((const uint8_t[]){{{literal}}}, {len(payload)}{held})"
            calls.append(f"    if (!{check}) {{ return {min(len(calls) + 1, 255)}; }}")
    return "".join([*parts, MAIN.format(calls="\n".join(calls))])


def loop(prefix: str, names: Names, fields: tuple[Field, ...], field: Field) -> str:
    """The comparison of all elements of a field."""
    assert isinstance(field.type, Array)
    name, member = f"{prefix}_{field.name}_at", names.member(field.name)
    type_ = f"__typeof__(((struct {prefix} *)0)->{member}[0])"
    read = f"found = {name}(payload, i);"
    if isinstance(field.type.element, Struct):
        read = f"{name}(payload, i, &found);"
    return LOOP.format(count=count_of(fields, field, names), type=type_, read=read, field=member)


def count_of(fields: tuple[Field, ...], field: Field, names: Names) -> str:
    """The number of a field's elements, in C."""
    assert isinstance(field.type, Array)
    extent = field.type.extent
    if isinstance(extent, Fixed):
        return f"{extent.count}u"
    if isinstance(extent, Fill | Marked):
        return f"message.{count_name(fields, field)}"
    count = next(step.count for step in plan_of(fields).steps if step.field is field)
    assert count is not None
    if count.by is None:
        return f"{count.known}u"
    path = lambda operand: ".".join(map(names.member, operand.name.split(".")))  # noqa: E731
    printer = FormulaPrinter(count.by, lambda operand: f"message.{path(operand)}")
    return f"(size_t)({printer.text(count.by.expression)})"


def test_there_is_one_for_each_array_of_elements_of_one_size_at_a_known_place() -> None:
    made = protocol_of(ELEMENTS)
    printed = {
        item.name: "\n".join(item.accessors) for item in unit_of(made, COptions()).module.messages
    }
    for text in (
        "static inline float elements_floats_singles_at(const uint8_t *payload, size_t index) {",
        "static inline elements_float64 elements_floats_doubles_at(",
    ):
        assert text in printed["floats"]
    head = "static inline void elements_counted_structs_points_at("
    assert head in printed["counted_structs"]
    assert "struct elements_point *out) {" in printed["counted_structs"]
    assert "_readings_at(" in printed["filled_structs"]
    # What is in them depends on a field in front; they vary in size; there is nothing in them.
    for name in ("chosen_outside", "varying", "without_values"):
        assert printed[name] == ""


def test_what_they_share_is_in_the_header_alone(tmp_path: Path) -> None:
    write_sources(protocol_of(ELEMENTS), tmp_path)
    header = (tmp_path / "elements.h").read_text()
    source = (tmp_path / "elements.c").read_text()
    for name in ("elements_load_u32be", "elements_load_f64le", "elements_copy"):
        assert header.count(f"{name}(") > 1
        assert f"static inline {name}" not in source
        assert source.count(f" {name}(const") == 0
    assert "elements_load_u16be(" in source  # The codecs call it, too.
