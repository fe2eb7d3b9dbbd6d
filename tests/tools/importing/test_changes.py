"""Changed models: the recipe that `import` writes builds the changed model again, as MuJoCo itself says."""

from __future__ import annotations

import re
from collections import defaultdict
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from mjcompose.bundle.staging import write_files
from mjcompose.contrast.changes import FieldChange
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.tools.importing.elements import ChangedAttribute
from mjcompose.tools.importing.recover import Recovered, RecoveryDifferences, changed, left, recover

ARM = """\
<mujoco model="arm">
  <compiler angle="degree"/>
  <default>
    <geom friction="0.9 0.005 0.0001"/>
    <default class="link"><geom rgba="0.2 0.3 0.4 1" density="700"/><joint damping="2" armature="0.01"/></default>
  </default>
  <asset>
    <texture name="grid" type="2d" builtin="checker" width="8" height="8" rgb1="1 0 0" rgb2="0 1 0"/>
    <material name="steel" texture="grid" shininess="0.25"/>
    <mesh name="wedge" vertex="0 0 0 0.1 0 0 0 0.1 0 0 0 0.1"/>
  </asset>
  <worldbody>
    <light pos="0 0 3"/>
    <geom name="floor" type="plane" size="1 1 0.1"/>
    <body name="base" childclass="link">
      <geom type="box" size="0.1 0.1 0.1" material="steel"/>
      <geom type="mesh" mesh="wedge" pos="0 0 0.2"/>
      <body name="upper" pos="0 0 0.5" euler="0 30 0">
        <joint name="shoulder" axis="0 1 0" range="-60 60"/>
        <geom type="capsule" fromto="0 0 0 0 0 0.3" size="0.02"/>
        <geom name="rod" type="capsule" fromto="0 0.1 0 0 0.1 0.3" size="0.01"/>
        <body name="lower" pos="0 0 0.3">
          <joint name="elbow" axis="0 1 0" range="-90 90" ref="10"/>
          <joint name="twist" axis="0 0 1" range="-90 90"/>
          <geom type="capsule" fromto="0 0 0 0 0 0.2" size="0.02"/>
          <site name="flange" pos="0 0 0.2" euler="0 0 90"/>
        </body>
      </body>
    </body>
  </worldbody>
  <equality><joint joint1="elbow" joint2="twist" polycoef="0 0.5 0 0 0"/></equality>
  <actuator>
    <position name="shoulder" joint="shoulder" kp="50" ctrlrange="-60 60"/>
    <motor joint="elbow" gear="5"/>
  </actuator>
  <sensor><jointpos joint="elbow"/></sensor>
  <keyframe><key name="home" qpos="0.1 0.2 0.3" ctrl="0.1 0"/></keyframe>
</mujoco>
"""
TOOL = """\
<mujoco model="tool">
  <default><default class="pad"><geom friction="2 0.01 0.001" solref="0.01 1"/></default></default>
  <asset><material name="rubber" rgba="0.1 0.1 0.1 1"/></asset>
  <worldbody>
    <body name="palm">
      <geom name="palm" type="box" size="0.03 0.03 0.01"/>
      <body name="left" pos="0 0.02 0.02"><joint name="left" type="slide" axis="0 1 0" range="0 0.02"/>
        <geom class="pad" type="box" size="0.01 0.002 0.01" material="rubber"/></body>
      <body name="right" pos="0 -0.02 0.02"><joint name="right" type="slide" axis="0 -1 0" range="0 0.02"/>
        <geom class="pad" type="box" size="0.01 0.002 0.01" material="rubber"/></body>
    </body>
  </worldbody>
  <actuator><position joint="left" kp="100"/></actuator>
</mujoco>
"""


@pytest.fixture(scope="module")
def merged() -> str:
    """The arm with the tool, as MuJoCo attaches and writes it: in radians, with six digits, other classes."""
    arm = mujoco.MjSpec.from_string(ARM)
    tool = mujoco.MjSpec.from_string(TOOL)
    arm.attach(tool, prefix="tool_", site=arm.site("flange"))
    arm.compile()
    text: str = arm.to_xml()
    # MuJoCo 4.0 writes a class here that it does not declare. 3.12 writes none, so that the tool would be in the class of
    # the arm: its palm weighs 50 g in what is written, and 72 g in what was compiled.
    text = text.replace('childclass="main"', 'childclass="tool_main"')
    return re.sub(r'<body name="tool_palm"(?! childclass)', '<body name="tool_palm" childclass="tool_main"', text)


