"""Names that ROS 2 takes, and what is known of places in its messages."""

from __future__ import annotations

import pytest

from protogen.convert.ros2.names import field_name, field_names, message_name
from protogen.model.names import free_name
from protogen.native.cdr_steps import Alignment


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("heading_deg", "heading_deg"),
        ("turn.angle", "turn_angle"),
        ("_size", "size"),
        ("a__b_", "a_b"),
        ("3d", "field_3d"),
        ("class", "class_value"),
        ("import", "import_value"),
        ("RPM", "rpm"),
    ],
)
def test_fields_have_names_that_ros_takes(name: str, expected: str) -> None:
    assert field_name(name) == expected


def test_no_two_fields_have_one_name() -> None:
    names = ["_size", "a.b", "size", "a_b", "__size"]
    expected = {"size": "size", "a_b": "a_b", "_size": "size_2", "a.b": "a_b_2", "__size": "size_3"}
    assert field_names(names) == expected


def test_messages_have_names_that_ros_takes() -> None:
    assert message_name("read_motor") == "ReadMotor"
    assert message_name("lidar.points", "list") == "LidarPointsList"
    assert free_name("Points", ["Points", "Points2"], between="") == "Points3"


def test_what_is_known_of_a_place() -> None:
    start = Alignment()
    assert [start.after(9).padding(size) for size in (1, 2, 4, 8)] == [0, 1, 3, 7]
    assert start.after(4).joined(start) == Alignment(4, 0)
    assert start.after(2).joined(start.after(6)) == Alignment(4, 2)
    assert Alignment(4, 2).padding(8) is None
    assert Alignment(4, 2).aligned(8) == Alignment(8, 0)
    assert Alignment(4, 2).aligned(4) == Alignment(4, 0)
