"""Lines of CSV from columns, printed by C: the same as those of Python's `csv.writer`."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from protogen.convert.arrays import Array, Codes, Lists, Nothing, Numbers, Octets, Spans
from protogen.convert.batches import Rows
from protogen.convert.composed import ListsOf, Structs
from protogen.convert.programs import Programs, needs_quotes, operand
from protogen.convert.side_by_side import NUMBERS, code_of, laid, spread
from protogen.convert.tables import Column
from protogen.convert.values import as_list, json_of_each
from protogen.native.printer import BESIDE, Kind, Operand, Printer, Table

Show = Callable[[Column, Any], Sequence[str]]
"""The cells of a column, as texts."""
_ALONE = ("nan", "inf", "-inf")


class CsvPrinter:
    """Prints rows of tables. Raises NativeError where there is no compiler."""

    def __init__(self, show: Show) -> None:
        """`show`: what a column has in the cells of which C knows nothing."""
        self._show = show
        self._printers: dict[tuple[Any, ...], Printer] = {}
        Printer(Programs().script())

    def lines(self, rows: Rows) -> Iterator[bytes]:
        """The lines of rows."""
        programs, lent = Programs(), _Lent()
        shapes: list[Any] = [rows.table.name]
        for column, values in zip(rows.table.all_columns, rows.columns, strict=True):
            if len(shapes) > 1:
                programs.text(",")
            shapes.append(_cell(programs, lent, values, partial(self._show, column)))
        programs.text("\n")
        programs.end()
        key = tuple(shapes)
        if key not in self._printers:
            self._printers[key] = Printer(programs.script(_special()))
        # Rows have an order of their own: there is only one table.
        return self._printers[key].texts([Table(lent.columns, 0, len(rows))])


class _Lent:
    """Columns for the printer."""

    def __init__(self) -> None:
        self.columns: list[Any] = []

    def take(self, values: Array | bytes) -> int:
        """The number of a column."""
        self.columns.append(values)
        return len(self.columns) - 1

    def number(self, values: Array) -> Operand:
        """A column of numbers."""
        return operand(code_of(values), source=self.take(values))


def _cell(programs: Programs, lent: _Lent, values: Any, show: Callable[[Any], Any]) -> Any:
    """Print a column; what the steps depend on."""
    match values:
        case Nothing():
            return None
        case Numbers():
            number = partial(_number, programs, lent.number(values.values), values.values, _ALONE)
            if values.missing is None:
                number()
            else:
                programs.when(Kind.IF, lent.number(~values.missing), number)
            return values.values.dtype, values.missing is None
        case Codes():
            texts = [_quoted(text) for text in values.texts]
            programs.name(lent.number(values.codes), texts)
            return values.codes.dtype, values.texts
        case Lists():
            return _lists(programs, lent, values)
        case ListsOf() if (shape := _nested(programs, lent, values)) is not None:
            return shape
        case Octets(values=matrix, counts=counts):
            first = Operand(lent.take(matrix))
            if counts is None:
                programs.step(Kind.HEX, a=1, b=matrix.shape[1], x=first)
            else:
                programs.step(Kind.HEX, x=first, y=lent.number(counts))
            return "octets", matrix.shape[1], counts is None
        case Spans():
            sizes = lent.number(values.ends.astype("i8") - values.starts.astype("i8"))
            starts = lent.number(values.starts.astype("i8"))
            programs.step(Kind.SPAN, lent.take(values.data), x=starts, y=sizes)
            return "spans"
    _texts(programs, lent, show(values))
    return "texts"


def _texts(programs: Programs, lent: _Lent, texts: Sequence[str]) -> None:
    whole = "".join(texts)
    each: Sequence[str | bytes] = texts
    if not whole.isascii():
        each = [text.encode() for text in texts]
    sizes = np.fromiter(map(len, each), "i8", len(each))
    blob, starts = lent.take(whole.encode()), lent.number(np.cumsum(sizes) - sizes)
    programs.step(Kind.QUOTE)
    programs.step(Kind.COPY, blob, x=starts, y=lent.number(sizes))
    programs.step(Kind.UNQUOTE)


def _number(programs: Programs, place: Operand, values: Array, others: Any) -> None:
    programs.number(place, code_of(values), others)


def _lists(programs: Programs, lent: _Lent, values: Lists) -> Any:
    matrix, missing = values.values, values.missing
    first = lent.number(np.ascontiguousarray(matrix))
    count: Operand | int = matrix.shape[1]
    if values.counts is not None:
        count = lent.number(values.counts)
    beside = -1 if missing is None else lent.take(np.ascontiguousarray(missing).view("u1"))
    element = partial(_number, programs, first._replace(source=-1, offset=0), matrix, NUMBERS)

    def body() -> None:
        if missing is None:
            element()
        else:
            cases = [(1, partial(programs.text, "null"))]
            programs.choose(operand("u1", source=BESIDE), cases, element)

    programs.step(Kind.QUOTE)
    programs.text("[")
    programs.listed(first, matrix.itemsize, count, body, beside)
    programs.text("]")
    programs.step(Kind.UNQUOTE)
    return matrix.dtype, matrix.shape[1], values.counts is None, missing is None


def _nested(programs: Programs, lent: _Lent, values: ListsOf) -> Any:
    """Lists of what lies side by side for the time being; None if C knows nothing of it."""
    elements = spread(laid(values.elements), values.counts)
    if elements is None:
        return None
    matrix = elements.values
    programs.step(Kind.QUOTE)
    programs.text("[")
    first, count = Operand(lent.take(matrix)), lent.number(np.ascontiguousarray(values.counts))
    programs.listed(first, matrix.itemsize, count, lambda: elements.step(programs, 0))
    programs.text("]")
    programs.step(Kind.UNQUOTE)
    return "nested", matrix.dtype


def _quoted(text: str) -> str:
    """The text as a cell of a line."""
    file = io.StringIO(newline="")
    csv.writer(file, lineterminator="\n").writerow([text, ""])
    return file.getvalue().removesuffix(",\n")


def _special() -> bytes:
    return needs_quotes(_quoted, map(chr, range(128)))


# --- texts of what is nested ----------------------------------------------------------------------


def json_texts(values: Any, default: Callable[[Any], str]) -> list[str]:
    """What `json.dumps` makes of each value, with less work for structs of numbers in lists."""
    match values:
        case ListsOf(elements=elements, counts=counts):
            texts, ends = json_texts(elements, default), np.cumsum(counts).tolist()
            pairs = pairwise([0, *ends])
            return ["[" + ", ".join(texts[start:end]) + "]" for start, end in pairs]
        case Structs(members=members) if members:
            names = (json.dumps(name).replace("%", "%%") for name in members)
            form = "{" + ", ".join(f"{name}: %s" for name in names) + "}"
            columns = (json_texts(member, default) for member in members.values())
            return [form % row for row in zip(*columns, strict=True)]
        case Numbers(values=numbers, missing=None) if numbers.dtype.kind in "iu":
            return list(map(str, numbers.tolist()))
    return json_of_each(as_list(values), default)
