"""Problems of arrays that end with the element that says that it is the last."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_fields

LAST_ELEMENT_CODES: tuple[Code, ...] = (
    Code(
        "PG265",
        "no-last-element-here",
        "A last element of what is no array of structs",
        """\
`until: {element: NAME}` makes an array of a struct: it ends with the first element in which that
field is not 0. Only structs have fields that can say so. Nothing else says how many elements there
are, neither a `count` nor a `size`, and beside separators numbers are text. A text or bytes end in
front of a byte: `until: 0`.
""",
        with_fields("hops: {count: 3, until: {element: last}, fields: {last: bool, to: uint8}}"),
        with_fields(
            "hops: {until: {element: last, max: 8}, fields: {last: bool, to: uint8}}",
        ),
    ),
    Code(
        "PG266",
        "no-mark",
        "A name of nothing that can say which element is the last",
        """\
`element` names what is 0 in all elements but the last: a bool, a flag or a run of bits, or an
unsigned number. It is a field of the element itself, or of a struct in it (`head.last`), and always
there: one with a `when` may be missing in the very element that is the last.
""",
        with_fields("hops: {until: {element: end, max: 8}, fields: {last: bool, to: uint8}}"),
        with_fields("hops: {until: {element: last, max: 8}, fields: {last: bool, to: uint8}}"),
    ),
    Code(
        "PG267",
        "mark-that-never-changes",
        "A field that says the same in every element",
        """\
Where a field is never 0, each first element would be the last, and where it is always 0, none
would: so its range, its constant or the values of a closed enum let it have 0 and others.
""",
        with_fields(
            "hops: {until: {element: kind, max: 8}, fields: {kind: {type: uint8, const: 0}}}"
        ),
        with_fields(
            "hops: {until: {element: kind, max: 8}, fields: {kind: {type: uint8, range: [0, 1]}}}"
        ),
    ),
    Code(
        "PG268",
        "unbounded-elements",
        "Elements of which there may be any number, or always the same",
        """\
A receiver needs memory for as many elements as there may be. So the frame bounds them, by a length
part or by `max_frame`, or the array does: `until: {element: last, max: 8}`. Where `min` and `max`
leave only one number, that is the `count`, and no element has to say anything.
""",
        with_fields("hops: {until: {element: last}, fields: {last: bool, to: uint8}}"),
        with_fields("hops: {until: {element: last, max: 8}, fields: {last: bool, to: uint8}}"),
    ),
)
