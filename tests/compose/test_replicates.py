"""What a recipe adds to a model with a `<replicate>`, or says of what is inside of one."""

from __future__ import annotations

import json
from pathlib import Path

import mujoco
import pytest
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

POSTS = """
<mujoco><asset><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset><worldbody>
  <replicate count="2" offset="0 3 0"><replicate count="2" offset="3 0 0" euler="0 0 20"><body name="post">
    <joint name="pj"/><geom name="pg" size=".05" pos="0 0 .1"/></body></replicate></replicate>
  <body name="last" pos="9 0 0"><joint name="j1"/><geom name="lg" size=".05"/></body></worldbody>
  {0}<keyframe><key name="k" qpos="1 2 3 4 5"/></keyframe></mujoco>
"""
ADDED = """
sensor:
  clk: {type: clock}
  p: {type: e_potential}
  k: {type: e_kinetic}
  u: {type: user, dim: 2, needstage: pos}
  j: {type: jointpos, joint: j1}
custom: {tuple: {t: {element: [{objtype: mesh, objname: m}]}}, numeric: {n: {data: [1, 2]}}}
"""
HELD = '<actuator><motor name="pm" joint="pj"/></actuator>'
TOOL = '<mujoco><worldbody><body name="a" pos="0 0 5"><geom name="g" size=".1"/></body></worldbody></mujoco>'


def built(folder: Path, recipe: str, posts: str = POSTS.format("")) -> mujoco.MjModel | list[Diagnostic]:
    for name, text in {"b.xml": posts, "t.xml": TOOL, "r.yaml": f"recipe: 1\nbase: ./b.xml\n{recipe}"}.items():
        (folder / name).write_text(text)
    context = Context(environment={}, folder=folder)
    done = build(ModelRequest(folder / "r.yaml"), context)
    if done is None:
        return list(context.sink.errors)
    return mujoco.MjModel.from_xml_string(done.bundle.files["model.xml"].decode())


@pytest.mark.mujoco4("it refuses keys beside joints in a replicate")
@pytest.mark.parametrize("attach", ["", "attach: {t: {model: ./t.xml}}\n"])
def test_what_the_recipe_adds_is_not_multiplied(tmp_path: Path, attach: str) -> None:
    alone = mujoco.MjModel.from_xml_string(POSTS.format(""))
    model = built(tmp_path, attach + ADDED)
    assert isinstance(model, mujoco.MjModel), model
    assert (model.nsensor, model.ntuple, model.nnumeric, model.njnt) == (5, 1, 1, alone.njnt)
    for at in range(alone.nbody):
        there = model.body(alone.body(at).name)
        assert there.pos == pytest.approx(alone.body(at).pos, abs=1e-15)
        assert there.quat == pytest.approx(alone.body(at).quat, abs=1e-15)
    for at in range(alone.njnt):
        name = alone.joint(at).name
        assert model.key("k").qpos[model.joint(name).qposadr] == alone.key("k").qpos[alone.joint(at).qposadr]


@pytest.mark.mujoco4("it refuses keys beside joints in a replicate")
@pytest.mark.parametrize(
    ("added", "posts"),
    [(ADDED, POSTS.format(HELD)), (ADDED + "actuator: {m: {type: motor, joint: pj}}\n", POSTS.format(""))],
)
def test_what_would_be_multiplied_is_one_error(tmp_path: Path, added: str, posts: str) -> None:
    found = built(tmp_path, added, posts)
    assert isinstance(found, list)
    assert {each.code for each in found} == {"not-supported"}
    assert all("MuJoCo would multiply" in each.message for each in found)
    assert all(each.span is not None and each.span.file == "r.yaml" for each in found)


@pytest.mark.mujoco4("it refuses keys beside joints in a replicate")
def test_sensors_of_replicated_joints_are_multiplied(tmp_path: Path) -> None:
    model = built(tmp_path, "sensor: {s: {type: jointpos, joint: pj}}\n")
    assert isinstance(model, mujoco.MjModel), model
    assert model.nsensor == 4


@pytest.mark.mujoco4("it refuses keys beside joints in a replicate")
def test_contacts_by_parts_name_every_copy(tmp_path: Path) -> None:
    recipe = (
        "attach: {t: {model: ./t.xml}}\ncontact:\n"
        "  exclude: [{between: [t, base]}, {between: [post, post]}]\n  collide: [{between: [t, post]}]\n"
    )
    model = built(tmp_path, recipe)
    assert isinstance(model, mujoco.MjModel), model
    pairs = {
        frozenset((model.body(int(each) >> 16).name, model.body(int(each) & 0xFFFF).name))
        for each in model.exclude_signature
    }
    posts = ["post00", "post10", "post01", "post11"]
    assert {frozenset(("t/a", each)) for each in [*posts, "last"]} <= pairs
    assert {frozenset((one, other)) for one in posts for other in posts if one != other} <= pairs
    geoms = {
        frozenset((model.geom(int(a)).name, model.geom(int(b)).name))
        for a, b in zip(model.pair_geom1, model.pair_geom2, strict=True)
    }
    assert geoms == {frozenset(("t/g", each.replace("post", "pg"))) for each in posts}


SCALED = """
<mujoco><worldbody><frame scale="2"><body name="a"><joint name="aj" type="slide" range="0 1"/><geom size=".1"/>
    <body name="b" pos="1 0 0"><geom size=".1"/></body></body></frame>
  <frame name="heavy" massscale="3"><body name="c"><geom size=".1"/></body></frame>
  <body name="d" pos="3 0 0"><geom size=".1"/><body name="e"><geom size=".1"/></body></body></worldbody></mujoco>
"""


