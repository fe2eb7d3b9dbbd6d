from __future__ import annotations

import re
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose.base.rotation import Pose
from mjcompose.mujoco.engine import RequestLimits
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.tools.outline import (
    Body,
    Outline,
    OutlineJoint,
    OutlinePart,
    Place,
    as_data,
    outline,
    render,
    render_places,
)

ROOT = Path(__file__).resolve().parents[2]
MODEL = """\
<mujoco model="m">
  <compiler angle="{angle}" eulerseq="zyx"/>
  <default><default class="high"><site pos="0 0 0.5" euler="10 0 0"/></default><joint range="{range}"/></default>
  <worldbody>
    <site name="on_the_world" class="high"/>
    <frame name="turned" euler="{turn} 0 0" pos="1 0 0">
      <body name="a" pos="0 2 0">
        <joint name="hinge"/>
        <joint name="open" limited="false"/>
        <joint name="rail" type="slide" range="-0.1 0.2"/>
        <geom size="0.1"/>
        <frame pos="0 0 3"><site name="rod" type="capsule" size="0.01" fromto="0 0 0 0 1 1"/></frame>
        <replicate count="3"><body name="leaf"><geom size="0.1"/></body></replicate>
        <body><geom size="0.1"/></body>
      </body>
    </frame>
    <body name="loose"><freejoint/><geom size="0.1"/></body>
  </worldbody>
</mujoco>
"""


def read(text: str, folder: Path = ROOT) -> Outline:
    context = Context(folder=folder)
    found = outline(text, context)
    assert found is not None and not context.sink.diagnostics, context.sink.diagnostics
    return found


@pytest.mark.parametrize("recipe", ["two_arms", "gantry"])
def test_places_are_where_mujoco_has_them(recipe: str, tmp_path: Path) -> None:
    context = Context(folder=ROOT)
    built = build(ModelRequest(ROOT / "recipes" / f"{recipe}.yaml"), context, limits=RequestLimits(seconds=60))
    assert built is not None
    for path, content in built.bundle.files.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_bytes(content)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / built.bundle.model))
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    found = read(f"recipes/{recipe}.yaml")
    seen = 0
    for body in found.world.walk():
        for place in body.places:
            if place.kind != "frame":
                there = data.site(place.name) if place.kind == "site" else data.body(place.name)
                np.testing.assert_allclose(place.world.pos, there.xpos, atol=1e-9)
                turned = np.zeros(9)
                mujoco.mju_quat2Mat(turned, np.array(place.world.quat))
                np.testing.assert_allclose(turned, there.xmat, atol=1e-9)
                seen += 1
    assert seen > 5
    assert {body.name for body in found.bodies} == {model.body(i).name for i in range(1, model.nbody)}
    of_bundle = read(str(tmp_path))
    assert of_bundle.world.places == found.world.places
    assert [each.joints for each in of_bundle.bodies] == [each.joints for each in found.bodies]
    assert [each.name for each in of_bundle.parts] == [each.name for each in found.parts]


@pytest.mark.parametrize(
    ("angle", "range", "turn"),
    [("degree", "-90 45", "90"), ("radian", "-1.5707963267948966 0.7853981633974483", "1.5707963267948966")],
)
def test_a_model_by_itself(tmp_path: Path, angle: str, range: str, turn: str) -> None:
    (tmp_path / "m.xml").write_text(MODEL.format(angle=angle, range=range, turn=turn))
    found = read("m.xml", tmp_path)
    names = [(body.name, body.part, body.copies) for body in found.world.walk()]
    assert names == [("world", None, 1), ("a", None, 1), ("leaf", None, 3), (None, None, 1), ("loose", None, 1)]
    a = found.bodies[0]
    hinge, open_, rail = a.joints
    assert hinge.range == pytest.approx((-np.pi / 2, np.pi / 4)) and open_.range is None
    assert (rail.type, rail.range) == ("slide", (-0.1, 0.2))
    assert [joint.type for joint in found.bodies[-1].joints] == ["free"]
    assert [(place.kind, place.name) for place in a.places] == [("body", "a"), ("site", "rod")]
    assert [(place.kind, place.name) for place in found.world.places] == [("site", "on_the_world"), ("frame", "turned")]
    assert found.world.places[0].pose.pos == (0, 0, 0.5)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "m.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    np.testing.assert_allclose(a.places[0].world.pos, data.body("a").xpos, atol=1e-12)
    np.testing.assert_allclose(a.places[1].world.pos, data.site("rod").xpos, atol=1e-12)


