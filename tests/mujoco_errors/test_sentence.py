from __future__ import annotations

import pytest

from composer.mujoco_errors.sentence import Topic, read_sentence


@pytest.mark.parametrize(
    ("message", "topic"),
    [
        ("mass and inertia of moving bodies must be larger than mjMINVAL", Topic.MASS),
        ("size 0 must be positive in geom", Topic.GEOM_SIZE),
        ("size 1 must be positive in site", Topic.SIZE),
        ("inertia must satisfy A + B >= C; use 'balanceinertia' to fix", Topic.INERTIA),
        ("URDF body not found", Topic.URDF_RING),
        ("URDF body not found here", None),
        ("it is odd", None),
    ],
)
def test_what_it_is_about(message: str, topic: Topic | None) -> None:
    assert read_sentence(message).topic is topic


def test_what_it_names() -> None:
    said = read_sentence("Schema violation: unrecognized attribute: 'colour'")
    assert (said.unknown_attribute, said.attribute, said.names) == ("colour", None, ("colour",))
    assert read_sentence("required attribute missing: 'pos'").missing_attribute == "pos"
    assert read_sentence("URDF missing element: 'inertial'").missing_element == "inertial"
    assert read_sentence("size 2 must be positive in geom").size_index == 2
    assert read_sentence("mj_init failed for plugin id 3").plugin == 3
    assert read_sentence("could not allocate arena memory").section == "size"
