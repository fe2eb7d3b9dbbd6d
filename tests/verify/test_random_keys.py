"""Random models with replicates and flexes, edited and joined at random: no key is other than MuJoCo's names say."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import mujoco
import pytest
from hypothesis import given, settings, strategies as st
from link.test_key_layout import World
from lxml import etree
from mjcompose.mujoco.engine import Session
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Path, Session]]:
    with Session() as session:
        yield tmp_path_factory.mktemp("keys"), session


def keyed(draw: st.DrawFn, world: str) -> str | None:
    """A model with actuators on its joints and a key of numbers that are all different; None if MuJoCo refuses it."""
    actuators = ""
    for at, joint in enumerate(etree.fromstring(f"<w>{world}</w>").iter("joint")):
        tag = draw(st.sampled_from(("", "motor", 'position timeconst=".1"', 'general dyntype="filter"')))
        actuators += f'<{tag} name="m{at}" joint="{joint.get("name")}"/>' if tag else ""
    text = f"<mujoco><worldbody>{world}</worldbody><actuator>{actuators}</actuator>{{}}</mujoco>"
    try:
        model = mujoco.MjModel.from_xml_string(text.format(""))
    except ValueError:
        return None
    sizes = {"qpos": model.nq, "qvel": model.nv, "act": model.na, "ctrl": model.nu, "mpos": 3 * model.nmocap}
    rows = {
        vector: " ".join(f"{first + at / 1000:.3f}" for at in range(size))
        for first, (vector, size) in enumerate(sizes.items(), 1)
        if size
    }
    key = " ".join(f'{vector}="{row}"' for vector, row in rows.items())
    return text.format(f'<keyframe><key name="k" {key}/></keyframe>')


def edit(draw: st.DrawFn, model: str) -> str:
    root = etree.fromstring(model)
    bodies = [str(each.get("name")) for each in root.iter("body")]
    joints = [str(each.get("name")) for each in root.iter("joint")]
    kind = draw(st.sampled_from(("move", "remove", "type", "rename", "count", "grid", "convert")))
    if kind == "move" and bodies:
        body = draw(st.sampled_from(bodies))
        to = draw(st.sampled_from([*bodies, "world"]))
        return f"{{select: {{body: {body}}}, move: {{to: {to}}}}}"
    if kind in ("remove", "type", "rename") and joints:
        verb = {"remove": "remove: cascade", "type": "set: {type: ball}", "rename": "rename: other"}[kind]
        return f"{{select: {{joint: {draw(st.sampled_from(joints))}}}, {verb}, optional: true}}"
    if kind == "count":
        return '{select: {replicate: "*"}, set: {count: 2}, optional: true}'
    if kind == "grid":
        return '{select: {flexcomp: "*"}, set: {count: [3, 3, 1]}, optional: true}'
    return '{select: {motor: "*"}, convert: {to: position, kp: 4}, optional: true}'


@st.composite
def compositions(draw: st.DrawFn) -> tuple[str, str, str] | None:
    base = keyed(draw, World(draw).inside(3, world=True))
    part = keyed(draw, World(draw).inside(2, world=True))
    if base is None or part is None:
        return None
    bodies = [str(each.get("name")) for each in etree.fromstring(base).iter("body")]
    at = draw(
        st.sampled_from(["pos: [1, 2, 3]", "euler: [10deg, 20deg, 30deg]", *(f"body: {each}" for each in bodies)])
    )
    own, whole = (", ".join(edit(draw, text) for _ in range(draw(st.integers(0, 2)))) for text in (part, base))
    added = (
        f"add: [{{to: {bodies[0]}, body: {{name: new, joint: {{name: nj}}, geom: {{size: 0.02}}}}}}]" if bodies else ""
    )
    policy = draw(st.sampled_from(("merge", "prefix")))
    recipe = f"""
recipe: 1
base: ./base.xml
attach:
  t: {{model: ./part.xml, {at}, keys: {policy}, edit: [{own}]}}
  u: {{model: ./part.xml, pos: [0, 0, 9], drop: [{{key: "**", optional: true}}]}}
edit: [{whole}]
{added}
keyframe: {{mine: {{from: {{base: k, t: k}}}}}}
"""
    return base, part, recipe


@given(case=compositions())
@settings(max_examples=60, deadline=None)
def test_no_key_is_wrong(place: tuple[Path, Session], case: tuple[str, str, str] | None) -> None:
    if case is None:
        return
    folder, session = place
    for name, text in zip(("base.xml", "part.xml", "recipe.yaml"), case, strict=True):
        (folder / name).write_text(text)
    context = Context(environment={}, folder=folder)
    build(ModelRequest(folder / "recipe.yaml"), context, session=session)
    assert [each.message for each in context.sink.errors if each.code == "keyframe-wrong"] == []
