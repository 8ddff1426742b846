"""Names of a protocol's C: those that templates use themselves, and those of writers.

A writer takes payloads byte by byte, where a frame is sent without a buffer.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from protogen.model.frame_plan import FramePlan
from protogen.model.messages import Message
from protogen.model.parts import members_of
from protogen.model.protocol import Protocol, Sender
from protogen.model.types import Struct, Switch
from protogen.targets.c.frame.checksums import checksum_name
from protogen.targets.c.frame.texts import claim_texts
from protogen.targets.c.frame.virtual import function_of
from protogen.targets.c.named import claim_fields, enum_view, flags_view
from protogen.targets.c.payload.message_names import claim_all
from protogen.targets.c.spelling import Names
from protogen.targets.kept import Kept
from protogen.targets.naming import OWN, NameTable, Thing, endpoint, inside, named_type, part

_MACROS = """
ok error_size error_value error_encoding error_range error_space spec_hash version h implementation
implemented message unknown invalid no_message no_reason size value encoding noise checksum length
stuffing truncated seeking taking failed lost found known open searching measuring empty needless
before inside after frame stuffed fast_feed sse2 expect each has no_handlers no_weak api inline
apart shared baud idle_timeout_ms protogen_version protogen_version_number zeros names fine
small_crc flash flash_8 flash_16 flash_32 flash_64 counters count sum_failed wrong_sum other_frame
packed as_in_memory hpp always_inline nodiscard
"""
_TAGS = "result message event_kind reason writer transmission counters"
_TYPES = "put offer float64"
_FUNCTIONS = """
copy_whole write first is_high mask sum_of xor_of clear lose tally took message_name result_name
reason_name transmit transmitted
"""
_TAGS_OF_A_SENDER = "parts event decoder"
_TYPES_OF_A_SENDER = "handler"
_FUNCTIONS_OF_A_SENDER = """
accept add_noise added begins close close_at_flush close_open compare complete content count
counted cross decide decoder_counters decoder_dispatch decoder_event decoder_feed decoder_flush
decoder_idle decoder_init decoder_next decoder_push dispatch drop end_noise ends_early
enter_payload find_size finish_region fitted follow_end follow_start frame_byte give_up hand_over
has_special head_fits identify invalid is_idle is_plain judge leave let_go look looks_idle measure
measure_head open pass payload payload_size reach read_length release reopen reset resume room run
search seek seek_on send_head send_tail set_payload settle show specials stuff surplus tail_fits
take take_byte take_head take_tail take_whole unstuff unstuff_one unstuff_to wire_end wrap write
wrong
"""
_MACROS_OF_A_SENDER = "frame_max idle_us decoder_init counted wrong"
_FUNCTIONS_OF_A_CANDIDATE = "begun begun_byte end fill_up mark read show step"
_TAGS_OF_FORMS = "decoder event form"
_FUNCTIONS_OF_FORMS = """
add_noise choose count counted decoder_counters decoder_dispatch decoder_event decoder_feed
decoder_flush decoder_idle decoder_init decoder_next decoder_push dispatch drop end_noise fail
follow_end give invalid judge leave mark open reset resume run seek seek_on take
"""
_MACROS_OF_FORMS = "frame_max decoder_init counted no_form no_start may_start is_start"


def names_of(protocol: Protocol) -> Names:
    """The names of a protocol, whatever is chosen to be printed of it; others may be added."""
    return _kept_names(protocol).copy()


def _all_names(protocol: Protocol) -> Names:
    names = Names(protocol.name)
    names.claim_file(protocol.name)
    _claim_own(names)
    if any(sender.plan.is_trimmed for sender in protocol.senders):
        names.claim_tag(OWN, "kept")
        names.claim(OWN, "keep")
    _claim_checksums(names, protocol.senders)
    claim_texts(names, protocol)
    for sender in protocol.senders:
        _claim_sender(names, sender)
    for name in dict.fromkeys(item.endpoint for item in protocol.senders if not item.is_only_form):
        _claim_forms(names, name, protocol.forms(name))
    for enum in protocol.enums:
        enum_view(enum, names)
    for flags in protocol.flags:
        flags_view(flags, names)
    for struct in protocol.structs:
        if struct.holds_values:
            names.claim_tag(named_type(struct.name), struct.name)
            claim_fields(names, struct.name, struct.fields)
    for message in protocol.messages:
        claim_all(names, message, protocol.senders_of(message))
    for name, thing in _members(protocol):
        names.claim_member(thing, name)
    return names


_kept_names = Kept(_all_names, most=64)
"""Names that are asked for twice: once to check them, and once to print them."""


def _members(protocol: Protocol) -> Iterator[tuple[str, Thing]]:
    """Members of structs and unions, and parameters. Local variables are called after them."""
    records: tuple[Struct | Message, ...] = (*protocol.structs, *protocol.messages)
    for record in records:
        for field in record.fields:
            yield field.name, inside(record.name, "field", field.name)
            if isinstance(field.element, Switch):
                for case in field.element.cases:
                    what = inside(record.name, "case", field.name, "cases", case.name)
                    yield case.name, what
    for sender in protocol.senders:
        if not sender.is_only_form:
            yield sender.form, endpoint(sender.endpoint)
        for item in sender.frame.declared:
            yield item.name, part(sender.name, item.name)
            for own in members_of(item):
                yield own.name, part(sender.name, item.name)


def _claim_own(names: Names) -> None:
    for word in _MACROS.split():
        names.claim_macro(OWN, word)
    for word in _TAGS.split():
        names.claim_tag(OWN, word)
    for word in _TYPES.split():
        names.claim_type(OWN, word)
    for word in _FUNCTIONS.split():
        names.claim(OWN, word)


def _claim_checksums(names: Names, senders: Iterable[Sender]) -> None:
    for item in (item for sender in senders for item in sender.frame.checksums):
        function = checksum_name(names.prefix, item.algorithm)
        for word in ("reversed", "table", "after", "step", "run", "final"):
            names.others.add(f"{function}_{word}")


def _claim_sender(names: Names, sender: Sender) -> None:
    """All names that begin with that of an endpoint, which is escaped where one of them is taken.

    `close` and `close_open` would both have a function `close_open_payload`.
    """
    thing, start = endpoint(sender.endpoint), f"{names.prefix}_{sender.name}"
    while any(name in table.things for table, name in _of_sender(names, sender, start)):
        start += "_"
    if not start.endswith(sender.name):
        names.others.note(thing, f"{start}_decoder")
    names.senders[sender.name] = start
    for table, name in _of_sender(names, sender, start):
        table.add(name, thing)


def _of_sender(names: Names, sender: Sender, start: str) -> Iterator[tuple[NameTable, str]]:
    """The names of an endpoint that begin so."""
    types, functions = _TYPES_OF_A_SENDER.split(), _FUNCTIONS_OF_A_SENDER.split()
    for word in (*_TAGS_OF_A_SENDER.split(), *types):
        yield names.tags, f"{start}_{word}"
    for word in (*types, *functions, *(f"{item.name}_run" for item in sender.frame.checksums)):
        yield names.others, f"{start}_{word}"
    for word in _MACROS_OF_A_SENDER.split():
        yield names.others, f"{start}_{word}".upper()
    for item in sender.frame.virtual if sender.plan.identity else ():
        yield names.others, function_of(start, item)
    if any(group.identities is not None for group in sender.plan.groups):
        yield names.others, f"{start}_told"
    for word in _sometimes(sender.plan):
        yield names.others, f"{start}_{word}"
    if not sender.is_only_form:
        yield from _of_candidate(names, start)


def _sometimes(plan: FramePlan) -> Iterator[str]:
    """Functions that only some frames have."""
    if plan.is_trimmed:
        yield from ("fill_up", "trim")
    if plan.mark_size and len(plan.start_words) > 1:
        yield from ("begun", "begun_byte")


def _of_candidate(names: Names, start: str) -> Iterator[tuple[NameTable, str]]:
    """The names of what is tried among the other forms of an endpoint's frames."""
    yield names.tags, f"{start}_candidate"
    for word in (*_FUNCTIONS_OF_A_SENDER.split(), *_FUNCTIONS_OF_A_CANDIDATE.split()):
        yield names.others, f"{start}_candidate_{word}"


