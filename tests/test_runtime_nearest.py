"""Physical values that fall on a special raw value: nobody would read them as what was meant."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from types import ModuleType

import pytest
from hypothesis import given
from hypothesis import strategies as st

import protogen
from protogen.cli.exits import UsageError
from protogen.cli.wire.values import raw_values
from protogen.model.protocol import Protocol
from protogen.runtime.payload.nearest import nearest_reading
from protogen.targets.python.emit import source

SCHEMA = """\
protocol: compass
endpoints: {board: Board}
byte_order: big
frame:
  id:      {type: uint8, id: true}
  length:  {type: uint8, counts: payload}
  payload: {}
  check:   {type: uint8, algorithm: sum-8, covers: id..payload}
messages:
  heading:
    id: 1
    from: board
    fields:
      value: {type: sint14, scale: 1/16, unit: deg, special: {invalid: -8192}}
      reach: {type: uint8, scale: 2, unit: mm, range: [10, 20], special: {nothing: 21, far: 20}}
      flag: {type: uint1, scale: 3, unit: V, special: {low: 0, high: 1}}
      steps: {type: uint8, count: 2, scale: 1/2, special: {nothing: 0}}
      plain: {type: uint8, unit: mm, special: {nothing: 0}}
"""


@pytest.fixture(scope="module")
def protocol(tmp_path_factory: pytest.TempPathFactory) -> Protocol:
    path: Path = tmp_path_factory.mktemp("compass") / "compass.yaml"
    path.write_text(SCHEMA)
    return protogen.load(path)


@pytest.fixture(scope="module")
def compass(protocol: Protocol) -> ModuleType:
    return protogen.module_of(protocol)


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [
        (
            "value_deg",
            -512,
            "-512 deg would be sent as -8192, which means invalid; "
            "the nearest reading is -511.9375 deg",
        ),
        # It is rounded to the special value; the message still shows what was asked for.
        ("value_deg", -511.98, "-511.98 deg would be sent as -8192"),
        # 21 is out of the range, 20 is special, too.
        ("reach_mm", 42, "which means nothing; the nearest reading is 38 mm"),
        ("flag_v", 3, "3 V would be sent as 1, which means high"),
        ("steps_scaled", [1.0, 0.2], "0.2 would be sent as 0, which means nothing"),
    ],
)
def test_a_property_refuses_a_number_that_is_no_reading(
    compass: ModuleType, name: str, value: object, says: str
) -> None:
    message = compass.Heading(value=1, reach=11, flag=0, steps=[1, 1], plain=1)
    with pytest.raises(ValueError, match="which means") as caught:
        setattr(message, name, value)
    assert says in str(caught.value)
    assert message == compass.Heading(value=1, reach=11, flag=0, steps=[1, 1], plain=1)


def test_what_is_said_to_be_the_nearest_reading_is_taken(compass: ModuleType) -> None:
    message = compass.Heading(value=1, reach=11, flag=0, steps=[1, 1], plain=1)
    message.value_deg = -511.9375
    message.reach_mm = 38
    message.steps_scaled = [0.5, None]
    assert (message.value, message.reach, message.steps) == (-8191, 19, [1, 0])
    message.value_deg = None
    assert (message.value, message.value_deg) == (-8192, None)


@pytest.mark.parametrize(
    ("written", "says", "hint"),
    [
        (
            {"value": "-512deg"},
            "value: `-512deg` is sent as -8192, which means `invalid`",
            "the nearest that can be sent is -511.9375deg",
        ),
        (
            {"value": "-511.99deg"},
            "no whole number of steps of 0.0625deg",
            "the nearest that can be sent is -511.9375deg",
        ),
        (
            {"reach": "42mm"},
            "reach: `42mm` is sent as 21, which means `nothing`",
            "the nearest that can be sent is 38mm",
        ),
        ({"flag": "3V"}, "flag: `3V` is sent as 1, which means `high`", None),
        (
            {"plain": "0mm"},
            "plain: `0mm` is sent as 0, which means `nothing`",
            "the nearest that can be sent is 1mm",
        ),
        (
            {"value": "-512.0"},
            "value: `-512.0` is none of",
            "a value in deg has its unit behind it: -511.9375deg",
        ),
        ({"flag": "3.0"}, "flag: `3.0` is none of", None),
    ],
)
def test_the_command_line_refuses_it_as_well(
    protocol: Protocol, written: dict[str, str], says: str, hint: str | None
) -> None:
    with pytest.raises(UsageError) as caught:
        raw_values(protocol.message("heading").plan.steps, written)
    assert says in str(caught.value)
    assert caught.value.hint == hint


@pytest.mark.parametrize(
    ("written", "value"), [("-8192", -8192), ("invalid", -8192), ("-511.9375deg", -8191)]
)
def test_raw_values_and_names_still_say_that_there_is_no_reading(
    protocol: Protocol, written: str, value: int
) -> None:
    assert raw_values(protocol.message("heading").plan.steps, {"value": written}) == {
        "value": value
    }


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("value_deg", "Value in deg, -511.9375..511.9375; None: no reading."),
        ("reach_mm", "Reach in mm, 20..38; None: no reading."),
        ("flag_v", "Flag in V; None: no reading."),
        ("steps_scaled", "Steps, scaled, 0.5..127.5; None: no reading."),
    ],
)
def test_a_range_in_a_docstring_ends_at_readings(protocol: Protocol, name: str, says: str) -> None:
    lines = [line.strip() for line in source(protocol).module.splitlines()]
    place = next(index for index, line in enumerate(lines) if line.startswith(f"{name} = "))
    assert lines[place + 1] == f'"""{says}"""'


@given(
    st.fractions(-20, 20),
    st.sets(st.integers(-12, 12), max_size=8),
    st.integers(-10, 10),
    st.integers(0, 20),
)
def test_the_nearest_reading_is_that_of_a_search(
    exact: Fraction, special: set[int], least: int, count: int
) -> None:
    greatest = least + count
    readings = [raw for raw in range(least, greatest + 1) if raw not in special]
    found = nearest_reading(exact, special, least, greatest)
    if not readings:
        assert found is None
    else:
        assert found in readings
        assert abs(found - exact) == min(abs(raw - exact) for raw in readings)