def imported(folder: Path, merged: str) -> Recovered:
    for name, text in (("arm", ARM), ("tool", TOOL), ("all", merged)):
        (folder / f"{name}.xml").write_text(text)
    context = Context(folder=folder)
    found = recover(folder / "all.xml", [folder / "arm.xml", folder / "tool.xml"], folder / "all.yaml", context)
    assert found is not None and not context.sink.diagnostics
    return found


def physics(model: Any) -> dict[str, list[list[float]]]:
    """What a model does, whatever its elements are called and in whichever order they stand."""
    owners = {
        "body": ("body_mass", "body_inertia", "body_pos", "body_quat", "body_gravcomp"),
        "jnt": ("jnt_type", "jnt_range", "jnt_axis", "jnt_stiffness", "jnt_limited"),
        "dof": ("dof_damping", "dof_armature", "dof_frictionloss"),
        "geom": (
            "geom_type",
            "geom_size",
            "geom_pos",
            "geom_quat",
            "geom_friction",
            "geom_solref",
            "geom_rgba",
            "geom_condim",
        ),
        "site": ("site_pos", "site_quat", "site_size"),
        "mat": ("mat_rgba", "mat_shininess", "mat_texrepeat"),
        "tex": ("tex_type", "tex_width", "tex_nchannel"),
        "mesh": ("mesh_scale", "mesh_vertnum"),
        "eq": ("eq_type", "eq_data", "eq_solref", "eq_active0"),
        "actuator": (
            "actuator_gainprm",
            "actuator_biasprm",
            "actuator_ctrlrange",
            "actuator_gear",
            "actuator_forcerange",
        ),
        "sensor": ("sensor_type", "sensor_cutoff"),
        "key": ("key_qpos", "key_ctrl", "key_time"),
        "pair": ("pair_friction", "pair_solref"),
        "exclude": (),
        "light": ("light_pos", "light_dir"),
        "cam": ("cam_pos", "cam_fovy"),
    }
    found: dict[str, list[list[float]]] = defaultdict(list)
    for kind, arrays in owners.items():
        count = model.nv if kind == "dof" else len(getattr(model, f"name_{kind}adr"))
        for index in range(count):
            values = {array: np.ravel(getattr(model, array)[index]) for array in arrays}
            # Of actuators that stand in another order, so do the controls.
            row = [
                float(each)
                for array, numbers in values.items()
                for each in (sorted(numbers) if array == "key_ctrl" else numbers)
            ]
            found[kind].append(row)
    option = [model.opt.timestep, *model.opt.gravity, model.opt.integrator, model.opt.cone, model.opt.impratio]
    found["option"].append([float(each) for each in option])
    return found


def assert_same(one: Any, other: Any) -> None:
    mine = physics(one)
    theirs = physics(other)
    for kind, rows in mine.items():
        assert len(rows) == len(theirs[kind]), kind
        left = list(theirs[kind])
        for row in rows:
            near = next((each for each in left if np.allclose(row, each, rtol=2e-5, atol=2e-6)), None)
            assert near is not None, (kind, row, left)
            left.remove(near)


def assert_builds_the_same(found: Recovered, folder: Path) -> None:
    assert found.outcome is not None and found.outcome.same, found.outcome
    assert found.bundle is not None
    (folder / "built").mkdir()
    write_files(found.bundle, folder / "built")
    assert_same(
        mujoco.MjModel.from_xml_path(str(folder / "all.xml")),
        mujoco.MjModel.from_xml_path(str(folder / "built" / found.bundle.model)),
    )


def test_what_mujoco_wrote_in_other_words_is_no_edit(merged: str, tmp_path: Path) -> None:
    found = imported(tmp_path, merged)
    assert_builds_the_same(found, tmp_path)
    assert "edit:" not in found.text and "add:" not in found.text and "actuator:" not in found.text
    assert not found.proposal.changed


