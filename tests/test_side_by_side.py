"""Targets that print side by side print what they print alone."""

from __future__ import annotations

from collections.abc import Sequence

import pytest
from compiled import SCHEMAS, protocol_of

from protogen.errors import UserError
from protogen.model.protocol import Protocol
from protogen.targets import TARGETS
from protogen.targets import side_by_side as module

pytestmark = pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")


class Refusing:
    """A target that can't print what it is given."""

    name = folder = "refusing"

    def emit(self, protocols: Sequence[Protocol]) -> tuple:
        raise UserError(f"{len(protocols)} protocols are too many")


@pytest.fixture
def begun(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The targets that a process of its own prints; few messages are many enough."""
    names: list[str] = []
    begin = module._begin

    def noted(target, protocols):
        names.append(target.name)
        return begin(target, protocols)

    monkeypatch.setattr(module, "_MANY", 1)
    monkeypatch.setattr(module, "_can_fork", lambda: True)
    monkeypatch.setattr(module, "_begin", noted)
    return names


def test_all_targets_print_what_each_prints_alone(begun: list[str]) -> None:
    protocols = [protocol_of(path) for path in SCHEMAS if path.stem in ("rn1", "rflex")]
    targets = list(TARGETS.values())
    printed = module.emit_all(targets, protocols)
    assert printed == [target.emit(protocols) for target in targets]
    assert begun == ["c", "typescript"]


def test_what_a_target_refuses_is_reported(begun: list[str]) -> None:
    targets = [TARGETS["markdown"], Refusing()]
    with pytest.raises(UserError, match="1 protocols are too many"):
        module.emit_all(targets, [protocol_of(SCHEMAS[0])])
    assert begun == ["refusing"]


def test_few_messages_start_no_process(begun: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_MANY", 500)
    module.emit_all(list(TARGETS.values()), [protocol_of(SCHEMAS[0])])
    assert begun == []
