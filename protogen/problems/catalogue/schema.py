"""Problems of what a schema says: keys, names, types, sizes, identities, framing."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.cutting import CUTTING_CODES
from protogen.problems.catalogue.exchanges import EXCHANGE_CODES
from protogen.problems.catalogue.expressions import EXPRESSION_CODES
from protogen.problems.catalogue.fields import FIELD_CODES
from protogen.problems.catalogue.forms import FORM_CODES
from protogen.problems.catalogue.frame_sizes import FRAME_SIZE_CODES
from protogen.problems.catalogue.frames import FRAME_CODES
from protogen.problems.catalogue.framing import FRAMING_CODES
from protogen.problems.catalogue.keys_and_names import KEY_AND_NAME_CODES
from protogen.problems.catalogue.last_elements import LAST_ELEMENT_CODES
from protogen.problems.catalogue.lengths import LENGTH_CODES
from protogen.problems.catalogue.messages import MESSAGE_CODES
from protogen.problems.catalogue.mirrors import MIRROR_CODES
from protogen.problems.catalogue.optional_fields import OPTIONAL_FIELD_CODES
from protogen.problems.catalogue.packing import PACKING_CODES
from protogen.problems.catalogue.part_bits import PART_BITS_CODES
from protogen.problems.catalogue.part_fields import PART_FIELD_CODES
from protogen.problems.catalogue.parts import PART_CODES
from protogen.problems.catalogue.rates import RATE_CODES
from protogen.problems.catalogue.silences import SILENCE_CODES
from protogen.problems.catalogue.sized_arrays import SIZED_ARRAY_CODES
from protogen.problems.catalogue.switch_cases import SWITCH_CASE_CODES
from protogen.problems.catalogue.tails import TAIL_CODES
from protogen.problems.catalogue.terminators import TERMINATOR_CODES
from protogen.problems.catalogue.text_forms import TEXT_FORM_CODES
from protogen.problems.catalogue.text_numbers import TEXT_NUMBER_CODES
from protogen.problems.catalogue.told_parts import TOLD_PART_CODES
from protogen.problems.catalogue.trimming import TRIMMING_CODES
from protogen.problems.catalogue.virtual_parts import VIRTUAL_PART_CODES
from protogen.problems.catalogue.wire_counts import WIRE_COUNT_CODES

SCHEMA_CODES: tuple[Code, ...] = (
    *KEY_AND_NAME_CODES,
    *FIELD_CODES,
    *PACKING_CODES,
    *TEXT_NUMBER_CODES,
    *TERMINATOR_CODES,
    *TEXT_FORM_CODES,
    *LAST_ELEMENT_CODES,
    *VIRTUAL_PART_CODES,
    *TOLD_PART_CODES,
    *SILENCE_CODES,
    *SIZED_ARRAY_CODES,
    *SWITCH_CASE_CODES,
    *EXPRESSION_CODES,
    *OPTIONAL_FIELD_CODES,
    *TAIL_CODES,
    *FRAME_CODES,
    *FRAMING_CODES,
    *FORM_CODES,
    *FRAME_SIZE_CODES,
    *TRIMMING_CODES,
    *CUTTING_CODES,
    *MESSAGE_CODES,
    *RATE_CODES,
    *EXCHANGE_CODES,
    *PART_CODES,
    *PART_BITS_CODES,
    *PART_FIELD_CODES,
    *MIRROR_CODES,
    *WIRE_COUNT_CODES,
    *LENGTH_CODES,
)
