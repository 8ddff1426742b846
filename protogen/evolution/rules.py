"""Rules: what each kind of change means. Names are stable: configurations and reviews use them."""

from __future__ import annotations

from enum import StrEnum

import msgspec


class Category(StrEnum):
    """Harm that a change can do, the worst first."""

    WIRE = "WIRE"
    """Bytes are cut or read another way: frames are lost or misread."""
    VALUE = "VALUE"
    """Bytes are read the same way and mean something else."""
    SOURCE = "SOURCE"
    """Code or settings have to follow; the bytes are the same."""
    NONE = "NONE"
    """Nobody has to do anything."""


class Rule(msgspec.Struct, frozen=True):
    """A kind of change."""

    name: str
    category: Category
    about: str
    """Short description of the change."""
    fix: str
    """Advice: what to do instead, or besides."""
    by_frame: bool = True
    """False if no frame can show the change: it is about the line, or about earlier versions."""


_W, _V, _S, _N = Category.WIRE, Category.VALUE, Category.SOURCE, Category.NONE
_BOTH = "change both ends together, or give the new layout an identity of its own"
_NEW_ID = "add a message with an identity of its own and reserve this one"
_TOGETHER = "change both ends together"
_USERS = "check the code that uses it"
_RENAME = "keep the name, or change the code on both ends"

