"""The limits of joints mean what the URDF standard says, and a joint without limits is reported."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.urdf.read import UrdfReader
from urdf.parts import ARM, joint, link, robot

Reader = Callable[..., UrdfReader]


def range_of(reader: UrdfReader, name: str = "shoulder") -> tuple[str | None, str | None]:
    unit = reader.unit()
    assert unit is not None, [each.message for each in reader.sink.errors]
    (found,) = (each for each in unit.root.iter("joint") if each.get("name") == name)
    return found.get("range"), found.get("limited")


def limited(limit: str, kind: str = "revolute") -> str:
    return robot(*ARM[:3], joint("shoulder", "base", "upper", limit, kind=kind), ARM[4])


def reported(reader: UrdfReader) -> list[Diagnostic]:
    return [each for each in reader.sink.sorted() if each.code == "urdf-limits"]


@pytest.mark.parametrize(
    ("limit", "expected"),
    [
        ('<limit upper="0.75" effort="3"/>', "0 0.75"),
        ('<limit lower="-0.25" effort="3"/>', "-0.25 0"),
        ('<limit lower="-0.25" upper="0.5"/>', "-0.25 0.5"),
    ],
)
@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_a_missing_end_is_zero(reader: Reader, limit: str, expected: str, kind: str) -> None:
    read = reader("r.urdf", limited(limit, kind))
    assert range_of(read) == (expected, None)
    assert not reported(read)


@pytest.mark.parametrize(
    ("limit", "why"),
    [
        ('<limit lower="0.5" upper="-0.5"/>', "`lower` (0.5) is above `upper` (-0.5)"),
        ('<limit upper="-0.5"/>', "`lower` (0) is above `upper` (-0.5); a missing `lower` is 0"),
        ('<limit lower="0.5"/>', "`lower` (0.5) is above `upper` (0); a missing `upper` is 0"),
        ('<limit lower="0.1" upper="0.1"/>', "`lower` and `upper` are both 0.1"),
        ('<limit effort="5" velocity="2"/>', "its `<limit>` has neither `lower` nor `upper`"),
        ('<limit lower="nan" upper="1"/>', "`nan` is not a number"),
    ],
)
def test_a_joint_without_limits_is_reported_at_its_limit(reader: Reader, limit: str, why: str) -> None:
    read = reader("r.urdf", limited(limit))
    assert range_of(read)[0] is None
    (warning,) = reported(read)
    assert warning.message == f"the revolute joint `shoulder` moves without limits: {why}"
    assert warning.span is not None and warning.span.line == 5 and warning.span.column > 50


def test_a_joint_without_limit_is_reported(reader: Reader) -> None:
    text = limited("").replace('<limit lower="-1" upper="1.5" effort="20" velocity="2"/>', "", 1)
    read = reader("r.urdf", text)
    assert range_of(read) == (None, None)
    (warning,) = reported(read)
    assert warning.message.endswith("it has no `<limit>`") and 'type="continuous"' in str(warning.help)


def test_joints_without_limits_are_one_warning(reader: Reader) -> None:
    joints = [joint(name, "base", name, '<limit effort="1"/>') for name in "abc"]
    read = reader("r.urdf", robot(link("base"), *map(link, "abc"), *joints))
    assert read.unit() is not None
    (warning,) = reported(read)
    assert [note.message.partition(":")[0] for note in warning.others] == ["`b`", "`c`"]


def test_mujoco_does_not_repeat_what_is_reported(reader: Reader) -> None:
    """MuJoCo 4 warns about equal ends at `<robot>`."""
    read = reader("r.urdf", limited('<limit lower="0" upper="0"/>'))
    assert read.unit() is not None
    assert [each.code for each in read.sink.sorted() if each.code != "urdf-unread"] == ["urdf-limits"]


@pytest.mark.parametrize("kind", ["continuous", "fixed"])
def test_other_types_need_no_limits(reader: Reader, kind: str) -> None:
    read = reader("r.urdf", limited('<limit effort="5"/>', kind))
    assert read.unit() is not None and not reported(read)
