"""The records of the parts say where MuJoCo has them, and which of them cannot be compared with their sources."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from composer.context import Context
from composer.plan.part_record import IN_PLACE, PartRecord
from composer.stages import Request, build

PART = """<mujoco><worldbody><site name="origin"/>
  <body name="b" pos=".1 .2 .3" euler="10 20 30"><geom size=".1"/><site name="s" pos="0 0 .5" euler="0 40 0"/></body>
</worldbody><keyframe><key name="home"/></keyframe></mujoco>"""
INNER = """recipe: 1
base: ./p.xml
attach:
  tool: {model: ./p.xml, site: s, pos: [0, 0, 1], euler: [30deg, 0, 0], keyframes: prefix}
add: [{to: b, frame: {name: mount, pos: [1, 0, 0], euler: [0, 0, 50deg]}}]
"""


def made(folder: Path, recipe: str) -> tuple[dict[str, PartRecord], mujoco.MjModel]:
    (folder / "p.xml").write_text(PART)
    (folder / "inner.yaml").write_text(INNER)
    (folder / "r.yaml").write_text(f"recipe: 1\n{recipe}")
    context = Context(environment={}, folder=folder)
    built = build(Request(folder / "r.yaml", verified=False), context)
    assert built is not None, context.sink.errors
    model = mujoco.MjModel.from_xml_string(built.bundle.files["model.xml"].decode())
    return {each.part: each for each in built.composed.members}, model


@pytest.mark.parametrize(
    "place",
    [
        "pos: [1, 2, 3], euler: [0, 0, 90deg]",
        "frame: stand/mount",
        "frame: stand/tool/nest, pos: [0, 1, 0]",
        "joint: free",
    ],
)
def test_the_pose_of_a_part_is_where_its_world_is(tmp_path: Path, place: str) -> None:
    nest = "add: [{to: stand/tool/b, frame: {pos: [0, 0, 2], euler: [20deg, 0, 0], frame: {name: stand/tool/nest, euler: [0, 60deg, 0]}}}]\n"
    recipe = f"attach:\n  stand: {{model: ./inner.yaml}}\n  a: {{model: ./inner.yaml, {place}}}\n{nest}"
    found, model = made(tmp_path, recipe)
    mujoco.mj_kinematics(model, data := mujoco.MjData(model))
    assert [*found] == ["stand/base", "stand/tool", "a/base", "a/tool"]
    for record in found.values():
        body = model.body(record.body).id if record.body else 0
        assert record.pose is not None and record.obscure is None
        turn = data.xmat[body].reshape(3, 3)
        where = data.site(f"{record.prefix}origin").xpos
        assert np.allclose(turn @ record.pose.pos + data.xpos[body], where)
        quat = np.zeros(4)
        mujoco.mju_mulQuat(quat, data.xquat[body], np.array(record.pose.quat))
        own = np.zeros(4)
        mujoco.mju_mat2Quat(own, data.site(f"{record.prefix}origin").xmat)
        assert np.isclose(abs(quat @ own), 1)


@pytest.mark.parametrize(
    ("policy", "keys"), [("merge", ["", "tool/"]), ("prefix", ["a/", "a/tool/"]), ("none", [None, None])]
)
def test_keys_begin_as_all_recipes_around_them_say(
    tmp_path: Path, policy: str, keys: list[str | None]
) -> None:
    found, _ = made(tmp_path, f"attach: {{a: {{model: ./inner.yaml, keyframes: {policy}}}}}\n")
    assert [found[part].keys for part in ("a/base", "a/tool")] == keys


def test_a_part_of_a_recipe_of_which_one_body_is_taken_is_not_compared(tmp_path: Path) -> None:
    found, _ = made(tmp_path, "attach: {a: {model: ./inner.yaml, subtree: b}}\n")
    assert {each.obscure for each in found.values()} == {"only its body `b` was taken"}
    found, _ = made(tmp_path, "base: {model: ./inner.yaml, subtree: b}\n")
    assert {each.obscure for each in found.values()} == {"only its body `b` was taken"}
    found, _ = made(tmp_path, "attach: {a: {model: ./p.xml, subtree: b}}\n")
    assert (found["a"].obscure, found["a"].subtree) == (None, "b")


@pytest.mark.parametrize("inside", ['<frame name="f" pos="0 0 1"/>', '<frame><frame name="f"/></frame>'])
def test_a_part_in_a_replicate_has_no_single_pose(tmp_path: Path, inside: str) -> None:
    base = f'<frame pos="0 0 5"><replicate count="2" offset="1 0 0">{inside}</replicate></frame>'
    (tmp_path / "base.xml").write_text(f"<mujoco><worldbody>{base}</worldbody></mujoco>")
    found, model = made(tmp_path, "base: ./base.xml\nattach: {a: {model: ./p.xml, frame: f}}\n")
    assert model.site("a/origin0").pos[0] != model.site("a/origin1").pos[0]
    assert (found["a"].pose, found["base"].pose) == (None, IN_PLACE)