@pytest.mark.skipif(
    mujoco.mj_versionString().startswith(("3.12", "3.13", "3.14", "3.15")), reason="frames scale since 3.16"
)
@pytest.mark.parametrize(
    ("recipe", "works"),
    [
        ("edit: [{select: {body: b}, move: {to: world}}]", False),
        ("edit: [{select: {body: e}, move: {to: a}}]", False),
        ("edit: [{select: {body: b}, move: {to: c}}]", False),
        ("edit: [{select: {body: c}, move: {to: d}}]", False),
        ("edit: [{select: {body: e}, move: {to: {frame: heavy}}}]", False),
        ("edit: [{select: {body: e}, move: {to: world}}]", True),
        ("edit: [{select: {frame: heavy}, move: {to: d}}]", True),
        ("add: [{to: b, site: {name: new, pos: [1, 0, 0]}}]", False),
        ("add: [{to: d, site: {name: new, pos: [1, 0, 0]}}]", True),
    ],
)
def test_nothing_is_scaled_by_a_move(tmp_path: Path, recipe: str, works: bool) -> None:
    found = built(tmp_path, recipe, SCALED)
    if works:
        assert isinstance(found, mujoco.MjModel), found
        alone = mujoco.MjModel.from_xml_string(SCALED)
        for at in range(1, alone.nbody):
            assert found.body(alone.body(at).name).mass == pytest.approx(alone.body(at).mass)
        return
    assert isinstance(found, list)
    assert [(each.code, each.span and each.span.line) for each in found] == [("not-supported", 3)]
    assert "a frame that scales" in found[0].message


RACK = """<mujoco model="rack"><worldbody><body name="wall" pos="0 0 1"><joint name="slide" type="slide"/><geom size=".1"/>
  <replicate count="2" offset="0 1 0"><frame name="shelf" pos="0 0 .5"><replicate count="12" offset=".3 0 0" euler="0 0 10" sep="_">
    <site name="slot" pos=".1 0 0"/><body name="tray" pos="0 0 .1"><joint name="open"/><geom size=".02"/></body></replicate>
  </frame></replicate></body></worldbody>
  <keyframe><key name="home" qpos="{}"/></keyframe></mujoco>""".format(" ".join(str(at / 10) for at in range(25)))
"""Without references from outside, its copies can be written out."""
PLACES = {"site": "slot_07{}", "body": "tray_11{}", "frame": "shelf{}"}


@pytest.mark.mujoco4("it refuses keys beside joints in a replicate")
@pytest.mark.parametrize(("kind", "name"), PLACES.items())
@pytest.mark.parametrize("number", [0, 1])
@pytest.mark.parametrize("inner", [False, True])
def test_a_part_is_attached_to_one_copy(tmp_path: Path, kind: str, name: str, number: int, inner: bool) -> None:
    """To the copy that has the name, in the base and in a part; the model is otherwise what it is alone."""
    alone = mujoco.MjModel.from_xml_string(RACK)
    name = name.format(number)
    prefix = "rack/" if inner else ""
    if inner:
        recipe = f"attach:\n  rack: {{model: ./b.xml}}\n  t: {{model: ./t.xml, {kind}: rack/{name}}}\n"
        (tmp_path / "empty.xml").write_text("<mujoco><worldbody/></mujoco>")
    else:
        recipe = f"attach: {{t: {{model: ./t.xml, {kind}: {name}}}}}\n"
    model = built(tmp_path, recipe, RACK)
    if inner:  # the base of `built` is the rack, too
        pass
    assert isinstance(model, mujoco.MjModel), model
    assert model.nbody == alone.nbody * (2 if inner else 1) + 1 - inner
    data = mujoco.MjData(model)
    before = mujoco.MjData(alone)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_kinematics(alone, before)
    if kind != "frame":
        place = before.site(name) if kind == "site" else before.body(name)
        tool = data.body("t/a").xpos - place.xmat.reshape(3, 3) @ [0, 0, 5]
        assert tool == pytest.approx(place.xpos, abs=1e-12)
    for at in range(1, alone.nbody):
        body = alone.body(at).name
        assert data.body(prefix + body).xpos == pytest.approx(before.body(body).xpos, abs=1e-12)
    for at in range(alone.njnt):
        joint = alone.joint(at).name
        mine = alone.key("home").qpos[alone.joint(joint).qposadr]
        assert model.key("home").qpos[model.joint(prefix + joint).qposadr] == mine


RAILS = """
<mujoco>
  <worldbody>
    <replicate count="2" euler="10 20 30">
      <body name="post">
        <joint name="pj"/>
        <geom size=".05"/>
      </body>
    </replicate>
  </worldbody>
</mujoco>
"""
EDITED = """recipe: 1
base: ./clock.xml
attach:
  r:
    model: ./rails.xml
    edit:
      - select: {joint: pj}
        set: {damping: 3}
"""


def test_copies_that_are_written_out_have_the_origin_of_the_edit(tmp_path: Path) -> None:
    (tmp_path / "rails.xml").write_text(RAILS)
    (tmp_path / "clock.xml").write_text("<mujoco><sensor><clock/></sensor></mujoco>")
    (tmp_path / "r.yaml").write_text(EDITED)
    done = build(ModelRequest(tmp_path / "r.yaml"), Context(environment={}, folder=tmp_path))
    assert done is not None
    joints = json.loads(done.bundle.files["manifest.json"])["index"]["joints"]
    assert [(joint["name"], joint["origin"]) for joint in joints] == [("r/pj0", "r.yaml:8"), ("r/pj1", "r.yaml:8")]
