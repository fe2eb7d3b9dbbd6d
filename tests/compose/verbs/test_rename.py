"""The verb `rename`: every reference follows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from compose.arm import Case
from link.test_files import skin
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context


def test_every_reference_follows_a_rename(radian: Case, own: bool) -> None:
    edits = (
        "{select: {joint: elbow}, rename: bend}, {select: {body: '*'}, rename: 'b_${name}'},"
        "{select: {site: tip}, rename: tool}, {select: {material: steel}, rename: iron},"
        "{select: {default: link}, rename: limb}, {select: {actuator: a2}, rename: drive}"
    )
    before = radian.model("recipe: 1\nbase: ./arm.xml\n")
    after = radian.edited(edits, own)
    assert after.joint("bend").range == pytest.approx(before.joint("elbow").range)
    for array in ("actuator_trnid", "sensor_objid", "geom_matid", "exclude_signature", "key_qpos", "dof_damping"):
        assert np.array_equal(getattr(before, array), getattr(after, array))
    assert after.actuator("drive").trnid[0] == after.joint("bend").id


def test_two_names_may_change_places(radian: Case) -> None:
    before = radian.model("recipe: 1\nbase: ./arm.xml\n")
    after = radian.edited(
        "{select: {joint: '{shoulder,elbow}'}, rename: \"${'elbow' if name == 'shoulder' else 'shoulder'}\"}"
    )
    assert after.joint("elbow").id == before.joint("shoulder").id
    assert np.array_equal(after.actuator_trnid, before.actuator_trnid)


def test_a_bone_keeps_the_name_of_its_body_when_a_geom_of_that_name_is_renamed(tmp_path: Path) -> None:
    (tmp_path / "coat.skn").write_bytes(skin("trunk"))
    puppet = """<mujoco><asset><skin name="coat" file="coat.skn"/></asset>
    <worldbody><body name="trunk"><geom name="trunk" size=".1"/></body></worldbody></mujoco>"""
    (tmp_path / "arm.xml").write_text(puppet)

    def bones(selected: str) -> bytes:
        recipe = f"recipe: 1\nbase: ./arm.xml\nedit: [{{select: {{{selected}: trunk}}, rename: chest}}]\n"
        (tmp_path / "recipe.yaml").write_text(recipe)
        built = build(ModelRequest(tmp_path / "recipe.yaml", verified=False), Context(environment={}, folder=tmp_path))
        assert built is not None
        (coat,) = [content for path, content in built.bundle.files.items() if path.endswith(".skn")]
        return coat

    assert bones("body") == skin("chest")
    assert bones("geom") == skin("trunk")


def test_copies_of_a_replicate_are_renamed(tmp_path: Path) -> None:
    text = (
        '<mujoco><worldbody><replicate count="3" offset="1 0 0"><body name="b"><joint name="j"/><geom size=".1"/></body></replicate>'
        '</worldbody><actuator><motor name="m" joint="j2"/></actuator></mujoco>'
    )
    model = Case(tmp_path, text).edited("{select: {joint: j}, rename: wheel}")
    assert model.actuator("m").trnid[0] == model.joint("wheel2").id == 2


def test_who_refers_may_be_renamed_with_what_it_refers_to(radian: Case) -> None:
    before = radian.model("recipe: 1\nbase: ./arm.xml\n")
    after = radian.edited("{select: {joint: '*'}, rename: 'x_${name}'}, {select: {actuator: '*'}, rename: 'x_${name}'}")
    assert after.actuator("x_a2").trnid[0] == after.joint("x_elbow").id
    assert np.array_equal(after.actuator_trnid, before.actuator_trnid)
