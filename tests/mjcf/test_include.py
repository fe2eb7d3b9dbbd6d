from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import mujoco
import pytest
from mjcompose import mjcf
from mjcompose.mjcf import MjcfError, MjcfWarning, RootElement

Compiled = Callable[[RootElement], mujoco.MjModel]


def _model(body: str, name: str = "m") -> RootElement:
    return mjcf.from_xml_string(f'<mujoco model="{name}">{body}</mujoco>')


def test_an_empty_model_becomes_the_other(arm: RootElement, compiled: Compiled) -> None:
    arm.keyframe.remove()
    model = mjcf.RootElement("new")
    model.include_copy(arm)
    assert model.model == "new"
    ours = compiled(model)
    theirs = compiled(arm)
    for name in ("body_pos", "body_inertia", "jnt_range", "dof_damping", "mesh_vert", "actuator_gainprm", "geom_rgba"):
        assert getattr(ours, name).tolist() == getattr(theirs, name).tolist(), name
    assert model.find("joint", "shoulder").origin == arm.find("joint", "shoulder").origin
    model.find("joint", "shoulder").name = "other"
    assert model.find("actuator", "shoulder").joint.name == "other"
    assert arm.find("joint", "shoulder") is not None


def test_files_of_two_folders(arm: RootElement, gripper: RootElement, compiled: Compiled) -> None:
    """Both have a `shell.stl`, in folders and with settings of their own."""
    gripper.find("mesh", "shell").name = "skin"
    arm.keyframe.remove()
    gripper.keyframe.remove()
    with pytest.warns(MjcfWarning, match="now applies to the elements of both"):
        arm.include_copy(gripper, override=True)
    assert arm.find("mesh", "skin").file.contents == gripper.find("mesh", "skin").file.contents
    assert arm.find("mesh", "shell").file.contents != arm.find("mesh", "skin").file.contents
    assert compiled(arm).nmesh == 2


def test_a_mesh_named_after_its_file_keeps_its_name(gripper: RootElement, folder: Path) -> None:
    model = mjcf.from_xml_string("<mujoco/>", base_dir=folder / "gripper")
    model.include_copy(gripper)
    assert model.find("geom").mesh is None
    assert [geom.mesh.name for geom in model.find_all("geom") if geom.mesh is not None] == ["shell"]


def test_names_that_are_taken_are_all_told_and_nothing_changes() -> None:
    model = _model('<worldbody><site name="s"/></worldbody><default><default class="c"/></default>', "one")
    before = model.to_xml_string()
    other = _model('<worldbody><site name="s"/></worldbody><default><default class="c"/></default>', "two")
    with pytest.raises(MjcfError, match="both `one` and `two` have a site `s`") as caught:
        model.include_copy(other)
    assert {each.code for each in caught.value.diagnostics} == {"name-clash", "class-clash"}
    assert model.to_xml_string() == before


def test_settings_that_differ() -> None:
    model = _model('<option timestep="0.001"/>', "one")
    other = _model('<option timestep="0.005" gravity="0 0 -1"><flag contact="disable"/></option>', "two")
    with pytest.raises(MjcfError, match="`option` has `timestep`, which is not the same in `one` and `two`") as caught:
        model.include_copy(other)
    assert [note.message for note in caught.value.diagnostics[0].notes] == ["`one` has `0.001`", "`two` has `0.005`"]
    model.include_copy(other, override=True)
    assert model.option.timestep == 0.005
    assert model.option.gravity.tolist() == [0, 0, -1]
    assert model.option.flag.contact == "disable"
    model.include_copy(_model('<option timestep="5e-3"/>'))


@pytest.mark.parametrize(
    "settings",
    ['<compiler angle="radian"/>', '<compiler autolimits="false"/>', '<default><geom density="5"/></default>'],
)
def test_a_setting_that_would_change_what_elements_mean(settings: str) -> None:
    geom = '<worldbody><geom size="1"/></worldbody>'
    for one, two in (("", settings), (settings, "")):
        model = _model(geom + one)
        other = _model(geom + two)
        with pytest.raises(MjcfError, match="is not the same in"):
            model.include_copy(other)
        mjcf.RootElement().include_copy(other)
        _model(one).include_copy(other)
    for winner, one, two in (("two", "", settings), ("one", settings, "")):
        model = _model(geom + one, "one")
        with pytest.warns(mjcf.MjcfWarning, match=f"the setting of `{winner}` now applies to the elements of both"):
            model.include_copy(_model(geom + two, "two"), override=True)
        assert len(model.find_all("geom")) == 2


def test_a_setting_that_both_write_is_not_lost_where_one_has_no_elements() -> None:
    geom = '<worldbody><geom size="1"/></worldbody>'
    for elements_of_one, elements_of_two in ((geom, ""), ("", geom), ("", "")):
        model = _model('<compiler boundmass="1"/>' + elements_of_one, "one")
        other = _model('<compiler boundmass="2"/>' + elements_of_two, "two")
        with pytest.raises(MjcfError, match="`compiler` has `boundmass`, which is not the same in `one` and `two`"):
            model.include_copy(other)
        assert model.compiler.boundmass == 1
        with pytest.warns(mjcf.MjcfWarning, match="the setting of `two` now applies"):
            model.include_copy(other, override=True)
        assert model.compiler.boundmass == 2


def test_attached_models_come_along(arm: RootElement, gripper: RootElement, compiled: Compiled) -> None:
    for each in (arm, gripper):
        each.keyframe.remove()
    frame = arm.find("site", "flange").attach(gripper)
    frame.add("joint", name="turn", type="hinge")
    hand = mjcf.from_xml_string('<mujoco model="hand"><worldbody><geom size="0.1"/></worldbody></mujoco>')
    arm.worldbody.attach(hand)
    model = mjcf.RootElement()
    model.include_copy(arm)
    assert [each.model for each in model.attached_models] == ["gripper", "hand"]
    assert gripper.parent_model is arm
    ours = compiled(model)
    theirs = compiled(arm)
    assert ours.njnt == theirs.njnt and ours.nbody == theirs.nbody
    joint = model.find("joint", "gripper/turn")
    assert model.compile_model().bind(joint).element_id == ours.joint("gripper/turn").id


def test_only_a_model_is_included(arm: RootElement) -> None:
    with pytest.raises(MjcfError, match="what is included is a `RootElement`, got `Worldbody`"):
        arm.include_copy(arm.worldbody)  # type: ignore[arg-type]
