"""Walks over the steps of a payload plan, to print statements for each."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from protogen.c_language.expressions import FormulaPrinter, type_for
from protogen.c_language.numbers import constant, integer_type, unsigned, unsigned_type
from protogen.model.expressions import ArithmeticOperator, Expression, Number, Operand
from protogen.model.names import free_name
from protogen.model.packing import FilledPacking, Packing
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ChooseStep,
    ConstantStep,
    Count,
    Formula,
    NumberStep,
    OptionalStep,
    PartStep,
    PayloadPlan,
    RecordStep,
    Reference,
    RegionStep,
    RepeatStep,
    RestStep,
)
from protogen.model.payload_walks import PackedNumber
from protogen.model.types import Integer
from protogen.targets.c.lines import Lines
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.packing import Placed, groups_of, members_of

_INDICES = "ijklmnopqrstuvw"
"""Names of indices; those of loops that are nested deeper have a number."""


def amount(count: int | str) -> str:
    """A number of elements or bytes as an argument."""
    return unsigned(count) if isinstance(count, int) else count


def type_of(formula: Formula) -> Integer:
    """The type of what `number_of` gives."""
    if formula.plain is None:
        return type_for(formula.hull)
    assert formula.plain.type is not None
    return formula.plain.type


def times(count: int | str, size: int) -> int | str:
    """The bytes of so many elements."""
    if size == 0:
        return 0
    if isinstance(count, int):
        return count * size
    return f"(size_t){unsigned(size)} * {count}" if size > 1 else count


def out_of_bounds(number: str, least: int, greatest: int, most: int) -> str:
    """The condition that a number of at most `most` is out of bounds; empty where none is."""
    tests = [f"{number} < {unsigned(least)}"] if least > 0 else []
    tests += [f"{number} > {unsigned(greatest)}"] if greatest < most else []
    return " || ".join(tests)


def _behind(start: str, item: PackedNumber) -> str:
    """The index of an element behind the first one of its group."""
    return f"{start} + {item.index}" if item.index else start


def is_unfit(number: str, count: Count, by: Formula) -> str:
    """The condition that a number that is worked out is out of bounds; empty where none is."""
    (least, most), type_ = by.bounds, type_of(by)
    tests = [f"{number} < {constant(count.least, type_)}"] if count.least > least else []
    tests += [f"{number} > {constant(count.greatest, type_)}"] if count.greatest < most else []
    return " || ".join(tests)


_TYPES = {f"{sign}int{bits}_t" for sign in ("", "u") for bits in (8, 16, 32, 64)}
RESERVED = frozenset(
    {"payload", "size", "need", "at", "end", "bool", "size_t", "i", "j", "k", "l", "m", "n"}
    | _TYPES
)
"""Names that a local variable may not have."""
_PARAMETERS = frozenset({"message", "capacity", "writer", "put", "user", "needed", *_INDICES})
"""Names that it may have only where these are no parameters."""


def parameter_for(member: str) -> str:
    """The parameter for a number of the frame that a message has as this member."""
    return f"{member}_part" if member in RESERVED | _PARAMETERS else member


class _Formula(FormulaPrinter):
    """Prints a formula with functions for what C has no operators for."""

    def __init__(self, helpers: Helpers, formula: Formula, whole: Callable[[Operand], str]) -> None:
        super().__init__(formula, whole)
        self._helpers = helpers

    def floored(self, operator: ArithmeticOperator, left: Expression, right: Number) -> str:
        """A call of the function that rounds down."""
        function = self._helpers.floored(operator, self.type)
        return f"{function}({self.text(left)}, {self.numeral(right)})"


class Walk:
    """Order of the steps. A subclass says what is printed for each kind of step.

    `place` is the member that a step belongs to, as `message->points[i]`.
    """

    def __init__(self, helpers: Helpers, lines: Lines) -> None:
        self.helpers = helpers
        self.lines = lines
        self._loops = 0
        self._records: list[str] = []  # What the members of each record around begin with.
        self._locals = set(RESERVED | _PARAMETERS)

    def follow(self, other: Walk) -> None:
        """Be where another walk has come to."""
        self._loops, self._records = other._loops, [*other._records]
        self._locals = other._locals

    def message(self, plan: PayloadPlan) -> None:
        """Walk over all steps of a message."""
        self.record(plan.steps, "message->")

    def record(self, steps: Sequence[AnyStep], base: str) -> None:
        """Walk over the steps of a record whose members begin with `base`."""
        self._records.append(base)
        for step in steps:
            self.step(step, base + self.helpers.member(step.name))
        self._records.pop()

    def step(self, step: AnyStep, place: str) -> None:
        """Walk over a step of any kind."""
        match step:
            case RepeatStep() if isinstance(step.packing, FilledPacking):
                self.packed_fill(step, place, str(self.count(step.count)))
            case RecordStep() | RepeatStep() if step.packing is not None:
                self.packed(step, place)
            case NumberStep():
                self._one_number(step, place)
            case ConstantStep():
                self.constant(step)
            case BytesStep() | RepeatStep():
                self._several(step, place)
            case RecordStep():
                self.record(step.steps, f"{place}.")
            case ChooseStep():
                self.choose(step, place)
            case OptionalStep():
                self.optional(step, place)
            case RegionStep():
                self.region(step, place)

    def _one_number(self, step: NumberStep, place: str) -> None:
        """Walk over a number of the payload, or of the frame."""
        if isinstance(step, PartStep):
            self.part(step, place)
        else:
            self.number(step, place)

    def _several(self, step: BytesStep | RepeatStep, place: str) -> None:
        """Walk over bytes or elements, where there are any."""
        count = self.count(step.count)
        if count == 0:
            return
        if isinstance(step, BytesStep):
            self.bytes(step, place, count)
        elif step.element.sizes.greatest or step.element.holds_values:
            self.repeat(step, place, count)

    # --- packed numbers ---------------------------------------------------------------------------

    def packed(self, step: RecordStep | RepeatStep, place: str) -> None:
        """Walk over packed numbers, each for itself; what goes by their bytes goes over `runs`."""
        if isinstance(step, RecordStep):
            self.record(step.steps, f"{place}.")
        else:
            self.repeat(step, place, step.count.known or 0)

    def packed_fill(self, step: RepeatStep, place: str, count: str) -> None:
        """Walk over as many packed numbers as there are, each for itself."""
        self.repeat(step, place, count)

    def runs(self, step: RecordStep | RepeatStep, place: str) -> None:
        """Walk over packed numbers, as many at once as take whole bytes."""
        if isinstance(step, RecordStep):
            assert isinstance(step.packing, Packing)
            self.run(step.packing, members_of(self.helpers, step.steps, f"{place}."))
            return
        behind = 0
        for group in groups_of(step):
            if group.times == 1:
                members = [(it, f"{place}[{behind + (it.index or 0)}]") for it in group.numbers]
                self.run(group.packing, members)
            else:
                count = len(group.numbers)
                with self.group(group.times, group.packing.size) as index:
                    start = f"{count} * {index}" if count > 1 else index
                    members = [(it, f"{place}[{_behind(start, it)}]") for it in group.numbers]
                    self.run(group.packing, members)
                behind += count * group.times

    def run(self, packing: Packing, placed: Sequence[Placed]) -> None:
        """Print numbers that are packed, with their members."""
        raise NotImplementedError

    @contextmanager
    def group(self, count: int, size: int) -> Iterator[str]:
        """A loop over so many groups of `size` bytes; yields the index."""
        with self.loop(count) as index:
            yield index

    # --- numbers that count and select ----------------------------------------------------------

    def count(self, count: Count) -> int | str:
        """Number of elements or bytes."""
        if count.known is not None:
            return count.known
        if count.by is None:
            return self.filled(count)
        if count.by.plain is None:
            return self.worked_out(count, count.by)
        number = self.referred(count.by.plain)
        assert count.by.plain.type is not None
        return f"(size_t){number}" if count.by.plain.type.bits > 16 else number

    def worked_out(self, count: Count, by: Formula) -> str:
        """A variable with the number of elements or bytes that a formula says."""
        return self.amount_of(by, self.number_of(by))

    def amount_of(self, by: Formula, number: str) -> str:
        """A variable with a number that is not below 0."""
        name, type_ = self.variable("amount"), type_of(by)
        kind = unsigned_type(type_.bits)
        self.lines.add(f"const {kind} {name} = ({kind})({number});")
        return f"(size_t){name}" if type_.bits > 16 else name

    def declared(self, by: Formula) -> str:
        """A variable with the value of a formula, which may be below 0."""
        name, kind = self.variable("amount"), integer_type(type_of(by))
        self.lines.add(f"const {kind} {name} = ({kind})({self.number_of(by)});")
        return name

    def variable(self, name: str) -> str:
        """The name of a new variable."""
        found = free_name(name, self._locals)
        self._locals.add(found)
        return found

    def filled(self, count: Count) -> str:
        """The member for the number of what fills the payload."""
        return self._records[-1] + count.member

    def number_of(self, formula: Formula) -> str:
        """The expression of a number that earlier ones say."""
        if formula.plain is not None:
            return self.referred(formula.plain)
        return self.printer(formula).text(formula.expression)

    def printer(self, formula: Formula) -> FormulaPrinter:
        """Prints a formula over the members of records."""
        whole = lambda operand: self.referred(formula.references[operand.name])  # noqa: E731
        return _Formula(self.helpers, formula, whole)

    def is_last(self, mark: Formula, element: str) -> str:
        """The condition that an element says that it is the last."""
        self._records.append(f"{element}.")
        condition = self.printer(mark).condition(mark.expression)
        self._records.pop()
        return condition

    def differs(self, formula: Formula, value: int) -> str:
        """The condition that a number that earlier ones say is another one."""
        number = self.number_of(formula)
        if formula.plain is None:
            number = self.printer(formula).compared(formula.expression)
        return f"{number} != {constant(value, type_of(formula))}"

    def referred(self, number: Reference) -> str:
        """The expression of an earlier number."""
        members = map(self.helpers.member, number.name.split("."))
        return self._records[number.level] + ".".join(members)

    # --- what subclasses say ----------------------------------------------------------------------

    def constant(self, step: ConstantStep) -> None:
        """Print a constant."""
        raise NotImplementedError

    def number(self, step: NumberStep, place: str) -> None:
        """Print a number."""
        raise NotImplementedError

    def part(self, step: PartStep, place: str) -> None:
        """Print a number of the frame, of which the payload has no bytes."""

    def bytes(self, step: BytesStep | RestStep, place: str, count: int | str) -> None:
        """Print a text, or bytes; those of a rest are at `place` as well."""
        raise NotImplementedError

    def repeat(self, step: RepeatStep, place: str, count: int | str) -> None:
        """Print elements; there are some, and they have bytes."""
        raise NotImplementedError

    def rest(self, step: RestStep, place: str) -> None:
        """Print the bytes of a value without a case; `place` has a `size` and `bytes`."""
        self.bytes(step, f"{place}.bytes", f"{place}.{step.count.member}")

    def elements(self, step: RepeatStep, place: str, count: int | str) -> None:
        """Print elements one by one."""
        with self.loop(count) as index:
            self.step(step.element, f"{place}[{index}]")

    def no_case(self) -> None:
        """Print what follows from a value without a case that is invalid."""

    def end_branch(self, step: ChooseStep | OptionalStep) -> None:
        """Print the end of one of several ways."""

    # --- loops and cases ------------------------------------------------------------------------

    @contextmanager
    def loop(self, count: int | str) -> Iterator[str]:
        """A loop over so many elements; yields the index."""
        turn, letter = divmod(self._loops, len(_INDICES))
        index = _INDICES[letter] + (str(turn + 1) if turn else "")
        self._loops += 1
        with self.lines.block(f"for (size_t {index} = 0; {index} < {amount(count)}; {index}++)"):
            yield index
        self._loops -= 1

    def choose(self, step: ChooseStep, place: str) -> None:
        """One of several cases."""
        if isinstance(step.selector, int):
            self._chosen(step.case(step.selector), place)
            return
        selector = type_of(step.selector)
        number = self.number_of(step.selector)
        with self.lines.switch(f"(uint8_t){number}" if selector.role == "bool" else number):
            for case in step.cases:
                label = "default"
                if case.value is not None:
                    label = f"case {constant(case.value, selector)}"
                with self.lines.case(label), self.branch():
                    self._chosen(case.step, place)
                    self.end_branch(step)
            if step.otherwise is None:
                with self.lines.case("default"), self.branch():
                    self._chosen(step.rest, place)

    def optional(self, step: OptionalStep, place: str) -> None:
        """A step that is there only where a condition holds."""
        formula = step.presence.holds
        if not isinstance(formula, Formula):
            if formula:
                self.step(step.step, place)
            return
        condition = self.printer(formula).condition(formula.expression)
        with self.lines.block(f"if ({condition})"), self.branch():
            self.step(step.step, place)
            self.end_branch(step)

    def region(self, step: RegionStep, place: str) -> None:
        """A step that takes just so many bytes."""
        self.step(step.step, place)

    @contextmanager
    def branch(self) -> Iterator[None]:
        """Surroundings of what is printed for one of several ways."""
        yield

    def _chosen(self, step: AnyStep | RestStep | None, place: str) -> None:
        if step is None:
            self.no_case()
        elif isinstance(step, RestStep):
            self.rest(step, f"{place}.{step.name}")
        else:
            self.step(step, f"{place}.{self.helpers.member(step.name)}")
