"""The runtime's dataclasses are those of the standard library, only made later."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import pickle
import pprint
import sys
from collections.abc import Callable, Hashable
from importlib.util import module_from_spec, spec_from_file_location
from types import ModuleType
from typing import Any, ClassVar, Generic, TypeVar, get_type_hints

import pytest

from generated.python import matty, rn1
from protogen.runtime import dataclass as ours

ItemT = TypeVar("ItemT")
LIBRARIES = pytest.mark.parametrize("library", [dataclasses, ours], ids=["standard", "ours"])
"""What holds for one has to hold for the other."""


def point(library: Any, **options: Any) -> Any:
    @library.dataclass(slots=True, **options)
    class Point:
        """A place."""

        kind: ClassVar[str] = "point"

        x: int
        y: int = 2
        marks: list[str] = library.field(default_factory=lambda: ["a"])
        hidden: int = library.field(default=0, repr=False, compare=False)

    return Point


def checked(library: Any) -> Any:
    @library.dataclass(slots=True, frozen=True)
    class Checked:
        low: int
        high: int = 9
        table: dict[int, int] = library.field(hash=False, default_factory=dict)
        size: int = library.field(init=False)
        count: int = library.field(init=False, default=3)
        names: list[str] = library.field(init=False, default_factory=list, hash=False)

        def __post_init__(self) -> None:
            if self.low > self.high:
                raise ValueError("no range")
            object.__setattr__(self, "size", self.high - self.low)

    return Checked


def children(library: Any) -> Any:
    @library.dataclass(slots=True, frozen=True)
    class Parent(Generic[ItemT]):
        item: ItemT
        more: int = 1

        def shown(self) -> str:
            return f"{self.item} {self.more}"

    @library.dataclass(slots=True, frozen=True)
    class Child(Parent[int]):
        more: int = 2
        last: str = "z"

    return Parent, Child


def outcome(act: Callable[[], Any]) -> Any:
    """What comes of it: a value, or the kind and words of an error."""
    try:
        return act()
    except Exception as error:
        return type(error), str(error)


ACTS: dict[str, Callable[[Any], Any]] = {
    "positional": lambda lib: repr(point(lib)(1, 5, [], 7)),
    "defaults": lambda lib: repr(point(lib)(x=1)),
    "missing": lambda lib: point(lib)(),
    "keywords only": lambda lib: point(lib, kw_only=True)(1),
    "no constructor": lambda lib: point(lib, init=False)(1),
    "no representation": lambda lib: point(lib, repr=False).__repr__ is object.__repr__,
    "surplus": lambda lib: point(lib)(x=1, z=2),
    "own lists": lambda lib: point(lib)(1).marks is point(lib)(1).marks,
    "signature": lambda lib: str(inspect.signature(point(lib))),
    "signature, kw_only": lambda lib: str(inspect.signature(point(lib, kw_only=True))),
    "annotations": lambda lib: point(lib).__init__.__annotations__,
    "name of a method": lambda lib: point(lib).__init__.__qualname__,
    "slots": lambda lib: point(lib).__slots__,
    "no other attribute": lambda lib: setattr(point(lib)(1), "z", 1),
    "class variable": lambda lib: point(lib).kind,
    "docstring": lambda lib: point(lib).__doc__,
    "match": lambda lib: point(lib).__match_args__,
    "match, kw_only": lambda lib: point(lib, kw_only=True).__match_args__,
    "unhashable": lambda lib: hash(point(lib)(1)),
    "not Hashable": lambda lib: isinstance(point(lib)(1), Hashable),
    "frozen": lambda lib: setattr(checked(lib)(1), "low", 2),
    "frozen, deleting": lambda lib: delattr(checked(lib)(1), "low"),
    "post-init": lambda lib: repr(checked(lib)(4)),
    "post-init refuses": lambda lib: checked(lib)(10),
    "not of init": lambda lib: checked(lib)(1, size=3),
    "fields": lambda lib: [
        (f.name, f.type, f.init, f.repr, f.hash, f.compare, f.kw_only)
        for f in dataclasses.fields(checked(lib))
    ],
    "asdict": lambda lib: dataclasses.asdict(point(lib)(1)),
    "astuple": lambda lib: dataclasses.astuple(checked(lib)(1)),
    "replace": lambda lib: repr(dataclasses.replace(point(lib)(1), y=3)),
    "replace, not of init": lambda lib: dataclasses.replace(checked(lib)(1), size=3),
    "replace checks": lambda lib: dataclasses.replace(checked(lib)(1), low=10),
    "is_dataclass": lambda lib: dataclasses.is_dataclass(point(lib)),
    "frozen parameter": lambda lib: checked(lib).__dataclass_params__.frozen,
    "of a parent": lambda lib: repr(children(lib)[1](5)),
    "order of fields": lambda lib: [f.name for f in dataclasses.fields(children(lib)[1])],
    "inherited method": lambda lib: children(lib)[1](5).shown(),
    "slots of a child": lambda lib: children(lib)[1].__slots__,
    "generic": lambda lib: children(lib)[0][str].__origin__ is children(lib)[0],
    "pprint": lambda lib: pprint.pformat(point(lib)(10**9, 10**9, ["x"]), width=20),
    "name of repr": lambda lib: point(lib).__repr__.__qualname__,
    "no repr": lambda lib: "object at" in repr(point(lib, repr=False)(1)),
}


@pytest.mark.parametrize("name", ACTS)
def test_it_does_as_the_standard_library(name: str) -> None:
    act = ACTS[name]
    assert outcome(lambda: act(ours)) == outcome(lambda: act(dataclasses))


@LIBRARIES
def test_equality(library: Any) -> None:
    cls, other = point(library), point(library)
    assert cls(1, hidden=5) == cls(1)
    assert cls(1) != cls(2)
    assert cls(1) != other(1)
    assert cls(1) != 1


@LIBRARIES
def test_hashes(library: Any) -> None:
    cls = checked(library)
    assert hash(cls(1, table={1: 1})) == hash(cls(1)) == hash((1, 9, 8, 3))


@LIBRARIES
def test_what_contains_itself_is_shown(library: Any) -> None:
    item = point(library)(1)
    item.marks.append(item)
    assert repr(item).endswith("marks=['a', ...])")


@LIBRARIES
def test_own_methods_stay(library: Any) -> None:
    @library.dataclass(slots=True, frozen=True)
    class Own:
        x: int

        def __repr__(self) -> str:
            return "mine"

        def __eq__(self, other: object) -> bool:
            return True

        def __hash__(self) -> int:
            return 7

    assert (repr(Own(1)), Own(1) == 5, hash(Own(1))) == ("mine", True, 7)


@LIBRARIES
def test_a_field_may_be_called_self(library: Any) -> None:
    @library.dataclass(slots=True, kw_only=True)
    class Odd:
        self: int
        other: int
        cls: int = 3

    assert repr(Odd(self=1, other=2)).endswith("Odd(self=1, other=2, cls=3)")
    assert Odd(self=1, other=2) == Odd(self=1, other=2)


@LIBRARIES
def test_subclasses_by_hand(library: Any) -> None:
    parent = point(library)

    class Sub(parent):  # type: ignore[misc,valid-type]
        def __init__(self, x: int) -> None:
            super().__init__(x, y=10)

    assert (Sub(1).x, Sub(1).y) == (1, 10)
    assert [field.name for field in dataclasses.fields(Sub)] == ["x", "y", "marks", "hidden"]

    @dataclasses.dataclass
    class More(parent):  # type: ignore[misc,valid-type]
        more: int = 4

    assert repr(More(1)).endswith("More(x=1, y=2, marks=['a'], more=4)")


# --- generated messages -------------------------------------------------------------------------


def gyro() -> rn1.Gyro:
    return rn1.Gyro(status=rn1.GyroStatus.OK, int_x=-5, int_y=0, int_z=812)


def test_a_message_is_a_dataclass() -> None:
    assert [field.name for field in dataclasses.fields(gyro())] == [
        "status", "int_x", "int_y", "int_z",
    ]  # fmt: skip
    assert dataclasses.asdict(gyro()) == {"status": 1, "int_x": -5, "int_y": 0, "int_z": 812}
    assert dataclasses.replace(gyro(), int_y=7).int_y == 7
    assert repr(gyro()) == "Gyro(status=<GyroStatus.OK: 1>, int_x=-5, int_y=0, int_z=812)"


def test_a_message_is_compared_and_not_hashed() -> None:
    assert gyro() == gyro() != dataclasses.replace(gyro(), int_y=7)
    assert rn1.Xcel(status=1, int_x=0, int_y=0, int_z=0) != rn1.Gyro(
        status=1, int_x=0, int_y=0, int_z=0
    )
    with pytest.raises(TypeError, match="unhashable"):
        hash(gyro())
    with pytest.raises(AttributeError):
        gyro().speed = 1  # type: ignore[attr-defined]


def test_a_message_can_be_matched() -> None:
    match rn1.decode(rn1.encode(gyro()), "brain"):
        case rn1.Gyro(status=rn1.GyroStatus.OK, int_z=int_z):
            assert int_z == 812
        case other:
            pytest.fail(str(other))


@pytest.mark.parametrize("protocol", range(2, pickle.HIGHEST_PROTOCOL + 1))
def test_messages_and_parts_are_pickled_and_copied(protocol: int) -> None:
    message = rn1.Maintenance(
        operation=rn1.MaintenanceOperation.RECONFIG_UART,
        argument=rn1.MaintenanceArgumentReconfigUart(baud_rate_register=300),
    )
    parts = matty.Parts(counter=3, command=0x47)
    for item in (message, parts, gyro()):
        assert pickle.loads(pickle.dumps(item, protocol)) == item
        assert copy.copy(item) == item
        assert copy.deepcopy(item) == item
    assert copy.deepcopy(message).magic is not message.magic == [66, 17, 122]


def test_parts_are_frozen_and_hashed() -> None:
    parts = matty.Parts(counter=3, command=0x47)
    with pytest.raises(dataclasses.FrozenInstanceError):
        parts.counter = 4  # type: ignore[misc]
    with pytest.raises(dataclasses.FrozenInstanceError):
        parts.number = 4  # type: ignore[attr-defined]
    assert {parts: 1}[matty.Parts(3, 0x47)] == 1


def test_changed_copies_by_the_protocol_of_later_pythons() -> None:
    # `copy.replace` of Python 3.13 calls it.
    replaced = copy.replace if sys.version_info >= (3, 13) else type(gyro()).__replace__
    assert replaced(gyro(), int_y=7) == dataclasses.replace(gyro(), int_y=7)


def test_the_types_of_arguments_can_be_looked_up() -> None:
    """As libraries do that validate arguments, or fill them in."""
    hints = get_type_hints(rn1.Lidar.__init__)
    assert hints == {
        "status": rn1.LidarStatus | int, "distances": list[int], "return": type(None),
    }  # fmt: skip
    signature = inspect.signature(rn1.Lidar, eval_str=True)
    assert signature.parameters["status"].annotation == rn1.LidarStatus | int


def test_a_class_may_be_called_like_what_is_built_in(monkeypatch: pytest.MonkeyPatch) -> None:
    code = """
