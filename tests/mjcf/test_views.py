from __future__ import annotations

from composer import mjcf


def test_an_element_keeps_its_identity(arm: mjcf.RootElement) -> None:
    joint = arm.find("joint", "elbow_joint")
    assert joint is not None
    assert arm.find("joint", "elbow_joint") is joint
    assert joint.parent is arm.find("body", "fore") and joint.parent.joint[0] is joint
    assert joint.root is arm and arm.worldbody.parent is arm and arm.parent is None
    assert any(each is joint for each in arm.find_all("joint"))


def test_a_kind_of_element_has_one_class(arm: mjcf.RootElement) -> None:
    shoulder, elbow = arm.find_all("joint")
    assert type(shoulder) is type(elbow) is not type(arm.default.joint)
    assert type(shoulder).__name__ == "Joint" and isinstance(shoulder, mjcf.Element)
