"""The quick way to a model's text says what the linker says, or leaves it to the linker."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose import mjcf
from mjcompose.base.sink import Sink
from mjcompose.link.defaults import choose_classes
from mjcompose.link.link import finish, link
from mjcompose.link.linking import Linking
from mjcompose.mjcf import flat
from mjcompose.mjcf.flat import copy_unit, label, link_checked, name_files, relocated_text
from mjcompose.tree.xml_text import to_text

Compiled = Callable[[mjcf.RootElement], mujoco.MjModel]


def test_writing_leaves_the_model_as_it_is(arm: mjcf.RootElement, gripper: mjcf.RootElement) -> None:
    arm.find("site", "flange").attach(gripper)  # type: ignore[union-attr]
    before = [repr(each) for tag in ("body", "geom", "joint", "mesh") for each in arm.find_all(tag)]
    assert arm.to_xml_string() == arm.to_xml_string()
    assert [repr(each) for tag in ("body", "geom", "joint", "mesh") for each in arm.find_all(tag)] == before
    assert [repr(each) for each in gripper.find_all("key")] == ['<key name="open" qpos="0.03 0.03" ctrl="0.03"/>']


def test_each_part_means_what_it_means_alone(
    arm: mjcf.RootElement, gripper: mjcf.RootElement, compiled: Compiled
) -> None:
    alone = {"": compiled(arm), "gripper/": compiled(gripper)}
    arm.find("site", "flange").attach(gripper)  # type: ignore[union-attr]
    both = compiled(arm)
    for prefix, one in alone.items():
        for number in range(one.njnt):
            name = one.joint(number).name
            for field in ("range", "damping", "axis", "type", "pos"):
                found = getattr(both.joint(prefix + name), field)
                np.testing.assert_array_equal(found, getattr(one.joint(name), field))
        for number in range(one.ngeom):
            name = one.geom(number).name
            if name:
                np.testing.assert_array_equal(both.geom(prefix + name).friction, one.geom(name).friction)
        assert both.body(prefix + ("upper" if not prefix else "left")).quat.tolist() == (
            one.body("upper" if not prefix else "left").quat.tolist()
        )


def test_keys_come_along_under_the_prefix(arm: mjcf.RootElement, gripper: mjcf.RootElement, compiled: Compiled) -> None:
    arm.find("site", "flange").attach(gripper)  # type: ignore[union-attr]
    assert arm.find("key", "gripper/open").full_identifier == "gripper/open"  # type: ignore[union-attr]
    model = compiled(arm)
    assert model.key("home").qpos.tolist() == [0.1, 0.2, 0, 0]
    assert model.key("gripper/open").qpos.tolist() == [0, 0, 0.03, 0.03]
    assert model.key("gripper/open").ctrl.tolist() == [0, 0, 0.03]


def test_options_that_differ_are_an_error_until_it_is_said_what_holds(
    arm: mjcf.RootElement, gripper: mjcf.RootElement, compiled: Compiled
) -> None:
    arm.option.impratio = 1
    arm.option.cone = "pyramidal"
    gripper.option.impratio = 10
    gripper.option.cone = "elliptic"
    arm.attach(gripper)
    with pytest.raises(mjcf.MjcfError) as caught:
        arm.to_xml_string()
    assert [fault.code for fault in caught.value.diagnostics] == ["option-conflict"]
    assert "`conflict='base'`" in str(caught.value) and "recipe" not in str(caught.value)
    with pytest.warns(mjcf.MjcfWarning, match="the model's values stay") as told:
        text = arm.to_xml_string(conflict="base")
    assert len(told) == 1 and told[0].filename == __file__
    assert str(told[0].message).startswith(f"{__file__}:")
    assert mujoco.MjModel.from_xml_string(text, arm.assets).opt.impratio == 1
    with pytest.raises(mjcf.MjcfError):
        arm.to_xml_string(conflict="mujoco")
    arm.option.impratio = None
    arm.option.cone = None
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # nobody else writes them: the model takes them
        model = compiled(arm)
    assert model.opt.impratio == 10 and model.opt.cone == mujoco.mjtCone.mjCONE_ELLIPTIC
    assert mujoco.MjModel.from_xml_string(arm.to_xml_string(), arm.assets).opt.impratio == 10
    arm.option.impratio = 10
    arm.option.cone = "elliptic"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert compiled(arm).opt.impratio == 10
    with pytest.raises(mjcf.MjcfError, match="`conflict` is one of"):
        arm.to_xml_string(conflict="ignore")  # type: ignore[arg-type]


def test_what_mujoco_cannot_have_is_told_in_pythons_words(arm: mjcf.RootElement) -> None:
    cube = mjcf.RootElement("cube")
    body = cube.worldbody.add("body", name="cube")
    body.add("freejoint")
    body.add("geom", size=[0.1])
    arm.find("site", "flange").attach(cube)  # type: ignore[union-attr]
    with pytest.raises(mjcf.MjcfError, match="free joint at its root") as caught:
        arm.to_xml_string()
    (fault,) = caught.value.diagnostics
    assert fault.help == "remove the free joint, or attach the model to the worldbody"
    assert fault.span is not None and fault.span.file == __file__


def test_a_model_that_nothing_hangs_on_is_as_the_linker_leaves_it(
    arm: mjcf.RootElement, gripper: mjcf.RootElement
) -> None:
    for model in (arm, gripper):
        linking = Linking(copy_unit(model._model), [], Sink())
        choose_classes(linking)
        assert link(linking)
        finish(linking)
        assert not linking.sink.diagnostics
        assert model.to_xml_string() == to_text(linking.base.root)


def test_keys_that_do_not_fit_are_told_when_the_model_is_compiled() -> None:
    model = mjcf.from_xml_string(
        "<mujoco><worldbody><body><joint/><geom size='1'/></body></worldbody>\n"
        "<keyframe><key name='k' qpos='0 0'/></keyframe></mujoco>"
    )
    assert 'qpos="0 0"' in model.to_xml_string()
    with pytest.raises(mjcf.MjcfError, match="`qpos` of the key `k` has 2 numbers") as caught:
        model.compile_model()
    assert caught.value.diagnostics[0].span.line == 2  # type: ignore[union-attr]


def test_an_attached_model_is_written_by_itself_too(arm: mjcf.RootElement, gripper: mjcf.RootElement) -> None:
    alone = gripper.to_xml_string()
    arm.attach(gripper)
    assert gripper.to_xml_string() == alone


def test_what_only_mujoco_can_tell_is_asked(arm: mjcf.RootElement, gripper: mjcf.RootElement, folder: Path) -> None:
    gripper.compiler.boundmass = 0.5
    alone = mujoco.MjModel.from_xml_string(gripper.to_xml_string(), gripper.assets)
    arm.find("site", "flange").attach(gripper)  # type: ignore[union-attr]
    both = mujoco.MjModel.from_xml_string(arm.to_xml_string(), arm.assets)
    assert both.body("gripper/left").mass == alone.body("left").mass == 0.5
    assert both.body("fore").mass != 0.5


def test_files_of_models_without_a_name_have_a_folder(tmp_path: Path) -> None:
    (tmp_path / "m.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
    model = mjcf.RootElement("my model")
    model.asset.add("mesh", file=str(tmp_path / "m.obj"))
    assert list(model.assets) == ["assets/my_model/m.obj"]


def test_a_model_without_a_file_is_told_by_its_name() -> None:
    model = mjcf.RootElement("table")
    child = mjcf.RootElement("lamp")
    model.attach(child)
    child.keyframe.add("key", name="on", qpos=[1])
    with pytest.raises(mjcf.MjcfError, match="`qpos` of the key `on` has 1 numbers, and `lamp` takes 0"):
        model.to_xml_string()


@pytest.mark.mujoco4("keys of other lengths are refused")
def test_a_key_that_ends_within_a_joint_stays_as_it_is() -> None:
    model = mjcf.from_xml_string("""<mujoco><worldbody><body><freejoint/><geom size="1"/></body></worldbody>
      <keyframe><key name="up" qpos="0 0 1"/></keyframe></mujoco>""")
    assert model.assets == {}
    assert model.compile_model().model.key_qpos.tolist() == [[0, 0, 1, 1, 0, 0, 0]]


def test_the_text_is_linked_anew_after_any_edit() -> None:
    arm = mjcf.from_xml_string(
        '<mujoco model="arm"><option timestep="0.001"/><worldbody><body name="a"><geom name="g" size="1"/>'
        '<site name="one"/><site name="two"/></body></worldbody></mujoco>'
    )
    hand = mjcf.RootElement("hand")
    other = mjcf.RootElement("other")
    frame = arm.find("site", "one").attach(hand)
    geom = hand.worldbody.add("geom", name="g", size=[1])
    places = arm.worldbody.add("body", name="b")

    def hang_elsewhere() -> None:
        hand.detach()
        arm.find("site", "two").attach(hand)

    edits: list[Callable[[], object]] = [
        lambda: setattr(geom, "size", [2]),
        lambda: setattr(geom, "name", "h"),
        lambda: setattr(frame, "pos", [1, 2, 3]),
        lambda: frame.add("freejoint"),
        lambda: frame.all_children()[0].remove(),
        lambda: hand.worldbody.add("site", name="s"),
        lambda: arm.actuator.add("motor", site="hand/s"),
        lambda: setattr(hand, "model", "paw"),
        lambda: places.attach(other),
        lambda: other.worldbody.add("light"),
        lambda: other.compiler.__setattr__("angle", "radian"),
        hang_elsewhere,
        lambda: geom.remove(),
        lambda: other.detach(),
    ]
    before = arm.to_xml_string()
    for edit in edits:
        edit()
        after = arm.to_xml_string()
        arm._model.written = None
        assert after == arm.to_xml_string() == arm.to_xml_string()
        before = after
    assert before


def test_the_second_text_is_not_linked_and_has_the_same_warnings(monkeypatch: pytest.MonkeyPatch) -> None:
    arm, hand = (
        mjcf.from_xml_string(f'<mujoco model="{name}"><option timestep="{step}"/></mujoco>')
        for name, step in (("arm", 0.001), ("hand", 0.002))
    )
    arm.attach(hand)
    with pytest.warns(mjcf.MjcfWarning) as first:
        text = arm.to_xml_string(conflict="base")
    monkeypatch.setattr(flat, "link_checked", None)
    with pytest.warns(mjcf.MjcfWarning) as second:
        assert arm.to_xml_string(conflict="base") == text
    assert [str(each.message) for each in first] == [str(each.message) for each in second]
    with pytest.raises(TypeError):  # another policy is another text
        arm.to_xml_string(conflict="mujoco")


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


FOLDER = os.environ.get("MJCOMPOSE_CORPUS")

_QUICK = {
    "two compilers": "<mujoco><compiler meshdir='m'/><compiler angle='radian'/></mujoco>",
    "nothing": "<mujoco/>",
    "no files": "<mujoco><compiler angle='radian'/><worldbody><geom name='a' size='1'/></worldbody></mujoco>",
    "a folder": "<mujoco><compiler meshdir='m' angle='radian' assetdir='a'/><asset><mesh file='x.obj'/>"
    "<mesh file='in/y.obj'/><texture type='2d' file='z.png'/></asset></mujoco>",
    "text to escape": "<mujoco><!-- &lt; --><compiler texturedir='a&amp;\"&lt;' eulerseq='xyz'/>"
    "<asset><mesh name='&lt;&quot;&gt;' file='&amp;.obj'/></asset></mujoco>",
}
_LEFT = {
    "a comment like a file": "<mujoco><asset><!-- file=\"x\" --><mesh file='x.obj'/></asset></mujoco>",
    "a comment like a compiler": "<mujoco><!-- <compiler/> --><compiler meshdir='m' angle='radian'/></mujoco>",
    "a compiler of folders": "<mujoco><compiler meshdir='m'/></mujoco>",
    "a compiler with children": "<mujoco><compiler meshdir='m'><lengthrange/></compiler></mujoco>",
    "a compiler below": "<mujoco><option/><compiler angle='radian'/></mujoco>",
    "strippath": "<mujoco><compiler strippath='true'/><asset><mesh file='a/b.obj'/></asset></mujoco>",
    "a path to shorten": "<mujoco><asset><mesh file='../x.obj'/></asset></mujoco>",
    "one file name twice": "<mujoco><asset><mesh file='a/x.obj'/><mesh name='y' file='b/X.obj'/></asset></mujoco>",
    "sides": "<mujoco><asset><texture type='cube' fileright='r.png'/></asset></mujoco>",
    "an empty section": "<mujoco><visual><global/></visual></mujoco>",
}


def by_linker(root: mjcf.RootElement) -> str:
    flat = link_checked(root._model, "error", copy_unit, check_keys=False)
    name_files(flat)
    return to_text(flat.unit.root)


def quick(root: mjcf.RootElement) -> str | None:
    return relocated_text(root._model, label(root._model))


@pytest.mark.parametrize("xml", _QUICK.values(), ids=_QUICK)
def test_the_quick_text_is_the_linkers(xml: str) -> None:
    root = mjcf.from_xml_string(xml)
    assert quick(root) == by_linker(root) == root.to_xml_string()


@pytest.mark.parametrize("xml", _LEFT.values(), ids=_LEFT)
def test_what_is_more_than_a_folder_is_left_to_the_linker(xml: str) -> None:
    root = mjcf.from_xml_string(xml)
    assert quick(root) is None
    assert root.to_xml_string() == by_linker(root)


def test_models_with_parts_and_files_from_memory_are_left_to_the_linker() -> None:
    arm = mjcf.RootElement("arm")
    tool = mjcf.RootElement("tool")
    arm.attach(tool)
    assert quick(arm) is None and quick(tool) is not None
    tool.asset.add("mesh", name="m", file=mjcf.Asset(b"o m", ".obj", "m"))
    assert quick(tool) is None


def test_a_setting_that_is_written_later_counts() -> None:
    root = mjcf.from_xml_string(
        "<mujoco><compiler angle='radian' meshdir='m'/><asset><mesh file='a/x.obj'/></asset></mujoco>"
    )
    assert 'file="assets/unnamed_model/a/x.obj"' in root.to_xml_string()
    root.compiler.strippath = "true"
    assert quick(root) is None
    assert 'file="assets/unnamed_model/x.obj"' in root.to_xml_string()


@pytest.mark.skipif(FOLDER is None, reason="MJCOMPOSE_CORPUS is not set")
def test_real_models() -> None:
    assert FOLDER is not None
    taken = 0
    for path in sorted(Path(FOLDER, "models").glob("*/*.xml")):
        try:
            root = mjcf.from_path(path)
            expected = by_linker(root)
        except mjcf.MjcfError:
            continue
        found = quick(root)
        assert found in (None, expected), path
        taken += found is not None
    assert taken > 50