from __future__ import annotations
from protogen.runtime.dataclass import dataclass

@dataclass(slots=True, frozen=True)
class NotImplemented:
    x: int

hash = object = None
"""
    module = ModuleType("shadowing")
    exec(code, vars(module))
    for name in ("shadowing", "elsewhere"):  # The module may be one that nobody imported.
        monkeypatch.setitem(sys.modules, name, module)
        made = module.NotImplemented(1)
        assert made == module.NotImplemented(1) != module.NotImplemented(2)
        assert (made == 1) is False
        assert hash(made) == hash(module.NotImplemented(1))
        monkeypatch.delitem(sys.modules, name)
        exec(code, vars(module))


# --- FORMAT and RULES ---------------------------------------------------------------------------


def test_a_declaration_is_made_once() -> None:
    assert rn1.Gyro.FORMAT is rn1.Gyro.FORMAT is gyro().FORMAT
    assert rn1.Gyro.RULES is rn1.Gyro.RULES
    assert rn1.HOST_FORMAT is rn1.HOST_FORMAT
    with pytest.raises(AttributeError, match=r"'generated\.python\.rn1' has no attribute 'Gyros'"):
        _ = rn1.Gyros


def test_a_subclass_has_the_declarations_of_its_parent() -> None:
    class Mine(matty.Go):
        pass

    assert Mine.FORMAT is matty.Go.FORMAT
    mine = Mine(speed=1, steer=2)
    mine.steer_deg = 12.5
    assert mine.steer == 1250


def test_a_module_that_is_loaded_again_makes_its_frames_again() -> None:
    spec = spec_from_file_location("loaded_again", matty.__file__)
    assert spec is not None
    assert spec.loader is not None
    module: Any = module_from_spec(spec)
    spec.loader.exec_module(module)
    before = module.PC_FORMAT
    spec.loader.exec_module(module)
    assert module.PC_FORMAT is not before
