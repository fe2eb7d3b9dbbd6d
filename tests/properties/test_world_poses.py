"""Fused bodies, copies and gravity compensation: every named thing of a part stands in the world as the mount puts it.

Poses in the world are another judge than the arrays that `unchanged` compares, which are relative to bodies.
"""

from __future__ import annotations

import os
from pathlib import Path
from random import Random

import mujoco
import numpy as np
import pytest
from properties.test_unchanged import composed

SEEDS = int(os.environ.get("MJCOMPOSE_EXAMPLES", "20"))
BASE = """
<mujoco><worldbody><body name="hub" pos="0 0 1" euler="10 20 30"><joint/><geom size=".1"/>
  <site name="mount" pos=".1 .1 .1" euler="30 40 50"/></body></worldbody></mujoco>
"""
KINDS = {
    "body": (mujoco.mjtObj.mjOBJ_BODY, "nbody", "xpos", "xmat"),
    "site": (mujoco.mjtObj.mjOBJ_SITE, "nsite", "site_xpos", "site_xmat"),
    "geom": (mujoco.mjtObj.mjOBJ_GEOM, "ngeom", "geom_xpos", "geom_xmat"),
}
Poses = dict[tuple[str, str], tuple[np.ndarray, np.ndarray]]


def _body(random: Random, depth: int, names: list[int]) -> str:
    names.append(len(names))
    number = names[-1]
    turned = f'euler="{random.randint(-90, 90)} {random.randint(-90, 90)} {random.randint(-90, 90)}"'
    joint = f'<joint name="j{number}"/>' if random.random() < 0.3 else ""
    floats = f'gravcomp="{random.choice((0.5, 1))}"' if random.random() < 0.5 else ""
    inner = "".join(_body(random, depth + 1, names) for _ in range(2) if depth < 3 and random.random() < 0.6)
    text = (
        f'<body name="b{number}" pos="{random.random():.2f} 0 .1" {turned} {floats}>{joint}'
        f'<geom name="g{number}" size=".05" pos=".1 0 0"/><site name="s{number}" pos="0 .1 .2" {turned}/>{inner}</body>'
    )
    wrapped = random.random()
    if wrapped < 0.2:
        return f'<frame pos=".1 .2 .3" {turned}>{text}</frame>'
    return f'<replicate count="2" offset=".5 0 0">{text}</replicate>' if wrapped < 0.3 else text


def _part(random: Random) -> str:
    settings = 'fusestatic="true"' if random.random() < 0.6 else ""
    bodies = _body(random, 0, [])
    return f'<mujoco><compiler {settings}/><worldbody><site name="w" pos="1 0 0"/>{bodies}</worldbody></mujoco>'


def _poses(model: mujoco.MjModel) -> Poses:
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    found: Poses = {}
    for kind, (obj, count, positions, matrices) in KINDS.items():
        for index in range(getattr(model, count)):
            name = mujoco.mj_id2name(model, obj, index)
            if name and name != "world":
                found[kind, name] = (getattr(data, positions)[index], getattr(data, matrices)[index].reshape(3, 3))
    return found


@pytest.mark.parametrize("seed", range(SEEDS))
def test_all_that_has_a_name_stands_where_the_mount_puts_it(tmp_path: Path, seed: int) -> None:
    random = Random(seed)
    (tmp_path / "base.xml").write_text(BASE)
    (tmp_path / "p.xml").write_text(_part(random))
    place = random.choice(("", "site: mount, ", "body: hub, "))
    offset = "pos: [.3, .1, .2], euler: [20deg, 30deg, 40deg]"
    recipe = tmp_path / "recipe.yaml"
    recipe.write_text(f"recipe: 1\nbase: ./base.xml\nattach: {{p: {{model: ./p.xml, {place}{offset}}}}}\n")
    text, told = composed(recipe)
    if any("omits only some copies" in line for line in told):
        pytest.skip("MuJoCo fuses some copies of a body only")
    assert text is not None, told
    alone = mujoco.MjModel.from_xml_path(str(tmp_path / "p.xml"))
    whole = mujoco.MjModel.from_xml_string(text)
    before = _poses(alone)
    after = _poses(whole)
    turn = after["site", "p/w"][1] @ before["site", "w"][1].T
    moved = after["site", "p/w"][0] - turn @ before["site", "w"][0]
    for (kind, name), (position, matrix) in before.items():
        there = after[kind, f"p/{name}"]
        assert there[0] == pytest.approx(turn @ position + moved, abs=1e-9), (kind, name)
        assert there[1] == pytest.approx(turn @ matrix, abs=1e-9), (kind, name)
        if kind == "body":
            weights = (whole.body_gravcomp[whole.body(f"p/{name}").id], alone.body_gravcomp[alone.body(name).id])
            assert weights[0] == weights[1], name