RULES: tuple[Rule, ...] = (
    # frames
    Rule("frame-literal", _W, "bytes or bits that each frame has are others", _TOGETHER),
    Rule("frame-mirror", _W, "bits of the frame follow from another number", _TOGETHER),
    Rule("frame-part-added", _W, "the frame has one part more", _TOGETHER),
    Rule("frame-part-deleted", _W, "the frame has one part less", _TOGETHER),
    Rule("frame-part-moved", _W, "a part of the frame stands elsewhere", _TOGETHER),
    Rule("frame-part-kind", _W, "a part of the frame has another job", _TOGETHER),
    Rule("frame-part-role", _S, "senders choose a part's value another way", "check the senders"),
    Rule("frame-part-type", _W, "a number of the frame is encoded another way", _TOGETHER),
    Rule("frame-part-text", _S, "a part of the frame is shown another way", _USERS),
    Rule("frame-part-renamed", _S, "a part of the frame has another name", _RENAME),
    Rule(
        "frame-part-range", _S, "senders may use other values of a part", "check what receivers do"
    ),
    Rule(
        "frame-value-range",
        _W,
        "receivers take other values of a part",
        "rebuild the receivers first",
    ),
    Rule("frame-part-default", _S, "a part has another default", "check the senders"),
    Rule(
        "frame-virtual-default",
        _W,
        "frames of unknown messages are verified with another value",
        _TOGETHER,
        by_frame=False,
    ),
    Rule(
        "frame-told",
        _W,
        "receivers learn in another way what frames do not say",
        _TOGETHER,
        by_frame=False,
    ),
    Rule("frame-length-rule", _W, "the length counts other parts", _TOGETHER),
    Rule("frame-length-range", _W, "receivers take other lengths", "rebuild the receivers first"),
    Rule("frame-checksum-algorithm", _W, "the checksum is worked out another way", _TOGETHER),
    Rule("frame-checksum-coverage", _W, "the checksum covers other bytes", _TOGETHER),
    Rule("frame-transparency", _W, "bytes are stuffed another way", _TOGETHER),
    Rule(
        "frame-silence",
        _W,
        "another silence, or none, ends a frame",
        _TOGETHER,
        by_frame=False,
    ),
    Rule(
        "frame-trailing-zeros",
        _W,
        "zeros at the end of payloads are left out, or no more",
        "rebuild the receivers first",
    ),
    Rule(
        "frame-longer-payloads",
        _S,
        "receivers take payloads longer than their message, or no more",
        "rebuild the receivers before senders have more fields",
    ),
    Rule("frame-leniency", _S, "receivers take other sloppy encodings", "check the receivers"),
    Rule("frame-size-limit", _S, "the greatest frame has another size", "rebuild the receivers"),
    Rule("form-added", _W, "an endpoint sends frames of a new form", "rebuild the receivers first"),
    Rule("form-deleted", _W, "a form of frame is gone", _TOGETHER),
    Rule("form-moved", _S, "forms of frame are tried in another order", "check the receivers"),
    # messages
    Rule("message-added", _N, "a message is new", "old receivers report it as unknown"),
    Rule("message-unskippable", _W, "old receivers can't skip a new message", _TOGETHER),
    Rule("message-deleted", _W, "a message is gone", "reserve its identity"),
    Rule("message-reserved", _N, "a message is gone and its identity reserved", "nothing"),
    Rule("message-renamed", _S, "a message has another name", _RENAME),
    Rule(
        "message-identity-added",
        _N,
        "a message has further identities",
        "old receivers report frames of these as unknown",
    ),
    Rule("message-identity", _W, "a message has another identity", _NEW_ID),
    Rule(
        "identity-reused",
        _W,
        "an identity means another message now",
        f"{_NEW_ID}; if only names changed, say `renamed_from`",
    ),
    Rule("reserved-deleted", _W, "what was reserved may be used again", "keep it", by_frame=False),
    Rule("reserved-reused", _W, "what was reserved is used again", _NEW_ID, by_frame=False),
    Rule("message-sender-added", _S, "others send the message, too", "check who listens"),
    Rule("message-sender-deleted", _W, "a sender of the message is gone", "reserve its identity"),
    Rule("message-virtual", _W, "another value of a message goes into the checksum", _BOTH),
    Rule("message-overload", _V, "messages that share an identity are told apart otherwise", _BOTH),
    Rule("message-size", _W, "payloads of other sizes are allowed", _BOTH),
    # fields
    Rule("field-added", _W, "a message has one field more", _BOTH),
    Rule(
        "field-appended",
        _N,
        "a message has one field more, which old receivers leave and new ones can do without",
        "nothing",
    ),
    Rule("field-deleted", _W, "a message has one field less", _BOTH),
    Rule("field-of-frame", _S, "a number of the frame is a field now, or none any more", _USERS),
    Rule("field-moved", _W, "a field stands elsewhere", _BOTH),
    Rule("field-renamed", _S, "a field has another name", _RENAME),
    Rule(
        "field-reused",
        _V,
        "fields of one type have other names, and which became which is not said",
        "say `renamed_from` in each of them, if only names changed",
    ),
    Rule("field-width", _W, "a number has another width", _BOTH),
    Rule("field-sign", _W, "a number has a sign now, or none any more", _BOTH),
    Rule("field-byte-order", _W, "a number's bytes stand in another order", _BOTH),
    Rule("field-encoding", _W, "a field is encoded another way", _BOTH),
    Rule("field-spelling", _N, "a number is written with other zeros or letters", "nothing"),
    Rule("field-kind", _S, "the same bytes are shown another way", _USERS),
    Rule("field-count", _W, "a field has another number of elements or bytes", _BOTH),
    Rule("field-cases", _W, "a switch has other cases", _BOTH),
    Rule("field-presence", _W, "a field is there in other payloads", _BOTH),
    Rule("field-constant", _W, "a constant has another value", _BOTH),
    Rule("field-default", _S, "a field has another default", "check the senders"),
    Rule("field-range-narrowed", _S, "senders may use fewer values", "check the senders"),
    Rule("field-range-widened", _S, "senders may use more values", "check what receivers do"),
    Rule("field-scale", _V, "the same number means another quantity", _BOTH),
    Rule("field-offset", _V, "the same number means another quantity", _BOTH),
    Rule("field-unit", _V, "the same number has another unit", _BOTH),
    Rule("field-rescaled", _S, "the same quantity has another unit", _USERS),
    Rule("field-special", _V, "a special value is new, gone or another", _BOTH),
    Rule("field-special-renamed", _S, "a special value has another name", _RENAME),
    # named values
    Rule("enum-value", _V, "a name stands for another number", "give the new meaning a new number"),
    Rule("enum-value-added", _N, "an enum has one value more", "old receivers show its number"),
    Rule("enum-value-deleted", _V, "an enum has one value less", "keep or reserve it"),
    Rule("enum-value-renamed", _S, "a value has another name", _RENAME),
    Rule("enum-closed-added", _W, "receivers refused this value", "rebuild the receivers first"),
    Rule("enum-closed-deleted", _W, "receivers refuse a value now", "keep it, or leave it open"),
    Rule("enum-closed", _W, "unnamed values are refused now", "leave it open"),
    Rule("enum-opened", _W, "unnamed values are taken now", "check what old receivers do"),
    Rule("flag-moved", _V, "a flag is another bit", "give the new meaning a new bit"),
    Rule("flag-added", _N, "a bit has a name", "nothing"),
    Rule("flag-deleted", _V, "a bit has no name any more", "keep it"),
    Rule("flag-renamed", _S, "a bit has another name", _RENAME),
    Rule("bits", _V, "runs of bits in a number are others", _BOTH),
    Rule("bits-renamed", _S, "a run of bits has another name", _RENAME),
    # the whole
    Rule("schema-deleted", _W, "a schema is gone", "keep it until nobody speaks it any more"),
    Rule("protocol-renamed", _S, "the protocol has another name", _RENAME),
    Rule("endpoint-renamed", _S, "an endpoint has another name", _RENAME),
    Rule("link", _W, "the line is set another way", "set both ends alike", by_frame=False),
    Rule("link-timeout", _W, "frames are given up after another pause", _TOGETHER, by_frame=False),
    Rule("link-stated", _S, "the line's setting is stated now, or not any more", "compare ends"),
    Rule(
        "version-not-bumped", _S, "the meaning changed and the version did not", "raise `version`"
    ),
)
"""All rules, in the order in which they are listed."""

BY_NAME = {rule.name: rule for rule in RULES}
ORDER = {category: index for index, category in enumerate(Category)}
"""The worst first."""
