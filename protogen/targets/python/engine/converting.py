"""Values as `struct` reads them, made the values of attributes."""

from __future__ import annotations

from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    FloatStep,
    IntegerStep,
    RecordStep,
    RepeatStep,
)
from protogen.model.payload_walks import without_constant
from protogen.model.types import Float, Octets
from protogen.targets.python.engine.layout import code_of, is_native, is_pair
from protogen.targets.python.engine.lines import Lines
from protogen.targets.python.engine.packing import unpacked


class Converter:
    """Writes the expressions that convert values."""

    def __init__(self, lines: Lines, *, is_ascii: bool) -> None:
        """With `is_ascii`, the caller has seen that no byte has its most significant bit set."""
        self.lines = lines
        self.is_ascii = is_ascii

    def converted(self, variable: str, step: AnyStep) -> str:
        """The attribute's value for what `struct` has read."""
        match without_constant(step):
            case IntegerStep() as number:
                return self.named(self._integer(variable, number), number)
            case FloatStep(type=Float(byte_bits=7) as type_):
                call = f'_fast.seven_bit_float({type_.bits}, "{type_.byte_order}").decode'
                return f"{self.lines.constants.named('FLOAT', call)}({variable})"
            case BytesStep() as string:
                return self.string(variable, string)
            case RecordStep() | RepeatStep() as run:  # Which is packed.
                return unpacked(self.lines, variable, run, self.named)
        return variable

    def _integer(self, variable: str, step: IntegerStep) -> str:
        type_ = step.type
        if type_.role == "bool":
            self.lines.refuse_if(f"{variable} > 1")
            return f"{variable} == 1"
        if is_native(step):
            return variable
        if is_pair(step):
            if self.is_ascii and type_.bits == 14:
                table = f"_TABLES.pairs({type_.bits}, {type_.signed})"
                return f"{self.lines.constants.named('PAIRS', table)}[{variable}]"
            return f"{self._pairs(step)}[{variable}]"
        code = code_of(step)
        assert code is not None
        if code.endswith("s"):
            return f"{self.lines.constants.number(type_)}.decode({variable})"
        if not (self.is_ascii and type_.bits == 7):
            self.lines.refuse_if(f"{variable} >> {type_.bits}")
        if not type_.signed:
            return variable
        sign = f"0x{1 << (type_.bits - 1):X}"
        return f"({variable} ^ {sign}) - {sign}"

    def _pairs(self, step: IntegerStep) -> str:
        type_ = step.type
        arguments = f'{type_.bits}, {type_.signed}, "{type_.byte_order}"'
        return self.lines.constants.named("PAIRS", f"_fast.Pairs({arguments})")

    def named(self, value: str, step: IntegerStep) -> str:
        """The member of an enum or a set of flags for a number."""
        type_ = step.type
        named = type_.enum or type_.flags
        if named is None:
            return value
        if not type_.is_closed and not type_.signed and type_.bits <= 8:
            table = f"_TABLES.members({self.lines.classes[named.name]}, {type_.bits})"
            return f"{self.lines.constants.named('MEMBERS', table)}[{value}]"
        kind = "closed" if type_.is_closed else "Members"
        members = f"_fast.{kind}({self.lines.classes[named.name]})"
        return f"{self.lines.constants.named('MEMBERS', members)}[{value}]"

    def string(self, value: str, step: BytesStep) -> str:
        """The text of some bytes, or the bytes themselves."""
        if step.type.byte_bits == 7 and not self.is_ascii:
            self.lines.refuse_if(f"not {value}.isascii()")
        if isinstance(step.type, Octets):
            return value
        if not step.type.form.is_plain:
            return f"{self.lines.constants.padded(step.type)}.decode({value})"
        padding = '.rstrip(b"\\0")' if step.count.is_fixed else ""
        return f'{value}{padding}.decode("latin-1")'

    def is_seen(self, step: AnyStep) -> bool:
        """True if a byte is the value itself, now that its top bit was seen to be clear."""
        if not isinstance(step, IntegerStep):
            return False
        type_ = step.type
        is_byte = (self.is_ascii, type_.bits, type_.size, type_.signed) == (True, 7, 1, False)
        return is_byte and type_.role != "bool" and not type_.is_named
