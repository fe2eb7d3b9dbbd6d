from __future__ import annotations

import pytest

from composer import mjcf


def faults(model: mjcf.RootElement) -> list[str]:
    with pytest.raises(mjcf.MjcfError) as caught:
        model.to_xml_string()
    return [fault.message for fault in caught.value.diagnostics]


def test_every_loose_end_is_told_once(arm: mjcf.RootElement, gripper: mjcf.RootElement) -> None:
    arm.attach(gripper)
    for name in "ab":
        arm.actuator.add("motor", name=name, joint="elbw_joint")
    arm.worldbody.add("geom", size=[1], material="grye")
    gripper.sensor.add("touch", name="t", site="pinhc")
    assert sorted(faults(arm)) == [
        "`<geom>` refers to the material `grye`, which does not exist",
        "`<motor>` `a` refers to the joint `elbw_joint`, which does not exist",
        "`<touch>` `t` refers to the site `pinhc`, which does not exist",
    ]


def test_what_was_meant_is_said(arm: mjcf.RootElement, gripper: mjcf.RootElement) -> None:
    arm.attach(gripper)
    arm.actuator.add("motor", name="m", joint="left")
    with pytest.raises(mjcf.MjcfError, match="did you mean `gripper/left`"):
        arm.to_xml_string()


def test_what_a_class_refers_to_is_not_looked_up() -> None:
    model = mjcf.RootElement()
    model.default.geom.material = "nothing"
    model.to_xml_string()


def test_names_that_mujoco_makes_are_let_through() -> None:
    model = mjcf.RootElement("many")
    copies = model.worldbody.add("replicate", count=3, offset=[1, 0, 0], sep="_")
    copies.add("body", name="b").add("geom", name="g", size=[0.1])
    model.sensor.add("framepos", objtype="body", objname="b_2")
    model.to_xml_string()
    outer = mjcf.RootElement()
    outer.attach(model)
    outer.sensor.add("framepos", objtype="geom", objname="many/g_1")
    assert 'objname="many/g_1"' in outer.to_xml_string()


def test_many_referrers_are_counted() -> None:
    model = mjcf.RootElement()
    for _ in range(30):
        model.sensor.add("touch", site="s")
    with pytest.raises(mjcf.MjcfError) as caught:
        model.to_xml_string()
    notes = [note.message for note in caught.value.diagnostics[0].notes]
    assert len(notes) == 22 and notes[20] == "and 10 more" and notes[21] == "there are no sites"