CHANGES = {
    "joint range": (r'(<joint name="elbow"[^>]*?)range="[^"]*"', r'\1range="-1 1"', "{joint: elbow}, set: {range: [-1, 1]}"),
    "named geom": (r'(<geom name="rod")', r'\1 condim="6"', "{geom: rod}, set: {condim: 6}"),
    "unnamed geom": (r'(<geom (?=[^>]*type="mesh"))', r'\1group="4" ', 'where: "${index == 1}"'),
    "class": (r'damping="2"', 'damping="3"', "{select: {default: link}, set: {joint: {damping: [3]}}}"),
    "class of a part": (r'friction="2 0.01 0.001"', 'friction="1.5 0.01 0.001"', "{default: tool_pad}, set: {geom: {friction: [1.5"),
    "material": (r'shininess="0.25"', 'shininess="0.75"', "{material: steel}, set: {shininess: 0.75}"),
    "material of a part": (r'(<material name="tool_rubber" )rgba="[^"]*"', r'\1rgba="1 0 0 1"', "{material: tool_rubber}"),
    "mesh": (r'(<mesh name="wedge")', r'\1 scale="1.1 1.1 1.1"', "{select: {mesh: wedge}, set: {scale: [1.1, 1.1, 1.1]}}"),
    "texture": (r'builtin="checker"', 'builtin="gradient"', "{select: {texture: grid}, set: {builtin: gradient}}"),
    "gain": (r'biasprm="0 -100"', 'biasprm="0 -100 -3"', 'general_1: {name: ""'),
    "kind of actuator": (
        r'<general name="shoulder" joint="shoulder"[^>]*/>',
        '<motor name="shoulder" joint="shoulder" gear="3"/>',
        "{select: {actuator: shoulder_new_1}, rename: shoulder}",
    ),
    "option": (r"<worldbody>", '<option gravity="0 0 -1.6" cone="elliptic"/><worldbody>', "option: {gravity: [0, 0, -1.6], cone: elliptic}"),
    "visual": (r"<worldbody>", '<visual><map znear="0.1"/></visual><worldbody>', "visual: {map: {znear: 0.1}}"),
    "statistic": (r"<worldbody>", '<statistic extent="3"/><worldbody>', "statistic: {extent: 3}"),
    "total mass": (r"<compiler ", '<compiler settotalmass="5" ', "compiler: {settotalmass: 5}"),
    "equality added": (r"</equality>", '<connect body1="upper" body2="tool_palm" anchor="0 0 0"/></equality>', """connect_1: {name: "", xml: '<connect"""),
    "actuator added": (r"</actuator>", '<motor joint="twist" gear="2"/></actuator>', 'motor_1: {name: ""'),
    "sensor added": (r"</sensor>", '<jointvel joint="twist"/></sensor>', 'jointvel_1: {name: ""'),
    "exclude added": (r"<equality>", '<contact><exclude body1="upper" body2="tool_left"/></contact><equality>', "exclude:"),
    "pair added": (r"<equality>", '<contact><pair geom1="rod" geom2="tool_palm" condim="1"/></contact><equality>', "pair:"),
    "geom added": (r"(<body name=\"lower\"[^>]*>)", r'\1<geom type="sphere" size="0.05" pos="0 0.1 0"/>', "{to: lower, xml: '<geom"),
    "site added": (r"(<body name=\"lower\"[^>]*>)", r'\1<site pos="0 0.1 0"/>', "{to: lower, xml: '<site"),
    "texture added": (r"</asset>", '<texture type="skybox" builtin="flat" rgb1="0 0 1" width="8" height="8"/></asset>', 'skybox: {name: "", type: skybox'),
    "geom removed": (r'<geom name="rod"[^>]*/>', "", "{select: {geom: rod}, remove: true}"),
    "unnamed geom removed": (r'<geom (?=[^>]*type="mesh")[^>]*/>', "", 'where: "${index == 1}"}, remove: true}'),
    "equality removed": (r"<equality>.*?</equality>", "", "remove: true"),
    "geom renamed": (r'name="rod"', 'name="bar"', "{select: {geom: rod}, rename: bar}"),
    "joint renamed": (r'"shoulder"(?=[^>]*?/>)', '"pan"', "{select: {joint: shoulder}, rename: pan}"),
    "body renamed": (r'"lower"', '"forearm"', "{select: {body: lower}, rename: forearm}"),
    "key changed": (r'(<key name="home" )qpos="[^"]*"', r'\1qpos="0.1 0.25 0.3 0 0"', "elbow: [0.25]"),
    "body moved": (r'(<body name="upper" )pos="0 0 0.5"', r'\1pos="0 0 0.6"', "{select: {body: upper}"),
}  # fmt: skip


@pytest.mark.parametrize("change", CHANGES)
def test_a_change_is_in_the_recipe(change: str, merged: str, tmp_path: Path) -> None:
    old, new, said = CHANGES[change]
    text, times = re.subn(old, new, merged, flags=re.S)
    assert times and text != merged
    mujoco.MjModel.from_xml_string(text)
    found = imported(tmp_path, text)
    assert said in found.text, found.text
    assert_builds_the_same(found, tmp_path)
    if found.proposal.changed:
        assert all("→" in line for line in changed(found.proposal.changed))


def test_a_key_without_a_name_is_a_comment(merged: str, tmp_path: Path) -> None:
    found = imported(tmp_path, merged.replace('<key name="home"', "<key"))
    assert "# not expressed: a key without a name, which a recipe cannot write" in found.text
    assert found.outcome is not None and "keyframe #0 is missing" in left(found.outcome, "all.xml")


