"""Arrays of elements of one fixed size, read and written all at once."""

from __future__ import annotations

from protogen.runtime.fused_function import Function
from protogen.runtime.fused_parts import Item, Lists, Part, Unfit, is_fixed, order_of
from protogen.runtime.fused_reading import Reading
from protogen.runtime.fused_writing import Writing


def lists_of(element: Part) -> Lists:
    """Arrays of an element. Raises Unfit where its size is not fixed, or nothing."""
    if isinstance(element, Item) and element.lists is not None:
        return element.lists
    if not is_fixed(element):
        raise Unfit
    function = Function("read(data)")
    reading = Reading(function, order_of(element))
    value = reading.part(element)
    layout, names = reading.layout(), reading.names()
    if not layout.size:
        raise Unfit
    function.lines.append(
        f"return [{value} for {names} in {function.name(layout.iter_unpack)}(data)]"
    )
    return Lists(layout.size, function.compiled(), _writer(element).compiled())


def _writer(element: Part) -> Function:
    function = Function("write(values)")
    writing = Writing(function, order_of(element))
    writing.part(element, "value")
    function.lines = [
        "if type(values) is not list and type(values) is not tuple: raise Unclear",
        "found = []",
        "add = found.append",
        "for value in values:",
        *(f"    {line}" for line in [*function.lines, f"add({writing.bytes()})"]),
        "return b''.join(found)",
    ]
    return function