def _claim_forms(names: Names, name: str, forms: Iterable[Sender]) -> None:
    """All names of the decoder for several forms, which begin with that of their endpoint."""
    thing, start = endpoint(name), f"{names.prefix}_{name}"
    while any(name in table.things for table, name in _of_forms(names, forms, start)):
        start += "_"
    if not start.endswith(name):
        names.others.note(thing, f"{start}_decoder")
    names.senders[name] = start
    for table, taken in _of_forms(names, forms, start):
        table.add(taken, thing)


def _of_forms(names: Names, forms: Iterable[Sender], start: str) -> Iterator[tuple[NameTable, str]]:
    types = _TYPES_OF_A_SENDER.split()
    for word in (*_TAGS_OF_FORMS.split(), *types):
        yield names.tags, f"{start}_{word}"
    for word in (*types, *_FUNCTIONS_OF_FORMS.split()):
        yield names.others, f"{start}_{word}"
    for word in (*_MACROS_OF_FORMS.split(), *(f"form_{form.form}" for form in forms)):
        yield names.others, f"{start}_{word}".upper()


def is_stateless(protocol: Protocol) -> bool:
    """True if what is sent goes out as it is: not summed, stuffed, or trimmed on the way."""
    frames = (sender.frame for sender in protocol.senders)
    return not any(f.checksums or f.transparency or f.payload.is_trimmed for f in frames)


def writer_parameter(protocol: Protocol) -> str:
    """Parameters for a writer.

    One without a state is the function and what it is given: compilers see through two parameters
    where they would not look into a struct, and can put the function in where it is called.
    """
    if is_stateless(protocol):
        return f"{protocol.name}_put put, void *user"
    return f"struct {protocol.name}_writer *writer"


def choose_writer(names: Names, chosen: Protocol) -> None:
    """Have the writer that the chosen senders need: others of the protocol may need more."""
    names.writer = writer_parameter(chosen)
    names.is_stateless = is_stateless(chosen)
    names.writing = "put, user" if names.is_stateless else "writer"