def test_parts() -> None:
    found = read("recipes/two_arms.yaml")
    parts = {body.name: body.part for body in found.bodies}
    assert parts["left/base"] == "left" and parts["left/gripper/base"] == "left/gripper"
    listed = {each.name: each for each in found.parts}
    assert listed["left/gripper"].model == "recipes/models/gripper2/gripper2.xml"
    assert listed["left/gripper"].body == "left/gripper/sense"  # which `sense` puts below the flange
    flange = next(body for body in found.bodies if body.name == "left/flange")
    assert [body.name for body in flange.children] == ["left/gripper/sense"]


def test_what_the_recipe_adds_and_what_the_linker_makes(tmp_path: Path) -> None:
    (tmp_path / "cube.xml").write_text(
        '<mujoco><worldbody><body name="c"><geom size="0.1"/></body></worldbody></mujoco>'
    )
    (tmp_path / "r.yaml").write_text(
        "recipe: 1\nbase: ./cube.xml\nattach: {cube: {model: ./cube.xml, joint: free}}\n"
        "add: [{to: world, body: {name: box, geom: {size: [0.1]}}}]\n"
    )
    found = read("r.yaml", tmp_path)
    parts = [(body.name, body.part) for body in found.bodies]
    assert parts == [("c", "base"), ("cube/", "cube"), ("cube/c", "cube"), ("box", None)]


TURN = Pose((0.1, 0, 1 / 3), (0, 1, 0, 0))
HAND = Body(
    "hand/palm",
    "hand",
    (OutlineJoint("a", "slide", (-0.1, 0.1)), OutlineJoint(None, "hinge", (-1, 0.5))),
    (Place("site", "12", Pose(), TURN), Place("frame", "hand/f", Pose(), Pose())),
)
ARM = Body(
    "arm",
    "base",
    (OutlineJoint("pan", "free"),),
    (Place("body", "arm", Pose(), Pose()),),
    (HAND, Body(None, None, copies=4)),
)
ROBOT = Outline(
    "robot",
    "robot.yaml",
    Body("world", None, children=(ARM,)),
    (OutlinePart("base", "arm.xml"), OutlinePart("hand", "hand.xml", "arm")),
)


def test_the_tree() -> None:
    assert render(ROBOT).splitlines() == [
        "robot: 3 bodies, 3 joints, 2 parts",
        "  base  arm.xml",
        "  hand  hand.xml, on arm",
        "world",
        "└ arm   pan free",
        "  ├ hand/palm [hand]   a slide ±0.1 m, hinge -57.3…28.6°",
        "  └ (no name) ×4",
    ]


def test_depth_says_what_it_hides() -> None:
    assert render(ROBOT, 1).splitlines()[-2:] == ["└ arm   pan free", "  └ … 2 bodies, 2 joints below"]
    assert render(ROBOT, 2) == render(ROBOT)
    assert [each["name"] for each in as_data(ROBOT, 1)["bodies"]] == ["world", "arm"]


def test_places_are_lines_to_paste() -> None:
    lines = render_places(ROBOT).splitlines()
    assert [line.split()[:2] for line in lines[1:]] == [["site:", '"12"'], ["frame:", "hand/f"], ["body:", "arm"]]
    assert lines[1].split()[4:] == ["0.1", "0", "0.3333", "0", "1", "0", "0"]
    assert len(render_places(ROBOT, 1).splitlines()) == 2
    assert "nothing with a name" in render_places(Outline("x", "x.xml", Body("world", None)))


def test_colors_go_around_the_same_text() -> None:
    for paint in (render, render_places):
        colored = paint(ROBOT, None, True)
        assert colored != paint(ROBOT) and re.sub(r"\x1b\[[\d;]*m", "", colored) == paint(ROBOT)


@pytest.mark.parametrize(("count", "is_read"), [(496, True), (497, False), (1500, False)])
def test_the_tree_of_nested_bodies_ends_where_mujoco_does(tmp_path: Path, count: int, is_read: bool) -> None:
    bodies = "\n".join(f'<body name="b{number}"><geom size="1"/>' for number in range(count)) + "</body>" * count
    text = f"<mujoco>\n<worldbody>\n{bodies}</worldbody></mujoco>"
    (tmp_path / "deep.xml").write_text(text)
    if is_read:
        mujoco.MjModel.from_xml_string(text)
    else:
        with pytest.raises(ValueError, match="nesting is too deep"):
            mujoco.MjModel.from_xml_string(text)
    context = Context(folder=tmp_path, environment={})
    found = outline("deep.xml", context)
    if is_read:
        assert found is not None and len(found.bodies) == count
        assert render(found).count("\n") == count + 1 and as_data(found)
    else:
        assert found is None
        (fault,) = context.sink.errors
        assert fault.code == "mujoco-rejects" and fault.span is not None and fault.span.line == 499
