"""Edits of the form on a page: each value of a message at its boundaries, and what they mean.

The bytes that are due come from the command that the page shows, run by the Python encoder.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

from protogen.cli.exits import UsageError
from protogen.cli.wire.codec import Codec
from protogen.cli.wire.given import given_message
from protogen.cli.wire.values import raw_values, split_assignment, tree_of
from protogen.model.computed import computed
from protogen.model.frame import Frame
from protogen.model.messages import Message, given_parts
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ChooseStep,
    ConstantStep,
    FloatStep,
    IntegerStep,
    OptionalStep,
    PartStep,
    RecordStep,
    RegionStep,
    RepeatStep,
    TrailingPresence,
)
from protogen.model.types import Field, Float, Integer, Text

_LONGEST = 300
"""Characters of the longest text that is tried, and bytes of the longest run of bytes."""

TRY = """([message, sender, frames, edits]) => {
    history.replaceState = () => {};
    const { encode } = protogen;
    encode.result = () => {};  // The rows of events are tried elsewhere.
    const hexOf = (bytes) => Array.from(bytes, (it) => it.toString(16).padStart(2, "0")).join("");
    const bytesOf = (hex) => Uint8Array.from(hex.match(/../g) ?? [], (it) => parseInt(it, 16));
    const controls = () => [...document.querySelectorAll("#fields [data-key]")];
    const find = (key) => document.querySelector(`#fields [data-key="${CSS.escape(key)}"]`);
    const plain = (key) => key.replace(/\\[\\d+\\]/g, "[i]");
    const class_ = (key) => key.replace(/\\[(\\d+)\\]/g, (_, it) => it === "0" ? "[0]" : "[i]");
    const choices = (control) => {
        if (control.tagName === "BUTTON") return [null];
        if (control.type === "checkbox") return [!control.checked];
        if (control.tagName === "SELECT") {
            return [...control.options].map((it) => it.value).filter((it) => it !== "");
        }
        const own = edits[plain(control.dataset.key)];
        if (control.tagName !== "TEXTAREA") return own ?? ["?"];
        const given = control.value.split(" ");
        const of = edits[`${plain(control.dataset.key)}[i]`] ?? ["?"];
        return of.flatMap((it) => [[it, ...given.slice(1)], [...given.slice(0, -1), it]])
            .map((it) => it.join(" "));
    };
    const [tried, found] = [new Set(), []];
    for (const hex of frames) {
        const data = bytesOf(hex);
        if (!encode.load(message, sender, data)) {
            found.push({ hex, kind: "not loaded" });
            continue;
        }
        if (!encode.bytes || hexOf(encode.bytes) !== hex) found.push({ hex, kind: "not the same" });
        const first = structuredClone({ values: encode.values, parts: encode.parts });
        const reset = () => {
            encode.make = () => {};
            encode.take(message, encode.side, structuredClone(first));
            delete encode.make;
        };
        for (const { dataset: { key } } of controls()) {
            if (tried.has(class_(key))) continue;
            tried.add(class_(key));
            reset();
            const { tagName, type } = find(key);
            const isText = tagName === "TEXTAREA" || (tagName === "INPUT" && type !== "checkbox");
            for (const value of choices(find(key))) {
                // A text takes the place of the one before, and the form stays as it is.
                if (!isText) reset();
                const own = find(key);
                if (own.disabled) continue;
                if (own.tagName === "BUTTON") own.click();
                else {
                    const isBox = own.type === "checkbox";
                    if (isBox) own.checked = value;
                    else own.value = value;
                    const isChange = isBox || own.tagName === "SELECT";
                    own.dispatchEvent(new Event(isChange ? "change" : "input"));
                }
                const isRead = own.getAttribute("aria-invalid") !== "true" || find(key) !== own;
                const bytes = encode.bytes ? hexOf(encode.bytes) : null;
                const fault = document.querySelector("#fault").textContent;
                const text = own.tagName === "SELECT" ? own.selectedOptions[0].text : "";
                const command = encode.command();
                found.push({ hex, key, kind: "edit", value, text, bytes, fault, command, isRead });
            }
        }
    }
    return [found, [...tried]];
}"""
"""Makes each edit of the first frame that has the value, and says what comes of it."""


class Value(NamedTuple):
    """A value that can be edited."""

    path: str
    """Its key on the page, with `[i]` for an element."""
    step: AnyStep

    @property
    def field(self) -> Field:
        """Its field."""
        return self.step.field


def editable(message: Message) -> Iterator[Value]:
    """Each value of a message that senders choose; one that may be missing has also `path?`."""
    yield from _record(message.plan.steps, message.fields, "")


def _record(steps: Iterable[AnyStep], fields: Sequence[Field], prefix: str) -> Iterator[Value]:
    # The size of a region is given like other numbers.
    computes = {name for name, item in computed(fields).items() if not item.is_region}
    for step in steps:
        if step.name not in computes:
            yield from _values(step, f"{prefix}{step.name}")


def _values(step: AnyStep, path: str) -> Iterator[Value]:
    match step:
        case PartStep() | IntegerStep() | FloatStep() | BytesStep():
            yield Value(path, step)
        case RecordStep():
            yield from _record(step.steps, step.type.fields, f"{path}.")
        case RepeatStep():
            yield from _values(step.element, f"{path}[i]")
        case OptionalStep():
            if isinstance(step.presence, TrailingPresence):
                yield Value(f"{path}?", step)
            yield from _values(step.step, path)
        case RegionStep():
            yield from _values(step.step, path)
        case ChooseStep():
            for case in step.cases:
                yield from _values(case.step, path)
        case ConstantStep():
            pass


def paths_in(value: Any, path: str = "") -> Iterator[str]:
    """The paths of all that is there in values."""
    if value is None:
        return
    yield path
    if isinstance(value, dict):
        for name, item in value.items():
            yield from paths_in(item, f"{path}.{name}" if path else name)
    elif isinstance(value, list):
        for item in value:
            yield from paths_in(item, f"{path}[i]")


def edits(message: Message, frame: Frame) -> dict[str, list[str]]:
    """What is put into each field of text, by its key: of the message, and of parts of a frame."""
    found: dict[str, list[str]] = {}
    for part in given_parts(frame, message):
        numbers = (part.least, part.greatest, part.least - 1, part.greatest + 1)
        texts = ["A", "7", "~~~~~~~~~"]
        found[f"@{part.name}"] = texts if part.type.is_text else [*map(str, numbers)]
    for value in editable(message):
        for key, texts in _texts(value):
            found[key] = [*dict.fromkeys([*found.get(key, []), *texts])]
    return found


def _texts(value: Value) -> Iterator[tuple[str, list[str]]]:
    path, step = value
    if isinstance(step, BytesStep):
        sizes = {0, 1, step.count.least, step.count.greatest, step.count.greatest + 1}
        unit = "A" if isinstance(step.type, Text) else "FE"
        yield path, [unit * size for size in sorted(sizes) if size <= _LONGEST]
    elif isinstance(step, FloatStep):
        greatest = "3.4028234663852886e+38" if step.type.bits == 32 else "1.7976931348623157e+308"
        yield path, ["0", "-0.0", "1.5", greatest, f"-{greatest}", "1e39", "nan", "inf"]
        if value.field.scaled:
            yield f"{path}~", ["0", "2.5", "-1e3"]
    elif isinstance(step, PartStep | IntegerStep):
        yield from _integer(path, step.type, value.field)


def _integer(path: str, type_: Integer, field: Field) -> Iterator[tuple[str, list[str]]]:
    bits = type_.bits - type_.signed
    ends = [-(1 << bits) if type_.signed else 0, (1 << bits) - 1]
    bounds = [item for item in (field.least, field.greatest) if item is not None]
    near = [*ends, *(int(bound) for bound in bounds)]
    beyond = [min(ends) - 1, max(ends) + 1, *(raw + step for raw in near[2:] for step in (-1, 1))]
    yield path, [str(raw) for raw in (*near, *beyond)]
    for run in type_.bit_fields:
        greatest = run.mask >> run.low
        yield f"{path}/{run.name}", ["0", str(greatest), str(greatest + 1)]
    if field.scaled:
        yield f"{path}~", [f"{float(raw * field.scale + field.offset):.15g}" for raw in ends]


# --- what an edit means ---------------------------------------------------------------------------


def mistakes(codec: Codec, message: Message, made: Sequence[dict[str, Any]]) -> list[str]:
    """What is wrong with what came of the edits of a message; empty: nothing."""
    by_path: dict[str, list[Value]] = {}
    for value in editable(message):
        by_path.setdefault(value.path, []).append(value)
    return [found for item in made if (found := _mistake(codec, message, by_path, item))]


def _mistake(
    codec: Codec, message: Message, by_path: dict[str, list[Value]], item: dict[str, Any]
) -> str:
    if item["kind"] != "edit":
        return f"{item['hex']} is {item['kind']}"
    told = f"{message.name} {item['hex']}: {item['key']} = {item['value']!r}: {item['command']}"
    if not item["isRead"]:
        return "" if item["bytes"] is None and item["fault"] else f"{told}: taken"
    try:
        values, due = _encoded(codec, message, item["command"])
    except UsageError as error:
        return "" if item["bytes"] is None else f"{told}: {item['bytes']}, but {error}"
    if item["bytes"] != due.hex():
        return f"{told}: {item['bytes'] or item['fault']}, not {due.hex()}"
    if item["key"].startswith("@") or item["key"][-1] in "?+-":
        return ""
    found = _at(values, item["key"])
    owners = by_path.get(re.sub(r"\[\d+\]", "[i]", re.split("[~=/]", item["key"])[0]), [])
    if item["value"] is not None and owners and not _means(owners, item, found):
        return f"{told}: the value is {found!r}"
    return ""


def _encoded(codec: Codec, message: Message, command: str) -> tuple[dict[str, Any], bytes]:
    """The values and the bytes of a command."""
    given, options = words_of(command)[4:], {"--sender": None, "--form": None}
    while given[-2:-1] and given[-2] in options:
        *given, name, options[name] = given
    assignments = [split_assignment(word) for word in given if not word.startswith("@")]
    values = raw_values(message.plan.steps, tree_of(assignments))
    return values, given_message(codec, message.name, given, *options.values()).frame()


def words_of(command: str) -> list[str]:
    """The words as a shell has them, which takes `shlex` long to find."""
    return shlex.split(command) if re.search(r"[^ -~]|['\"\\]", command) else command.split(" ")


def _at(values: Any, key: str) -> Any:
    """The value at a key of the page."""
    for name in re.findall(r"[^.\[\]]+", re.split("[~=/]", key)[0]):
        values = values[int(name) if isinstance(values, list) else name]
    return values


def _means(owners: Sequence[Value], item: dict[str, Any], found: Any) -> bool:
    """True if a value is the one that was put in; fields of several cases can have its path."""
    return any(_is_meant(owner, item, found) for owner in owners)


def _is_meant(owner: Value, item: dict[str, Any], found: Any) -> bool:
    key, value, field = item["key"], item["value"], owner.field
    type_ = owner.step.type  # type: ignore[union-attr]
    _, _, run = key.partition("/")
    if run:
        return isinstance(type_, Integer) and _is_run(type_, run, value, found)
    if key.endswith("~"):
        due = (Fraction(value) - field.offset) / field.scale
        return float(due) == found if isinstance(type_, Float) else round(due) == found
    if key.endswith("="):
        if isinstance(value, bool):
            return found == value
        enum = type_.enum if isinstance(type_, Integer) else None
        named = {it.name: it.value for it in (*(enum.values if enum else ()), *field.special)}
        return named.get(item["text"]) == found
    if isinstance(type_, Float):
        # As JSON has them: of NaNs there is one, and zeros have signs.
        return isinstance(found, float | int) and str(float(value)) == str(float(found))
    if isinstance(type_, Integer):
        return bool(re.fullmatch(r"-?\d+", value)) and int(value) == found
    return value == found if isinstance(type_, Text) else value.lower() == found


def _is_run(type_: Integer, name: str, value: Any, found: int) -> bool:
    """True if the bits of that name have the value."""
    for flag in () if type_.flags is None else type_.flags.bits:
        if flag.name == name:
            return bool(found >> flag.bit & 1) == value
    run = next((item for item in type_.bit_fields if item.name == name), None)
    return run is not None and (found & run.mask) >> run.low == int(value)
