"""Keys of a mapping: only names and integers, each once."""

from __future__ import annotations

from protogen.problems import Problems
from protogen.schema.text.nodes import Node, ScalarNode, SequenceNode
from protogen.schema.text.scalars import Scalar


class Keys:
    """The keys of one mapping that is being read."""

    def __init__(self, problems: Problems) -> None:
        self._problems = problems
        self._first: dict[Scalar, ScalarNode] = {}

    def accept(self, key: Node) -> ScalarNode | None:
        """Return the key if it can be used; otherwise report why not."""
        if not isinstance(key, ScalarNode):
            kind = "list" if isinstance(key, SequenceNode) else "mapping"
            self._problems.add("PG009", key.span, f"a {kind} can't be a key")
        elif key.plain and key.text == "<<":
            message = "the merge key `<<` is no part of YAML 1.2"
            self._problems.add("PG012", key.span, message, "repeat the keys, or use `extends`")
        elif not isinstance(key.value, str | int):
            self._report_scalar(key)
        elif key.value in self._first:
            self._report_duplicate(key, self._first[key.value])
        else:
            self._first[key.value] = key
            return key
        return None

    def _report_scalar(self, key: ScalarNode) -> None:
        if not key.text:
            self._problems.add("PG009", key.span, "a key is missing")
            return
        kind = "nothing" if key.value is None else "a fraction"
        message = f"`{key.text}` means {kind}, so it can't be a key"
        self._problems.add("PG009", key.span, message, f'write `"{key.text}"` if it is a name')

    def _report_duplicate(self, key: ScalarNode, first: ScalarNode) -> None:
        same = "" if key.text == first.text else f", which is the same as `{first.text}`"
        message = f"the key `{key.text}` stands twice{same}"
        self._problems.add("PG006", key.span, message, notes=[(first.span, "it stands here first")])
