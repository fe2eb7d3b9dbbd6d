"""Names that MuJoCo makes of a `<flexcomp>`, and those by which a rod finds its twists: renamed, removed and cut with it."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import pytest
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

OLDER = mujoco.mj_versionString().startswith("3.")
NET = """
<mujoco><worldbody><body name="frame" pos="0 0 1"><geom size=".05"/>
  <flexcomp name="net" type="grid" count="3 3 1" spacing=".1 .1 .1" dim="2" mass=".2" radius=".005"><edge equality="true"/>
    <contact selfcollide="none"/></flexcomp>
  <flexcomp name="net_1" type="grid" count="2 2 1" spacing=".1 .1 .1" dim="2" mass=".2" radius=".005" pos="0 0 1">
    <edge equality="true"/><contact selfcollide="none"/></flexcomp></body>
  <body name="load" pos=".1 .1 1"><freejoint/><geom size=".03"/></body><site name="net_site"/></worldbody>
  <equality><weld name="w" body1="net_8" body2="load"/><connect name="c" body1="net_1_3" body2="load" anchor="0 0 0"/></equality>
  <contact><exclude name="x" body1="load" body2="net_0"/></contact>
  <sensor><framepos name="s" objtype="xbody" objname="net_4"/><framepos name="t" objtype="body" objname="net_1_0"/>
    <framepos name="u" objtype="site" objname="net_site"/></sensor></mujoco>
"""
TWISTED = """
<mujoco><worldbody><body name="frame" pos="0 0 1"><geom size=".05"/>
  <flexcomp name="rod" type="grid" count="4 1 1" spacing=".1 .1 .1" dim="1" mass=".1" radius=".01"><edge equality="true"/>
    <elasticity young="1e5" poisson="0"/><contact selfcollide="none"/></flexcomp></body></worldbody>
  <actuator><motor name="m" joint="rod_twist"/></actuator><sensor><jointpos name="s" joint="rod_twist_1"/></sensor></mujoco>
"""
RECIPE = "recipe: 1\nbase: {{model: ./m.xml, {0}}}"


def built(folder: Path, source: str, recipe: str) -> mujoco.MjModel | list[Diagnostic]:
    (folder / "m.xml").write_text(source)
    (folder / "r.yaml").write_text(recipe)
    context = Context(environment={}, folder=folder)
    done = build(ModelRequest(folder / "r.yaml"), context)
    if done is None:
        return list(context.sink.errors)
    return mujoco.MjModel.from_xml_string(done.bundle.files["model.xml"].decode())


def names(model: object, kind: str) -> set[str]:
    assert isinstance(model, mujoco.MjModel), model
    count = {"equality": "neq", "sensor": "nsensor", "body": "nbody", "joint": "njnt", "actuator": "nactuator"}[kind]
    return {getattr(model, kind)(at).name for at in range(getattr(model, count, 0))}


@pytest.mark.parametrize("edit", ["base", "recipe"])
def test_what_a_flexcomp_makes_is_renamed_with_it(tmp_path: Path, edit: str) -> None:
    entry = "edit: [{select: {flexcomp: net}, rename: sheet}, {select: {flexcomp: net_1}, rename: other}]"
    recipe = RECIPE.format(entry) if edit == "base" else f"recipe: 1\nbase: ./m.xml\n{entry}"
    model = built(tmp_path, NET, recipe)
    assert {"sheet_8", "sheet_0", "other_3"} <= names(model, "body")
    assert names(model, "sensor") == {"s", "t", "u"}
    assert names(model, "equality") >= {"w", "c"}


@pytest.mark.parametrize("entry", ["drop: [{flexcomp: net}]", "edit: [{select: {flexcomp: net}, remove: cascade}]"])
def test_what_refers_to_it_goes_with_it(tmp_path: Path, entry: str) -> None:
    model = built(tmp_path, NET, RECIPE.format(entry))
    assert names(model, "equality") - {""} == {"c"}
    assert names(model, "sensor") == {"t", "u"}
    model = built(tmp_path, NET, RECIPE.format("drop: [{body: frame}]"))
    assert names(model, "equality") == set()
    assert names(model, "sensor") == {"u"}


def test_a_flexcomp_that_is_referred_to_stays(tmp_path: Path) -> None:
    found = built(tmp_path, NET, RECIPE.format("edit: [{select: {flexcomp: net}, remove: true}]"))
    assert isinstance(found, list)
    assert [each.code for each in found] == ["still-referred-to"]
    assert found[0].span is not None and found[0].span.file == "r.yaml"
    assert any("net_8" in str(note) for note in found[0].notes)


def raw(folder: Path) -> str:
    """The rod as MuJoCo saves it: bodies, joints and a `<flex>`."""
    spec = mujoco.MjSpec.from_string(TWISTED)
    spec.compile()
    return str(spec.to_xml())


def torsion(model: object) -> list[str]:
    """The joints that the rod's bends are twisted by."""
    assert isinstance(model, mujoco.MjModel), model
    rows = model.flex_bending.ravel()
    return [model.joint(int(rows[at + 7])).name if rows[at + 7] >= 0 else "" for at in range(1, len(rows), 10)]


