"""Check that what the transparency makes can be undone."""

from __future__ import annotations

from collections.abc import Mapping

from protogen.model.frame import Substitution
from protogen.passes.context import Context, Loc
from protogen.passes.draft import Draft
from protogen.passes.proofs.codewords import ambiguity, prefix_clash
from protogen.passes.proofs.wire_code import code_of


def check_codes(context: Context, draft: Draft) -> None:
    """Two inputs never give one output, and a receiver can decode at once."""
    checked: set[str] = set()
    for sender, frame in draft.frames.items():
        key = sender if sender in context.syntax.transparency else ""
        if frame.transparency is None or key in checked:
            continue
        checked.add(key)
        code = code_of(frame.transparency.encoding)
        if code is not None:
            is_table = isinstance(frame.transparency.encoding, Substitution)
            _check(context, code, ("transparency", key, "substitute" if is_table else "escape"))


def _check(context: Context, code: Mapping[int, bytes], loc: Loc) -> None:
    witness = ambiguity(code)
    if witness is not None:
        one, other, output = witness
        context.error(
            "PG140",
            loc,
            f"this can't be undone: {_hex(one)} and {_hex(other)} both become {_hex(output)}",
            "list every byte that begins a sequence, or choose sequences that differ",
        )
        return
    clash = prefix_clash(code)
    if clash is not None:
        short, long = sorted(clash, key=lambda byte: len(code[byte]))
        text = f"what stands for {short:02X} begins what stands for {long:02X}"
        context.error("PG141", loc, f"{text}, so a receiver can't decode at once")


def _hex(data: bytes) -> str:
    return data.hex(" ").upper() or "nothing"