def test_what_differs_is_told_in_sentences() -> None:
    outcome = RecoveryDifferences(
        (
            FieldChange("removed", "equality", "#0 (`a`, `b`)"),
            FieldChange("changed", "joint", "elbow", "dof_damping", 2.0, 3.0, "hinge"),
            FieldChange("changed", "geom", "pad", "geom_rbound", 1.0, 2.0, follows=True),
            FieldChange("changed", "body", "palm", "body_invweight0", (1.0, 1.0), (2.0, 2.0), follows=True),
        )
    )
    assert list(left(outcome, "all.xml")) == [
        "equality #0 (`a`, `b`) is missing",
        "damping of joint `elbow`: 3 N·m·s/rad, in all.xml it is 2 N·m·s/rad",
        "2 numbers that MuJoCo computes from these differ too",
    ]


def test_what_changed_is_told_once() -> None:
    facts = (
        ChangedAttribute("mesh", "elbow", "scale", "1 1 1", "1.1 1.1 1.1"),
        ChangedAttribute("joint", "a", "damping", "1", "2", "N·m·s/rad"),
        ChangedAttribute("joint", "b", "damping", "1", "2", "N·m·s/rad"),
        ChangedAttribute("default class", "pad", "geom friction", None, "1.5", count=4),
    )
    assert list(changed(facts)) == [
        "mesh `elbow`: scale 1 1 1 → 1.1 1.1 1.1",
        "2 joints `a`, `b`: damping 1 N·m·s/rad → 2 N·m·s/rad",
        "default class `pad`: geom friction none → 1.5 (4 elements)",
    ]


def test_progress_is_heard(merged: str, tmp_path: Path) -> None:
    for name, text in (("arm", ARM), ("tool", TOOL), ("all", merged)):
        (tmp_path / f"{name}.xml").write_text(text)
    heard: list[str] = []
    files = [tmp_path / f"{name}.xml" for name in ("all", "arm", "tool")]
    recover(files[0], files[1:], tmp_path / "all.yaml", Context(folder=tmp_path), heard.append)
    assert heard == ["compiling all.xml and its parts", "trying the recipe"]


PAIRS = {
    "ur5e and 2f85": ("universal_robots_ur5e/ur5e", "robotiq_2f85/2f85", "attachment_site"),
    "xarm7 and hand": ("ufactory_xarm7/xarm7_nohand", "ufactory_xarm7/hand", "attachment_site"),
}


REAL: dict[str, tuple[tuple[str, str], ...]] = {
    "nothing": (),
    "mesh class": ((r'(<mesh (?:class="[^"]*" )?)(?=[^>]*name="[^"]*base)', r'\1refpos="0 0 0.001" '),),
    "equality": ((r"<worldbody>", '<equality><joint joint1="{0}" joint2="{1}"/></equality><worldbody>'),),
    "geom": ((r'(<body name="[^"]*2[^"]*"[^>]*>)', r'\1<geom type="sphere" size="0.02" pos="0 0 0.1"/>'),),
}


@pytest.mark.slow
@pytest.mark.parametrize("pair", PAIRS)
def test_real_models_that_were_changed(pair: str, corpus: Path, tmp_path: Path) -> None:
    base, part, site = PAIRS[pair]
    files = [corpus / "models" / f"{name}.xml" for name in (base, part)]
    (tmp_path / "cell.yaml").write_text(
        f"recipe: 1\nconflict: mujoco\nbase: {files[0]}\nattach: {{tool: {{model: {files[1]}, site: {site}}}}}\n"
    )
    built = build(ModelRequest(tmp_path / "cell.yaml"), Context(folder=tmp_path))
    assert built is not None
    (tmp_path / "cell").mkdir()
    write_files(built.bundle, tmp_path / "cell")
    text = (tmp_path / "cell" / "model.xml").read_text()
    joints = re.findall(r'<joint [^>]*name="([^"]*)"', text)
    for name, changes in REAL.items():
        changed_text = text
        for old, new in changes:
            new = new.format(*joints) if "{" in new else new
            changed_text, times = re.subn(old, new, changed_text, count=1)
            assert times, name
        (tmp_path / "cell" / "all.xml").write_text(changed_text)
        found = recover(tmp_path / "cell" / "all.xml", files, tmp_path / "all.yaml", Context(folder=tmp_path))
        assert found is not None and found.outcome is not None and found.outcome.same, (name, found)
        assert not any(entry.note for entry in found.proposal.entries), name
        if not changes:
            assert "edit:" not in found.text