@pytest.mark.skipif(OLDER, reason="rods twist since MuJoCo 4.0")
def test_a_rod_keeps_its_twists(tmp_path: Path) -> None:
    assert torsion(built(tmp_path, TWISTED, RECIPE.format("edit: [{select: {flexcomp: rod}, rename: wire}]"))) == [
        "wire_twist_1",
        "wire_twist",
    ]
    model = built(tmp_path, raw(tmp_path), RECIPE.format("edit: [{select: {flex: rod}, rename: wire}]"))
    assert torsion(model) == ["wire_twist_1", "wire_twist"]
    assert isinstance(model, mujoco.MjModel)
    assert model.joint(model.actuator("m").trnid[0]).name == "wire_twist"


@pytest.mark.skipif(OLDER, reason="rods twist since MuJoCo 4.0")
@pytest.mark.parametrize(
    ("entry", "code"),
    [
        ("edit: [{select: {joint: rod_twist_0}, rename: other}]", "bad-name"),
        ('edit: [{select: {joint: "rod_twist*"}, rename: "x${index}"}]', "bad-name"),
        ("edit: [{select: {joint: rod_twist_0}, remove: true}]", "still-referred-to"),
    ],
)
def test_joints_of_a_rod_stay_with_it(tmp_path: Path, entry: str, code: str) -> None:
    found = built(tmp_path, raw(tmp_path), RECIPE.format(entry))
    assert isinstance(found, list)
    assert [(each.code, each.span and each.span.file) for each in found] == [(code, "r.yaml")]


@pytest.mark.skipif(OLDER, reason="rods twist since MuJoCo 4.0")
def test_a_rod_whose_twists_are_elsewhere_is_left_out(tmp_path: Path) -> None:
    (tmp_path / "m.xml").write_text(raw(tmp_path))
    (tmp_path / "r.yaml").write_text("recipe: 1\nattach: {a: {model: ./m.xml, subtree: frame}}")
    context = Context(environment={}, folder=tmp_path)
    done = build(ModelRequest(tmp_path / "r.yaml"), context)
    assert done is not None
    assert "subtree-cut" in [each.code for each in context.sink.diagnostics]
    assert b"<flex " not in done.bundle.files["model.xml"]


@pytest.mark.skipif(OLDER, reason="rods twist since MuJoCo 4.0")
@pytest.mark.parametrize("source", ["flexcomp", "flex", "circle"])
def test_a_moved_rod_is_unchanged(tmp_path: Path, source: str) -> None:
    """The bends of a circle have four vertices, and no joint where other bends have one."""
    circle = re.sub("<actuator>.*</sensor>", "", TWISTED).replace('type="grid" count="4', 'type="circle" count="5')
    text = {"flexcomp": TWISTED, "flex": raw(tmp_path), "circle": circle}[source]
    base = '<mujoco><worldbody><body name="b" pos="0 0 1"><joint/><geom size=".1"/></body></worldbody></mujoco>'
    (tmp_path / "b.xml").write_text(base)
    recipe = "recipe: 1\nbase: ./b.xml\nattach: {a: {model: ./m.xml, pos: [1, 2, 3]}, c: {model: ./m.xml}}\ncheck: {all: {unchanged: {}}}"
    assert isinstance(built(tmp_path, text, recipe), mujoco.MjModel)
