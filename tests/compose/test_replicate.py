"""Copies of a part are where MuJoCo's own `<replicate>` puts them."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from composer.context import Context
from composer.stages import Request, build

PART = """
<mujoco model="part"><worldbody>
  <body name="b" pos=".1 .2 .3" quat="1 .2 0 .1"><site name="s" pos="0 .1 0" quat="1 0 .3 0"/><geom size=".1"/>
    <body name="c" pos="0 0 .2"><joint name="j"/><geom size=".05"/></body></body>
</worldbody></mujoco>
"""


def models(folder: Path, part: str, recipe: str) -> mujoco.MjModel:
    (folder / "part.xml").write_text(part)
    (folder / "recipe.yaml").write_text(recipe)
    context = Context(environment={}, folder=folder)
    built = build(Request(folder / "recipe.yaml", verified=False), context)
    assert built is not None, [each.message for each in context.sink.diagnostics]
    return mujoco.MjModel.from_xml_string(built.bundle.files["model.xml"].decode())


def assert_same_places(ours: mujoco.MjModel, theirs: mujoco.MjModel) -> None:
    found = []
    for model in (ours, theirs):
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        found.append(data)
    assert ours.nbody == theirs.nbody > 3
    np.testing.assert_allclose(found[0].xpos, found[1].xpos, atol=1e-12)
    np.testing.assert_allclose(found[0].xmat, found[1].xmat, atol=1e-12)


@pytest.mark.parametrize("sequence", ["xyz", "XYZ", "zyx"])
@pytest.mark.parametrize(
    ("axes", "opened"),
    [
        ("[{count: 4, offset: [.3, 0, .1]}]", '<replicate count="4" offset=".3 0 .1">'),
        (
            "[{count: 5, offset: [.3, .1, 0], euler: [10, 20, -35]}]",
            '<replicate count="5" offset=".3 .1 0" euler="10 20 -35">',
        ),
        (
            "[{count: 3, offset: [1, 0, 0], euler: [0, 30, 5]}, {count: 11, offset: [0, .2, .1], euler: [7, 0, 9]}]",
            '<replicate count="3" offset="1 0 0" euler="0 30 5"><replicate count="11" offset="0 .2 .1" euler="7 0 9">',
        ),
        ("[{count: 2, euler: [0, 0, 90]}, {count: 1}]", '<replicate count="2" euler="0 0 90">'),
    ],
)
def test_as_mujoco_has_it(tmp_path: Path, sequence: str, axes: str, opened: str) -> None:
    ours = models(
        tmp_path,
        PART,
        f"recipe: 1\nangle: degree\neulerseq: {sequence}\nattach:\n"
        f"  p: {{model: ./part.xml, pos: [1, 2, 3], euler: [15, -25, 50], replicate: {axes}}}\n",
    )
    body = PART.split("<worldbody>")[1].split("</worldbody>")[0]
    theirs = mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler eulerseq="{sequence}"/><worldbody><frame pos="1 2 3" euler="15 -25 50">{opened}{body}'
        f"{'</replicate>' * opened.count('<replicate')}</frame></worldbody></mujoco>"
    )
    assert_same_places(ours, theirs)


def test_turned_about_the_mate(tmp_path: Path) -> None:
    """With `mate` it is that site that is copied from place to place, and the part turns about it."""
    ours = models(
        tmp_path,
        PART,
        "recipe: 1\nattach: {p: {model: ./part.xml, mate: s, pos: [1, 0, 0], "
        "replicate: [{count: 3, offset: [0, 1, 0], euler: [0, 0, 30deg]}]}}\n",
    )
    data = mujoco.MjData(ours)
    mujoco.mj_forward(ours, data)
    theirs = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><replicate count="3" offset="0 1 0" euler="0 0 30"><site name="s"/></replicate>'
        "</worldbody></mujoco>"
    )
    np.testing.assert_allclose(data.site_xpos, theirs.site_pos + np.array([1, 0, 0]), atol=1e-12)
    for at, quat in enumerate(theirs.site_quat):
        matrix = np.zeros(9)
        mujoco.mju_quat2Mat(matrix, quat)
        np.testing.assert_allclose(data.site_xmat[at], matrix, atol=1e-12)


def test_names_are_padded(tmp_path: Path) -> None:
    model = models(
        tmp_path, PART, "recipe: 1\nattach: {p: {model: ./part.xml, replicate: [{count: 2}, {count: 11}]}}\n"
    )
    names = [model.body(at).name for at in range(1, model.nbody, 2)]
    assert names[:2] + names[10:13] + names[-1:] == [
        "p0_00/b", "p0_01/b", "p0_10/b", "p1_00/b", "p1_01/b", "p1_10/b",
    ]  # fmt: skip


def test_a_part_may_hang_on_a_copy_and_keys_go_with_the_copies(tmp_path: Path) -> None:
    cube = PART.replace('<joint name="j"/>', "").replace("<site", '<freejoint/><site name="top"/><site')
    cube = cube.replace(
        "</mujoco>",
        '<keyframe><key name="home" qpos="0 0 1 1 0 0 0" qvel="1 0 0 0 0 0"/></keyframe></mujoco>',
    )
    model = models(
        tmp_path,
        cube,
        "recipe: 1\nattach:\n  lid: {model: ./part.xml, joint: weld, site: cube1/top}\n"
        "  cube: {model: ./part.xml, replicate: [{count: 3, offset: [1, 0, 0], euler: [0, 0, 90deg]}]}\n",
    )
    assert model.body("lid/b").parentid[0] == model.body("cube1/b").id
    qpos, qvel = model.key("home").qpos.reshape(3, 7), model.key("home").qvel.reshape(3, 6)
    half = np.sqrt(0.5)
    np.testing.assert_allclose(
        qpos,
        [[0, 0, 1, 1, 0, 0, 0], [1, 0, 1, half, 0, 0, half], [1, 1, 1, 0, 0, 0, 1]],
        atol=1e-12,
    )
    np.testing.assert_allclose(qvel[:, :3], [[1, 0, 0], [0, 1, 0], [-1, 0, 0]], atol=1e-12)
